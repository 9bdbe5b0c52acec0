# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the light, and the passes that estimate each: direct light by one of two methods, and the world's light.

An estimator says which passes a sample needs. All that compute one part of the light write the same targets.
"""

from collections.abc import Iterator
from typing import Protocol

from ..resources import ATLAS_BATCH, VIRTUAL_LIGHT_COUNTS
from ..settings import Method, Settings
from .frame import Frame, Pass
from .passes.direct.predict_visibility import PredictVisibility
from .passes.direct.select_faint_lights import SelectFaintLights
from .passes.direct.trace_shadows import TraceShadows
from .passes.environment.ambient_occlusion import AmbientOcclusion
from .passes.environment.blur import BlurOcclusion
from .passes.light_selection.probe_visibility import ProbeVisibility
from .passes.light_selection.retest_occluded import RetestOccluded
from .passes.shadow_maps.atlas import batches
from .passes.shadow_maps.fill_holes import FillHoles
from .passes.shadow_maps.gather import GatherLight
from .passes.shadow_maps.light_importance import WeighLights
from .passes.shadow_maps.sample_points import SamplePoints
from .passes.shadow_maps.select_points import SelectPoints
from .passes.shadow_maps.splat import SplatMaps
from .passes.shadow_maps.virtual_lights import PlaceVirtualLights


class Estimator(Protocol):
    """One part of the light."""

    #: Whether its passes trace rays, which need acceleration structures.
    traces_rays: bool
    #: Whether a sample takes less time the fewer tiles take part in it.
    adaptive: bool
    #: All passes that a sample may need.
    pass_types: tuple[type[Pass], ...]

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """Those of this sample, in order; some more than once. Each is executed before the next is asked for."""


class RayTracedDirect:
    """Direct light by shadow rays: predicted, then corrected (Heitz, Hill & McGuire 2018)."""

    traces_rays = adaptive = True
    pass_types: tuple[type[Pass], ...] = (
        *(ProbeVisibility, RetestOccluded, PredictVisibility),
        *(SelectFaintLights, TraceShadows),
    )

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """Prediction first, then the rays that correct it."""
        yield from self.pass_types


class ShadowMappedDirect:
    """Direct light by imperfect shadow maps (Ritschel et al. 2008; Beck-Norén & Valter 2013)."""

    traces_rays = adaptive = False
    PREPARE = SamplePoints, WeighLights, PlaceVirtualLights, SelectPoints
    FOR_EACH_ATLAS = SplatMaps, FillHoles, GatherLight
    pass_types: tuple[type[Pass], ...] = (*PREPARE, *FOR_EACH_ATLAS)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """For as many virtual lights as an atlas holds, their maps and the light that they let through."""
        yield from self.PREPARE
        count = sum((frame.get(VIRTUAL_LIGHT_COUNTS) or {}).values())
        for batch in batches(count, frame.settings.quality.map_size, frame.device.texture_size):
            frame[ATLAS_BATCH] = batch
            yield from self.FOR_EACH_ATLAS


class WorldLight:
    """The world's light, as far as ambient occlusion leaves it."""

    traces_rays, adaptive = False, True
    pass_types: tuple[type[Pass], ...] = (AmbientOcclusion, BlurOcclusion)

    def passes(self, frame: Frame) -> Iterator[type[Pass]]:
        """Occlusion, then its noise is blurred."""
        yield from self.pass_types


DIRECT: dict[Method, Estimator] = {
    Method.RAY_TRACED: RayTracedDirect(),
    Method.SHADOW_MAPS: ShadowMappedDirect(),
}
WORLD_LIGHT: Estimator = WorldLight()


def estimators(settings: Settings) -> tuple[Estimator, ...]:
    """Those that draw a picture of these settings."""
    return DIRECT[settings.shadow.method], WORLD_LIGHT
