# SPDX-License-Identifier: GPL-3.0-or-later
"""How far the curved surface stands out over its triangles, so that no triangle shades its round neighbour."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.gl.shader_compiler import FOLDER
from tests.scenes.small import sphere
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, with_quality

ASK = """
in vec3 b;
in vec3 p0; in vec3 p1; in vec3 p2;
in vec3 n0; in vec3 n1; in vec3 n2;
out float told;
void main() { told = terminator_offset(b, vec3[3](p0, p1, p2), vec3[3](n0, n1, n2)); }
"""


def heights(device, barycentric: np.ndarray, corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(N,) of places (N,3) on triangles (N,3,3) with corners' normals (N,3,3)."""
    source = "#version 410 core\n" + (FOLDER / "glsl/surfaces/terminator_offset.glsl").read_text() + ASK
    program = device.gl.program(vertex_shader=source, varyings=["told"])
    rows = np.concatenate([barycentric, corners.reshape(-1, 9), normals.reshape(-1, 9)], 1).astype(np.float32)
    buffer = device.gl.buffer(reserve=4 * len(rows))
    device.gl.simple_framebuffer((1, 1)).use()
    content = [(device.gl.buffer(rows), "3f 3f 3f 3f 3f 3f 3f", "b", "p0", "p1", "p2", "n0", "n1", "n2")]
    device.gl.vertex_array(program, content).transform(buffer, moderngl.POINTS, vertices=len(rows))
    return np.frombuffer(buffer.read(), "f4").astype(float)


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def places(count: int, seed: int = 0) -> np.ndarray:
    """(N,3) uniform barycentric coordinates."""
    return np.random.default_rng(seed).dirichlet(np.ones(3), count)


def on_sphere(count: int, size: float, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Corners and normals (N,3,3) of triangles about `size` radii large that face outwards."""
    random = np.random.default_rng(1)
    around = unit(random.normal(size=(count, 1, 3)))
    turned = np.cross(around, unit(random.normal(size=(count, 1, 3))))
    across = [unit(turned), np.cross(around, unit(turned))]
    angles = 2 * np.pi * (np.arange(3)[None, :, None] + random.uniform(0, 0.6, (count, 3, 1))) / 3
    normals = unit(around + size * (np.cos(angles) * across[0] + np.sin(angles) * across[1]))
    return radius * normals, normals


def test_flat_triangles_do_not_rise(device):
    corners = np.random.default_rng(2).normal(size=(500, 3, 3))
    normal = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    found = heights(device, places(500), corners, np.repeat(normal[:, None], 3, 1))
    assert np.abs(found).max() < 1e-5


@pytest.mark.parametrize("size", [0.02, 0.1, 0.4])
@pytest.mark.parametrize("radius", [1e-3, 1.0, 100.0])
def test_over_a_spheres_triangles_stands_the_sphere(device, size, radius):
    """At least as high as it is, and no more than three times: rays that start there clear the neighbours."""
    corners, normals = on_sphere(1000, size, radius)
    barycentric = places(1000)
    found = heights(device, barycentric, corners, normals) / radius
    sphere_height = 1.0 - np.linalg.norm(np.einsum("nk,nkc->nc", barycentric, corners) / radius, axis=1)
    assert (found > 0.85 * sphere_height - 1e-6).all()
    assert (found < 3.0 * sphere_height + 0.1 * size**2 + 1e-6).all()


def test_at_the_corners_it_is_the_triangle(device):
    corners, normals = on_sphere(300, 0.3)
    for k in range(3):
        found = heights(device, np.tile(np.eye(3)[k], (300, 1)), corners, normals)
        assert np.abs(found).max() < 1e-6


def test_it_does_not_matter_which_corner_comes_first_nor_where_or_how_large_it_is(device):
    random = np.random.default_rng(3)
    corners, normals = random.normal(size=(500, 3, 3)), unit(random.normal(size=(500, 3, 3)))
    barycentric = places(500)
    found = heights(device, barycentric, corners, normals)
    assert found.max() > 0.1
    rolled = [np.roll(rows, 1, 1) for rows in (barycentric, corners, normals)]
    assert heights(device, *rolled) == pytest.approx(found, abs=1e-5)
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    moved = heights(device, barycentric, 3.0 * corners @ turn.T + (1.0, -2.0, 0.5), normals @ turn.T)
    assert moved == pytest.approx(3.0 * found, abs=1e-4)


@pytest.mark.parametrize("around", [8, 12, 24])
@pytest.mark.parametrize("side", [(1, 0, 0.1), (-0.3, 1, 0.6), (0.6, -0.8, 0)])
def test_a_ball_of_few_triangles_has_none_that_are_dark_at_its_terminator(device, around, side):
    """A convex thing throws no shadow on what faces the light: with shadows or without, it looks nearly the same."""
    ball = make_scene(
        [sphere((0, 0, 0), 1.0, around, around // 2)],
        facing(unit(np.array(side, float))),
    )
    view, settings = look_at((2.5, -2.5, 1.5), size=(64, 64)), with_quality(SMALL_SETTINGS, samples=16)
    lit = draw(device, replace(ball, lights=replace(ball.lights, casts_shadow=np.array([False]))), view, settings).color
    shaded = draw(device, ball, view, settings).color
    missing = (lit - shaded)[..., 0] / lit[..., 0].max()
    assert missing.max() < 0.25
    assert (missing > 0.05).mean() < 0.01
    assert missing.mean() < 0.005


def facing(direction: np.ndarray):
    """A lamp far away in that direction that shines at the origin."""
    u = unit(np.cross(direction, (0.3, 0.2, 1.0)))
    return light(position=6.0 * direction, axis_u=0.5 * u, axis_v=0.5 * np.cross(u, direction))
