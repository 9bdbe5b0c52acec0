# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds of maps and strengths as nobody means them: as Cycles draws them, or with a sentence."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.engine import statistics
from tests.benchmark.files import our_render
from tests.scenes.parts.node_tree import world_of

from .beside_cycles import error
from .test_background import background

pytestmark = pytest.mark.usefixtures("registered")

random = np.random.default_rng(0)


def with_texel(value):
    """A white map in which one texel is another."""
    texels = np.ones((64, 128, 3))
    texels[50, 30] = value
    return texels


#: Texels (H,W,3), and strengths.
MAPS = {
    "a texel": (np.full((1, 1, 3), 0.7), 1.0),
    "a column": (random.random((8192, 1, 3)), 1.0),
    "a row": (random.random((1, 8192, 3)), 1.0),
    "one bright texel": (with_texel(1e9), 1.0),
    "a texel that is no number": (with_texel(np.nan), 1.0),
    "an infinite texel": (with_texel(np.inf), 1.0),
    "a strength of 1e12": (random.random((8, 16, 3)), 1e12),
}
BLACK = {
    "a black map": (np.zeros((8, 16, 3)), 1.0),
    "a strength of 0": (np.ones((8, 16, 3)), 0.0),
}
NEGATIVE = {
    "a map of negative texels": (np.full((8, 16, 3), -1.0), 1.0),
    "a negative strength": (np.ones((8, 16, 3)), -1.0),
    "a negative color": (None, -1.0),
}


def world(texels, strength):
    """Of a map, or white if there is none."""
    if texels is None:
        return world_of(lambda tree: background(tree, (1.0, 1.0, 1.0, 1.0), strength))
    height, width = texels.shape[:2]
    image = bpy.data.images.new("odd", width, height, float_buffer=True)
    image.pixels.foreach_set(np.concatenate([texels, np.ones((height, width, 1))], 2).astype(np.float32).ravel())
    image.pack()
    return world_of(lambda tree: background(tree, tree.add("ShaderNodeTexEnvironment", image=image), strength))


@pytest.mark.parametrize("name", MAPS)
def test_odd_maps_light_surfaces_as_in_cycles(place, name):
    place.scene.world = world(*MAPS[name])
    assert error(our_render(64)[0]) <= 0.03


@pytest.mark.parametrize("name", BLACK)
def test_black_worlds_light_nothing(place, name):
    place.scene.world = world(*BLACK[name])
    assert (our_render(2)[0] == 0.0).all()
    assert statistics()["pairs_traced"] == 0


@pytest.mark.parametrize("name", NEGATIVE)
def test_negative_worlds_light_nothing_and_a_sentence_says_so(place, name, capfd):
    place.scene.world = world(*NEGATIVE[name])
    place.scene.render.film_transparent = True
    assert (our_render(2)[0] == 0.0).all() and statistics()["pairs_traced"] == 0
    assert "negative" in capfd.readouterr().out
