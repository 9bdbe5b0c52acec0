# SPDX-License-Identifier: GPL-3.0-or-later
"""Each feature of a file that is not drawn is reported in one sentence; features without effect are not."""

import bpy
import numpy as np
import pytest

from tests.scenes.cycles import direct_light


def with_nodes(owner):
    """The node tree of a material, a world or a light, which is made if there is none."""
    if owner.node_tree is None or not owner.use_nodes:
        owner.use_nodes = True
    return owner.node_tree


@pytest.fixture
def material(add):
    """A new material with Blender's default nodes, on a square."""
    new_material = bpy.data.materials.new("Paint")
    with_nodes(new_material)
    add("Square").data.materials.append(new_material)
    return new_material


def principled(material):
    return material.node_tree.nodes["Principled BSDF"]


SOCKETS = [
    ("Transmission Weight", 1.0, "What materials transmit is not drawn"),
    ("Subsurface Weight", 0.5, "Subsurface scattering is drawn as diffuse reflection"),
    ("Thin Film Thickness", 300.0, "Thin films are not drawn"),
]


@pytest.mark.parametrize("linked", [False, True])
@pytest.mark.parametrize(("name", "value", "issue"), SOCKETS, ids=[name for name, _, _ in SOCKETS])
def test_each_socket_that_is_not_drawn_is_reported(material, read_scene, name, value, issue, linked):
    node = principled(material)
    if name not in node.inputs:
        assert bpy.app.version < (4, 3), name
        return
    assert read_scene().warnings == (), "a new material has nothing to report"
    socket = node.inputs[name]
    if linked:
        checker = material.node_tree.nodes.new("ShaderNodeTexChecker")
        material.node_tree.links.new(checker.outputs["Fac"], socket)
    else:
        socket.default_value = value
    assert read_scene().warnings == (f"{issue}: 'Paint'.",)


OTHERS = "Glossy shaders of other distributions are drawn with that of GGX"


@pytest.mark.parametrize(
    ("node", "distribution", "issues"),
    [
        ("Sheen", "MICROFIBER", ()),
        ("Sheen", "ASHIKHMIN", ("Sheen of the distribution Ashikhmin is drawn as microfibers: 'Paint'.",)),
        ("Anisotropic", "BECKMANN", ()),
        ("Anisotropic", "ASHIKHMIN_SHIRLEY", (f"{OTHERS}: 'Paint'.",)),
    ],
)
def test_distributions_that_are_not_drawn_are_reported(material, read_scene, node, distribution, issues):
    tree = material.node_tree
    surface = tree.nodes.new(f"ShaderNodeBsdf{node}")
    surface.distribution = distribution
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    assert read_scene().warnings == issues


def test_a_value_node_is_read_as_the_sockets_own_number(material, read_scene):
    value = material.node_tree.nodes.new("ShaderNodeValue")
    material.node_tree.links.new(value.outputs[0], principled(material).inputs["Transmission Weight"])
    assert read_scene().warnings == ()
    value.outputs[0].default_value = 1.0
    assert read_scene().warnings == ("What materials transmit is not drawn: 'Paint'.",)


def test_what_has_no_effect_is_not_reported(material, read_scene):
    inputs = principled(material).inputs
    inputs["Emission Strength"].default_value, inputs["Emission Color"].default_value = 1.0, (0, 0, 0, 1)
    inputs["Roughness"].default_value, inputs["Specular IOR Level"].default_value = 0.0, 0.0
    assert read_scene().warnings == ()


@pytest.mark.parametrize("node", ["NormalMap", "Bump"])
@pytest.mark.parametrize("shader", ["BsdfPrincipled", "BsdfDiffuse"])
def test_normals_of_nodes_are_drawn(material, read_scene, node, shader):
    tree = material.node_tree
    surface, normals = tree.nodes.new(f"ShaderNode{shader}"), tree.nodes.new(f"ShaderNode{node}")
    tree.links.new(surface.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    tree.links.new(normals.outputs["Normal"], surface.inputs["Normal"])
    scene = read_scene()
    assert scene.warnings == () and scene.graphs[0].changes_normals


@pytest.mark.parametrize(
    ("node", "socket", "issue"),
    [
        ("VolumeScatter", "Volume", "Volumes are not drawn by this engine"),
        ("Displacement", "Displacement", "Displacement is drawn as a change of normals, without moving the surface"),
    ],
)
def test_volume_and_displacement_are_reported(material, read_scene, node, socket, issue):
    tree, material.displacement_method = material.node_tree, "BOTH"
    tree.links.new(tree.nodes.new(f"ShaderNode{node}").outputs[0], tree.nodes["Material Output"].inputs[socket])
    assert read_scene().warnings == (f"{issue}: 'Paint'.",)


@pytest.mark.parametrize(
    ("targets", "drawn"),
    [(("EEVEE",), 0), (("CYCLES",), 0), (("EEVEE", "CYCLES"), 1), (("CYCLES", "ALL"), 0), (("ALL", "EEVEE"), 0)],
)
def test_the_output_is_the_one_that_cycles_uses(material, read_scene, targets, drawn):
    tree = material.node_tree
    tree.nodes.clear()
    colors = ((1, 0, 0, 1), (0, 1, 0, 1))
    for target, color in zip(targets, colors, strict=False):
        output, shader = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfDiffuse")
        output.target, shader.inputs["Color"].default_value = target, color
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [list(colors[drawn][:3])]
    assert scene.warnings == ()


def test_a_material_without_any_surface_is_reported(material, read_scene):
    material.node_tree.nodes.clear()
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [[0, 0, 0]]
    assert scene.warnings == ("Materials without a surface are drawn black: 'Paint'.",)


def test_holdout_of_a_collection_and_shadow_catchers_are_reported(add, read_scene, empty_scene):
    inner = bpy.data.collections.new("Inner")
    empty_scene.collection.children.link(inner)
    add("Hole", collection=inner)
    bpy.context.view_layer.layer_collection.children["Inner"].holdout = True
    add("Catcher").is_shadow_catcher = True
    assert read_scene().warnings == (
        "Holdouts are drawn as plain surfaces: 'Hole'.",
        "Shadow catchers are drawn as plain surfaces: 'Catcher'.",
    )


def test_scene_features_that_are_not_drawn_are_reported(add, read_scene, empty_scene):
    empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    assert read_scene().warnings == ()
    empty_scene.camera.data.dof.use_dof = True
    empty_scene.render.use_motion_blur = empty_scene.render.use_freestyle = True
    layer = bpy.context.view_layer.name
    assert read_scene().warnings == (
        "Depth of field is not drawn: 'Camera'.",
        "Motion blur is not drawn: 'Scene'.",
        f"Freestyle's lines are not drawn: '{layer}'.",
    )


@pytest.fixture
def background(empty_scene):
    """The Background node of a new world, which is white."""
    empty_scene.world = bpy.data.worlds.new("World")
    node = with_nodes(empty_scene.world).nodes["Background"]
    node.inputs["Color"].default_value = (1, 1, 1, 1)
    return node


def test_a_worlds_strength_is_read_from_value_nodes_and_other_nodes_are_reported(read_scene, background):
    tree = background.id_data
    value, occlusion = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("ShaderNodeAmbientOcclusion")
    value.outputs[0].default_value = 0.25
    tree.links.new(value.outputs[0], background.inputs["Strength"])
    scene = read_scene()
    assert scene.world.radiance.tolist() == [0.25] * 3 and scene.warnings == ()
    tree.links.new(occlusion.outputs[0], background.inputs["Strength"])
    sentence = "Worlds whose Strength is given by a node 'Ambient Occlusion' have the socket's own value: 'World'."
    assert read_scene().warnings == (sentence,)


def test_a_worlds_volume_and_visibility_are_reported(read_scene, background, empty_scene):
    tree = background.id_data
    volume = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(volume.outputs[0], tree.nodes["World Output"].inputs["Volume"])
    visibility = empty_scene.world.cycles_visibility
    visibility.camera, visibility.glossy = False, False
    scene = read_scene()
    assert scene.warnings == (
        "Volumes of worlds are not drawn: 'World'.",
        "Worlds light diffuse and glossy surfaces alike: 'World'.",
    )
    assert scene.world.radiance.tolist() == [1, 1, 1] and scene.world.background.tolist() == [0, 0, 0]
    visibility.diffuse = False
    empty_scene.world.update_tag()  # which only panels do
    assert read_scene().world.radiance.tolist() == [0, 0, 0]


def test_a_view_layer_can_disable_the_world_and_surfaces_as_in_cycles(add, read_scene, background, empty_scene):
    add("Square", ([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [(0, 1, 2, 3)]))
    empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.camera.location = 0, 0, 5
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 4
    layer = bpy.context.view_layer
    layer.use_sky = False
    assert read_scene().world.radiance.tolist() == [0, 0, 0]
    assert direct_light(1)[2, 2].tolist() == [0, 0, 0, 1]
    layer.use_sky, layer.use_solid = True, False
    assert read_scene().triangle_count == 0
    assert np.allclose(direct_light(1)[2, 2], 1.0)


def test_a_view_layers_own_world_is_read(read_scene, background):
    layer = bpy.context.view_layer
    if not hasattr(layer, "world_override"):
        assert bpy.app.version < (4, 3)
        return
    layer.world_override = bpy.data.worlds.new("Own")
    node = with_nodes(layer.world_override).nodes["Background"]
    node.inputs["Color"].default_value = (0.5, 0.25, 0.125, 1)
    assert read_scene().world.radiance.tolist() == [0.5, 0.25, 0.125]
