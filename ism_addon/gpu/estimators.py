# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimators of components of the light: what ambient occlusion leaves of it, direct light by one of two methods, the
world that is seen, and emission that is seen.

An estimator says which passes a sample needs. Estimators of the same component write the same targets.
"""

from collections.abc import Iterator

from ..resources import ATLAS_BATCH, VIRTUAL_LIGHT_COUNTS
from ..resources.world import STEADY_OCCLUSION
from ..scene import Scene
from ..settings import Method, Settings
from .frame import Frame, Pass
from .occlusion import traces_occlusion
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


class Estimator:
    """Estimates one component of the light."""

    #: Whether its passes trace shadow rays, which need acceleration structures.
    traces_rays = False
    #: Whether a sample with fewer tiles takes less time.
    adaptive = True
    #: All passes that a sample may need.
    pass_types: tuple[type[Pass], ...] = ()
    #: Those that correct the first sample after its picture.
    corrections: tuple[type[Pass], ...] = ()

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """The passes of this sample, in order; some more than once. Each is executed before the next is requested."""
        yield from self.pass_types

    def corrects(self, frame: Frame) -> bool:
        """Whether samples after the first picture have corrections, which it lacks."""
        return False


class RayTracedDirect(Estimator):
    """Direct light by shadow rays: predicted, then corrected (Heitz, Hill & McGuire 2018)."""

    traces_rays = True
    pass_types = (
        *(FindPortals, ProbeVisibility, RetestOccluded, PredictVisibility, MatchPredictions),
        *(SelectFaintLights, TraceShadows),
    )
    corrections = MatchPredictions, TraceShadows

    def corrects(self, frame: Frame) -> bool:
        """Whether shadow rays or samples of gloss correct what is predicted of any light."""
        return len(frame.scene.lights.shape) > 0 and (frame.traces_shadows or frame.scene.has_gloss)


class ShadowMappedDirect(Estimator):
    """Direct light by imperfect shadow maps (Ritschel et al. 2008; Beck-Norén & Valter 2013)."""

    adaptive = False
    PREPARE = SamplePoints, WeighLights, PlaceVirtualLights, SelectPoints
    FOR_EACH_ATLAS = SplatMaps, FillHoles, GatherLight
    pass_types = (*PREPARE, *FOR_EACH_ATLAS)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """For each batch of virtual lights that fits in an atlas: their shadow maps, and the light that these pass."""
        yield from self.PREPARE
        count = sum((frame.get(VIRTUAL_LIGHT_COUNTS) or {}).values())
        for batch in batches(count, frame.settings.quality.map_size, frame.device.texture_size):
            frame[ATLAS_BATCH] = batch
            yield from self.FOR_EACH_ATLAS


class Occlusion(Estimator):
    """Ambient occlusion."""

    pass_types = AmbientOcclusion, BlurOcclusion, TraceOcclusion, FilterOcclusion, SteadyOcclusion

    def corrects(self, frame: Frame) -> bool:
        """See corrects_occlusion."""
        return corrects_occlusion(frame)


class OcclusionPass(Estimator):
    """The render pass AO."""

    pass_types = ShadeOcclusion, AccumulateOcclusion, ResolveOcclusion
    corrections = ShadeOcclusion, AccumulateOcclusion

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """A sample, and the sums of all samples. They are resolved when the image is read back."""
        yield from self.corrections

    def corrects(self, frame: Frame) -> bool:
        """See corrects_occlusion."""
        return corrects_occlusion(frame)


def corrects_occlusion(frame: Frame) -> bool:
    """Whether rays correct what is filtered, or the first picture blends it with that of other views."""
    return traces_occlusion(frame) or not frame.is_neutral(STEADY_OCCLUSION)


class SeenWorld(Estimator):
    """The background."""

    pass_types = (ShadeBackground,)


class SeenEmission(Estimator):
    """Emission that the camera sees."""

    pass_types = ShadeEmission, FindEmissionEdges, FilterEmission


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
