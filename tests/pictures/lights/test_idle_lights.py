# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights of all types that light nothing in the picture cost no draws, no rays, and change nothing."""

import numpy as np

from ism_addon.gpu.passes.light_selection.retest_occluded import RETEST_PROBABILITY
from ism_addon.gpu.tiles import PROBES_PER_TILE_SIDE
from ism_addon.resources import IRRADIANCE_CACHE, PROBES, TILE_SIZE, TILE_VISIBILITY
from tests.scenes.lights.mixed_rooms import IDLE, LAMPS, mixed_rooms
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality

SIZE = 96, 64
#: Lights that matter: the lamps, and an emissive panel.
MATTER = len(LAMPS) + 1


def test_idle_lights_of_all_types_are_skipped(device):
    """But for a few that may be faint, which have one prediction a tile."""
    settings, idle = with_quality(SMALL_SETTINGS, samples=4), 20 * len(IDLE)
    few, many = (draw(device, *mixed_rooms(count, *SIZE), settings) for count in (0, idle))
    assert len(many.renderer.last[0].scene.lights.shape) == MATTER + idle
    assert few.profile.counts["lights_used"] == len(many.renderer.graph[TILE_VISIBILITY]) == MATTER
    assert many.profile.counts["lights_used"] <= MATTER + 0.05 * idle
    assert many.profile.counts["pairs_traced"] <= 1.1 * few.profile.counts["pairs_traced"]
    # Twenty suns above the roof are each as strong as the light in the room.
    assert len(many.renderer.graph[PROBES]) <= MATTER + 2
    rays = settings.quality.samples * SIZE[0] * SIZE[1] / TILE_SIZE**2 * PROBES_PER_TILE_SIDE**2
    assert many.profile.counts["retests"] <= 1.1 * RETEST_PROBABILITY * rays


def test_idle_lights_change_no_picture(device):
    """But for the points on the lights that rays go to."""
    settings = with_quality(SMALL_SETTINGS, samples=16)
    few, many = (draw(device, *mixed_rooms(idle, *SIZE), settings).color[..., :3] for idle in (0, 4 * len(IDLE)))
    assert np.abs(few - many).mean() < 0.01 * few.mean()


def test_each_type_of_idle_light_is_skipped(device):
    """Emissive meshes follow the lamps. A light is known by its visibility."""
    graph = draw(device, *mixed_rooms(len(IDLE), *SIZE), SMALL_SETTINGS).renderer.graph
    assert sorted(graph[TILE_VISIBILITY]) == [*range(MATTER - 1), MATTER - 1 + len(IDLE) - 1]
    assert not graph[IRRADIANCE_CACHE], "the only light with a light BVH is in another room"
