# SPDX-License-Identifier: GPL-3.0-or-later
"""The method, as it is written in the paper.

Beck-Norén & Valter, "Soft shadows in real time by imperfect shadow maps and screen space ambient occlusion", 2013.
"""

import itertools
import math
import time
from collections.abc import Callable, Collection, Iterator

import numpy as np

from ..render_passes import COMBINED, RenderPass
from ..sampling import PIXEL_GRIDS, narrow_pixel_grid, pixel_grid
from ..scene import Scene, View
from ..settings import Method, Settings
from ..spaces import anchor_of, camera_position
from .atlas import batches
from .convergence import Convergence
from .frame import Frame, Pass
from .gl import frame_uniforms
from .gl.context import Device
from .gl.errors import Cancelled
from .gl.render_targets import DEPTH, Targets
from .memory_estimate import check, needed
from .passes.direct.predict_visibility import PredictVisibility
from .passes.direct.trace_faint_lights import TraceFaintLights
from .passes.direct.trace_shadows import TraceShadows
from .passes.environment.ambient_occlusion import AmbientOcclusion
from .passes.environment.blur import BlurOcclusion
from .passes.film.accumulate import Accumulate, filter_margin
from .passes.film.debug_image import DebugImage
from .passes.film.estimate_error import EstimateError, is_due
from .passes.film.resolve import Resolve
from .passes.film.shade import Shade
from .passes.light_selection.cull_lights import CullLights
from .passes.light_selection.probe_visibility import ProbeVisibility
from .passes.light_selection.retest_occluded import RetestOccluded
from .passes.shadow_maps.fill_holes import FillHoles
from .passes.shadow_maps.gather import GatherLight
from .passes.shadow_maps.light_importance import WeighLights
from .passes.shadow_maps.sample_points import SamplePoints
from .passes.shadow_maps.select_points import SelectPoints
from .passes.shadow_maps.splat import SplatMaps
from .passes.shadow_maps.virtual_lights import PlaceVirtualLights
from .passes.surfaces.gbuffer import GBuffer
from .passes.surfaces.select_tiles import SelectTiles
from .passes.upload.build_bvh import BuildBLAS, BuildTLAS
from .passes.upload.cull_meshes import CullMeshes
from .passes.upload.upload_lights import UploadLights
from .passes.upload.upload_scene import UploadInstances, UploadMaterials, UploadMeshes, UploadUVs
from .profile import Profile
from .read_back import image
from .submission import Submission, never

#: The scene, in the order that suits shadow rays;
SCENE = (CullMeshes, BuildBLAS, UploadMeshes, UploadUVs, UploadInstances, UploadMaterials)
#: what the camera sees of it, in the parts of the picture that the sample is spent on, and the lights that reach it
#: (the trees of large meshes are made while the camera looks);
BEFORE = (*SCENE, SelectTiles, GBuffer, UploadLights, BuildTLAS, CullLights)
#: what of them arrives, by a few rays that predict it and more that say how wrong that is;
FITTED = (ProbeVisibility, RetestOccluded, PredictVisibility, TraceShadows, TraceFaintLights)
#: or as in the paper: the scene as points, and for as many light points as an atlas holds an imperfect shadow map each,
#: filled, and the light they let through,
CLASSIC = (SamplePoints, WeighLights, PlaceVirtualLights, SelectPoints)
FOR_EACH_BATCH = (SplatMaps, FillHoles, GatherLight)
#: the creases too small for either, and all of it put together; again with other points, and summed.
AFTER = (AmbientOcclusion, BlurOcclusion, Shade, DebugImage, Accumulate)
#: Whenever the picture is wanted: the sums as one; and how far that is from its end.
AT_LAST = Resolve
JUDGED = EstimateError

PASSES = (*BEFORE, *FITTED, *CLASSIC, *FOR_EACH_BATCH, *AFTER, AT_LAST, JUDGED)

#: What settings.debug_view may name: whatever is drawn before it is shown.
SHOWABLE = tuple(
    name
    for kind in PASSES
    for name, target in kind.writes.items()
    if target.dtype != DEPTH
    and name != "triangles"
    and kind not in (SelectTiles, CullLights, RetestOccluded, DebugImage, Accumulate, Resolve, EstimateError)
)

#: Pixels of the largest picture of triangles' numbers, 12 bytes each.
MAX_FINE_PIXELS = 1 << 25


class Renderer:
    """Draws samples of pictures; keeps what the next one can use again."""

    def __init__(self, device: Device):
        self.device = device
        self.pace = Submission(device)
        self.passes = {kind: kind(device) for kind in PASSES}
        self.targets = Targets(device.gl)
        self.tables: dict = {}
        self.block = device.gl.buffer(reserve=frame_uniforms.DTYPE.itemsize)
        self.keys: dict[type[Pass], dict] = {}
        #: Of targets and other resources: the same number where they hold the same.
        self.revisions: dict[str, int] = {}
        self.numbers = itertools.count(1)
        #: Of each pass, for the newest first sample that it was drawn for: its key, and the revisions of what it made.
        self.firsts: dict[type[Pass], tuple[dict, dict[str, int]]] = {}

    def sample(
        self,
        scene: Scene,
        view: View,
        settings: Settings,
        sample: int,
        profile: Profile,
        low_latency: bool = False,
        cancelled: Callable[[], bool] = never,
    ) -> Iterator[str]:
        """Draw one sample, and yield the name of each pass when the GPU has been asked for it, see submission.py.

        With `low_latency` the first sample comes sooner, and all that follow come later. Raises Cancelled within a long
        pass if that is so: then the picture is lost, and another may be begun.
        """
        self.pace.begin(sample, cancelled)
        frame = self.frame(scene, view, settings, sample, profile, low_latency)
        for kind in (*BEFORE, *FITTED, *CLASSIC):
            yield self.run(kind, frame, profile)
        points = sum(self.tables.get("points_per_light", {}).values())
        for frame.batch in batches(points, settings.quality.map_size, self.device.texture_size):
            for kind in FOR_EACH_BATCH:
                yield self.run(kind, frame, profile)
        frame.batch = None
        for kind in AFTER:
            yield self.run(kind, frame, profile)
        for kind in (AT_LAST, JUDGED) if is_due(sample, settings.quality.samples) else (JUDGED,):
            yield self.run(kind, frame, profile)
        self.pace.end()
        profile.counts["bytes_of_targets"] = self.targets.bytes
        self.last = frame, profile
        self.device.collect()

    def frame(
        self, scene: Scene, view: View, settings: Settings, sample: int, profile: Profile, low_latency: bool = False
    ) -> Frame:
        """What the passes are told about this sample. Raises ValueError if there is no such target to show.

        And MemoryError for a picture that would take more memory than there is.
        """
        if settings.debug_view not in SHOWABLE:
            raise ValueError(f"there is no target {settings.debug_view} to show, only {', '.join(SHOWABLE)}")
        limit = self.device.texture_size
        if max(view.width, view.height) > limit:
            raise ValueError(
                f"{view.width}×{view.height} pixels are more than the {limit}×{limit} that this OpenGL can draw at once"
            )
        camera = camera_position(view.view_from_world)
        anchor = anchor_of(camera, scene.extent)
        # The first sample is at the pixels' centres in any case; drawn for itself, it comes sooner.
        alone, samples = low_latency and sample == 0, settings.quality.samples
        count = 1 if alone else samples_per_visibility_buffer(view, samples, limit)
        narrow = filter_margin(view.filter_width) == 0
        fine = narrow_pixel_grid(sample, view.filter_width) if narrow else pixel_grid(sample // count, count)
        if sample == 0:
            self.estimate(scene, view, settings, int(fine.bounds(view.width, view.height)[1].prod()))
        self.block.write(frame_uniforms.frame_block(view, anchor, scene.working_space))
        return Frame(
            self.device,
            scene,
            view,
            settings,
            sample,
            anchor,
            self.targets,
            self.tables,
            profile.counts,
            fine,
            self.pace,
        )

    def estimate(self, scene: Scene, view: View, settings: Settings, fine_pixels: int) -> None:
        """Raises MemoryError if a picture would take more than there is."""
        fitted = settings.shadow.method == Method.RAY_TRACED
        others = (*CLASSIC, *FOR_EACH_BATCH) if fitted else FITTED
        casting = int(scene.lights.casts_shadow.sum()) if settings.shadow.enabled else 0
        lights, map_texels = (casting if fitted else 0), 0
        if casting and not fitted:
            points = max(settings.quality.virtual_lights, casting)
            atlas, *_ = batches(points, settings.quality.map_size, self.device.texture_size)
            map_texels = math.prod(atlas.size)
        wanted = needed([kind for kind in PASSES if kind not in others], view, fine_pixels, lights, map_texels)
        check(self.device.gl, wanted - self.targets.bytes, view, lights)

    def run(self, kind: type[Pass], frame: Frame, profile: Profile) -> str:
        """Draw one pass if the picture needs it and something that it depends on is new."""
        step, row = self.passes[kind], profile.rows[kind.__name__]
        needed = step.needed(frame)
        key = self.key(kind, frame) if needed else {}
        done = not needed and frame.sample > 0  # what it made for the first sample is kept for the next picture's
        may_reuse = frame.settings.shortcuts or frame.sample > 0 or not needed
        if may_reuse and kind in self.keys and (done or self.keys[kind] == key):
            row.reused, row.skipped = row.reused + needed, row.skipped + (not needed)
            return kind.__name__
        start = time.perf_counter()
        for name, target in kind.writes.items():
            if not needed:
                self.targets.use_neutral(name, target)
            elif target.divisor:
                self.targets.allocate(name, target, target.size(frame.view.width, frame.view.height))
        if needed:
            # Another renderer may have drawn since the last pass.
            self.block.bind_to_uniform_block(frame_uniforms.BINDING)
            try:
                step.draw(frame)
            except Cancelled:
                self.abandon()
                raise
            self.pace.passed(row, start)
        row.drawn, row.skipped = row.drawn + needed, row.skipped + (not needed)
        self.keys[kind] = key
        self.revise(kind, key, frame.sample)
        return kind.__name__

    def abandon(self) -> None:
        """Keep no targets: one may be half drawn, or half added to. Passes make all else as the last that they do."""
        for kind in PASSES:
            if kind.writes:
                self.keys.pop(kind, None)
                self.firsts.pop(kind, None)

    def revise(self, kind: type[Pass], key: dict, sample: int) -> None:
        """Number what a pass has drawn. A first sample depends on the key alone; others, on all samples before too."""
        new = {*kind.writes, *kind.makes}
        if sample == 0:
            before, revisions = self.firsts.get(kind, ({}, {}))
            changed = {name for name in key.keys() | before.keys() if key.get(name) != before.get(name)}
            if changed <= kind.parts.keys():
                new = {name for part in changed for name in kind.parts[part]}
            self.revisions |= revisions
        self.revisions |= {name: next(self.numbers) for name in sorted(new)}
        if sample == 0:
            self.firsts[kind] = key, {name: self.revisions.get(name, 0) for name in (*kind.writes, *kind.makes)}

    def key(self, kind: type[Pass], frame: Frame) -> dict:
        """All that a pass depends on, by name: equal as long as what it drew last still holds."""
        sized = any(target.divisor for target in kind.writes.values())
        return {
            **{change: frame.part(change) for change in kind.depends_on},
            **{f"settings.{path}": setting(frame.settings, path) for path in kind.settings},
            **{name: self.revisions.get(name, 0) for name in kind.reads},
            **{f"content of {name}": self.tables.get(name) for name in kind.compares},
            "size": (frame.view.width, frame.view.height) if sized else None,
            "batch": frame.batch,
        }

    def picture(self) -> np.ndarray:
        """(H,W,4): the samples so far as one picture, alpha premultiplied, bottom row first. Raises as Device.check."""
        return self.images([COMBINED])[COMBINED.name]

    def images(self, wanted: Collection[RenderPass]) -> dict[str, np.ndarray]:
        """Render passes (H,W,channels) by name, bottom row first: filtered ones of all samples so far, others of the
        newest. Raises as Device.check."""
        frame, profile = self.last
        if any(each.filtered for each in wanted):
            self.run(AT_LAST, frame, profile)
            self.pace.finish()
        found = {each.name: image(self.targets, each, frame.anchor) for each in wanted}
        self.device.check()  # else they might be whatever was in memory
        return found

    @property
    def error(self) -> Convergence:
        """Of the picture so far."""
        return self.tables["error"]

    @staticmethod
    def pixel_pass_seconds(profile: Profile) -> float:
        """What of the profile's time went into passes that draw pixels, the fewer the sooner."""
        return sum(profile.rows[kind.__name__].ms for kind in PASSES if kind.writes) / 1e3

    def release(self) -> None:
        """Free the GPU's memory."""
        self.targets.release()
        self.tables.clear()
        self.device.collect()


def setting(settings: Settings, path: str) -> object:
    """The setting, or section of settings, that a path such as "shadow.bias" names."""
    value: object = settings
    for name in path.split("."):
        value = getattr(value, name)
    return value


def samples_per_visibility_buffer(view: View, samples: int, limit: int) -> int:
    """How many samples share one drawing of the triangles, on a grid finer than the pixels' by as much."""
    counts = [count for count in PIXEL_GRIDS if count <= samples and filter_margin(view.filter_width) > 0]
    for count in sorted(counts, reverse=True):
        size = pixel_grid(0, count).room(view.width, view.height)
        if size.max() <= limit and size.prod() <= MAX_FINE_PIXELS:
            return count
    return 1
