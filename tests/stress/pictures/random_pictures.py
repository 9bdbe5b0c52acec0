# SPDX-License-Identifier: GPL-3.0-or-later
"""Hypothesis strategies for random pictures: scenes, views and settings. They shrink to small, plain ones."""

import math
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from ism_addon.scene import Instances, Lights, LightShape, Mesh, Scene, View, World
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.scenes.parts.tables import instances_of, materials_of
from tests.scenes.small import mesh, perspective
from tests.stress.pictures.moves import Picture
from tests.support.light_profiles import beam, stripes
from tests.support.small_scenes import AREA_SHAPES

SEEDS = st.integers(0, 2**32 - 1)


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    """10 to a power between `low` and `high`; shrinks towards 1."""
    return st.floats(low, high, width=16).map(lambda power: 10.0**power)


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """A few triangles: random, coplanar, slivers, or snapped to a grid; flat, or with random normals at the corners."""
    random, count = generator(draw), draw(st.integers(1, 40))
    size = draw(powers(-2, 0.5))
    corners = random.uniform(-1.0, 1.0, (count, 1, 3)) + size * random.uniform(-1.0, 1.0, (count, 3, 3))
    layout = draw(st.sampled_from(["any", "plane", "slivers", "grid"]))
    if layout == "plane":
        corners[..., 2] = 0.0
    if layout == "slivers":
        corners[:, 2] = corners[:, 1] + draw(powers(-7, -2)) * random.uniform(-1.0, 1.0, (count, 3))
    if layout == "grid":
        corners = np.round(2.0 * corners) / 2.0
    corners = corners.astype(np.float32)
    edges = corners[:, 1:] - corners[:, :1]
    corners = corners[
        (np.cross(edges[:, 0], edges[:, 1]) ** 2).sum(1) > 0.0
    ]  # the scene reader leaves out triangles without area
    if not len(corners):
        corners = np.eye(3, dtype=np.float32)[None]
    flat = mesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    if not draw(st.booleans()):
        return flat
    normals = random.normal(size=(len(corners), 3, 3))
    return replace(flat, normals=(normals / np.linalg.norm(normals, axis=2, keepdims=True)).astype(np.float32))


def generator(draw: st.DrawFn) -> np.random.Generator:
    """A seeded generator, for values that need not shrink."""
    return np.random.default_rng(draw(SEEDS))


def random_orthogonal(random: np.random.Generator) -> np.ndarray:
    """(3,3): a random orthogonal matrix, sometimes a permutation of the axes."""
    if random.random() < 0.3:
        return np.eye(3)[random.permutation(3)]
    return np.linalg.qr(random.normal(size=(3, 3)))[0]


@st.composite
def instances(draw: st.DrawFn, mesh_count: int) -> Instances:
    """Rotated, mirrored, sheared and scaled instances that may overlap."""
    random, count = generator(draw), draw(st.integers(1, 5))
    matrices = np.tile(np.eye(4), (count, 1, 1))
    for matrix in matrices:
        stretch = random.choice([1.0, -1.0, 0.5, 3.0, 1e-3, 0.0], 3, p=[0.7, 0.1, 0.1, 0.06, 0.02, 0.02])
        shear = np.eye(3)
        shear[0, 2] = random.choice([0.0, 0.7, -4.0], p=[0.8, 0.1, 0.1])
        matrix[:3, :3], matrix[:3, 3] = random_orthogonal(random) @ shear * stretch, np.round(random.normal(size=3), 1)
    visible, casts_shadow = random.random((2, count)) < 0.85
    mesh_ids = random.integers(0, mesh_count, count).astype(np.int32)
    return instances_of(mesh_ids, matrices, visible=visible, casts_shadow=casts_shadow)


def basis_towards_origin(random: np.random.Generator, position: np.ndarray) -> np.ndarray:
    """(3,3): right, up and forward of a camera or light at a position (3,) that faces roughly the origin."""
    forward = random.normal(size=3) * 0.3 - position
    right = np.cross(forward, random.normal(size=3))
    rows = np.array([right, np.cross(right, forward), forward])
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


@st.composite
def lights(draw: st.DrawFn) -> Lights:
    """Zero to four lights of any type, inside and outside of meshes, of any size, power and spread."""
    random, count = generator(draw), draw(st.integers(0, 4))
    position = random.normal(size=(count, 3)) * random.choice([0.5, 2.0, 10.0], (count, 1))
    axes = np.array([basis_towards_origin(random, each) for each in position]).reshape(-1, 3, 3)
    sizes = 10.0 ** random.uniform(-4.0, 1.5, (count, 2))
    colors = random.choice([0.0, 0.5, 1.0], (count, 3)) if draw(st.booleans()) else np.ones((count, 3))
    power = 10.0 ** random.uniform(-3.0, 3.0, (count, 1)) * colors
    unlinked, shape = np.full(count, -1, np.int32), random.choice(len(LightShape), count).astype(np.int32)
    is_area = np.isin(shape, AREA_SHAPES)
    emission = power / np.where(is_area, sizes.prod(1), 1.0)[:, None]
    sizes = np.where(is_area[:, None], sizes, random.choice([1.0, 0.5, 2.0], (count, 2)))  # of spots, their cone's
    spread = random.choice([math.pi, 2.0, 0.5, 0.01, 0.0], count, p=[0.6, 0.2, 0.1, 0.05, 0.05])
    is_sun = shape == LightShape.SUN
    has_image = (is_area | (shape == LightShape.SPOT)) & (random.random(count) < 0.2)
    spread[is_sun] = random.choice([0.0, 0.01, 0.5, 2.0, math.pi], count)[is_sun]
    return Lights(
        shape=shape,
        position=position,
        axis_u=axes[:, 0] * sizes[:, :1],
        axis_v=axes[:, 1] * sizes[:, 1:],
        normal=axes[:, 2],
        emission=emission.astype(np.float32),
        spread=spread.astype(np.float32),
        blend=random.choice([0.0, 0.2, 1.0], count).astype(np.float32),
        radius=random.choice([0.0, 1e-3, 0.1, 1.0, 20.0], count),
        soft_falloff=random.random(count) < 0.5,
        visible_camera=random.random(count) < 0.1,
        shadow_softness=random.choice([1.0, 0.0, 0.5, 4.0], count, p=[0.8, 0.05, 0.1, 0.05]).astype(np.float32),
        casts_shadow=random.random(count) < 0.9,
        receivers=unlinked,
        blockers=unlinked.copy(),
        falloff_power=np.where(is_sun, 0, random.choice(3, count, p=[0.9, 0.05, 0.05])).astype(np.int32),
        falloff_smooth=np.where(is_sun, 0.0, random.choice([0.0, 1.0], count, p=[0.9, 0.1])).astype(np.float32),
        profile=np.where(is_sun, -1, random.choice([-1, 0], count, p=[0.9, 0.1])).astype(np.int32),
        profile_axes=axes.copy(),
        image=np.where(has_image, 0, -1).astype(np.int32),
    )


@st.composite
def views(draw: st.DrawFn) -> View:
    """Views from anywhere, also inside of meshes, of few pixels."""
    random = generator(draw)
    width, height = draw(st.sampled_from([16, 24, 9, 1])), draw(st.sampled_from([12, 17, 8, 1]))
    position = random.normal(size=3) * random.choice([0.3, 2.0, 20.0], p=[0.2, 0.7, 0.1])
    right, up, forward = basis_towards_origin(random, position)
    matrix = np.eye(4)
    matrix[:3, :3] = right, up, -forward
    matrix[:3, 3] = -matrix[:3, :3] @ position
    if random.random() < 0.25:
        clip = np.diag([0.5, 0.5 * width / height, -0.01, 1.0])
        clip[2, 3] = -1.0
    else:
        clip = perspective(random.choice([0.9, 0.3, 2.5]), width / height, random.choice([0.1, 1e-3]), 1e3)
    filter_width = draw(st.sampled_from([1.5, 0.01, 3.0]))
    return View(clip, matrix, width, height, filter_width=filter_width, transparent=draw(st.booleans()))


@st.composite
def all_settings(draw: st.DrawFn) -> Settings:
    """Settings of both methods, with few points and samples."""
    method = draw(st.sampled_from(Method))
    ssao = SSAO(
        enabled=draw(st.booleans()),
        radius=draw(powers(-4, 3)),
        cone_angle=draw(st.sampled_from([2.8, 0.02, math.pi])),
        intensity=draw(st.sampled_from([1.0, 10.0])),
        attenuation=draw(st.sampled_from([1.0, 0.0, 100.0])),
    )
    quality = Quality(
        samples=draw(st.sampled_from([1, 2, 5])),
        error_threshold=0.0,
        virtual_lights=draw(st.sampled_from([4, 1])),
        map_size=draw(st.sampled_from([16, 8, 33])),
        map_points=draw(st.sampled_from([256, 1])),
    )
    return Settings(Shadow(method=method), ssao, quality, shortcuts=not draw(st.booleans()))


@st.composite
def pictures(draw: st.DrawFn) -> Picture:
    """A scene, its view and settings."""
    scene_meshes = tuple(draw(st.lists(meshes(), min_size=1, max_size=3)))
    scene = Scene(
        meshes=scene_meshes,
        instances=draw(instances(len(scene_meshes))),
        materials=materials_of([(0.6, 0.3, 0.9)]),
        images=(),
        lights=draw(lights()),
        world=World.even(np.full(3, draw(st.sampled_from([0.0, 0.1, 5.0])), np.float32)),
        light_profiles=(beam(),),
        light_images=(stripes(),),
    )
    return scene, draw(views()), draw(all_settings())
