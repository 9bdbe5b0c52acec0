# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that are made into triangles together are what each is alone."""

import math

import bpy
import numpy as np

from ism_addon.blender.sync.geometry import meshes

NAN, INF = math.nan, math.inf


def assorted(random: np.random.Generator, add, number: int) -> bpy.types.Mesh:
    """A mesh of a few triangles, quads or polygons, with holes in what it says of itself, or without."""
    count, sides = int(random.integers(3, 12)), random.choice(["3", "4", "34", "345"])
    points = random.normal(size=(max(count, 5), 3))
    if random.random() < 0.3:
        points[random.integers(count)] = random.choice([NAN, INF, 1e30, 0.0])
    corners = [int(random.choice(list(sides))) for _ in range(random.integers(1, 7))]
    source = add(f"Mesh {number}", (points.tolist(), [random.permutation(count)[:k].tolist() for k in corners])).data
    source.polygons.foreach_set("use_smooth", random.integers(0, 2 if random.random() < 0.5 else 1, len(corners)))
    if random.random() < 0.3:
        source.shade_smooth()
    if random.random() < 0.5:
        source.uv_layers.new().uv.foreach_set("vector", random.normal(size=2 * len(source.loops)))
    if random.random() < 0.5:
        source.attributes.new("material_index", "INT", "FACE").data.foreach_set(
            "value", random.integers(-1, 5, len(corners))
        )
    return source


def test_meshes_that_are_made_together_are_what_each_is_alone(add):
    """Of all kinds, with vertices that are no places, triangles without area, slots that are not there."""
    random = np.random.default_rng(0)
    sources = [assorted(random, add, number) for number in range(120)]
    raws = [meshes.read(source, tuple(range(k % 3 + 1))) for k, source in enumerate(sources)]
    assert len({raw.layout for raw in raws}) > 12
    together = meshes.triangulated(raws)
    assert 0 < sum(each.mesh is None for each in together) < 60
    for one, raw in zip(together, raws, strict=True):
        (alone,) = meshes.triangulated([raw])
        assert one[1:] == alone[1:]
        assert (one.mesh is None) == (alone.mesh is None)
        assert one.mesh is None or one.mesh.equals(alone.mesh)


def test_a_mesh_whose_normals_are_mended_leaves_those_beside_it_alone(add):
    """It has normals by corner then; the others keep theirs by vertex."""
    raws = []
    for name in ("One", "Odd", "Other"):
        source = add(name).data
        source.shade_smooth()
        raws.append(meshes.read(source, (0,)))
    raws[1].normals[2] = NAN
    one, odd, other = (each.mesh.normals for each in meshes.triangulated(raws))
    assert (one.ndim, odd.ndim, other.ndim) == (2, 3, 2)
    assert np.all(odd == (0, 0, 1))
