# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that are triangulated together equal those that are triangulated one by one."""

import math

import bpy
import numpy as np

from ism_addon.blender.sync.geometry import meshes

NAN, INF = math.nan, math.inf


def random_mesh(random: np.random.Generator, add, index: int) -> bpy.types.Mesh:
    """A mesh of few triangles, quads or polygons; vertices may be invalid, UVs missing, slots out of range."""
    count, sides = int(random.integers(3, 12)), random.choice(["3", "4", "34", "345"])
    points = random.normal(size=(max(count, 5), 3))
    if random.random() < 0.3:
        points[random.integers(count)] = random.choice([NAN, INF, 1e30, 0.0])
    corners = [int(random.choice(list(sides))) for _ in range(random.integers(1, 7))]
    source = add(f"Mesh {index}", (points.tolist(), [random.permutation(count)[:k].tolist() for k in corners])).data
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


def test_meshes_triangulated_together_equal_those_triangulated_one_by_one(add):
    """Many data layouts, invalid vertices, triangles without area, and slots that do not exist."""
    random = np.random.default_rng(0)
    sources = [random_mesh(random, add, index) for index in range(120)]
    raws = [meshes.read(source, tuple(range(k % 3 + 1))) for k, source in enumerate(sources)]
    assert len({raw.layout for raw in raws}) > 12
    together = meshes.triangulated(raws)
    assert 0 < sum(each.mesh is None for each in together) < 60
    for one, raw in zip(together, raws, strict=True):
        (single,) = meshes.triangulated([raw])
        assert one[1:] == single[1:]
        assert (one.mesh is None) == (single.mesh is None)
        assert one.mesh is None or one.mesh.equals(single.mesh)


def test_repairing_the_normals_of_a_mesh_leaves_the_others_unchanged(add):
    """The repaired mesh then has normals per corner; the others keep theirs per vertex."""
    raws = []
    for name in ("One", "Odd", "Other"):
        source = add(name).data
        source.shade_smooth()
        raws.append(meshes.read(source, (0,)))
    raws[1].normals[2] = NAN
    one, odd, other = (each.mesh.normals for each in meshes.triangulated(raws))
    assert (one.ndim, odd.ndim, other.ndim) == (2, 3, 2)
    assert np.all(odd == (0, 0, 1))
