# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of the node Sky Texture, and of its sun's disc, compared with Cycles."""

import math
from dataclasses import fields

import bpy
import numpy as np
import pytest
from mathutils import Vector

from ism_addon.shading.sky import Sky, SkyModel, radiance, sun, sun_radiance
from ism_addon.shading.sky.parameters import ANALYTIC, direction_at
from tests.scenes.cycles import direct_light

#: Relative to the brightest pixel. Before 5.0, Cycles' matrix from CIE XYZ differs by 3e-4.
TOLERANCE = 1e-3
AEROSOLS = "aerosol_density" if bpy.app.version >= (5, 0) else "dust_density"
MODELS = [SkyModel(item.identifier) for item in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items]
SCATTERING = [model for model in MODELS if model not in ANALYTIC]
#: For models with a fitted formula, and for those of scattering.
ANALYTIC_SETTINGS = {
    "noon": {"sun_direction": direction_at(0.9, 0.5), "turbidity": 2.2, "ground_albedo": 0.3},
    "haze": {"sun_direction": direction_at(0.1, 3.5), "turbidity": 6.5, "ground_albedo": 0.8},
    "night": {"sun_direction": direction_at(-0.2, 5.0), "turbidity": 10.0, "ground_albedo": 1.0},
}
SCATTERING_SETTINGS = {
    "morning": {"sun_elevation": 0.25, "altitude": 0.0},
    "mountain": {
        "sun_elevation": 2.0,
        "sun_rotation": 7.0,
        "altitude": 3000.0,
        "air_density": 2.0,
        AEROSOLS: 3.0,
        "ozone_density": 5.0,
    },
    "sunset": {"sun_elevation": 0.0, "sun_rotation": -2.0, "altitude": 30e3},
    "twilight": {"sun_elevation": -0.06, "sun_rotation": 5.0, "altitude": 200.0},
    "dense": {"sun_elevation": 0.5, "air_density": 10.0, AEROSOLS: 10.0, "ozone_density": 0.0, "altitude": 59e3},
}
CASES = [
    (model, name) for model in MODELS for name in (ANALYTIC_SETTINGS if model in ANALYTIC else SCATTERING_SETTINGS)
]


@pytest.fixture
def sky_node(empty_scene):
    """The node whose colour is the world's radiance. Cycles prepares no light of it: only the camera sees it."""
    world = empty_scene.world = bpy.data.worlds.new("World")
    world.use_nodes, world.cycles.sampling_method = True, "NONE"
    node = world.node_tree.nodes.new("ShaderNodeTexSky")
    world.node_tree.links.new(node.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
    return node


@pytest.fixture
def camera(empty_scene, add):
    empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.render.resolution_percentage = 100
    return empty_scene.camera


def sky_of(node, **settings):
    """The Sky of the node with these settings."""
    for name, value in settings.items():
        setattr(node, name, value)
    names = {field.name for field in fields(Sky)} - {"model", "sun_direction", "aerosol_density"}
    return Sky(
        SkyModel(node.sky_type),
        sun_direction=tuple(node.sun_direction),
        aerosol_density=getattr(node, AEROSOLS),
        **{name: getattr(node, name) for name in names},
    )


def panorama(scene, camera, height):
    """Make the camera see all: (H,2H,3) unit vectors of the pixels' centres."""
    settings = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    camera.data.type, settings.panorama_type = "PANO", "EQUIRECTANGULAR"
    camera.rotation_euler = 0.5 * math.pi, 0.0, -0.5 * math.pi
    scene.render.resolution_x, scene.render.resolution_y = 2 * height, height
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * math.pi
    azimuth = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2.0 * math.pi
    columns = np.stack([np.cos(azimuth), np.sin(azimuth), np.ones_like(azimuth)], -1)
    rows = np.stack([np.cos(elevation), np.cos(elevation), np.sin(elevation)], -1)
    return rows[:, None] * columns


@pytest.mark.parametrize(("model", "name"), CASES)
def test_colors_equal_those_of_cycles(empty_scene, sky_node, camera, model, name):
    settings = ANALYTIC_SETTINGS[name] if model in ANALYTIC else SCATTERING_SETTINGS[name]
    sky = sky_of(sky_node, sky_type=model.value, sun_disc=False, **settings)
    directions = panorama(empty_scene, camera, 32)
    theirs = direct_light(1)[..., :3]
    ours = radiance(sky, directions.reshape(-1, 3)).reshape(theirs.shape)
    assert np.abs(ours - theirs).max() <= TOLERANCE * theirs.max()


def close_up(scene, camera, direction, angle):
    """Make the camera see an angle about a direction: (S,S,3) unit vectors of the pixels' centres."""
    side, width = 24, 2.0 * math.tan(0.5 * angle)
    camera.data.angle, camera.rotation_euler = angle, Vector(direction).to_track_quat("-Z", "Y").to_euler()
    scene.render.resolution_x = scene.render.resolution_y = side
    right, up, back = np.array(camera.rotation_euler.to_matrix()).T
    steps = width * ((np.arange(side) + 0.5) / side - 0.5)
    directions = steps[:, None] * right + steps[:, None, None] * up - back
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


@pytest.mark.parametrize("model", SCATTERING)
def test_the_horizon_equals_that_of_cycles(empty_scene, sky_node, camera, model):
    """Where its table is densest, and its rounding decides which rows meet the ground."""
    settings = {"sun_elevation": 0.03, "sun_rotation": 0.8, "altitude": 0.0}
    sky = sky_of(sky_node, sky_type=model.value, sun_disc=False, **settings)
    directions = close_up(empty_scene, camera, direction_at(0.0, 0.8), 0.03)
    theirs = direct_light(1)[..., :3]
    ours = radiance(sky, directions.reshape(-1, 3)).reshape(theirs.shape)
    assert np.abs(ours - theirs).max() <= TOLERANCE * theirs.max()


@pytest.mark.parametrize("model", SCATTERING)
@pytest.mark.parametrize(("elevation", "size"), [(0.5, 0.01), (0.01, 0.1), (-0.01, 0.04), (1.2, 0.8)])
def test_the_disc_of_the_sun_equals_that_of_cycles(empty_scene, sky_node, camera, model, elevation, size):
    settings = {"sun_elevation": elevation, "sun_rotation": 0.8, "sun_size": size, "altitude": 2000.0}
    sky = sky_of(sky_node, sky_type=model.value, sun_intensity=2.0, **settings)
    directions = close_up(empty_scene, camera, direction_at(elevation, 0.8), 1.1 * size).reshape(-1, 3)
    theirs = direct_light(1)[..., :3]
    shown = sun(sky)
    disc, behind = sun_radiance(shown, directions), radiance(sky, directions)
    ours = np.where(disc.any(1, keepdims=True) & shown.hides_sky, disc, disc + behind).reshape(theirs.shape)
    assert 0.05 < disc.any(1).mean() < 0.8
    assert np.abs(ours - theirs).max() <= TOLERANCE * theirs.max()
