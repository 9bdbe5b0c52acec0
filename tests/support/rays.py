# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays through the trees, and against every triangle in float64."""

from dataclasses import replace

import moderngl
import numpy as np

from ism_addon.gpu.gl.shader_compiler import FOLDER, bind, expand, head
from ism_addon.gpu.gl.shader_records import CASTER
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
out float told;
void main() {
    vec2 own = texelFetch(owners, gl_VertexID).xy;
    vec3 from = texelFetch(starts, gl_VertexID).xyz, to = texelFetch(ends, gl_VertexID).xyz;
    told = any_hit(from, to, int(own.x), int(own.y), -1) ? 1.0 : 0.0;
}
"""


def occluded(device, scene, starts: np.ndarray, ends: np.ndarray, owners: np.ndarray | None = None) -> np.ndarray:
    """(N,) bool: whether the shader finds anything between starts and ends (N,3) but their own triangle, row (N,2)."""
    renderer, view = Renderer(device), look_at(np.abs(starts).max() * np.array([1.0, -1.0, 1.0]))
    frame = renderer.frame(scene, view, replace(SMALL_SETTINGS, shortcuts=False), 0, Profile())
    for kind in (CullMeshes, BuildBLAS, UploadMeshes, UploadInstances, UploadBLAS, BuildTLAS):
        renderer.graph.step(kind, frame, Profile())
    owners = np.full((len(starts), 2), -5.0) if owners is None else owners
    shader = "\n".join([head((CASTER,), {}), expand(FOLDER / "glsl/trace/traversal.glsl", []), SHADER])
    program = device.gl.program(vertex_shader=shader, varyings=["told"])
    rays = {"starts": starts - frame.anchor, "ends": ends - frame.anchor, "owners": owners}
    padded = {name: np.pad(rows, ((0, 0), (0, 4 - rows.shape[1]))).astype(np.float32) for name, rows in rays.items()}
    bind(program, **{name: device.buffer_from(rows) for name, rows in padded.items()}, **frame[TLAS])
    device.gl.simple_framebuffer((1, 1)).use()
    buffer = device.gl.buffer(reserve=4 * len(starts))
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=len(starts))
    return np.frombuffer(buffer.read(), "f4") > 0.5


def reference_occlusion(
    scene, starts: np.ndarray, ends: np.ndarray, doubt: float = 1e-4
) -> tuple[np.ndarray, np.ndarray]:
    """(N,) whether any triangle is in the way, and whether that is so by more than rounding: off edges and ends."""
    triangles = reference.world_triangles(scene, scene.instances.casts_shadow)
    found, sure = np.zeros(len(starts), bool), np.zeros(len(starts), bool)
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    step = max(reference.PAIRS_AT_A_TIME // max(len(triangles), 1), 1)
    for first in range(0, len(starts), step):
        rows = slice(first, first + step)
        way, offset = (ends - starts)[rows, None], starts[rows, None] - a
        p, q = np.cross(way, v), np.cross(offset, u)
        with np.errstate(all="ignore"):
            scale = 1.0 / (u * p).sum(2)
            s, t, at = (offset * p).sum(2) * scale, (q * way).sum(2) * scale, (v * q).sum(2) * scale
            margin = np.minimum.reduce([s, t, 1.0 - s - t, at, 1.0 - at])
        most = np.nan_to_num(margin, nan=-1.0).max(1)
        found[rows], sure[rows] = most > 0.0, np.abs(most) > doubt
    return found, sure


def assert_agree(device, scene, starts: np.ndarray, ends: np.ndarray, unsure: float = 0.02) -> None:
    """All rays but those that pass too close to an edge; some are free and some are not."""
    ours = occluded(device, scene, starts, ends)
    expected, sure = reference_occlusion(scene, starts, ends)
    assert (~sure).mean() <= unsure
    assert 0.01 < expected[sure].mean() < 0.99, "these rays ask nothing"
    wrong = np.flatnonzero(sure & (ours != expected))
    assert not len(wrong), (len(wrong), starts[wrong[0]], ends[wrong[0]], ours[wrong[0]])


def random_rays(count: int, reach: float = 1.5, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Starts and ends (N,3) anywhere."""
    random = np.random.default_rng(seed)
    return tuple(random.uniform(-reach, reach, (2, count, 3)))
