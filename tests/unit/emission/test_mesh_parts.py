# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected parts of meshes, and which of them are closed."""

import numpy as np
import pytest

from ism_addon.gpu.emission.mesh_parts import connected, parts_of
from ism_addon.scene import Mesh
from tests.scenes.small import mesh, sphere, subdivided_box
from tests.support.small_scenes import quad

BOX = subdivided_box((0, 0, 0), (1, 2, 3), 3)
FLAT = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))


def joined(*meshes: Mesh) -> Mesh:
    """One mesh of all."""
    firsts = np.cumsum([0, *(len(each.positions) for each in meshes)])
    triangles = [each.triangles + first for each, first in zip(meshes, firsts, strict=False)]
    return mesh(np.concatenate([each.positions for each in meshes]), np.concatenate(triangles))


def turned(flipped: Mesh) -> Mesh:
    """The same with all triangles in the other orientation."""
    return mesh(flipped.positions, flipped.triangles[:, ::-1])


@pytest.mark.parametrize(
    ("one", "side"),
    [
        (BOX, 1.0),
        (turned(BOX), -1.0),
        (FLAT, 0.0),
        (sphere((0, 0, 5), 0.3, 16, 8), 1.0),  # its seam and poles have vertices of their own
        (mesh(BOX.positions, BOX.triangles[1:]), 0.0),
    ],
    ids=["box", "turned", "flat", "sphere", "open box"],
)
def test_a_part_is_closed_if_each_edge_has_two_triangles(one, side):
    parts = parts_of(one)
    assert parts.side.tolist() == [side]
    assert np.allclose(parts.boxes[0], one.box)


def test_one_turned_triangle_makes_a_part_count_as_open():
    triangles = BOX.triangles.copy()
    triangles[7] = triangles[7, ::-1]
    assert parts_of(mesh(BOX.positions, triangles)).side.tolist() == [0.0]


def test_parts_are_found_in_any_order():
    shapes = [FLAT, BOX, turned(sphere((5, 0, 0), 1.0, 8, 6)), BOX]
    moved = [mesh(each.positions + [9.0 * k, 0.0, 0.0], each.triangles) for k, each in enumerate(shapes)]
    whole = joined(*moved)
    order = np.random.default_rng(1).permutation(len(whole.triangles))
    parts = parts_of(mesh(whole.positions, whole.triangles[order]))
    origin = np.repeat(np.arange(4), [len(each.triangles) for each in shapes])[order]
    assert len(set(zip(origin.tolist(), parts.part.tolist(), strict=True))) == len(parts.side) == 4
    for index, side in enumerate((0.0, 1.0, -1.0, 1.0)):
        part = parts.part[origin == index][0]
        assert parts.side[part] == side
        assert np.allclose(parts.boxes[part], moved[index].box)


def test_a_long_strip_is_one_part():
    index = np.arange(5000)
    strip = np.stack([index, index + 1, index + 2], 1)
    assert not connected(strip[np.random.default_rng(2).permutation(5000)]).any()


def test_parts_are_found_once():
    assert parts_of(BOX) is parts_of(BOX)
