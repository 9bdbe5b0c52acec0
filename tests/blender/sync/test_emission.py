# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that materials emit, compared with what the camera sees in Cycles."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.color import MAX_TEMPERATURE, MIN_TEMPERATURE, blackbody
from tests.scenes.cycles import direct_light

from .test_materials import new_image, texture
from .test_materials import surface as surface

SHADERS = {
    "ShaderNodeEmission": ("Color", "Strength"),
    "ShaderNodeBsdfPrincipled": ("Emission Color", "Emission Strength"),
}


@pytest.fixture(params=SHADERS)
def emitter(request, surface, empty_scene, add):
    """A material that emits, its color and strength sockets, and a camera that sees only it."""
    material, node = surface(request.param)
    if "Base Color" in node.inputs:
        node.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
        node.inputs["Specular IOR Level"].default_value = 0.0
    empty_scene.camera = add("camera", bpy.data.cameras.new("camera"))
    empty_scene.camera.data.type, empty_scene.camera.data.ortho_scale = "ORTHO", 0.1
    empty_scene.camera.location = (0.5, 0.5, 2.0)
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 4
    color, strength = (node.inputs[name] for name in SHADERS[request.param])
    color.default_value, strength.default_value = (1.0, 0.5, 0.25, 1.0), 3.0
    return material, color, strength


def test_color_times_strength(emitter, read_scene):
    scene = read_scene()
    assert scene.warnings == ()
    assert np.allclose(scene.materials.emission, [(3.0, 1.5, 0.75)])
    assert np.allclose(direct_light(1)[..., :3], scene.materials.emission[0])


@pytest.mark.parametrize("temperature", [500.0, 1000.0, 2000.0, 4000.0, 6500.0, 11000.0, 20000.0])
def test_the_colour_of_a_black_body(emitter, read_scene, temperature):
    material, color, _ = emitter
    body = material.node_tree.nodes.new("ShaderNodeBlackbody")
    body.inputs["Temperature"].default_value = temperature
    material.node_tree.links.new(body.outputs["Color"], color)
    scene, theirs = read_scene(), direct_light(1)[0, 0, :3]
    assert scene.warnings == ()
    assert np.allclose(scene.materials.emission[0], theirs, atol=0.004 * theirs.max())


def test_all_temperatures_have_a_colour():
    colors = np.array([blackbody(each) for each in np.linspace(0.5 * MIN_TEMPERATURE, 2.0 * MAX_TEMPERATURE, 999)])
    assert (colors >= 0.0).all() and (colors[:, 0] > 0.0).all()
    assert np.abs(np.diff(colors, axis=0)).max() < 0.15


@pytest.mark.parametrize("operation", ["ADD", "SUBTRACT", "MULTIPLY", "DIVIDE"])
@pytest.mark.parametrize("operand", [2.0, 0.0])
def test_arithmetic_of_constants(emitter, read_scene, operation, operand):
    material, _, strength = emitter
    node = material.node_tree.nodes.new("ShaderNodeMath")
    node.operation = operation
    node.inputs[0].default_value, node.inputs[1].default_value = 5.0, operand
    material.node_tree.links.new(node.outputs[0], strength)
    scene = read_scene()
    assert scene.warnings == ()
    assert np.allclose(scene.materials.emission[0], direct_light(1)[0, 0, :3])


def test_the_mean_of_an_image_is_known(emitter, read_scene):
    material, color, _ = emitter
    texture(material, color, new_image(pixels=[(1, 0, 0, 1), (1, 1, 0, 1), (0, 0, 0, 1), (0, 1, 0, 1)]))
    scene = read_scene()
    assert np.allclose(scene.materials.emission, [(1.5, 1.5, 0.0)], atol=0.01)
    assert scene.warnings == () and scene.has_emission_graphs


def test_other_nodes_are_reported(emitter, read_scene):
    material, color, strength = emitter
    particle = material.node_tree.nodes.new("ShaderNodeParticleInfo")
    for output, socket in (("Velocity", color), ("Age", strength)):
        material.node_tree.links.new(particle.outputs[output], socket)
    assert read_scene().warnings == tuple(
        f"Materials whose {socket.name} is given by a node 'Particle Info' have the socket's own value: 'Paint'."
        for socket in (color, strength)
    )


@pytest.mark.parametrize(("value", "emitted"), [(0.0, 0.0), (-2.0, -2.0), (1e12, 1e12), (1e30, 0.0)])
def test_odd_strengths(emitter, read_scene, value, emitted):
    _, color, strength = emitter
    if value < 0.0 and strength.name == "Emission Strength" and bpy.app.version >= (5, 0):
        emitted = 0.0  # as in Cycles
    color.default_value, strength.default_value = (1.0, 1.0, 1.0, 1.0), value
    scene = read_scene()
    assert np.allclose(scene.materials.emission, emitted)
    assert scene.warnings == (("Materials too bright to be drawn emit nothing: 'Paint'.",) if value > 1e15 else ())
    if abs(value) < 1e15:
        assert np.allclose(direct_light(1)[..., :3], emitted)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_no_number_emits_nothing(emitter, read_scene, value):
    _, _, strength = emitter
    strength.default_value = value
    assert not np.isfinite(strength.default_value) or strength.default_value > 1e30
    assert not read_scene().materials.emission.any()


def test_a_material_that_begins_to_emit_is_read_again(emitter, read_scene):
    _, _, strength = emitter
    strength.default_value = 0.0
    assert not read_scene().materials.emission.any()
    strength.default_value = 1.0
    assert read_scene().materials.emission.any()


@pytest.mark.parametrize("strength", [0.0, 3.0])
def test_a_transparent_surface_has_a_graph_of_emission_only_if_it_emits(surface, read_scene, strength):
    """Each surface with one is taken for a light, and baked."""
    _, node = surface("ShaderNodeBsdfPrincipled")
    node.inputs["Alpha"].default_value = 0.5
    node.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    node.inputs["Emission Strength"].default_value = strength
    scene = read_scene()
    assert scene.has_transparency == (True, True)
    assert scene.has_emission_graphs == (strength > 0.0)
