# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimators of components of the light: what ambient occlusion leaves of it, direct light by one of two methods, the
world that is seen, and emission that is seen.

An estimator says which passes a sample needs. Estimators of the same component write the same targets.
"""

from collections.abc import Iterator
from typing import Protocol

from ..resources import ATLAS_BATCH, VIRTUAL_LIGHT_COUNTS
from ..scene import Scene
from ..settings import Method, Settings
from .frame import Frame, Pass
from .passes.direct.match_predictions import MatchPredictions
from .passes.direct.predict_visibility import PredictVisibility
from .passes.direct.select_faint_lights import SelectFaintLights
from .passes.direct.trace_shadows import TraceShadows
from .passes.emission.filter_emission import FilterEmission
from .passes.emission.find_emission_edges import FindEmissionEdges
from .passes.emission.shade_emission import ShadeEmission
from .passes.environment.shade_background import ShadeBackground
from .passes.film.accumulate import AccumulateOcclusion
from .passes.film.resolve import ResolveOcclusion
from .passes.light_selection.find_portals import FindPortals
from .passes.light_selection.probe_visibility import ProbeVisibility
from .passes.light_selection.retest_occluded import RetestOccluded
from .passes.occlusion.ambient_occlusion import AmbientOcclusion
from .passes.occlusion.blur import BlurOcclusion
from .passes.occlusion.filter_occlusion import FilterOcclusion
from .passes.occlusion.shade_occlusion import ShadeOcclusion
from .passes.occlusion.steady_occlusion import SteadyOcclusion
from .passes.occlusion.trace_occlusion import TraceOcclusion
from .passes.shadow_maps.atlas import batches
from .passes.shadow_maps.fill_holes import FillHoles
from .passes.shadow_maps.gather import GatherLight
from .passes.shadow_maps.light_importance import WeighLights
from .passes.shadow_maps.sample_points import SamplePoints
from .passes.shadow_maps.select_points import SelectPoints
from .passes.shadow_maps.splat import SplatMaps
from .passes.shadow_maps.virtual_lights import PlaceVirtualLights


class Estimator(Protocol):
    """Estimates one component of the light."""

    #: Whether its passes trace rays, which need acceleration structures.
    traces_rays: bool
    #: Whether a sample with fewer tiles takes less time.
    adaptive: bool
    #: All passes that a sample may need.
    pass_types: tuple[type[Pass], ...]

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """The passes of this sample, in order; some more than once. Each is executed before the next is requested."""


class RayTracedDirect:
    """Direct light by shadow rays: predicted, then corrected (Heitz, Hill & McGuire 2018)."""

    traces_rays = adaptive = True
    pass_types: tuple[type[Pass], ...] = (
        *(FindPortals, ProbeVisibility, RetestOccluded, PredictVisibility, MatchPredictions),
        *(SelectFaintLights, TraceShadows),
    )

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """The prediction, then the rays that correct it."""
        yield from self.pass_types


class ShadowMappedDirect:
    """Direct light by imperfect shadow maps (Ritschel et al. 2008; Beck-Norén & Valter 2013)."""

    traces_rays = adaptive = False
    PREPARE = SamplePoints, WeighLights, PlaceVirtualLights, SelectPoints
    FOR_EACH_ATLAS = SplatMaps, FillHoles, GatherLight
    pass_types: tuple[type[Pass], ...] = (*PREPARE, *FOR_EACH_ATLAS)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """For each batch of virtual lights that fits in an atlas: their shadow maps, and the light that these pass."""
        yield from self.PREPARE
        count = sum((frame.get(VIRTUAL_LIGHT_COUNTS) or {}).values())
        for batch in batches(count, frame.settings.quality.map_size, frame.device.texture_size):
            frame[ATLAS_BATCH] = batch
            yield from self.FOR_EACH_ATLAS


class Occlusion:
    """Ambient occlusion."""

    traces_rays, adaptive = False, True
    pass_types: tuple[type[Pass], ...] = (
        *(AmbientOcclusion, BlurOcclusion, TraceOcclusion, FilterOcclusion, SteadyOcclusion),
    )

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """Occlusion, from the screen or by rays, then a filter of its noise."""
        yield from self.pass_types


class OcclusionPass:
    """The render pass AO."""

    traces_rays, adaptive = False, True
    pass_types: tuple[type[Pass], ...] = (ShadeOcclusion, AccumulateOcclusion, ResolveOcclusion)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """A sample, and the sums of all samples. They are resolved when the image is read back."""
        yield from (ShadeOcclusion, AccumulateOcclusion)


class SeenWorld:
    """The background."""

    traces_rays, adaptive = False, True
    pass_types: tuple[type[Pass], ...] = (ShadeBackground,)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """What the camera sees of the world."""
        yield from self.pass_types


class SeenEmission:
    """Emission that the camera sees."""

    traces_rays, adaptive = False, True
    pass_types: tuple[type[Pass], ...] = (ShadeEmission, FindEmissionEdges, FilterEmission)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """Emission at the samples' positions, then through the pixel filter where it has edges."""
        yield from self.pass_types


DIRECT: dict[Method, Estimator] = {
    Method.RAY_TRACED: RayTracedDirect(),
    Method.SHADOW_MAPS: ShadowMappedDirect(),
}
OCCLUSION: Estimator = Occlusion()
OCCLUSION_PASS: Estimator = OcclusionPass()
SEEN_WORLD: Estimator = SeenWorld()
EMISSION: Estimator = SeenEmission()
ALL_ESTIMATORS = OCCLUSION, *DIRECT.values(), SEEN_WORLD, EMISSION, OCCLUSION_PASS


def estimators(scene: Scene, settings: Settings) -> tuple[Estimator, ...]:
    """The estimators of a scene's picture with these settings."""
    has_emission = scene.has_emission_graphs or scene.materials.emission.any() or scene.lights.visible_camera.any()
    optional = ((has_emission, EMISSION), (settings.occlusion_pass, OCCLUSION_PASS))
    return OCCLUSION, DIRECT[settings.shadow.method], SEEN_WORLD, *(each for wanted, each in optional if wanted)
