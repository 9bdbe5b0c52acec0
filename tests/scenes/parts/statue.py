# SPDX-License-Identifier: GPL-3.0-or-later
"""A statue of a robed water carrier, 2.3 m high, feet on z = 0: shapes joined by a voxel remesh and smoothed."""

from itertools import pairwise

import bpy
import numpy as np

from tests.scenes.parts.shapes import Shape, grid, join, lathe

VOXEL = 0.0145  # m: about 60,000 triangles, fine enough for the folds


def statue_mesh() -> bpy.types.Mesh:
    """The figure as a fine mesh without texture coordinates."""
    shape = figure()
    mesh = bpy.data.meshes.new("Statue")
    mesh.from_pydata(shape.positions.tolist(), [], shape.quads.tolist())
    sculpture = bpy.data.objects.new("Statue", mesh)
    bpy.context.scene.collection.objects.link(sculpture)
    remesh = sculpture.modifiers.new("Remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", VOXEL
    smooth = sculpture.modifiers.new("Smooth", "SMOOTH")
    smooth.factor, smooth.iterations = 0.5, 8
    depsgraph = bpy.context.evaluated_depsgraph_get()
    result = bpy.data.meshes.new_from_object(sculpture.evaluated_get(depsgraph))
    bpy.data.objects.remove(sculpture)
    bpy.data.meshes.remove(mesh)
    result.name = "Statue"
    result.shade_smooth()
    return result


def figure() -> Shape:
    """All parts. They overlap; the remesh keeps only the outer surface."""
    left, right, neck = (0.19, 0.0, 1.60), (-0.19, 0.0, 1.58), (0.0, -0.01, 1.64)
    elbow_up, hand_up = (0.40, -0.06, 1.76), (0.27, -0.05, 2.02)
    elbow_down, hand_down = (-0.36, 0.05, 1.30), (-0.21, -0.17, 1.17)
    parts = [
        robe(),
        limb((0.01, 0.0, 1.12), (0.0, 0.0, 1.30), 0.155, 0.145),
        limb((-0.07, 0.0, 1.32), (-0.07, -0.01, 1.50), 0.11, 0.115),
        limb((0.07, 0.0, 1.32), (0.07, -0.01, 1.50), 0.11, 0.115),
        limb((-0.075, -0.1, 1.46), (-0.075, -0.1, 1.47), 0.072, 0.072),
        limb((0.075, -0.1, 1.46), (0.075, -0.1, 1.47), 0.072, 0.072),
        limb(right, left, 0.082, 0.082),
        limb(neck, (0.015, -0.02, 1.80), 0.064, 0.058),
        limb((0.02, -0.03, 1.86), (0.022, -0.015, 1.93), 0.094, 0.105),
        limb((0.022, 0.085, 1.92), (0.022, 0.12, 1.88), 0.07, 0.06),
        limb((0.02, -0.118, 1.885), (0.02, -0.125, 1.865), 0.018, 0.022),
        limb(left, elbow_up, 0.078, 0.058),
        limb(elbow_up, hand_up, 0.056, 0.042),
        limb(right, elbow_down, 0.078, 0.058),
        limb(elbow_down, hand_down, 0.056, 0.042),
        jar().moved(x=0.27, y=0.02, z=1.68),
    ]
    return join(parts + sash())


def robe() -> Shape:
    """The skirt from the waist to the ground. Its folds deepen downwards and twist."""
    t = np.linspace(0.0, 1.0, 60)
    radius = 0.16 + 0.11 * np.sin(np.pi * np.clip(t * 1.5, 0.0, 0.5)) + 0.13 * np.clip(t - 0.2, 0.0, 1.0) ** 1.4
    angle = np.linspace(0.0, 2.0 * np.pi, 145)
    twist = 0.5 * np.sin(2.2 * t)[:, None]
    folds = np.cos(9.0 * angle + 3.0 * twist) + 0.55 * np.cos(14.0 * angle - 4.0 * twist) + 0.5 * np.cos(5.0 * angle)
    knee = 0.05 * np.exp(-(((t - 0.5) / 0.22) ** 2))[:, None] * np.exp(-(((angle - 4.3) / 0.5) ** 2))
    r = radius[:, None] * (1.0 + 0.075 * np.clip(t * 1.6, 0.0, 1.0)[:, None] * folds) + knee
    sway = 0.035 * np.sin(np.pi * t)[:, None]
    x, y = 1.05 * r * np.cos(angle) + sway, 0.9 * r * np.sin(angle)
    z = np.broadcast_to(1.18 * (1.0 - t)[:, None], r.shape)
    rows = np.stack([x, y, z], -1)
    closed = np.concatenate([rows[:1] * (0.01, 0.01, 1.0), rows, rows[-1:] * (0.01, 0.01, 1.0)])
    return grid(closed, np.zeros((*closed.shape[:2], 2)))


def sash() -> list[Shape]:
    """A sash from the raised shoulder to the hip, in three strands."""
    t = np.linspace(0.0, 2.0 * np.pi, 25)
    strands = []
    for k in range(3):
        tilt = 0.20 + 0.03 * k
        path = np.stack(
            [(0.215 - 0.01 * k) * np.cos(t), 0.19 * np.sin(t) - 0.01, 1.36 - 0.045 * k + tilt * np.cos(t)], -1
        )
        strands += [limb(a, b, 0.026, 0.026, 10) for a, b in pairwise(path)]
    return strands


def jar() -> Shape:
    """The jar on her shoulder."""
    t = np.linspace(0.0, 1.0, 30)
    radius = (
        0.05 + 0.11 * np.sin(np.pi * np.clip(t / 0.85, 0.0, 1.0)) ** 0.9 + 0.06 * np.clip((t - 0.82) / 0.18, 0.0, 1.0)
    )
    profile = np.stack([radius, 0.52 * t], axis=-1)
    return lathe(np.concatenate([[(0.001, 0.0)], profile, [(0.001, 0.52)]]), 40)


def limb(start: object, end: object, start_radius: float, end_radius: float, segments: int = 24) -> Shape:
    """A truncated cone with round ends, from one joint (x,y,z) to the next."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    length = float(np.linalg.norm(b - a))
    angles = np.linspace(-0.5 * np.pi, 0.0, 9)
    low = np.stack([start_radius * np.cos(angles), start_radius * np.sin(angles)], -1)
    high = np.stack([end_radius * np.cos(angles), -end_radius * np.sin(angles)], -1)[::-1] + (0.0, length)
    profile = np.concatenate([low, high])
    profile[[0, -1], 0] = 1e-3
    cone = lathe(profile, segments)
    axis = (b - a) / length
    side = np.cross(axis, (0.0, 1.0, 0.0) if abs(axis[1]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    frame = np.stack([side, np.cross(axis, side), axis])
    return Shape(cone.positions @ frame + a, cone.quads, cone.uvs)
