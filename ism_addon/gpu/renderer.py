# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws samples of an image: runs the passes in order; the graph skips those whose inputs are unchanged.

Direct light: predicted, then corrected by rays (Heitz, Hill & McGuire 2018), or by imperfect shadow maps (Ritschel et
al. 2008; Beck-Norén & Valter 2013, "Soft shadows in real time by imperfect shadow maps and screen space ambient
occlusion").
"""

from collections.abc import Callable, Collection, Generator, Iterator

import numpy as np

from ..render_passes import COMBINED, OCCLUSION, RenderPass
from ..resource_types import Target
from ..resources import BAKED_EMISSION, CONVERGENCE, TILE_SELECTION
from ..resources.world import BAKED_WORLD
from ..sampling.pixel_grid import (
    PixelGrid,
    filter_margin,
    narrow_pixel_grid,
    pixel_grid,
    samples_per_visibility_buffer,
)
from ..scene import Scene, View
from ..settings import DebugView, Settings
from ..spaces import anchor_of, camera_position
from .convergence import Convergence
from .emission.scene_lights import SceneLights
from .estimators import ALL_ESTIMATORS, Estimator, estimators
from .frame import Frame, Pass
from .gl import frame_uniforms
from .gl.context import Device
from .graph import Graph
from .memory_estimate import check, required_bytes
from .passes.environment.bake_world import BakeWorld
from .passes.film.accumulate import Accumulate
from .passes.film.debug_image import DebugImage
from .passes.film.estimate_error import EstimateError, is_due
from .passes.film.resolve import Resolve, ResolveOcclusion
from .passes.film.shade import Shade
from .passes.light_selection.cache_irradiance import CacheIrradiance
from .passes.light_selection.cull_lights import CullLights
from .passes.surfaces.find_graphs import FindGraphs
from .passes.surfaces.gbuffer import GBuffer, TracingGBuffer
from .passes.surfaces.select_tiles import SelectTiles
from .passes.surfaces.transmitted_color import TransmittedColor
from .passes.surfaces.visibility_buffer import VisibilityBuffer
from .passes.upload.bake_emission import BakeEmission
from .passes.upload.build_bvh import BuildBLAS, BuildTLAS, UploadBLAS
from .passes.upload.cull_meshes import CullMeshes
from .passes.upload.upload_lights import UploadLights
from .passes.upload.upload_point_graphs import UploadPointGraphs
from .passes.upload.upload_scene import (
    UploadAttributes,
    UploadInstances,
    UploadMaterials,
    UploadMeshes,
    UploadUVs,
)
from .profile import Profile
from .read_back import image
from .submission import Submission, never

#: Uploads what has changed in the scene. Triangles lie in the order of their BLAS.
UPLOAD = (
    *(CullMeshes, BuildBLAS, UploadMeshes, UploadUVs, UploadAttributes),
    *(UploadInstances, UploadMaterials, UploadPointGraphs, UploadLights),
)
#: Evaluates what lights surfaces by graphs.
BAKES = BakeEmission, BakeWorld
#: Visible surfaces in the tiles that take part in the sample.
SURFACES = SelectTiles, VisibilityBuffer, TransmittedColor, FindGraphs, GBuffer
#: Which lights contribute in which tile. Large BLAS are built while the passes of SURFACES draw.
SELECTION = UploadBLAS, BuildTLAS, CullLights, CacheIrradiance
#: Radiance of a sample, and the sums of all samples.
FILM = Shade, DebugImage, Accumulate

#: Passes of every image.
COMMON = *UPLOAD, *BAKES, *SURFACES, *SELECTION, *FILM, Resolve, EstimateError
PASSES: tuple[type[Pass], ...] = (
    *(*COMMON, TracingGBuffer),
    *(pass_type for estimator in ALL_ESTIMATORS for pass_type in estimator.pass_types),
)


class Renderer:
    """Draws samples of images; keeps what the next sample or image can reuse."""

    def __init__(self, device: Device):
        self.device = device
        self.submission = Submission(device)
        self.graph = Graph(device)
        self.uniforms = device.gl.buffer(reserve=frame_uniforms.DTYPE.itemsize)
        self.scene_lights = SceneLights()
        #: The scene and view of `uniforms`, and their anchor.
        self.placed: tuple[Scene, View, np.ndarray] | None = None

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
        """Draw one sample, and yield the name of each pass after it has been submitted, see submission.py.

        With `low_latency` the first sample is finished earlier, and all others later. Raises Cancelled if `cancelled()`
        is true, even within a long pass: the image is then lost, and another one can be begun.
        """
        self.submission.begin(sample, cancelled)
        run = self.graph.run
        if sample == 1:
            yield from self.correct_first(scene, view, settings, profile)
        frame = yield from self.uploaded(scene, view, settings, sample, profile, low_latency)
        yield from run(surfaces(scene), frame, profile)
        yield from run(SELECTION, frame, profile)
        for estimator in frame.estimators:
            yield from run(estimator.passes(frame), frame, profile)
        yield from run(FILM, frame, profile)
        resolves = is_due(sample, settings.quality.samples)
        yield from run((Resolve, EstimateError) if resolves else (EstimateError,), frame, profile)
        self.submission.end()
        profile.counts["render_target_bytes"] = self.graph.targets.bytes
        self.last = frame, profile
        self.device.free_released()

    def correct_first(self, scene: Scene, view: View, settings: Settings, profile: Profile) -> Iterator[str]:
        """Shade the first sample again: its picture had only predictions, now these are corrected."""
        frame = self.frame(scene, view, settings, 0, profile, corrects=True)
        correcting = [estimator for estimator in frame.estimators if estimator.corrects(frame)]
        if correcting:
            corrections = (pass_type for estimator in correcting for pass_type in estimator.corrections)
            yield from self.graph.run((SelectTiles, *corrections, *FILM), frame, profile)

    def surfaces(
        self, scene: Scene, view: View, settings: Settings, profile: Profile, cancelled: Callable[[], bool] = never
    ) -> Iterator[str]:
        """Draw only the visible surfaces, as `sample` does. A picture that begins afterwards reuses them."""
        self.submission.begin(0, cancelled)
        frame = yield from self.uploaded(scene, view, settings, 0, profile)
        yield from self.graph.run(surfaces(scene), frame, profile)

    def uploaded(
        self, scene: Scene, view: View, settings: Settings, sample: int, profile: Profile, low_latency: bool = False
    ) -> Generator[str, None, Frame]:
        """Upload the scene, as `sample` does. Returns the input of the other passes."""
        frame = self.frame(scene, view, settings, sample, profile, low_latency)
        yield from self.graph.run(UPLOAD, frame, profile)
        if sample > 0 or not (scene.has_emission_graphs or scene.world.graph[0] >= 0):
            return frame
        baked = self.graph.get(BAKED_EMISSION), self.graph.get(BAKED_WORLD)
        yield from self.graph.run(BAKES, frame, profile)
        if (self.graph.get(BAKED_EMISSION), self.graph.get(BAKED_WORLD)) != baked:  # then there are other lights
            frame = self.frame(scene, view, settings, sample, profile, low_latency)
            yield from self.graph.run(UPLOAD, frame, profile)
        return frame

    def frame(
        self,
        scene: Scene,
        view: View,
        settings: Settings,
        sample: int,
        profile: Profile,
        low_latency: bool = False,
        corrects: bool = False,
    ) -> Frame:
        """The input of the passes for one sample. `corrects`: of the first one, whether it is shaded again.

        Raises ValueError for an unknown debug view and for more pixels than OpenGL can draw at once, and MemoryError
        for an image that would take more memory than is free.
        """
        if settings.debug_view not in list(DebugView):
            raise ValueError(f"there is no target {settings.debug_view} to show, only {', '.join(DebugView)}")
        limit = self.device.texture_size
        if max(view.width, view.height) > limit:
            raise ValueError(
                f"{view.width}×{view.height} pixels are more than the {limit}×{limit} that this OpenGL can draw at once"
            )
        chosen = estimators(scene, settings)
        scene = self.with_all_lights(scene, settings)
        if self.placed is None or self.placed[0] is not scene or self.placed[1] is not view:
            anchor = anchor_of(camera_position(view.view_from_world), scene.extent)
            self.uniforms.write(frame_uniforms.frame_block(scene, view, anchor))
            self.placed = scene, view, anchor
        grid = self.grid(view, settings, sample, low_latency)
        if sample == 0 and not corrects:
            pass_types, fine_pixels = (
                (*pass_types_of(chosen), *surfaces(scene)),
                int(grid.bounds(view.width, view.height)[1].prod()),
            )
            required, lights = required_bytes(self.device, scene, view, settings, pass_types, fine_pixels)
            check(self.device.gl, required - self.graph.targets.bytes, view, lights)
            self.graph.begin(pass_types)
        return Frame(
            device=self.device,
            scene=scene,
            view=view,
            settings=settings,
            sample=sample,
            corrects=corrects or sample > 0,
            low_latency=low_latency,
            anchor=self.placed[2],
            graph=self.graph,
            estimators=chosen,
            counts=profile.counts,
            warnings=profile.warnings,
            grid=grid,
            submission=self.submission,
            uniforms=self.uniforms,
        )

    def with_all_lights(self, scene: Scene, settings: Settings) -> Scene:
        """The scene with the lights of its emissive meshes, and the world as a light if it is no even ambient light.

        The same object for the same arguments.
        """
        world_shadows = settings.shadow.of_world and bool(scene.instances.casts_shadow.any())
        baked = self.graph.get(BAKED_WORLD) if scene.world.graph[0] >= 0 else None
        of_map = baked.world_light if baked is not None else None
        return self.scene_lights.lit(scene, world_shadows, of_map, self.graph.get(BAKED_EMISSION))

    def grid(self, view: View, settings: Settings, sample: int, low_latency: bool) -> PixelGrid:
        """Positions of a sample in the pixels. The first is at their centres; it is finished earlier if drawn alone."""
        if filter_margin(view.filter_width) == 0:
            return narrow_pixel_grid(sample, view.filter_width)
        count = samples_per_visibility_buffer(
            view.width, view.height, settings.quality.samples, self.device.texture_size
        )
        count = 1 if low_latency and sample == 0 else count
        return pixel_grid(sample // count, count)

    def picture(self) -> np.ndarray:
        """(H,W,4): the image of all samples so far, alpha premultiplied, bottom row first. Raises as Device.check."""
        return self.images([COMBINED])[COMBINED.name]

    def images(self, requested: Collection[RenderPass]) -> dict[str, np.ndarray]:
        """Render passes (H,W,channels) by name, bottom row first: filtered ones of all samples so far, others of the
        latest sample. Raises as Device.check."""
        frame, profile = self.last
        if any(each.filtered for each in requested):
            self.graph.step(Resolve, frame, profile)
            if OCCLUSION in requested:
                self.graph.step(ResolveOcclusion, frame, profile)
            self.submission.finish()
        images = {each.name: image(self.graph.targets, each, frame.anchor) for each in requested}
        self.device.check()  # after an error the images might be uninitialised memory
        return images

    @property
    def has_drawn(self) -> bool:
        """Whether it has drawn any sample."""
        return hasattr(self, "last")

    @property
    def error(self) -> Convergence:
        """Convergence of the image so far."""
        return self.graph[CONVERGENCE]

    @property
    def excess_lights(self) -> float:
        """See TileSelection."""
        return self.graph[TILE_SELECTION].excess_lights

    @property
    def is_adaptive(self) -> bool:
        """See Frame.is_adaptive."""
        return self.last[0].is_adaptive

    @staticmethod
    def pixel_pass_seconds(profile: Profile) -> float:
        """Time of the passes that draw targets: it grows with the number of pixels."""
        drawing = {pass_type.__name__ for pass_type in PASSES if draws_target(pass_type)}
        return sum(row.ms for name, row in profile.rows.items() if name in drawing) / 1e3

    def release(self) -> None:
        """Free the GPU's memory."""
        self.graph.release()
        self.device.free_released()


def surfaces(scene: Scene) -> tuple[type[Pass], ...]:
    """The passes that draw a scene's visible surfaces."""
    return SURFACES if not scene.traces_graphs else (UploadBLAS, BuildTLAS, *SURFACES[:-1], TracingGBuffer)


def pass_types_of(chosen: tuple[Estimator, ...]) -> tuple[type[Pass], ...]:
    """All passes of an image with these estimators."""
    return (*COMMON, *(pass_type for estimator in chosen for pass_type in estimator.pass_types))


def draws_target(pass_type: type[Pass]) -> bool:
    """Whether a pass draws a target."""
    return any(isinstance(output, Target) for output in pass_type.outputs)
