# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws samples of pictures: runs the passes in order; the graph skips those whose inputs are unchanged.

Direct light: predicted, then corrected by rays (Heitz, Hill & McGuire 2018), or by imperfect shadow maps (Ritschel et
al. 2008; Beck-Norén & Valter 2013, "Soft shadows in real time by imperfect shadow maps and screen space ambient
occlusion").
"""

import math
from collections.abc import Callable, Collection, Iterator

import numpy as np

from ..render_passes import COMBINED, RenderPass
from ..resource_types import Target
from ..resources import CONVERGENCE
from ..sampling import PIXEL_GRIDS, PixelGrid, narrow_pixel_grid, pixel_grid
from ..scene import Scene, View
from ..settings import DebugView, Settings
from ..spaces import anchor_of, camera_position
from .convergence import Convergence
from .estimators import DIRECT, WORLD_LIGHT, Estimator, estimators
from .frame import Frame, Pass
from .gl import frame_uniforms
from .gl.context import Device
from .graph import Graph
from .memory_estimate import check, needed
from .passes.film.accumulate import Accumulate, filter_margin
from .passes.film.debug_image import DebugImage
from .passes.film.estimate_error import EstimateError, is_due
from .passes.film.resolve import Resolve
from .passes.film.shade import Shade
from .passes.light_selection.cull_lights import CullLights
from .passes.shadow_maps.atlas import batches
from .passes.surfaces.gbuffer import GBuffer
from .passes.surfaces.select_tiles import SelectTiles
from .passes.surfaces.visibility_buffer import VisibilityBuffer
from .passes.upload.build_bvh import BuildBLAS, BuildTLAS, UploadBLAS
from .passes.upload.cull_meshes import CullMeshes
from .passes.upload.upload_lights import UploadLights
from .passes.upload.upload_scene import UploadInstances, UploadMaterials, UploadMeshes, UploadUVs
from .profile import Profile
from .read_back import image
from .submission import Submission, never

#: What changed in the scene goes to the GPU. Triangles lie in the order of their trees.
UPLOAD = CullMeshes, BuildBLAS, UploadMeshes, UploadUVs, UploadInstances, UploadMaterials, UploadLights
#: What the camera sees, in the tiles that take part in the sample.
SURFACES = SelectTiles, VisibilityBuffer, GBuffer
#: Which lights matter in which tile. Large trees are finished while the camera's passes draw.
SELECTION = UploadBLAS, BuildTLAS, CullLights
#: Radiance to the picture, the sums of all samples to an image, and how far that is from its end.
FILM = Shade, DebugImage, Accumulate
AT_LAST = Resolve
JUDGED = EstimateError

#: Passes of every picture.
COMMON = *UPLOAD, *SURFACES, *SELECTION, *FILM, AT_LAST, JUDGED
ALL_ESTIMATORS = *DIRECT.values(), WORLD_LIGHT
PASSES: tuple[type[Pass], ...] = (*COMMON, *(kind for estimator in ALL_ESTIMATORS for kind in estimator.kinds))

#: Pixels of the largest visibility buffer, 12 bytes each.
MAX_FINE_PIXELS = 1 << 25


class Renderer:
    """Draws samples of pictures; keeps what the next one can use again."""

    def __init__(self, device: Device):
        self.device = device
        self.submission = Submission(device)
        self.graph = Graph(device)
        self.uniforms = device.gl.buffer(reserve=frame_uniforms.DTYPE.itemsize)

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
        self.submission.begin(sample, cancelled)
        frame = self.frame(scene, view, settings, sample, profile, low_latency)
        run = self.graph.run
        yield from run(UPLOAD, frame, profile)
        yield from run(SURFACES, frame, profile)
        yield from run(SELECTION, frame, profile)
        for estimator in frame.estimators:
            yield from run(estimator.passes(frame), frame, profile)
        yield from run(FILM, frame, profile)
        yield from run((AT_LAST, JUDGED) if is_due(sample, settings.quality.samples) else (JUDGED,), frame, profile)
        self.submission.end()
        profile.counts["render_target_bytes"] = self.graph.targets.bytes
        self.last = frame, profile
        self.device.free_released()

    def frame(
        self, scene: Scene, view: View, settings: Settings, sample: int, profile: Profile, low_latency: bool = False
    ) -> Frame:
        """What the passes are told about this sample.

        Raises ValueError for an unknown debug view and for more pixels than OpenGL can draw at once, and MemoryError
        for a picture that would take more memory than there is.
        """
        if settings.debug_view not in list(DebugView):
            raise ValueError(f"there is no target {settings.debug_view} to show, only {', '.join(DebugView)}")
        limit = self.device.texture_size
        if max(view.width, view.height) > limit:
            raise ValueError(
                f"{view.width}×{view.height} pixels are more than the {limit}×{limit} that this OpenGL can draw at once"
            )
        anchor = anchor_of(camera_position(view.view_from_world), scene.extent)
        grid, chosen = self.grid(view, settings, sample, low_latency), estimators(settings)
        if sample == 0:
            self.estimate_memory(scene, view, settings, chosen, int(grid.bounds(view.width, view.height)[1].prod()))
            self.graph.begin(kinds_of(chosen))
        self.uniforms.write(frame_uniforms.frame_block(view, anchor, scene.working_space))
        return Frame(
            device=self.device,
            scene=scene,
            view=view,
            settings=settings,
            sample=sample,
            anchor=anchor,
            graph=self.graph,
            estimators=chosen,
            counts=profile.counts,
            grid=grid,
            submission=self.submission,
            uniforms=self.uniforms,
        )

    def grid(self, view: View, settings: Settings, sample: int, low_latency: bool) -> PixelGrid:
        """Where in the pixels a sample lies. The first is at their centres; drawn alone, it comes sooner."""
        if filter_margin(view.filter_width) == 0:
            return narrow_pixel_grid(sample, view.filter_width)
        count = samples_per_visibility_buffer(view, settings.quality.samples, self.device.texture_size)
        count = 1 if low_latency and sample == 0 else count
        return pixel_grid(sample // count, count)

    def estimate_memory(
        self, scene: Scene, view: View, settings: Settings, chosen: tuple[Estimator, ...], fine_pixels: int
    ) -> None:
        """Raises MemoryError if a picture would take more than there is."""
        casting = int(scene.lights.casts_shadow.sum()) if settings.shadow.enabled else 0
        traced = any(estimator.traces_rays for estimator in chosen)
        map_texels = 0
        if casting and not traced:
            points = max(settings.quality.virtual_lights, casting)
            atlas, *_ = batches(points, settings.quality.map_size, self.device.texture_size)
            map_texels = math.prod(atlas.size)
        lights = casting if traced else 0
        targets = {output for kind in kinds_of(chosen) for output in kind.outputs if isinstance(output, Target)}
        wanted = needed(targets, view, fine_pixels, lights, map_texels)
        check(self.device.gl, wanted - self.graph.targets.bytes, view, lights)

    def picture(self) -> np.ndarray:
        """(H,W,4): the samples so far as one picture, alpha premultiplied, bottom row first. Raises as Device.check."""
        return self.images([COMBINED])[COMBINED.name]

    def images(self, wanted: Collection[RenderPass]) -> dict[str, np.ndarray]:
        """Render passes (H,W,channels) by name, bottom row first: filtered ones of all samples so far, others of the
        newest. Raises as Device.check."""
        frame, profile = self.last
        if any(each.filtered for each in wanted):
            self.graph.step(AT_LAST, frame, profile)
            self.submission.finish()
        found = {each.name: image(self.graph.targets, each, frame.anchor) for each in wanted}
        self.device.check()  # else they might be whatever was in memory
        return found

    @property
    def error(self) -> Convergence:
        """Of the picture so far."""
        return self.graph[CONVERGENCE]

    @staticmethod
    def pixel_pass_seconds(profile: Profile) -> float:
        """What of the profile's time went into passes that draw pixels, the fewer the sooner."""
        drawing = {kind.__name__ for kind in PASSES if any_target(kind)}
        return sum(row.ms for name, row in profile.rows.items() if name in drawing) / 1e3

    def release(self) -> None:
        """Free the GPU's memory."""
        self.graph.release()
        self.device.free_released()


def kinds_of(chosen: tuple[Estimator, ...]) -> tuple[type[Pass], ...]:
    """All passes of a picture with these estimators."""
    return (*COMMON, *(kind for estimator in chosen for kind in estimator.kinds))


def any_target(kind: type[Pass]) -> bool:
    """Whether a pass draws."""
    return any(isinstance(output, Target) for output in kind.outputs)


def samples_per_visibility_buffer(view: View, samples: int, limit: int) -> int:
    """How many samples share one drawing of the triangles, on a grid finer than the pixels' by as much."""
    for count in sorted((count for count in PIXEL_GRIDS if count <= samples), reverse=True):
        size = pixel_grid(0, count).room(view.width, view.height)
        if size.max() <= limit and size.prod() <= MAX_FINE_PIXELS:
            return count
    return 1
