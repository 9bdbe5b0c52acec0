# SPDX-License-Identifier: GPL-3.0-or-later
"""Where meshes stand: everything that Blender makes of objects, collections, nodes, particles and curves."""

import random

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from ism_addon.blender.sync import scene_reader
from tests.tools.new_file import open_empty_file

TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


def places(scene) -> list[list[float]]:
    """Origins of all instances, sorted."""
    return sorted(np.round(scene.instances.world_from_object[:, :3, 3], 5).tolist())


def test_objects_that_share_a_mesh_share_it_here(add, extracted):
    first = add("A")
    add("B", first.data).location = (1, 2, 3)
    add("C", first.data).scale = (2, 2, 2)
    scene = extracted()
    assert len(scene.meshes) == 1
    assert scene.instances.mesh.tolist() == [0, 0, 0]
    assert places(scene) == [[0, 0, 0], [0, 0, 0], [1, 2, 3]]
    assert scene.triangle_count == 6
    assert scene.instances.mesh.dtype == np.int32
    assert scene.instances.world_from_object.dtype == np.float64


def test_a_mesh_with_other_materials_is_another_mesh(add, extracted):
    first = add("A")
    first.data.materials.append(bpy.data.materials.new("Of the mesh"))
    second = add("B", first.data)
    second.material_slots[0].link = "OBJECT"
    second.material_slots[0].material = bpy.data.materials.new("Of the object")
    scene = extracted()
    assert scene.instances.mesh.tolist() == [0, 1]
    assert [set(mesh.materials.tolist()) for mesh in scene.meshes] == [{0}, {1}]


def test_world_matrices_are_blenders_through_parents(add, extracted):
    parent, child = add("Parent", None), add("Child")
    child.parent = parent
    parent.matrix_world = Matrix.Translation((1, 2, 3)) @ Matrix.Rotation(0.7, 4, "X")
    child.location, child.scale = (0.1, 0.2, 0.3), (2, -3, 4)
    scene = extracted()
    assert scene.instances.world_from_object[0].tolist() == [list(row) for row in child.matrix_world]


def test_matrices_are_affine_whatever_blender_rounds(add, extracted):
    """As where objects were parented: the parent's matrix, inverted, may end in next to 1."""
    chance = random.Random(1)
    for number in range(50):
        parent, child = add(f"Parent {number}"), add(f"Child {number}")
        parent.rotation_euler = [chance.uniform(-3.0, 3.0) for _ in range(3)]
        parent.scale = [chance.uniform(0.1, 3.0) for _ in range(3)]
        bpy.context.view_layer.objects.active = parent
        with bpy.context.temp_override(selected_editable_objects=[parent, child]):
            bpy.ops.object.parent_set()
    bpy.context.view_layer.update()
    assert any(tuple(thing.matrix_world[3]) != (0.0, 0.0, 0.0, 1.0) for thing in bpy.data.objects)
    assert (extracted().instances.world_from_object[:, 3] == (0.0, 0.0, 0.0, 1.0)).all()


def test_collections_stand_wherever_they_are_instanced_nested_too(add, extracted):
    inner, outer = (bpy.data.collections.new(name) for name in ("Inner", "Outer"))
    add("Leaf", TRIANGLE, inner).location.x = 1
    for y in (10, 20):
        holder = add(f"Inner at {y}", None, outer)
        holder.instance_type, holder.instance_collection, holder.location.y = "COLLECTION", inner, y
    for z in (100, 200):
        holder = add(f"Outer at {z}", None)
        holder.instance_type, holder.instance_collection, holder.location.z = "COLLECTION", outer, z
    scene = extracted()
    assert len(scene.meshes) == 1
    assert places(scene) == [[1, y, z] for y in (10, 20) for z in (100, 200)]


def test_lights_of_instanced_collections_shine(add, extracted):
    lamps = bpy.data.collections.new("Lamps")
    add("Lamp", bpy.data.lights.new("Lamp", "AREA"), lamps)
    for x in (1, 2, 3):
        holder = add("Holder", None)
        holder.instance_type, holder.instance_collection, holder.location.x = "COLLECTION", lamps, x
    assert sorted(extracted().lights.position[:, 0]) == [1, 2, 3]


def instance_on_points(material=None):
    """A geometry node group: a cube on each point of the mesh, in the material if there is one."""
    tree = bpy.data.node_groups.new("Cubes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    cube, instances = tree.nodes.new("GeometryNodeMeshCube"), tree.nodes.new("GeometryNodeInstanceOnPoints")
    shape = cube.outputs["Mesh"]
    if material:
        painted = tree.nodes.new("GeometryNodeSetMaterial")
        painted.inputs["Material"].default_value = material
        tree.links.new(shape, painted.inputs["Geometry"])
        shape = painted.outputs["Geometry"]
    tree.links.new(start.outputs[0], instances.inputs["Points"])
    tree.links.new(shape, instances.inputs["Instance"])
    tree.links.new(instances.outputs["Instances"], end.inputs[0])
    return tree


def test_geometry_nodes_instances_share_one_mesh_and_keep_their_material(add, extracted):
    red = bpy.data.materials.new("Red")
    red.node_tree or setattr(red, "use_nodes", True)
    red.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (1, 0, 0, 1)
    host = add("Host", TRIANGLE)
    host.location.z = 5
    host.modifiers.new("Cubes", "NODES").node_group = instance_on_points(red)
    scene = extracted()
    assert len(scene.meshes) == 1
    assert places(scene) == [[0, 0, 5], [0, 1, 5], [1, 0, 5]]
    assert len(scene.meshes[0].triangles) == 12
    assert scene.materials.base_color[scene.meshes[0].materials].tolist() == [[1, 0, 0]] * 12


@pytest.mark.parametrize("shows_emitter", [True, False])
def test_particles_show_their_object_and_their_emitter_if_it_does(add, as_rendered, shows_emitter):
    leaf = add("Leaf", TRIANGLE)
    leaf.hide_render = True
    emitter = add("Emitter")
    system = emitter.modifiers.new("Leaves", "PARTICLE_SYSTEM").particle_system
    settings = system.settings
    settings.type, settings.count, settings.render_type, settings.instance_object = "HAIR", 7, "OBJECT", leaf
    emitter.show_instancer_for_render = shows_emitter
    (scene,) = as_rendered(lambda engine, depsgraph: scene_reader.scene(depsgraph))
    sizes = [len(scene.meshes[mesh].triangles) for mesh in scene.instances.mesh]
    assert sorted(sizes) == [1] * 7 + [2] * shows_emitter
    assert scene.warnings == ()


def test_hair_strands_are_named_as_left_out(add, extracted):
    add("Head").modifiers.new("Hair", "PARTICLE_SYSTEM").particle_system.settings.type = "HAIR"
    assert extracted().warnings == ("Hair strands are not drawn by this engine: 'Head'.",)


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
    made = bpy.context.object
    data = made.data
    bpy.data.objects.remove(made)
    return data


@pytest.mark.parametrize("make", [text, tube, ball, patch])
def test_what_evaluates_to_a_mesh_stands_once_where_its_object_is(add, extracted, make):
    thing = add("Thing", make())
    thing.location = (1, 2, 3)
    scene = extracted()
    assert places(scene) == [[1, 2, 3]]
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    expected = evaluated.to_mesh()
    assert sorted(map(tuple, scene.meshes[0].positions.tolist())) == sorted(tuple(v.co) for v in expected.vertices)
    expected.calc_loop_triangles()
    assert len(scene.meshes[0].triangles) == len(expected.loop_triangles)
    evaluated.to_mesh_clear()


def test_a_curve_without_a_surface_is_nothing_and_no_trouble(add, extracted):
    curve = tube()
    curve.bevel_depth = 0
    add("Path", curve)
    scene = extracted()
    assert scene.meshes == ()
    assert scene.warnings == ()


def test_hidden_things_do_not_render(add, as_rendered):
    add("Seen")
    add("Hidden", TRIANGLE).hide_render = True
    add("Dark", bpy.data.lights.new("Dark", "AREA")).hide_render = True
    (scene,) = as_rendered(lambda engine, depsgraph: scene_reader.scene(depsgraph))
    assert [len(mesh.triangles) for mesh in scene.meshes] == [2]
    assert len(scene.lights.shape) == 0


def test_visibility_to_camera_and_shadow_is_the_objects_and_its_instancers(add, extracted):
    add("Plain")
    add("Unseen").visible_camera = False
    add("Shadowless").visible_shadow = False
    group = bpy.data.collections.new("Group")
    add("In a group", TRIANGLE, group)
    holder = add("Holder", None)
    holder.instance_type, holder.instance_collection, holder.visible_camera = "COLLECTION", group, False
    instances = extracted().instances
    assert instances.visible.tolist() == [True, False, True, False]
    assert instances.casts_shadow.tolist() == [True, True, False, True]


def test_an_indirect_only_collection_is_unseen_but_casts_shadows(add, extracted, empty_scene):
    group = bpy.data.collections.new("Group")
    empty_scene.collection.children.link(group)
    add("Caster", collection=group)
    bpy.context.view_layer.layer_collection.children["Group"].indirect_only = True
    instances = extracted().instances
    assert instances.visible.tolist() == [False]
    assert instances.casts_shadow.tolist() == [True]


def test_holdouts_are_named(add, extracted):
    add("Hole").is_holdout = True
    assert extracted().warnings == ("Holdouts are drawn as plain surfaces: 'Hole'.",)


@pytest.mark.parametrize("scale", [(0, 1, 1), (0, 0, 0), (1, 1, float("inf")), (float("nan"), 1, 1)])
def test_objects_without_extent_in_some_direction_are_left_out(add, extracted, scale):
    add("Kept").scale = (1e-4, 1e3, 1e-4)
    add("Flat").scale = scale
    scene = extracted()
    assert scene.instances.mesh.tolist() == [0]
    assert np.isfinite(scene.instances.world_from_object).all()
    assert scene.warnings == ("Objects scaled to nothing in some direction, or beyond 1e+09 m, are left out: 'Flat'.",)


def test_a_mesh_that_stands_nowhere_is_not_kept(add, extracted):
    add("Flat", TRIANGLE).scale = (0, 1, 1)
    add("Kept")
    scene = extracted()
    assert [len(mesh.triangles) for mesh in scene.meshes] == [2]
    assert scene.instances.mesh.tolist() == [0]


def test_the_scene_outlives_the_file(add, extracted):
    add("A")
    scene = extracted()
    before = scene.meshes[0].positions.copy()
    open_empty_file()
    assert np.array_equal(scene.meshes[0].positions, before)
