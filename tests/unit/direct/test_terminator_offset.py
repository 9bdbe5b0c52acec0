# SPDX-License-Identifier: GPL-3.0-or-later
"""The height of a smooth surface above its triangles: rays start there, so that no triangle shadows a neighbour."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.gl.shader_compiler import FOLDER
from tests.scenes.small import sphere
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, with_quality

SHADER = """
in vec3 b;
in vec3 p0; in vec3 p1; in vec3 p2;
in vec3 n0; in vec3 n1; in vec3 n2;
out float result;
void main() { result = FUNCTION; }
"""
OFFSET = "terminator_offset(b, vec3[3](p0, p1, p2), vec3[3](n0, n1, n2))"
ALONG_NORMAL = "offset_along_normal(b, vec3[3](p0, p1, p2), vec3[3](n0, n1, n2), cross(p1 - p0, p2 - p0))"


def offsets(
    device, barycentric: np.ndarray, corners: np.ndarray, normals: np.ndarray, function: str = OFFSET
) -> np.ndarray:
    """(N,) at barycentric coordinates (N,3) on triangles (N,3,3) with normals (N,3,3) of the corners."""
    code = (FOLDER / "glsl/surfaces/terminator_offset.glsl").read_text() + SHADER.replace("FUNCTION", function)
    source = "#version 410 core\n" + code
    program = device.gl.program(vertex_shader=source, varyings=["result"])
    rows = np.concatenate([barycentric, corners.reshape(-1, 9), normals.reshape(-1, 9)], 1).astype(np.float32)
    buffer = device.gl.buffer(reserve=4 * len(rows))
    device.gl.simple_framebuffer((1, 1)).use()
    content = [(device.gl.buffer(rows), "3f 3f 3f 3f 3f 3f 3f", "b", "p0", "p1", "p2", "n0", "n1", "n2")]
    device.gl.vertex_array(program, content).transform(buffer, moderngl.POINTS, vertices=len(rows))
    return np.frombuffer(buffer.read(), "f4").astype(float)


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_barycentric(count: int, seed: int = 0) -> np.ndarray:
    """(N,3) uniform barycentric coordinates."""
    return np.random.default_rng(seed).dirichlet(np.ones(3), count)


def on_sphere(count: int, size: float, radius: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Corners and normals (N,3,3) of triangles about `size` radii large that face outwards."""
    random = np.random.default_rng(1)
    direction = unit(random.normal(size=(count, 1, 3)))
    perpendicular = np.cross(direction, unit(random.normal(size=(count, 1, 3))))
    tangents = [unit(perpendicular), np.cross(direction, unit(perpendicular))]
    angles = 2 * np.pi * (np.arange(3)[None, :, None] + random.uniform(0, 0.6, (count, 3, 1))) / 3
    normals = unit(direction + size * (np.cos(angles) * tangents[0] + np.sin(angles) * tangents[1]))
    return radius * normals, normals


def test_flat_triangles_have_no_offset(device):
    corners = np.random.default_rng(2).normal(size=(500, 3, 3))
    normal = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    height = offsets(device, random_barycentric(500), corners, np.repeat(normal[:, None], 3, 1))
    assert np.abs(height).max() < 1e-5


@pytest.mark.parametrize("size", [0.02, 0.1, 0.4])
@pytest.mark.parametrize("radius", [1e-3, 1.0, 100.0])
def test_offsets_on_a_spheres_triangles_reach_the_sphere(device, size, radius):
    """At least about the sphere's height above the triangle, at most three times that: rays clear the neighbours."""
    corners, normals = on_sphere(1000, size, radius)
    barycentric = random_barycentric(1000)
    height = offsets(device, barycentric, corners, normals) / radius
    sphere_height = 1.0 - np.linalg.norm(np.einsum("nk,nkc->nc", barycentric, corners) / radius, axis=1)
    assert (height > 0.85 * sphere_height - 1e-6).all()
    assert (height < 3.0 * sphere_height + 0.1 * size**2 + 1e-6).all()


def test_the_offset_is_zero_at_the_corners(device):
    corners, normals = on_sphere(300, 0.3)
    for k in range(3):
        height = offsets(device, np.tile(np.eye(3)[k], (300, 1)), corners, normals)
        assert np.abs(height).max() < 1e-6


def test_the_offset_follows_similarities_and_does_not_depend_on_the_first_corner(device):
    random = np.random.default_rng(3)
    corners, normals = random.normal(size=(500, 3, 3)), unit(random.normal(size=(500, 3, 3)))
    barycentric = random_barycentric(500)
    height = offsets(device, barycentric, corners, normals)
    assert height.max() > 0.1
    rolled = [np.roll(rows, 1, 1) for rows in (barycentric, corners, normals)]
    assert offsets(device, *rolled) == pytest.approx(height, abs=1e-5)
    rotation = np.linalg.qr(random.normal(size=(3, 3)))[0]
    moved = offsets(device, barycentric, 3.0 * corners @ rotation.T + (1.0, -2.0, 0.5), normals @ rotation.T)
    assert moved == pytest.approx(3.0 * height, abs=1e-4)


def test_rays_start_on_the_seen_side_though_normals_point_away(device):
    """Negative along such normals; as far from the triangle as along their opposites."""
    corners, normals = on_sphere(200, 0.3)
    barycentric = random_barycentric(200)
    height = offsets(device, barycentric, corners, normals, ALONG_NORMAL)
    assert height == pytest.approx(offsets(device, barycentric, corners, normals)) and height.max() > 0.01
    away = offsets(device, barycentric, corners, -normals, ALONG_NORMAL)
    assert away == pytest.approx(-height)


@pytest.mark.parametrize("around", [8, 12, 24])
@pytest.mark.parametrize("side", [(1, 0, 0.1), (-0.3, 1, 0.6), (0.6, -0.8, 0)])
def test_a_coarse_ball_has_no_dark_triangles_at_its_terminator(device, around, side):
    """A convex body casts no shadow on its lit side: with and without shadows, it looks nearly the same."""
    ball = make_scene(
        [sphere((0, 0, 0), 1.0, around, around // 2)],
        light_from(unit(np.array(side, float))),
    )
    view, settings = look_at((2.5, -2.5, 1.5), size=(64, 64)), with_quality(SMALL_SETTINGS, samples=16)
    unshadowed = draw(
        device, replace(ball, lights=replace(ball.lights, casts_shadow=np.array([False]))), view, settings
    ).color
    shadowed = draw(device, ball, view, settings).color
    missing = (unshadowed - shadowed)[..., 0] / unshadowed[..., 0].max()
    assert missing.max() < 0.25
    assert (missing > 0.05).mean() < 0.01
    assert missing.mean() < 0.005


def light_from(direction: np.ndarray):
    """A light far away in that direction, which faces the origin."""
    u = unit(np.cross(direction, (0.3, 0.2, 1.0)))
    return light(position=6.0 * direction, axis_u=0.5 * u, axis_v=0.5 * np.cross(u, direction))
