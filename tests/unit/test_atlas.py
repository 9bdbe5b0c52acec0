# SPDX-License-Identifier: GPL-3.0-or-later
"""The atlas of shadow maps: each virtual light has a map of its own, whatever the texture size limit."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.passes.shadow_maps.atlas import MAP_SIZE_MULTIPLE, MAX_ATLAS_TEXELS, batches
from tests.scenes.small import box_over_plane
from tests.support.reference import nrmse
from tests.support.small_scenes import SMALL_SHADOW_MAPS, draw, with_quality


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.integers(1, 2000), st.integers(1, 5000), st.sampled_from([64, 256, 1024, 4096, 16384]))
def test_no_virtual_light_is_lost_and_no_map_overlaps_another(virtual_lights, map_size, texture_size):
    first = 0
    for batch in batches(virtual_lights, map_size, texture_size):
        assert batch.first == first
        first += batch.count
        width, height = batch.size
        assert max(width, height) <= texture_size
        assert width * height <= MAX_ATLAS_TEXELS + batch.side * batch.side
        assert batch.side % MAP_SIZE_MULTIPLE == 0
        assert batch.side >= min(map_size, texture_size // MAP_SIZE_MULTIPLE * MAP_SIZE_MULTIPLE)
        corners = np.array([batch.corner(index) for index in range(batch.count)])
        assert len(np.unique(corners, axis=0)) == batch.count
        assert (corners % batch.side == 0).all()
        assert (corners >= 0).all()
        assert (corners + batch.side <= (width, height)).all()
    assert first == virtual_lights


def test_no_virtual_lights_still_make_one_batch():
    assert len(batches(0, 128, 4096)) == 1


def test_several_batches_give_the_picture_of_one(device):
    scene, view = box_over_plane(48, 32)
    quality = with_quality(SMALL_SHADOW_MAPS, virtual_lights=40, map_size=32, map_points=2048)
    one_batch = draw(device, scene, view, quality)
    narrow = replace(device, texture_size=96)
    several = draw(narrow, scene, view, quality)
    assert len(batches(40, 32, 96)) == 5
    assert several.profile.rows["SplatMaps"].drawn == 5 * one_batch.profile.rows["SplatMaps"].drawn
    assert nrmse(several.color, one_batch.color) < 1e-6


def test_a_map_wider_than_the_largest_texture_is_limited_to_its_width(device):
    scene, view = box_over_plane(24, 16)
    narrow = replace(device, texture_size=64)
    large = draw(narrow, scene, view, with_quality(SMALL_SHADOW_MAPS, virtual_lights=3, map_size=4096))
    fitting = draw(narrow, scene, view, with_quality(SMALL_SHADOW_MAPS, virtual_lights=3, map_size=64))
    assert np.array_equal(large.color, fitting.color)
