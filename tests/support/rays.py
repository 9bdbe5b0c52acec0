# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays and camera rays: traced by the shader through the BVHs, and tested in float64 against every triangle."""

from dataclasses import replace

import moderngl
import numpy as np

from ism_addon.gpu.gl.shader_compiler import FOLDER, UNIFORM, bind, expand, head
from ism_addon.gpu.gl.shader_records import CASTER
from ism_addon.gpu.materials.point_graphs import OPAQUE
from ism_addon.gpu.passes.upload.build_bvh import BuildBLAS, BuildTLAS, UploadBLAS
from ism_addon.gpu.passes.upload.cull_meshes import CullMeshes
from ism_addon.gpu.passes.upload.upload_scene import UploadInstances, UploadMeshes
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import TLAS
from tests.support import reference
from tests.support.small_scenes import SMALL_SETTINGS, look_at

SHADER = """
uniform samplerBuffer starts;
uniform samplerBuffer ends;
uniform samplerBuffer owners;
out float result;
void main() {
    vec2 owner = texelFetch(owners, gl_VertexID).xy;
    vec3 from = texelFetch(starts, gl_VertexID).xyz, to = texelFetch(ends, gl_VertexID).xyz;
    result = RESULT;
}
"""
ANY_HIT = "1.0 - transmittance(from, to, int(owner.x), int(owner.y), -1).x"
DISTANCE = "nearest_hit(from, to, -1, -1).distance"


def occluded(device, scene, starts: np.ndarray, ends: np.ndarray, owners: np.ndarray | None = None) -> np.ndarray:
    """(N,) bool: whether the shader finds a triangle between starts and ends (N,3).

    `owners` (N,2): the triangle and instance that each ray starts on, which cannot occlude it.
    """
    return traced(device, scene, ANY_HIT, starts, ends, owners) > 0.5


def distances(device, scene, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(N,) float32: distances from starts (N,3) to the nearest visible triangles, as fractions of those to the ends."""
    return traced(device, scene, DISTANCE, starts, ends)


def traced(
    device, scene, result: str, starts: np.ndarray, ends: np.ndarray, owners: np.ndarray | None = None
) -> np.ndarray:
    """(N,) float32: a GLSL expression for each ray."""
    renderer, view = Renderer(device), look_at(np.abs(starts).max() * np.array([1.0, -1.0, 1.0]))
    frame = renderer.frame(scene, view, replace(SMALL_SETTINGS, shortcuts=False), 0, Profile())
    for pass_type in (CullMeshes, BuildBLAS, UploadMeshes, UploadInstances, UploadBLAS, BuildTLAS):
        renderer.graph.step(pass_type, frame, Profile())
    owners = np.full((len(starts), 2), -5.0) if owners is None else owners
    shader = "\n".join(
        [
            head((CASTER,), OPAQUE.constants),
            expand(FOLDER / "glsl/trace/traversal.glsl", [], {}),
            SHADER.replace("RESULT", result),
        ]
    )
    program = device.gl.program(vertex_shader=shader, varyings=["result"])
    program.extra = frozenset(UNIFORM.findall(shader))
    rays = {"starts": starts - frame.anchor, "ends": ends - frame.anchor, "owners": owners}
    padded = {name: np.pad(rows, ((0, 0), (0, 4 - rows.shape[1]))).astype(np.float32) for name, rows in rays.items()}
    bind(program, **{name: device.buffer_from(rows) for name, rows in padded.items()}, **frame[TLAS])
    device.gl.simple_framebuffer((1, 1)).use()
    buffer = device.gl.buffer(reserve=4 * len(starts))
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=len(starts))
    return np.frombuffer(buffer.read(), "f4")


def reference_occlusion(
    scene, starts: np.ndarray, ends: np.ndarray, min_margin: float = 1e-4
) -> tuple[np.ndarray, np.ndarray]:
    """(N,) bool each: whether any triangle occludes the ray, and whether that is certain despite rounding.

    It is uncertain if the ray passes close to an edge, or a triangle is close to an end of the ray.
    """
    margin, _ = reference_hits(scene, scene.instances.casts_shadow, starts, ends)
    return margin > 0.0, np.abs(margin) > min_margin


def reference_hits(scene, is_hit: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,) each, for the triangles of instances (I,) bool: margins and distances.

    A margin is the largest distance, in barycentric coordinates or in fractions of the ray, by which the ray hits a
    triangle, or minus the smallest one by which it misses all. A distance is that to the nearest triangle, or 1.
    """
    triangles = reference.world_triangles(scene, is_hit)
    margin, distance = np.full(len(starts), -1.0), np.ones(len(starts))
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    step = max(reference.PAIRS_AT_A_TIME // max(len(triangles), 1), 1)
    for first in range(0, len(starts), step):
        rows = slice(first, first + step)
        ray, offset = (ends - starts)[rows, None], starts[rows, None] - a
        p, q = np.cross(ray, v), np.cross(offset, u)
        with np.errstate(all="ignore"):
            scale = 1.0 / (u * p).sum(2)
            s, t, along = (offset * p).sum(2) * scale, (q * ray).sum(2) * scale, (v * q).sum(2) * scale
            margins = np.nan_to_num(np.minimum.reduce([s, t, 1.0 - s - t, along, 1.0 - along]), nan=-1.0)
        margin[rows] = margins.max(1)
        distance[rows] = np.where(margins > 0.0, along, 1.0).min(1)
    return margin, distance


def assert_agree(device, scene, starts: np.ndarray, ends: np.ndarray, max_uncertain: float = 0.02) -> None:
    """Assert that shader and reference agree, but for rays whose result is uncertain.

    Also that some rays are occluded and some are not, as the comparison means nothing otherwise.
    """
    ours = occluded(device, scene, starts, ends)
    expected, is_certain = reference_occlusion(scene, starts, ends)
    assert (~is_certain).mean() <= max_uncertain
    assert 0.01 < expected[is_certain].mean() < 0.99, "nearly all rays have the same result"
    wrong = np.flatnonzero(is_certain & (ours != expected))
    assert not len(wrong), (len(wrong), starts[wrong[0]], ends[wrong[0]], ours[wrong[0]])


def random_rays(count: int, extent: float = 1.5, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Random starts and ends (N,3), with coordinates up to `extent`."""
    random = np.random.default_rng(seed)
    return tuple(random.uniform(-extent, extent, (2, count, 3)))
