# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance of emissive meshes: triangles against Lambert's sum, light BVHs against their triangles, bounds."""

import moderngl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.emission.emissive_lights import EmissiveLights
from ism_addon.gpu.emission.emitters import EmissiveMeshes
from ism_addon.gpu.gl.render_targets import pixels
from ism_addon.gpu.gl.shader_compiler import FOLDER, UNIFORM, bind, expand, head
from ism_addon.gpu.gl.shader_records import LIGHT_RECORDS
from ism_addon.gpu.lights.emissive_mesh import EmissiveMeshBounds
from ism_addon.gpu.passes.upload.upload_lights import light_buffers
from ism_addon.scene import Mesh
from tests.scenes.small import grid_triangles, mesh, sphere, subdivided_box
from tests.support.reference_irradiance import edge_sum
from tests.support.small_scenes import make_scene, quad

from .conftest import RECEIVERS

seeds = st.integers(0, 1 << 30)
fast = settings(max_examples=60, deadline=None, derandomize=True)


def lights_of(one: Mesh) -> EmissiveLights:
    lights = EmissiveMeshes().lights_of(make_scene([one], emission=(1.0, 1.0, 1.0)))
    assert isinstance(lights, EmissiveLights)
    return lights


def some_receivers(random: np.random.Generator, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (N,3) about the origin, and normals (N,3) to all sides."""
    points, normals = random.normal(size=(2, RECEIVERS, 3))
    points *= distance / np.linalg.norm(points, axis=1, keepdims=True)
    return np.float32(points).astype(float), normals / np.linalg.norm(normals, axis=1, keepdims=True)


@fast
@given(seed=seeds, distance=st.sampled_from([0.3, 1.0, 3.0, 30.0, 1e3]))
def test_a_triangle_is_exact(shader, seed, distance):
    random = np.random.default_rng(seed)
    corners = np.float32(random.normal(size=(3, 3)))
    points, normals = some_receivers(random, distance)
    expected = [abs(edge_sum(corners - p, n)) for p, n in zip(points, normals, strict=True)]
    area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])) / 2.0
    scale = min(1.0, area / distance**2)
    assert shader(lights_of(mesh(corners, np.array([[0, 1, 2]]))), points, normals) == pytest.approx(
        expected, rel=1e-3, abs=2e-4 * scale
    )


def test_a_box_is_the_sum_of_its_front(shader):
    random = np.random.default_rng(1)
    box = subdivided_box((-0.5, -0.4, -0.3), (0.5, 0.4, 0.3), 1)
    points, normals = some_receivers(random, 1.2)
    triangles = box.positions.astype(float)[box.triangles]
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    expected = [
        sum(abs(edge_sum(t - p, n)) for t, f in zip(triangles, facing, strict=True) if f @ (p - t[0]) > 0.0)
        for p, n in zip(points, normals, strict=True)
    ]
    assert shader(lights_of(box), points, normals) == pytest.approx(expected, abs=1e-4)


def test_inside_of_a_box_its_inner_side_counts(shader):
    """All of the hemisphere."""
    points, normals = some_receivers(np.random.default_rng(2), 0.1)
    assert shader(lights_of(subdivided_box((-1, -1, -1), (1, 1, 1), 1)), points, normals) == pytest.approx(
        np.full(RECEIVERS, np.pi), rel=1e-3
    )


def crumpled(cells: int) -> Mesh:
    """A square sheet with random folds."""
    across = np.linspace(-0.5, 0.5, cells + 1)
    heights = np.random.default_rng(5).uniform(-0.05, 0.05, (cells + 1, cells + 1, 1))
    positions = np.concatenate([np.stack(np.meshgrid(across, across), -1), heights], 2)
    return mesh(positions.reshape(-1, 3), grid_triangles(cells + 1, cells + 1))


SHAPES = {
    "ball": sphere((0, 0, 0), 0.5, 32, 16),
    "box": subdivided_box((-0.5, -0.3, -0.1), (0.5, 0.3, 0.1), 6),
    "rod": subdivided_box((-0.5, -0.02, -0.02), (0.5, 0.02, 0.02), 6),
    "sheet": crumpled(12),
}
ACCURATE = """
uniform sampler2D points;
uniform sampler2D normals;
out vec2 irradiances; // accurate, sum of all triangles
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 p = texelFetch(points, at, 0).xyz, n = texelFetch(normals, at, 0).xyz;
    Light light = fetch_Light(scene_records, lights);
    bool enclosed = emissive_mesh_encloses(light, p);
    irradiances.x = emissive_mesh_accurate_irradiance(light, p, n).x;
    irradiances.y = emissive_triangles_irradiance(light.first_triangle, light.triangle_count, p, n, enclosed).x;
}
"""


@pytest.fixture(scope="module")
def of_bvh(opened_device):
    """of_bvh(lights, points, normals): (N,2) the irradiance for the cache by the first light, and by all triangles."""
    begin = head(LIGHT_RECORDS, {"meshes_without_bvh": 0})
    with opened_device.gl as gl:
        fragment_shader = begin + expand(FOLDER / "glsl/lights/light.glsl", [], {}) + ACCURATE
        program = gl.program(begin + (FOLDER / "glsl/full_screen.vert").read_text(), fragment_shader=fragment_shader)
        program.extra = frozenset(UNIFORM.findall(fragment_shader))

    def run(lights: EmissiveLights, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        padded = (np.pad(rows, ((0, 0), (0, 1))).astype("f4") for rows in (points, normals))
        with opened_device.gl as gl:
            points, normals = (gl.texture((RECEIVERS, 1), 4, rows.tobytes(), dtype="f4") for rows in padded)
            target = gl.texture((RECEIVERS, 1), 2, dtype="f4")
            gl.enable_only(moderngl.NOTHING)
            gl.framebuffer([target]).use()
            tables = light_buffers(opened_device.scene_records(), lights, np.zeros(3))
            bind(program, points=points, normals=normals, **tables)
            gl.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
            return pixels(target)[0].astype(float)

    return run


@pytest.mark.parametrize("distance", [0.55, 0.8, 1.5, 5.0, 50.0])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_irradiance_for_the_cache_is_that_of_the_triangles(of_bvh, shape, distance):
    """In units of the mean irradiance. The largest errors are of receivers that see little of it, from the side."""
    random, lights = np.random.default_rng(3), lights_of(SHAPES[shape])
    both = np.concatenate([of_bvh(lights, *some_receivers(random, distance)) for _ in range(32)])
    error = np.abs(both[:, 0] - both[:, 1]) / both[:, 1].mean()
    assert np.median(error) < 1e-3 and np.quantile(error, 0.99) < 1e-2 and error.max() < 0.03


@pytest.mark.parametrize("shape", [*SHAPES, "panel"])
def test_no_mesh_is_brighter_than_its_bound(shader, of_bvh, shape):
    lights = lights_of(quad((-0.5, -0.5, 0), (1, 0, 0), (0, 1, 0)) if shape == "panel" else SHAPES[shape])
    bounds, random = EmissiveMeshBounds.of(lights, np.zeros(3)), np.random.default_rng(4)
    for distance in [0.3, 0.8, 3.0, 100.0] * 8:
        points, normals = some_receivers(random, distance)
        surfaces = SurfaceBounds.around(points.T.astype(np.float32), normals.T.astype(np.float32))
        bound, estimate = bounds.irradiance(surfaces)
        irradiance = shader(lights, points, normals) if shape == "panel" else of_bvh(lights, points, normals)[:, 1]
        # Of folded triangles some hide others.
        assert (np.minimum(irradiance, np.pi) <= bound[0] * (1.0 + 1e-5) + 1e-7).all()
        assert (estimate <= bound * (1.0 + 1e-5)).all()
