# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles, normals, UVs and material slots of single meshes, beside Blender's own data."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.blender import meshes

NAN, INF = math.nan, math.inf


def test_a_mesh_is_blenders_own_triangles(add, extracted):
    bpy.ops.mesh.primitive_monkey_add()
    monkey = bpy.context.object
    source = monkey.data
    source.calc_loop_triangles()
    (mesh,) = extracted().meshes
    assert mesh.positions.tolist() == [list(vertex.co) for vertex in source.vertices]
    assert mesh.triangles.tolist() == [list(triangle.vertices) for triangle in source.loop_triangles]
    corners = [list(triangle.loops) for triangle in source.loop_triangles]
    normals = [[list(source.corner_normals[i].vector) for i in each] for each in corners]
    assert mesh.corner_normals.tolist() == normals
    uv = source.uv_layers.active.uv
    assert mesh.uvs.tolist() == [[list(uv[i].vector) for i in each] for each in corners]
    assert [array.dtype for array in (mesh.positions, mesh.triangles, mesh.normals, mesh.uvs, mesh.materials)] == [
        np.float32,
        np.uint32,
        np.float32,
        np.float32,
        np.uint32,
    ]
    assert not mesh.positions.flags.writeable


@pytest.mark.parametrize("operator", ["primitive_ico_sphere_add", "primitive_uv_sphere_add", "primitive_cylinder_add"])
def test_triangles_quads_and_polygons_have_their_area(add, extracted, operator):
    getattr(bpy.ops.mesh, operator)()
    source = bpy.context.object.data
    (mesh,) = extracted().meshes
    a, b, c = (mesh.positions[mesh.triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(sum(polygon.area for polygon in source.polygons), rel=1e-5)


def test_quads_are_cut_as_blender_cuts_them(add, extracted):
    """Flat and bent ones, and ones that overlap themselves along one of their diagonals."""
    random = np.random.default_rng(0)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = square + random.normal(size=(300, 4, 3)) * random.choice([0.0, 0.2, 0.6], (300, 1, 1))
    source = add("Bent", (corners.reshape(-1, 3).tolist(), np.arange(1200).reshape(-1, 4).tolist())).data
    (mesh,) = extracted().meshes
    source.calc_loop_triangles()
    assert mesh.triangles.tolist() == [list(triangle.vertices) for triangle in source.loop_triangles]
    assert {2, 3} <= {int(third) % 4 for third in mesh.triangles[::2, 2]}, "some are cut along each diagonal"


def test_modifiers_are_applied(add, extracted):
    add("Plain").modifiers.new("Subdivision", "SUBSURF").levels = 2
    (mesh,) = extracted().meshes
    assert len(mesh.triangles) == 32


def test_flat_faces_have_their_own_normals_and_smooth_ones_share(add, extracted):
    bpy.ops.mesh.primitive_cube_add()
    source = bpy.context.object.data
    (flat,) = extracted().meshes
    assert set(np.abs(flat.normals).max(axis=2).reshape(-1)) == {1.0}
    source.shade_smooth()
    (smooth,) = extracted().meshes
    assert np.allclose(np.abs(smooth.normals), 1 / math.sqrt(3), atol=1e-6)


def test_custom_normals_are_kept(add, extracted):
    source = add("Bent").data
    source.normals_split_custom_set([(0.6, 0.0, 0.8)] * 4)
    (mesh,) = extracted().meshes
    assert np.allclose(mesh.normals, (0.6, 0.0, 0.8), atol=1e-3)


def test_the_layer_that_renders_gives_the_uvs(add, extracted):
    source = add("Mapped").data
    for name, value in (("First", 0.25), ("Second", 0.75)):
        layer = source.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", [value] * 8)
    source.uv_layers["Second"].active_render = True
    source.uv_layers["First"].active = True
    (mesh,) = extracted().meshes
    assert mesh.uvs.shape == (2, 3, 2)
    assert np.all(mesh.uvs == 0.75)


def test_a_mesh_without_uvs_has_none(add, extracted):
    add("Bare")
    (mesh,) = extracted().meshes
    assert mesh.uvs.shape == (0, 3, 2)


def test_faces_of_slots_that_are_not_there_have_the_last_slots_material(add):
    source = add("Many", ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])).data
    for name in ("A", "B"):
        source.materials.append(bpy.data.materials.new(name))
    source.polygons.foreach_set("material_index", [1, 0])
    assert meshes.read(source, (7, 5)).mesh.materials.tolist() == [5, 7]
    source.attributes["material_index"].data.foreach_set("value", [9, -3])
    assert meshes.read(source, (7, 5)).mesh.materials.tolist() == [5, 7]


@pytest.mark.parametrize("bad", [NAN, INF, -INF, 1e30])
def test_a_vertex_that_is_no_place_takes_only_its_triangles_with_it(add, extracted, bad):
    add("Torn", ([(0, 0, 0), (bad, 0, 0), (1, 1, 0), (0, 1, 0), (2, 2, 0)], [(0, 1, 2), (0, 2, 3), (2, 3, 4)]))
    scene = extracted()
    (mesh,) = scene.meshes
    corners = mesh.positions[mesh.triangles]
    assert corners.tolist() == [[[0, 0, 0], [1, 1, 0], [0, 1, 0]], [[1, 1, 0], [0, 1, 0], [2, 2, 0]]]
    assert np.abs(mesh.positions).max() == 2
    assert np.allclose(np.abs(mesh.normals[..., 2]), 1.0)
    assert scene.warnings == ("Triangles with corners that are no numbers, or beyond 1e+09 m, are left out: 'Torn'.",)


def test_vertices_of_no_triangle_are_left_out(add, extracted):
    thing = add("Loose", ([(NAN, 0, 0), (1e30, 0, 0), (0, 0, 0), (1, 0, 0), (0, 1, 0)], [(2, 3, 4)]))
    scene = extracted()
    assert len(thing.data.vertices) == 5
    assert scene.meshes[0].positions.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert scene.meshes[0].triangles.tolist() == [[0, 1, 2]]
    assert scene.warnings == ()


def test_triangles_without_area_are_left_out_and_counted(add, extracted):
    line = [(0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 0)]
    add("Thin", (line, [(0, 1, 2), (0, 0, 1), (0, 1, 3)]))
    scene = extracted()
    assert len(scene.meshes[0].triangles) == 1
    assert scene.warnings == ("Triangles without area are left out: 'Thin' (2).",)


def test_meshes_without_triangles_do_not_stand_in_the_scene(add, extracted):
    add("Nothing", ([], []))
    add("Points", ([(0, 0, 0), (1, 0, 0)], []))
    add("Collapsed", ([(0, 0, 0)] * 3, [(0, 1, 2)]))
    add("Lost", ([(NAN, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    scene = extracted()
    assert scene.meshes == ()
    assert scene.instances.mesh.shape == (0,)
    assert scene.instances.world_from_object.shape == (0, 4, 4)
    assert scene.triangle_count == 0
    assert len(scene.warnings) == 2


def test_normals_and_uvs_that_are_no_numbers_are_mended(add, extracted):
    source = add("Odd").data
    layer = source.uv_layers.new(name="UV")
    layer.uv.foreach_set("vector", [0.5, NAN, INF, 0.5, 0.5, -INF, 0.5, 0.5])
    (mesh,) = extracted().meshes
    assert np.isfinite(mesh.uvs).all()
    assert set(mesh.uvs.reshape(-1)) == {0.0, 0.5}
    assert np.all(mesh.normals == (0, 0, 1))


def test_a_corner_without_a_normal_has_its_triangles():
    positions, triangles = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.uint32([[0, 1, 2]])
    normals = np.float32([[NAN, 0, 0], [0, 0, 0], [1, 0, 0]])
    for given in (normals, normals[None]):
        assert meshes._mended(given, positions, triangles).tolist() == [[[0, 0, 1], [0, 0, 1], [1, 0, 0]]]


def test_normals_are_of_unit_length():
    """Blender 4.5's free normals, attributes of any numbers, need not be."""
    positions, triangles = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.uint32([[0, 1, 2]])
    normals = np.float32([[0.7, 0, 0], [0, 3, 0], [0, 0, 1]])
    assert meshes._mended(normals, positions, triangles).tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_a_mesh_in_edit_mode_is_read_as_it_stands(add, extracted):
    import bmesh

    thing = add("Edited")
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bmesh.ops.create_cube(bmesh.from_edit_mesh(thing.data))
    bmesh.update_edit_mesh(thing.data)
    assert extracted().triangle_count == 14
    bpy.ops.object.mode_set(mode="OBJECT")
    assert extracted().triangle_count == 14
