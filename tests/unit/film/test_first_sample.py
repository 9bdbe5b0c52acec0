# SPDX-License-Identifier: GPL-3.0-or-later
"""The first sample is shown as predicted, then shaded again with what corrects its predictions."""

from dataclasses import replace

import pytest

from ism_addon.choices import OcclusionSampling
from ism_addon.settings import SSAO
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality

WITHOUT_SHADOWS = replace(SMALL_SETTINGS, shadow=replace(SMALL_SETTINGS.shadow, enabled=False))
TRACED_OCCLUSION = SSAO(sampling=OcclusionSampling.TRACED)


@pytest.mark.parametrize(
    ("settings", "times"),
    [
        (SMALL_SETTINGS, 1),
        (WITHOUT_SHADOWS, 0),
        (replace(WITHOUT_SHADOWS, ssao=TRACED_OCCLUSION, occlusion_pass=True), 1),
        (SMALL_SHADOW_MAPS, 0),
        (replace(SMALL_SHADOW_MAPS, ssao=SSAO()), 0),
    ],
    ids=["shadow rays", "no shadows", "rays of ambient occlusion", "shadow maps", "ambient occlusion on the screen"],
)
def test_it_is_shaded_again_only_if_later_samples_have_what_it_lacks(device, settings, times):
    """Its surfaces are not drawn again. A picture of one sample is only predicted."""
    for samples in (1, 4):
        drawn = draw(device, *box_over_plane(24, 16), with_quality(settings, samples=samples))
        counts = {name: row.drawn for name, row in drawn.profile.rows.items()}
        again = times if samples > 1 else 0
        assert counts["GBuffer"] == samples
        assert counts["Shade"] == counts["Accumulate"] == samples + again
        if "TraceShadows" in counts:
            assert counts["TraceShadows"] == samples + again * settings.shadow.enabled
