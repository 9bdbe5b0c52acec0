# SPDX-License-Identifier: GPL-3.0-or-later
"""The same surfaces and lights described in other ways are the same picture."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import LightShape, Mesh, Scene
from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.small import grid_triangles, mesh, sphere
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.test_similar import turn
from tests.support.small_scenes import draw, join_lights, light, look_at, make_scene, quad, random_triangles, transform

SETTINGS = Settings(quality=Quality(samples=16, error_threshold=0.0))
VIEW = look_at((3.0, -3.6, 2.6), size=(64, 44))
LAMP = light(position=(0.8, -0.6, 3.2), radiance=5.0)
TILTED = turn((1.0, 2.0, 3.0), 0.4)


def plane(parts: int) -> Mesh:
    """A square of 2 parts² triangles."""
    across, along = np.meshgrid(*[np.linspace(-2.0, 2.0, parts + 1)] * 2, indexing="ij")
    points = np.column_stack([across.ravel(), along.ravel(), np.zeros(across.size)])
    return mesh(points, grid_triangles(parts + 1, parts + 1))


def above(thing: Mesh, linear: np.ndarray | None = None) -> Scene:
    """It, with a ball and rubble over it."""
    meshes = [thing, sphere((0.5, 0.5, 0.8), 0.4, 24, 16), random_triangles(60, 0.5)]
    return make_scene(
        meshes, LAMP, [transform(linear), transform(linear), transform(offset=(-0.7, 0.0, 0.9))], world=0.1
    )


@pytest.mark.parametrize("linear", [np.eye(3), TILTED, 1e3 * TILTED], ids=["level", "tilted", "large"])
@pytest.mark.parametrize("parts", [3, 40, 316])
def test_a_plane_of_many_triangles(device, within, parts, linear):
    one, many = (above(plane(count), linear) for count in (1, parts))
    within(relative_difference(draw(device, many, VIEW, SETTINGS).color, draw(device, one, VIEW, SETTINGS).color), 1e-3)


def heap(count: int) -> tuple[list[Mesh], np.ndarray]:
    """A mesh, and `count` places for it over a floor."""
    random = np.random.default_rng(3)
    places = np.column_stack([random.uniform(-1.5, 1.5, (count, 2)), random.uniform(0.2, 1.0, count)])
    angles = random.uniform(0.0, 6.0, count)
    axes = random.normal(size=(count, 3))
    turns = [turn(tuple(axis), angle) for axis, angle in zip(axes, angles, strict=True)]
    return [random_triangles(12, 0.05, 0.05)], np.array(
        [transform(each, at) for each, at in zip(turns, places, strict=True)]
    )


def with_floor(meshes: list[Mesh], matrices: np.ndarray, ids: np.ndarray) -> Scene:
    floor = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    return make_scene([floor, *meshes], LAMP, [transform(), *matrices], [0, *(1 + ids)], world=0.1)


def test_instances_of_a_mesh_or_meshes(device, within):
    """A thousand of them: of one mesh, each a mesh of its own, or all in one."""
    meshes, matrices = heap(1000)
    (original,) = meshes
    instances = draw(device, with_floor(meshes, matrices, np.zeros(1000, int)), VIEW, SETTINGS).color
    own = with_floor([replace(original) for _ in matrices], matrices, np.arange(1000))
    within(relative_difference(draw(device, own, VIEW, SETTINGS).color, instances), 1e-3)
    points = np.einsum("nij,pj->npi", matrices[:, :3, :3], original.positions) + matrices[:, None, :3, 3]
    count = len(original.positions)
    merged = mesh(
        points.reshape(-1, 3), np.concatenate([original.triangles + count * row for row in range(len(matrices))])
    )
    whole = with_floor([merged], np.eye(4)[None], np.zeros(1, int))
    within(relative_difference(draw(device, whole, VIEW, SETTINGS).color, instances), 5e-3)


def test_the_order_of_objects(device, within):
    meshes, matrices = heap(50)
    row = np.random.default_rng(4).permutation(50)
    one, other = (with_floor(meshes, matrices[rows], np.zeros(50, int)) for rows in (np.arange(50), row))
    within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, one, VIEW, SETTINGS).color), 1e-3
    )


def test_the_order_of_triangles(device, within):
    scene = above(plane(40))
    random = np.random.default_rng(5)
    shuffled = []
    for thing in scene.meshes:
        row = random.permutation(len(thing.triangles))
        normals = thing.normals if thing.normals.ndim == 2 else thing.normals[row]
        shuffled.append(replace(thing, triangles=thing.triangles[row], normals=normals, materials=thing.materials[row]))
    other = replace(scene, meshes=tuple(shuffled))
    within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, scene, VIEW, SETTINGS).color), 1e-3
    )


@pytest.mark.parametrize(("corners", "side"), [([1, 2, 0], 1.0), ([0, 2, 1], -1.0)], ids=["turned", "flipped"])
def test_the_order_of_corners(device, within, corners, side):
    """From another corner on, or the other way round, when normals are on the other side too."""
    scene = above(plane(40))
    turned = []
    for thing in scene.meshes:
        normals = side * (thing.normals if thing.normals.ndim == 2 else thing.normals[:, corners])
        turned.append(replace(thing, triangles=np.ascontiguousarray(thing.triangles[:, corners]), normals=normals))
    other = replace(scene, meshes=tuple(turned))
    within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, scene, VIEW, SETTINGS).color), 1e-3
    )


def quarters() -> list[dict]:
    """Of the lamp."""
    centre, u, v = LAMP.position[0], LAMP.axis_u[0], LAMP.axis_v[0]
    places = [centre + 0.25 * (a * u + b * v) for a in (-1, 1) for b in (-1, 1)]
    return [{"position": place, "axis_u": 0.5 * u, "axis_v": 0.5 * v, "radiance": 5.0} for place in places]


@pytest.mark.parametrize(("samples", "bound"), [(16, 2e-2), (256, 4e-3)])
def test_a_light_of_four_quarters(device, within, samples, bound):
    """But for the noise, which falls."""
    first, *others = (light(**each) for each in quarters())
    for other in others:
        first = join_lights(first, other)
    settings = replace(SETTINGS, quality=replace(SETTINGS.quality, samples=samples))
    whole = above(plane(1))
    parts = replace(whole, lights=first)
    within(
        relative_difference(draw(device, parts, VIEW, settings).color, draw(device, whole, VIEW, settings).color), bound
    )


def test_unshadowed_light_of_four_quarters(device, within):
    first, *others = (light(**each, casts_shadow=False) for each in quarters())
    for other in others:
        first = join_lights(first, other)
    whole = above(plane(1))
    whole = replace(whole, lights=replace(LAMP, casts_shadow=np.array([False])))
    parts = replace(whole, lights=first)
    within(
        relative_difference(draw(device, parts, VIEW, SETTINGS).color, draw(device, whole, VIEW, SETTINGS).color), 1e-5
    )


@pytest.mark.parametrize("shape", list(LightShape), ids=["rectangle", "ellipse"])
@pytest.mark.parametrize("which", ["exchanged", "backwards"])
def test_a_lights_axes(device, within, shape, which):
    """Its width and height exchanged, or both the other way round: the same light, with other noise."""
    lamp = light(shape, position=(0.8, -0.6, 3.2), axis_v=(0.0, -0.5, 0.0), radiance=5.0)
    axes = {"exchanged": (lamp.axis_v, -lamp.axis_u), "backwards": (-lamp.axis_u, -lamp.axis_v)}[which]
    settings = replace(SETTINGS, quality=replace(SETTINGS.quality, samples=256), ssao=SSAO(enabled=False))
    scene = replace(above(plane(1)), lights=lamp)
    other = replace(scene, lights=replace(lamp, axis_u=axes[0], axis_v=axes[1]))
    within(
        relative_difference(draw(device, other, VIEW, settings).color, draw(device, scene, VIEW, settings).color), 5e-3
    )
