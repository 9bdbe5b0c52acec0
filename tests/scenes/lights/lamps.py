# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds points, spots, suns, emissive materials and a world to the open file."""

import math

import bpy

from tests.scenes.atrium_light import aim
from tests.scenes.blend_file import Point


def add_point(position: Point, watts: float, color: Point, radius: float) -> None:
    """Add a point light, which the camera does not see."""
    _add(_data("POINT", watts, color, shadow_soft_size=radius), position, position)


def add_spot(
    position: Point, target: Point, watts: float, color: Point, radius: float, degrees: float, blend: float
) -> None:
    """Add a spot, which the camera does not see."""
    data = _data("SPOT", watts, color, shadow_soft_size=radius)
    data.spot_size, data.spot_blend = math.radians(degrees), blend
    _add(data, position, target)


def add_sun(direction: Point, strength: float, color: Point, degrees: float) -> None:
    """Add a sun of a strength in W/m²."""
    data = _data("SUN", strength, color)
    data.angle = math.radians(degrees)
    _add(data, (0.0, 0.0, 0.0), direction)


def emissive(name: str, color: Point, strength: float) -> bpy.types.Material:
    """A material that only emits, W/(sr m²)."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (*color, 1.0), strength
    tree.links.new(emission.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def set_world(color: Point) -> None:
    """Give the world a color, W/(sr m²)."""
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1.0)


def _data(kind: str, energy: float, color: Point, **properties: float) -> bpy.types.Light:
    data = bpy.data.lights.new(kind.capitalize(), kind)
    data.energy, data.color = energy, color
    for name, value in properties.items():
        setattr(data, name, value)
    return data


def _add(data: bpy.types.Light, position: Point, target: Point) -> None:
    lamp = bpy.data.objects.new(data.name, data)
    lamp.location, lamp.visible_camera = position, False
    if target != position:
        lamp.rotation_euler = aim(position, target)
    bpy.context.scene.collection.objects.link(lamp)
