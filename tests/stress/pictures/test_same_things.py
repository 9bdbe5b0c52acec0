# SPDX-License-Identifier: GPL-3.0-or-later
"""Equivalent descriptions of the same surfaces and lights give the same picture."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Mesh, Scene
from ism_addon.settings import SSAO, Quality, Settings, Shadow
from tests.scenes.small import grid_triangles, mesh, sphere
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.test_similar import rotation
from tests.support.small_scenes import (
    AREA_SHAPES,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    transform,
)

SETTINGS = Settings(shadow=Shadow(world=False), quality=Quality(samples=16, error_threshold=0.0))
VIEW = look_at((3.0, -3.6, 2.6), size=(64, 44))
LIGHT = light(position=(0.8, -0.6, 3.2), radiance=5.0)
TILTED = rotation((1.0, 2.0, 3.0), 0.4)


def plane(subdivisions: int) -> Mesh:
    """A square of 2 subdivisions² triangles."""
    across, along = np.meshgrid(*[np.linspace(-2.0, 2.0, subdivisions + 1)] * 2, indexing="ij")
    points = np.column_stack([across.ravel(), along.ravel(), np.zeros(across.size)])
    return mesh(points, grid_triangles(subdivisions + 1, subdivisions + 1))


def with_casters_above(floor: Mesh, linear: np.ndarray | None = None) -> Scene:
    """A floor with a ball and loose triangles above it."""
    meshes = [floor, sphere((0.5, 0.5, 0.8), 0.4, 24, 16), random_triangles(60, 0.5)]
    return make_scene(
        meshes, LIGHT, [transform(linear), transform(linear), transform(offset=(-0.7, 0.0, 0.9))], world=0.1
    )


@pytest.mark.parametrize("linear", [np.eye(3), TILTED, 1e3 * TILTED], ids=["level", "tilted", "large"])
@pytest.mark.parametrize("subdivisions", [3, 40, 316])
def test_a_plane_of_many_triangles(device, assert_within, subdivisions, linear):
    one, many = (with_casters_above(plane(count), linear) for count in (1, subdivisions))
    assert_within(
        relative_difference(draw(device, many, VIEW, SETTINGS).color, draw(device, one, VIEW, SETTINGS).color), 1e-3
    )


def heap(count: int) -> tuple[list[Mesh], np.ndarray]:
    """A mesh, and `count` instance matrices that place it over a floor."""
    random = np.random.default_rng(3)
    positions = np.column_stack([random.uniform(-1.5, 1.5, (count, 2)), random.uniform(0.2, 1.0, count)])
    angles = random.uniform(0.0, 6.0, count)
    axes = random.normal(size=(count, 3))
    rotations = [rotation(tuple(axis), angle) for axis, angle in zip(axes, angles, strict=True)]
    return [random_triangles(12, 0.05, 0.05)], np.array(
        [transform(*each) for each in zip(rotations, positions, strict=True)]
    )


def with_floor(meshes: list[Mesh], matrices: np.ndarray, ids: np.ndarray) -> Scene:
    floor = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    return make_scene([floor, *meshes], LIGHT, [transform(), *matrices], [0, *(1 + ids)], world=0.1)


def test_instances_of_a_mesh_or_meshes(device, assert_within):
    """A thousand instances of one mesh, a mesh for each, or all merged into one mesh."""
    meshes, matrices = heap(1000)
    (original,) = meshes
    instances = draw(device, with_floor(meshes, matrices, np.zeros(1000, int)), VIEW, SETTINGS).color
    copies = with_floor([replace(original) for _ in matrices], matrices, np.arange(1000))
    assert_within(relative_difference(draw(device, copies, VIEW, SETTINGS).color, instances), 1e-3)
    points = np.einsum("nij,pj->npi", matrices[:, :3, :3], original.positions) + matrices[:, None, :3, 3]
    count = len(original.positions)
    merged = mesh(
        points.reshape(-1, 3), np.concatenate([original.triangles + count * row for row in range(len(matrices))])
    )
    single = with_floor([merged], np.eye(4)[None], np.zeros(1, int))
    assert_within(relative_difference(draw(device, single, VIEW, SETTINGS).color, instances), 5e-3)


def test_the_order_of_objects(device, assert_within):
    meshes, matrices = heap(50)
    shuffled = np.random.default_rng(4).permutation(50)
    one, other = (with_floor(meshes, matrices[rows], np.zeros(50, int)) for rows in (np.arange(50), shuffled))
    assert_within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, one, VIEW, SETTINGS).color), 1e-3
    )


def test_the_order_of_triangles(device, assert_within):
    scene = with_casters_above(plane(40))
    random = np.random.default_rng(5)
    shuffled = []
    for each in scene.meshes:
        order = random.permutation(len(each.triangles))
        normals = each.normals if each.normals.ndim == 2 else each.normals[order]
        shuffled.append(
            replace(each, triangles=each.triangles[order], normals=normals, materials=each.materials[order])
        )
    other = replace(scene, meshes=tuple(shuffled))
    assert_within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, scene, VIEW, SETTINGS).color), 1e-3
    )


@pytest.mark.parametrize(("corners", "side"), [([1, 2, 0], 1.0), ([0, 2, 1], -1.0)], ids=["turned", "flipped"])
def test_the_order_of_corners(device, assert_within, corners, side):
    """Corners start with another one, or are in reverse order and the normals point to the other side too."""
    scene = with_casters_above(plane(40))
    reordered = []
    for each in scene.meshes:
        normals = side * (each.normals if each.normals.ndim == 2 else each.normals[:, corners])
        reordered.append(replace(each, triangles=np.ascontiguousarray(each.triangles[:, corners]), normals=normals))
    other = replace(scene, meshes=tuple(reordered))
    assert_within(
        relative_difference(draw(device, other, VIEW, SETTINGS).color, draw(device, scene, VIEW, SETTINGS).color), 1e-3
    )


def quarters() -> list[dict]:
    """The four quarters of LIGHT, as arguments of light()."""
    centre, u, v = LIGHT.position[0], LIGHT.axis_u[0], LIGHT.axis_v[0]
    positions = [centre + 0.25 * (a * u + b * v) for a in (-1, 1) for b in (-1, 1)]
    return [{"position": position, "axis_u": 0.5 * u, "axis_v": 0.5 * v, "radiance": 5.0} for position in positions]


@pytest.mark.parametrize(("samples", "bound"), [(16, 2e-2), (256, 4e-3)])
def test_a_light_of_four_quarters(device, assert_within, samples, bound):
    """The pictures differ only by noise, which falls with more samples."""
    lights, *others = (light(**each) for each in quarters())
    for other in others:
        lights = join_lights(lights, other)
    settings = replace(SETTINGS, quality=replace(SETTINGS.quality, samples=samples))
    one_light = with_casters_above(plane(1))
    quartered = replace(one_light, lights=lights)
    assert_within(
        relative_difference(
            draw(device, quartered, VIEW, settings).color, draw(device, one_light, VIEW, settings).color
        ),
        bound,
    )


def test_unshadowed_light_of_four_quarters(device, assert_within):
    lights, *others = (light(**each, casts_shadow=False) for each in quarters())
    for other in others:
        lights = join_lights(lights, other)
    one_light = with_casters_above(plane(1))
    one_light = replace(one_light, lights=replace(LIGHT, casts_shadow=np.array([False])))
    quartered = replace(one_light, lights=lights)
    assert_within(
        relative_difference(
            draw(device, quartered, VIEW, SETTINGS).color, draw(device, one_light, VIEW, SETTINGS).color
        ),
        1e-5,
    )


@pytest.mark.parametrize("shape", AREA_SHAPES, ids=["rectangle", "ellipse"])
def test_a_lights_axes(device, assert_within, shape):
    """Axes u and v exchanged, or both reversed: the same light, with other noise."""
    area_light = light(shape, position=(0.8, -0.6, 3.2), axis_v=(0.0, -0.5, 0.0), radiance=5.0)
    settings = replace(SETTINGS, quality=replace(SETTINGS.quality, samples=256), ssao=SSAO(enabled=False))
    scene = replace(with_casters_above(plane(1)), lights=area_light)
    original = draw(device, scene, VIEW, settings).color
    exchanged, reversed_ = (area_light.axis_v, -area_light.axis_u), (-area_light.axis_u, -area_light.axis_v)
    for axis_u, axis_v in (exchanged, reversed_):
        other = replace(scene, lights=replace(area_light, axis_u=axis_u, axis_v=axis_v))
        assert_within(relative_difference(draw(device, other, VIEW, settings).color, original), 5e-3)
