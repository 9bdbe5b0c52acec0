# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of meshes: those that Blender makes of objects, collections, nodes, particles and curves."""

import random

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from ism_addon.blender.sync import scene_reader
from tests.tools.new_file import open_empty_file

TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


def positions(scene) -> list[list[float]]:
    """Origins of all instances, sorted."""
    return sorted(np.round(scene.instances.world_from_object[:, :3, 3], 5).tolist())


def test_objects_that_share_a_mesh_share_it_here(add, read_scene):
    first = add("A")
    add("B", first.data).location = (1, 2, 3)
    add("C", first.data).scale = (2, 2, 2)
    scene = read_scene()
    assert len(scene.meshes) == 1
    assert scene.instances.mesh.tolist() == [0, 0, 0]
    assert positions(scene) == [[0, 0, 0], [0, 0, 0], [1, 2, 3]]
    assert scene.triangle_count == 6
    assert scene.instances.mesh.dtype == np.int32
    assert scene.instances.world_from_object.dtype == np.float64


def test_a_mesh_with_other_materials_is_another_mesh(add, read_scene):
    first = add("A")
    first.data.materials.append(bpy.data.materials.new("Of the mesh"))
    second = add("B", first.data)
    second.material_slots[0].link = "OBJECT"
    second.material_slots[0].material = bpy.data.materials.new("Of the object")
    scene = read_scene()
    assert scene.instances.mesh.tolist() == [0, 1]
    assert [set(mesh.materials.tolist()) for mesh in scene.meshes] == [{0}, {1}]


def test_world_matrices_are_blenders_through_parents(add, read_scene):
    parent, child = add("Parent", None), add("Child")
    child.parent = parent
    parent.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, "X")
    child.location, child.scale = (0.1, 0.2, 0.3), (2, -3, 4)
    scene = read_scene()
    assert scene.instances.world_from_object[0].tolist() == [list(row) for row in child.matrix_world]


def test_matrices_are_affine_though_blender_rounds(add, read_scene):
    """Parenting stores the parent's inverse matrix, rounded: its last row may not be exactly 0, 0, 0, 1."""
    rng = random.Random(1)
    for index in range(50):
        parent, child = add(f"Parent {index}"), add(f"Child {index}")
        parent.rotation_euler = [rng.uniform(-3.0, 3.0) for _ in range(3)]
        parent.scale = [rng.uniform(0.1, 3.0) for _ in range(3)]
        bpy.context.view_layer.objects.active = parent
        with bpy.context.temp_override(selected_editable_objects=[parent, child]):
            bpy.ops.object.parent_set()
    bpy.context.view_layer.update()
    assert any(tuple(thing.matrix_world[3]) != (0.0, 0.0, 0.0, 1.0) for thing in bpy.data.objects)
    assert (read_scene().instances.world_from_object[:, 3] == (0.0, 0.0, 0.0, 1.0)).all()


def test_nested_collections_are_instanced(add, read_scene):
    inner, outer = (bpy.data.collections.new(name) for name in ("Inner", "Outer"))
    add("Leaf", TRIANGLE, inner).location.x = 1
    for y in (10, 20):
        holder = add(f"Inner at {y}", None, outer)
        holder.instance_type, holder.instance_collection, holder.location.y = "COLLECTION", inner, y
    for z in (100, 200):
        holder = add(f"Outer at {z}", None)
        holder.instance_type, holder.instance_collection, holder.location.z = "COLLECTION", outer, z
    scene = read_scene()
    assert len(scene.meshes) == 1
    assert positions(scene) == [[1, y, z] for y in (10, 20) for z in (100, 200)]


def test_lights_of_instanced_collections_are_read(add, read_scene):
    collection = bpy.data.collections.new("Lamps")
    add("Lamp", bpy.data.lights.new("Lamp", "AREA"), collection)
    for x in (1, 2, 3):
        holder = add("Holder", None)
        holder.instance_type, holder.instance_collection, holder.location.x = "COLLECTION", collection, x
    assert sorted(read_scene().lights.position[:, 0]) == [1, 2, 3]


def instance_on_points(material=None):
    """A geometry node group that instances a cube on each point of the mesh, with the material if there is one."""
    tree = bpy.data.node_groups.new("Cubes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    cube, instances = tree.nodes.new("GeometryNodeMeshCube"), tree.nodes.new("GeometryNodeInstanceOnPoints")
    shape = cube.outputs["Mesh"]
    if material:
        set_material = tree.nodes.new("GeometryNodeSetMaterial")
        set_material.inputs["Material"].default_value = material
        tree.links.new(shape, set_material.inputs["Geometry"])
        shape = set_material.outputs["Geometry"]
    tree.links.new(start.outputs[0], instances.inputs["Points"])
    tree.links.new(shape, instances.inputs["Instance"])
    tree.links.new(instances.outputs["Instances"], end.inputs[0])
    return tree


def test_geometry_nodes_instances_share_one_mesh_and_keep_their_material(add, read_scene):
    red = bpy.data.materials.new("Red")
    red.node_tree or setattr(red, "use_nodes", True)
    red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (1, 0, 0, 1)
    host = add("Host", TRIANGLE)
    host.location.z = 5
    host.modifiers.new("Cubes", "NODES").node_group = instance_on_points(red)
    scene = read_scene()
    assert len(scene.meshes) == 1
    assert positions(scene) == [[0, 0, 5], [0, 1, 5], [1, 0, 5]]
    assert len(scene.meshes[0].triangles) == 12
    assert scene.materials.base_color[scene.meshes[0].materials].tolist() == [[1, 0, 0]] * 12


@pytest.mark.parametrize("shows_emitter", [True, False])
def test_particles_instance_their_object_and_may_show_their_emitter(add, call_in_render, shows_emitter):
    leaf = add("Leaf", TRIANGLE)
    leaf.hide_render = True
    emitter = add("Emitter")
    system = emitter.modifiers.new("Leaves", "PARTICLE_SYSTEM").particle_system
    settings = system.settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 7, "OBJECT", leaf
    emitter.show_instancer_for_render = shows_emitter
    (scene,) = call_in_render(lambda engine, depsgraph: scene_reader.scene(depsgraph))
    sizes = [len(scene.meshes[mesh].triangles) for mesh in scene.instances.mesh]
    assert sorted(sizes) == [1] * 7 + [2] * shows_emitter
    assert scene.warnings == ()


def test_hair_strands_are_reported_as_left_out(add, read_scene):
    add("Head").modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings.type = "HAIR"
    assert read_scene().warnings == ("Hair strands are not drawn by this engine: 'Head'.",)


def text():
    letters = bpy.data.curves.new("Text", "FONT")
    letters.body = "O"
    return letters


def tube():
    curve = bpy.data.curves.new("Tube", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    curve.splines.new("POLY").points.add(1)
    curve.splines[0].points[1].co = (1, 0, 0, 1)
    return curve


def ball():
    family = bpy.data.metaballs.new("Ball")
    family.elements.new()
    return family


def patch():
    bpy.ops.surface.primitive_nurbs_surface_surface_add()
    patch_object = bpy.context.object
    data = patch_object.data
    bpy.data.objects.remove(patch_object)
    return data


@pytest.mark.parametrize("make", [text, tube, ball, patch])
def test_what_evaluates_to_a_mesh_is_one_instance_at_its_object(add, read_scene, make):
    thing = add("Thing", make())
    thing.location = (1, 2, 3)
    scene = read_scene()
    assert positions(scene) == [[1, 2, 3]]
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    expected = evaluated.to_mesh()
    assert sorted(map(tuple, scene.meshes[0].positions.tolist())) == sorted(tuple(v.co) for v in expected.vertices)
    expected.calc_loop_triangles()
    assert len(scene.meshes[0].triangles) == len(expected.loop_triangles)
    evaluated.to_mesh_clear()


def test_a_curve_without_a_surface_is_left_out_silently(add, read_scene):
    curve = tube()
    curve.bevel_depth = 0
    add("Path", curve)
    scene = read_scene()
    assert scene.meshes == ()
    assert scene.warnings == ()


def test_hidden_objects_are_not_rendered(add, call_in_render):
    add("Seen")
    add("Hidden", TRIANGLE).hide_render = True
    add("Dark", bpy.data.lights.new("Dark", "AREA")).hide_render = True
    (scene,) = call_in_render(lambda engine, depsgraph: scene_reader.scene(depsgraph))
    assert [len(mesh.triangles) for mesh in scene.meshes] == [2]
    assert len(scene.lights.shape) == 0


def test_visibility_to_camera_and_shadow_is_that_of_the_object_and_its_instancer(add, read_scene):
    add("Plain")
    add("Unseen").visible_camera = False
    add("Shadowless").visible_shadow = False
    group = bpy.data.collections.new("Group")
    add("In a group", TRIANGLE, group)
    holder = add("Holder", None)
    holder.instance_type, holder.instance_collection, holder.visible_camera = "COLLECTION", group, False
    instances = read_scene().instances
    assert instances.visible.tolist() == [True, False, True, False]
    assert instances.casts_shadow.tolist() == [True, True, False, True]


def test_an_indirect_only_collection_is_invisible_but_casts_shadows(add, read_scene, empty_scene):
    group = bpy.data.collections.new("Group")
    empty_scene.collection.children.link(group)
    add("Caster", collection=group)
    bpy.context.view_layer.layer_collection.children["Group"].indirect_only = True
    instances = read_scene().instances
    assert instances.visible.tolist() == [False]
    assert instances.casts_shadow.tolist() == [True]


def test_holdouts_are_reported(add, read_scene):
    add("Hole").is_holdout = True
    assert read_scene().warnings == ("Holdouts are drawn as plain surfaces: 'Hole'.",)


@pytest.mark.parametrize("scale", [(0, 0, 1), (0, 0, 0), (1, 1, float("inf")), (float("nan"), 1, 1)])
def test_objects_without_extent_in_two_directions_are_left_out(add, read_scene, scale):
    add("Kept").scale = (1e-4, 1e3, 1e-4)
    add("Flat").scale = scale
    scene = read_scene()
    assert scene.instances.mesh.tolist() == [0]
    assert np.isfinite(scene.instances.world_from_object).all()
    assert scene.warnings == ("Objects scaled to nothing in two directions, or beyond 1e+09 m, are left out: 'Flat'.",)


def test_flattened_objects_lie_in_a_plane(add, read_scene):
    """Blender draws planes whose third scale is 0."""
    flat = add("Flat")
    flat.scale, flat.rotation_euler = (2, 0, 3), (0.3, 0.4, 0.5)
    scene = read_scene()
    assert scene.warnings == ()
    (linear,) = scene.instances.world_from_object[:, :3, :3]
    exact = np.array(flat.rotation_euler.to_matrix()) * (2, 0, 3)
    np.testing.assert_allclose(linear, exact, atol=4e-5)
    assert np.linalg.det(linear) != 0.0


def test_a_mesh_without_instances_is_not_kept(add, read_scene):
    add("Flat", TRIANGLE).scale = (0, 0, 1)
    add("Kept")
    scene = read_scene()
    assert [len(mesh.triangles) for mesh in scene.meshes] == [2]
    assert scene.instances.mesh.tolist() == [0]


def test_the_scene_outlives_the_file(add, read_scene):
    add("A")
    scene = read_scene()
    before = scene.meshes[0].positions.copy()
    open_empty_file()
    assert np.array_equal(scene.meshes[0].positions, before)
