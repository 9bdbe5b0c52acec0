# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles, normals, UVs and material slots of single meshes, compared with Blender's own data."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.geometry import meshes
from tests.scenes.cycles import direct_light

NAN, INF = math.nan, math.inf


def add_image_material(source: bpy.types.Mesh) -> None:
    """Give the mesh a material with an image: UVs are read only for those."""
    material = bpy.data.materials.new("Paint")
    material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Picture", 2, 2)
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    source.materials.append(material)


def test_a_mesh_is_blenders_own_triangles(add, read_scene):
    bpy.ops.mesh.primitive_monkey_add()
    bpy.ops.object.shade_smooth()
    source = bpy.context.object.data
    add_image_material(source)
    source.calc_loop_triangles()
    (mesh,) = read_scene().meshes
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
def test_triangulation_keeps_the_area_of_polygons(add, read_scene, operator):
    getattr(bpy.ops.mesh, operator)()
    source = bpy.context.object.data
    (mesh,) = read_scene().meshes
    a, b, c = (mesh.positions[mesh.triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(sum(polygon.area for polygon in source.polygons), rel=1e-5)


def test_quads_are_triangulated_as_by_blender(add, read_scene):
    """Quads that are flat, bent, or overlap themselves along one of their diagonals."""
    random = np.random.default_rng(0)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = square + random.normal(size=(300, 4, 3)) * random.choice([0.0, 0.2, 0.6], (300, 1, 1))
    source = add("Bent", (corners.reshape(-1, 3).tolist(), np.arange(1200).reshape(-1, 4).tolist())).data
    (mesh,) = read_scene().meshes
    source.calc_loop_triangles()
    assert mesh.triangles.tolist() == [list(triangle.vertices) for triangle in source.loop_triangles]
    assert {2, 3} <= {int(third) % 4 for third in mesh.triangles[::2, 2]}, "both diagonals occur"


def test_modifiers_are_applied(add, read_scene):
    add("Plain").modifiers.new("Subdivision", "SUBSURF").levels = 2
    (mesh,) = read_scene().meshes
    assert len(mesh.triangles) == 32


def test_flat_faces_have_face_normals_and_smooth_ones_vertex_normals(add, read_scene):
    bpy.ops.mesh.primitive_cube_add()
    source = bpy.context.object.data
    (flat,) = read_scene().meshes
    assert set(np.abs(flat.normals).max(axis=2).reshape(-1)) == {1.0}
    source.shade_smooth()
    (smooth,) = read_scene().meshes
    assert np.allclose(np.abs(smooth.normals), 1 / math.sqrt(3), atol=1e-6)


#: A bent quad and a plane one, which share an edge.
BENT = ([(-1, -1, 0), (0, -1, 0), (0, 1, 0.6), (-1, 1, 0), (1, -1, 0), (1, 1, 0.6)], [(0, 1, 2, 3), (1, 4, 5, 2)])


@pytest.mark.parametrize("smooth", [(False, False), (False, True), (True, True)])
@pytest.mark.parametrize("custom", [False, True])
def test_bent_flat_faces_have_triangle_normals_as_in_cycles(add, read_scene, empty_scene, smooth, custom):
    thing = add("Bent", BENT)
    thing.data.polygons.foreach_set("use_smooth", smooth)
    if custom:
        thing.data.normals_split_custom_set([(0.6, 0.0, 0.8)] * 8)
    material = bpy.data.materials.new("Normals")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output, emission, geometry = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("OutputMaterial", "Emission", "NewGeometry")
    )
    tree.links.new(geometry.outputs["Normal"], emission.inputs["Color"])
    tree.links.new(emission.outputs["Emission"], output.inputs["Surface"])
    thing.data.materials.append(material)
    camera = empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 2.0, (0, 0, 9)
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 16
    (mesh,) = read_scene().meshes
    reference = direct_light(1)[..., :3]
    coordinates = (np.arange(16) + 0.5) / 8.0 - 1.0
    corners = mesh.positions[mesh.triangles].astype(np.float64)
    # Cycles shades a smooth face beside a flat one as if both were smooth; Blender does not.
    for row, column in [(12, 2), (3, 5), (12, 10), (3, 13)][: 2 if smooth[0] != smooth[1] else 4]:
        point = coordinates[column], coordinates[row], 1.0
        flat = np.concatenate([corners[:, :, :2], np.ones((len(corners), 3, 1))], 2)
        barycentrics = np.linalg.solve(flat.transpose(0, 2, 1), np.broadcast_to([point], (len(flat), 3))[..., None])
        triangle = int(np.argmax(barycentrics[..., 0].min(1)))
        normal = barycentrics[triangle, :, 0] @ mesh.corner_normals[triangle]
        assert np.allclose(normal / np.linalg.norm(normal), reference[row, column], atol=0.02)


def test_plane_flat_faces_have_blenders_face_normals(add, read_scene):
    bpy.ops.mesh.primitive_cylinder_add(rotation=(0.3, 0.4, 0.5))
    bpy.ops.object.transform_apply()
    source = bpy.context.object.data
    (mesh,) = read_scene().meshes
    source.calc_loop_triangles()
    normals = [list(source.polygon_normals[triangle.polygon_index].vector) for triangle in source.loop_triangles]
    assert mesh.normals[:, 0].tolist() == normals


def test_custom_normals_are_kept(add, read_scene):
    source = add("Bent").data
    source.normals_split_custom_set([(0.6, 0.0, 0.8)] * 4)
    (mesh,) = read_scene().meshes
    assert np.allclose(mesh.normals, (0.6, 0.0, 0.8), atol=1e-3)


def test_uvs_are_those_of_the_layer_that_is_active_for_rendering(add, read_scene):
    source = add("Mapped").data
    add_image_material(source)
    for name, value in (("First", 0.25), ("Second", 0.75)):
        layer = source.uv_layers.new(name=name)
        layer.uv.foreach_set("vector", [value] * 8)
    source.uv_layers["Second"].active_render = True
    source.uv_layers["First"].active = True
    (mesh,) = read_scene().meshes
    assert mesh.uvs.shape == (2, 3, 2)
    assert np.all(mesh.uvs == 0.75)


def mesh_with_uv_layers(add, names=("First", "Second", "Third")):
    """A mesh of two triangles with two slots and UV layers, whose UVs are all 0.1, all 0.2 and all 0.3."""
    source = add("Mapped", ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])).data
    for index, name in enumerate(names):
        source.uv_layers.new(name=name).uv.foreach_set("vector", np.float32([(index + 1) / 10] * 12))
    source.polygons.foreach_set("material_index", [1, 0])
    return source


@pytest.mark.parametrize(
    ("layers", "uvs"), [(("Second",), (0.2, 0.2)), (("", "Third"), (0.3, 0.1)), (("Gone", "Second"), (0.2, 0.0))]
)
def test_each_slot_has_the_uvs_of_the_layer_that_it_names(add, layers, uvs):
    source = mesh_with_uv_layers(add)
    result = meshes.triangulated([meshes.read(source, tuple(range(len(layers))), layers)])[0].mesh.uvs
    assert np.array_equal(result, np.broadcast_to(np.float32(uvs)[:, None, None], (2, 3, 2)))


def test_a_mesh_without_uvs_has_none(add, read_scene):
    add("Bare")
    (mesh,) = read_scene().meshes
    assert mesh.uvs.shape == (0, 3, 2)


def test_material_slots_that_do_not_exist_are_clamped(add):
    source = add("Many", ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])).data
    for name in ("A", "B"):
        source.materials.append(bpy.data.materials.new(name))
    source.polygons.foreach_set("material_index", [1, 0])
    assert meshes.triangulated([meshes.read(source, (7, 5))])[0].mesh.materials.tolist() == [5, 7]
    source.attributes["material_index"].data.foreach_set("value", [9, -3])
    assert meshes.triangulated([meshes.read(source, (7, 5))])[0].mesh.materials.tolist() == [5, 7]


@pytest.mark.parametrize("bad", [NAN, INF, -INF, 1e30])
def test_an_invalid_vertex_removes_only_its_triangles(add, read_scene, bad):
    add("Torn", ([(0, 0, 0), (bad, 0, 0), (1, 1, 0), (0, 1, 0), (2, 2, 0)], [(0, 1, 2), (0, 2, 3), (2, 3, 4)]))
    scene = read_scene()
    (mesh,) = scene.meshes
    corners = mesh.positions[mesh.triangles]
    assert corners.tolist() == [[[0, 0, 0], [1, 1, 0], [0, 1, 0]], [[1, 1, 0], [0, 1, 0], [2, 2, 0]]]
    assert np.abs(mesh.positions).max() == 2
    assert np.allclose(np.abs(mesh.normals[..., 2]), 1.0)
    assert scene.warnings == ("Triangles with corners that are no numbers, or beyond 1e+09 m, are left out: 'Torn'.",)


def test_vertices_without_triangles_are_left_out(add, read_scene):
    thing = add("Loose", ([(NAN, 0, 0), (1e30, 0, 0), (0, 0, 0), (1, 0, 0), (0, 1, 0)], [(2, 3, 4)]))
    scene = read_scene()
    assert len(thing.data.vertices) == 5
    assert scene.meshes[0].positions.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert scene.meshes[0].triangles.tolist() == [[0, 1, 2]]
    assert scene.warnings == ()


def test_triangles_without_area_are_left_out_and_counted(add, read_scene):
    line = [(0, 0, 0), (1, 1, 1), (2, 2, 2), (0, 1, 0)]
    add("Thin", (line, [(0, 1, 2), (0, 0, 1), (0, 1, 3)]))
    scene = read_scene()
    assert len(scene.meshes[0].triangles) == 1
    assert scene.warnings == ("Triangles without area are left out: 'Thin' (2).",)


def test_meshes_without_triangles_are_left_out(add, read_scene):
    add("Nothing", ([], []))
    add("Points", ([(0, 0, 0), (1, 0, 0)], []))
    add("Collapsed", ([(0, 0, 0)] * 3, [(0, 1, 2)]))
    add("Lost", ([(NAN, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    scene = read_scene()
    assert scene.meshes == ()
    assert scene.instances.mesh.shape == (0,)
    assert scene.instances.world_from_object.shape == (0, 4, 4)
    assert scene.triangle_count == 0
    assert len(scene.warnings) == 2


def test_normals_and_uvs_that_are_not_finite_are_repaired(add, read_scene):
    source = add("Odd").data
    add_image_material(source)
    layer = source.uv_layers.new(name="UV")
    layer.uv.foreach_set("vector", [0.5, NAN, INF, 0.5, 0.5, -INF, 0.5, 0.5])
    (mesh,) = read_scene().meshes
    assert np.isfinite(mesh.uvs).all()
    assert set(mesh.uvs.reshape(-1)) == {0.0, 0.5}
    assert np.all(mesh.normals == (0, 0, 1))


def test_a_corner_without_a_normal_has_that_of_its_triangle():
    positions, triangles = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.uint32([[0, 1, 2]])
    normals = np.float32([[NAN, 0, 0], [0, 0, 0], [1, 0, 0]])
    for given in (normals, normals[None]):
        assert meshes._repaired(given, positions, triangles).tolist() == [[[0, 0, 1], [0, 0, 1], [1, 0, 0]]]


def test_normals_are_of_unit_length():
    """The free normals of Blender 4.5 are attributes, which may have any length."""
    positions, triangles = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.uint32([[0, 1, 2]])
    normals = np.float32([[0.7, 0, 0], [0, 3, 0], [0, 0, 1]])
    assert meshes._repaired(normals, positions, triangles).tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]


def test_a_mesh_in_edit_mode_is_read_with_its_edits(add, read_scene):
    import bmesh

    thing = add("Edited")
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bmesh.ops.create_cube(bmesh.from_edit_mesh(thing.data))
    bmesh.update_edit_mesh(thing.data)
    assert read_scene().triangle_count == 14
    bpy.ops.object.mode_set(mode="OBJECT")
    assert read_scene().triangle_count == 14
