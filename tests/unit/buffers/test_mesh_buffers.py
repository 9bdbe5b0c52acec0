# SPDX-License-Identifier: GPL-3.0-or-later
"""Uploads of meshes, in portions: each triangle is at its index, and only meshes that a picture needs are uploaded."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.accel.blas import build_blas
from ism_addon.gpu.buffers import corner_buffers, mesh_buffers
from ism_addon.gpu.buffers.corner_buffers import UVBuffers, rows_of
from ism_addon.gpu.buffers.mesh_buffers import TRIANGLES_AT_A_TIME, MeshBuffers, buffers_of, portions
from ism_addon.gpu.gl.shader_records import directions_from_octahedron
from ism_addon.scene import Image
from tests.scenes.small import sphere
from tests.support.small_scenes import draw, light, make_scene, quad, random_triangles, view_from_above


def uploaded(buffers: MeshBuffers) -> tuple[np.ndarray, np.ndarray]:
    """Corners (T,3,3) in quanta and normals (T,3,3) of all triangles, read back from the GPU."""
    count = buffers.count
    words = np.frombuffer(buffers.samplers["corners"].buffer.read(), np.uint32)[: 8 * count].reshape(-1, 8)
    last = ((words[:, :4] & 127).astype(np.int64) << np.array([0, 7, 14, 21])).sum(1)
    last = (last ^ 1 << 27) - (1 << 27)
    corners = np.column_stack([words.view(np.int32) >> 7, last]).reshape(-1, 3, 3)
    encoded = np.frombuffer(buffers.samplers["corner_normal_buffer"].buffer.read(), np.int16)[: 6 * count]
    return corners, directions_from_octahedron(encoded.reshape(-1, 3, 2) / 32767.0)


@pytest.mark.parametrize("wanted", [[(0, 1, 2, 3)], [(2,), (), (1, 2), (0, 1, 3)]], ids=["at once", "by and by"])
@pytest.mark.parametrize("in_blas_order", [False, True])
def test_every_triangle_is_at_its_index(device, in_blas_order, wanted):
    """Several meshes in a portion, and a mesh in several portions; normals of vertices, and of corners."""
    ball = sphere((0.3, 0.0, 1.0), 0.5, 16, 8)
    smooth = np.zeros_like(ball.positions)
    smooth[ball.triangles] = ball.normals
    meshes = (
        random_triangles(5),
        random_triangles(TRIANGLES_AT_A_TIME + 100, seed=1),
        replace(ball, normals=smooth),
        random_triangles(7, seed=2),
    )
    blases = dict(enumerate(map(build_blas, meshes))) if in_blas_order else {}
    buffers = MeshBuffers(device, meshes, in_blas_order)
    for batch in wanted:
        buffers.add(batch, blases)
    corners, normals = uploaded(buffers)
    for k, mesh in enumerate(meshes):
        own = slice(buffers.first_triangle[k], buffers.first_triangle[k] + len(mesh.triangles))
        order = blases[k].order if blases else np.arange(len(mesh.triangles))
        positions = corners[own] / buffers.quanta_per_metre[k] + buffers.centres[k]
        assert np.abs(positions - mesh.positions[mesh.triangles[order]]).max() < 1e-6
        assert np.abs(normals[own] - mesh.corner_normals[order]).max() < 1e-4


@pytest.mark.parametrize("portion", [0, 1])
def test_a_failed_upload_can_be_repeated(monkeypatch, device, portion):
    """Another renderer may use the same buffers."""
    meshes = random_triangles(5), random_triangles(TRIANGLES_AT_A_TIME, seed=1), random_triangles(7, seed=2)
    buffers, done = MeshBuffers(device, meshes, in_blas_order=False), []

    def fail_at_portion(ranges):
        if len(done) == portion:
            raise MemoryError
        done.append(buffers_of(ranges))
        return done[-1]

    buffers.add((2,), {})
    with monkeypatch.context() as patch, pytest.raises(MemoryError):
        patch.setattr(mesh_buffers, "PORTIONS_AHEAD", 0)
        patch.setattr(mesh_buffers, "buffers_of", fail_at_portion)
        buffers.add((0, 1), {})
    assert buffers.add((0, 1), {}) == 44 * (TRIANGLES_AT_A_TIME + 5)
    corners, _ = uploaded(buffers)
    for k, mesh in enumerate(meshes):
        own = slice(buffers.first_triangle[k], buffers.first_triangle[k] + len(mesh.triangles))
        positions = corners[own] / buffers.quanta_per_metre[k] + buffers.centres[k]
        assert np.abs(positions - mesh.positions[mesh.triangles]).max() < 1e-6


def test_a_failed_upload_of_texture_coordinates_can_be_repeated(monkeypatch, device):
    meshes = tuple(
        replace(random_triangles(n, seed=n), uvs=np.full((n, 3, 2), n, np.float32)) for n in (5, TRIANGLES_AT_A_TIME, 7)
    )
    buffers = MeshBuffers(device, meshes, in_blas_order=False)
    uv_buffers, done = UVBuffers(device, buffers), []
    buffers.add((0,), {})
    uv_buffers.upload_new()

    def fail_at_second(*arguments):
        if done:
            raise MemoryError
        done.append(rows_of(*arguments))
        return done[-1]

    buffers.add((1, 2), {})
    with monkeypatch.context() as patch, pytest.raises(MemoryError):
        patch.setattr(mesh_buffers, "PORTIONS_AHEAD", 0)
        patch.setattr(corner_buffers, "rows_of", fail_at_second)
        uv_buffers.upload_new()
    uv_buffers.upload_new()
    uvs = np.frombuffer(uv_buffers.texture.buffer.read(), np.float32)
    assert np.array_equal(
        uvs[: 6 * buffers.count], np.repeat([5, TRIANGLES_AT_A_TIME, 7], [6 * 5, 6 * TRIANGLES_AT_A_TIME, 6 * 7])
    )


@pytest.mark.parametrize("in_blas_order", [False, True])
def test_texture_coordinates_of_small_meshes_are_where_their_triangles_are(device, in_blas_order):
    """One mesh has none: its coordinates are zero."""
    random = np.random.default_rng(0)
    counts = (3, 12, 40, 7)
    uvs = [random.random((count if k != 1 else 0, 3, 2), np.float32) for k, count in enumerate(counts)]
    meshes = tuple(replace(random_triangles(count, seed=k), uvs=uvs[k]) for k, count in enumerate(counts))
    blases = dict(enumerate(map(build_blas, meshes))) if in_blas_order else {}
    buffers = MeshBuffers(device, meshes, in_blas_order)
    buffers.add(range(4), blases)
    uv_buffers = UVBuffers(device, buffers)
    uv_buffers.upload_new()
    uploaded_uvs = np.frombuffer(uv_buffers.texture.buffer.read(), np.float32)[: 6 * sum(counts)].reshape(-1, 3, 2)
    orders = [blases[k].order if blases else np.arange(count) for k, count in enumerate(counts)]
    uvs[1] = np.zeros((counts[1], 3, 2), np.float32)
    assert np.array_equal(
        uploaded_uvs, np.concatenate([mesh_uvs[order] for mesh_uvs, order in zip(uvs, orders, strict=True)])
    )


def test_all_portions_but_the_last_are_full():
    lengths = [3, 0, 10, 4, 1]
    result = list(portions(lengths, 5))
    assert [sum(range_.stop - range_.start for _, range_ in portion) for portion in result] == [5, 5, 5, 3]
    indices = [(k, i) for portion in result for k, range_ in portion for i in range(range_.start, range_.stop)]
    assert indices == [(k, i) for k, length in enumerate(lengths) for i in range(length)]


def test_texture_coordinates_are_uploaded_only_if_there_are_images(device):
    plate = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    untextured, view = make_scene([plate], light()), view_from_above(2.0)
    textured = make_scene([plate], light(), image=Image(np.full((2, 2, 4), 255, np.uint8)))
    assert draw(device, untextured, view).profile.rows["UploadUVs"].drawn == 0
    assert draw(device, textured, view).profile.rows["UploadUVs"].drawn == 1


@pytest.mark.parametrize("limit", ["int32", "rows"])
def test_too_many_triangles_are_refused_with_a_message(device, monkeypatch, limit):
    """Only meshes that a picture needs count. As many triangles as the limit are drawn."""
    if limit == "int32":
        monkeypatch.setattr(mesh_buffers, "MAX_TRIANGLES", 100)
    else:
        monkeypatch.setattr(device.buffer_textures, "max_rows", 302)
    buffers = MeshBuffers(
        device,
        (random_triangles(60), random_triangles(41), random_triangles(30), random_triangles(10)),
        in_blas_order=False,
    )
    assert buffers.add((0,), {}) == 44 * 60
    with pytest.raises(ValueError, match="the meshes have 101 triangles, of which this OpenGL can draw 100"):
        buffers.add((0, 1), {})
    assert buffers.add((0, 2), {}) == 44 * 30
    assert buffers.add((3,), {}) == 44 * 10
    assert buffers.count == 100
