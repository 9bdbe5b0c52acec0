# SPDX-License-Identifier: GPL-3.0-or-later
"""What is uploaded of meshes: all triangles where their numbers say, in portions; nothing that no picture needs."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.accel.blas import build_blas
from ism_addon.gpu.buffers import mesh_buffers
from ism_addon.gpu.buffers.mesh_buffers import TRIANGLES_AT_A_TIME, MeshBuffers, UVBuffers, buffers_of, portions, uvs_of
from ism_addon.gpu.gl.shader_records import directions_from_octahedron
from ism_addon.scene import Image
from tests.scenes.small import sphere
from tests.support.small_scenes import draw, light, make_scene, quad, random_triangles, view_from_above


def uploaded(made: MeshBuffers) -> tuple[np.ndarray, np.ndarray]:
    """Corners (T,3,3) in steps and normals (T,3,3) of all triangles, from the arrays."""
    count = made.count
    words = np.frombuffer(made.samplers["corners"].buffer.read(), np.uint32)[: 8 * count].reshape(-1, 8)
    last = ((words[:, :4] & 127).astype(np.int64) << np.array([0, 7, 14, 21])).sum(1)
    last = (last ^ 1 << 27) - (1 << 27)
    corners = np.column_stack([words.view(np.int32) >> 7, last]).reshape(-1, 3, 3)
    points = np.frombuffer(made.samplers["corner_normal_buffer"].buffer.read(), np.int16)[: 6 * count].reshape(-1, 3, 2)
    return corners, directions_from_octahedron(points / 32767.0)


@pytest.mark.parametrize("wanted", [[(0, 1, 2, 3)], [(2,), (), (1, 2), (0, 1, 3)]], ids=["at once", "by and by"])
@pytest.mark.parametrize("sorted_by_trees", [False, True])
def test_every_triangle_is_where_its_number_says(device, sorted_by_trees, wanted):
    """Several meshes to a portion, and a mesh over several; normals of vertices, and of corners."""
    ball = sphere((0.3, 0.0, 1.0), 0.5, 16, 8)
    smooth = np.zeros_like(ball.positions)
    smooth[ball.triangles] = ball.normals
    meshes = (
        random_triangles(5),
        random_triangles(TRIANGLES_AT_A_TIME + 100, seed=1),
        replace(ball, normals=smooth),
        random_triangles(7, seed=2),
    )
    trees = dict(enumerate(map(build_blas, meshes))) if sorted_by_trees else {}
    made = MeshBuffers(device, meshes, sorted_by_trees)
    for some in wanted:
        made.add(some, trees)
    corners, normals = uploaded(made)
    for k, mesh in enumerate(meshes):
        own = slice(made.first_triangle[k], made.first_triangle[k] + len(mesh.triangles))
        order = trees[k].order if trees else np.arange(len(mesh.triangles))
        positions = corners[own] / made.quanta_per_metre[k] + made.centres[k]
        assert np.abs(positions - mesh.positions[mesh.triangles[order]]).max() < 1e-6
        assert np.abs(normals[own] - mesh.corner_normals[order]).max() < 1e-4


@pytest.mark.parametrize("portion", [0, 1])
def test_what_has_failed_on_its_way_comes_again(monkeypatch, device, portion):
    """Another renderer may use the same geometry."""
    meshes = random_triangles(5), random_triangles(TRIANGLES_AT_A_TIME, seed=1), random_triangles(7, seed=2)
    made, done = MeshBuffers(device, meshes, in_blas_order=False), []

    def some(pieces):
        if len(done) == portion:
            raise MemoryError
        done.append(buffers_of(pieces))
        return done[-1]

    made.add((2,), {})
    with monkeypatch.context() as short, pytest.raises(MemoryError):
        short.setattr(mesh_buffers, "PORTIONS_AHEAD", 0)
        short.setattr(mesh_buffers, "buffers_of", some)
        made.add((0, 1), {})
    assert made.add((0, 1), {}) == 44 * (TRIANGLES_AT_A_TIME + 5)
    corners, _ = uploaded(made)
    for k, mesh in enumerate(meshes):
        own = slice(made.first_triangle[k], made.first_triangle[k] + len(mesh.triangles))
        positions = corners[own] / made.quanta_per_metre[k] + made.centres[k]
        assert np.abs(positions - mesh.positions[mesh.triangles]).max() < 1e-6


def test_texture_coordinates_that_have_failed_on_their_way_come_again(monkeypatch, device):
    meshes = tuple(
        replace(random_triangles(n, seed=n), uvs=np.full((n, 3, 2), n, np.float32)) for n in (5, TRIANGLES_AT_A_TIME, 7)
    )
    made = MeshBuffers(device, meshes, in_blas_order=False)
    coordinates, done = UVBuffers(device, made), []
    made.add((0,), {})
    coordinates.upload_new()

    def some(pieces):
        if done:
            raise MemoryError
        done.append(uvs_of(pieces))
        return done[-1]

    made.add((1, 2), {})
    with monkeypatch.context() as short, pytest.raises(MemoryError):
        short.setattr(mesh_buffers, "PORTIONS_AHEAD", 0)
        short.setattr(mesh_buffers, "uvs_of", some)
        coordinates.upload_new()
    coordinates.upload_new()
    found = np.frombuffer(coordinates.uvs.texture.buffer.read(), np.float32)
    assert np.array_equal(
        found[: 6 * made.count], np.repeat([5, TRIANGLES_AT_A_TIME, 7], [6 * 5, 6 * TRIANGLES_AT_A_TIME, 6 * 7])
    )


@pytest.mark.parametrize("sorted_by_trees", [False, True])
def test_texture_coordinates_of_small_meshes_are_where_their_triangles_are(device, sorted_by_trees):
    """Some have none: theirs are zero."""
    random = np.random.default_rng(0)
    counts = (3, 12, 40, 7)
    uvs = [random.random((count if k != 1 else 0, 3, 2), np.float32) for k, count in enumerate(counts)]
    meshes = tuple(replace(random_triangles(count, seed=k), uvs=uvs[k]) for k, count in enumerate(counts))
    trees = dict(enumerate(map(build_blas, meshes))) if sorted_by_trees else {}
    made = MeshBuffers(device, meshes, sorted_by_trees)
    made.add(range(4), trees)
    coordinates = UVBuffers(device, made)
    coordinates.upload_new()
    found = np.frombuffer(coordinates.uvs.texture.buffer.read(), np.float32)[: 6 * sum(counts)].reshape(-1, 3, 2)
    orders = [trees[k].order if trees else np.arange(count) for k, count in enumerate(counts)]
    uvs[1] = np.zeros((counts[1], 3, 2), np.float32)
    assert np.array_equal(found, np.concatenate([own[order] for own, order in zip(uvs, orders, strict=True)]))


def test_portions_are_whole_but_for_the_last():
    lengths = [3, 0, 10, 4, 1]
    found = list(portions(lengths, 5))
    assert [sum(part.stop - part.start for _, part in pieces) for pieces in found] == [5, 5, 5, 3]
    numbers = [(k, i) for pieces in found for k, part in pieces for i in range(part.start, part.stop)]
    assert numbers == [(k, i) for k, length in enumerate(lengths) for i in range(length)]


def test_texture_coordinates_are_uploaded_with_images_alone(device):
    plate = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    plain, view = make_scene([plate], light()), view_from_above(2.0)
    painted = make_scene([plate], light(), image=Image(np.full((2, 2, 4), 255, np.uint8)))
    assert draw(device, plain, view).profile.rows["UploadUVs"].drawn == 0
    assert draw(device, painted, view).profile.rows["UploadUVs"].drawn == 1


@pytest.mark.parametrize("limit", ["int32", "rows"])
def test_too_many_triangles_are_refused_with_a_sentence(device, monkeypatch, limit):
    """Of meshes that a picture needs. Up to the last triangle that there is room for, they are drawn."""
    if limit == "int32":
        monkeypatch.setattr(mesh_buffers, "MAX_TRIANGLES", 100)
    else:
        monkeypatch.setattr(device.buffer_textures, "max_rows", 302)
    made = MeshBuffers(
        device,
        (random_triangles(60), random_triangles(41), random_triangles(30), random_triangles(10)),
        in_blas_order=False,
    )
    assert made.add((0,), {}) == 44 * 60
    with pytest.raises(ValueError, match="the meshes have 101 triangles, of which this OpenGL can draw 100"):
        made.add((0, 1), {})
    assert made.add((0, 2), {}) == 44 * 30
    assert made.add((3,), {}) == 44 * 10
    assert made.count == 100
