# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw calls of instances: in portions, and small meshes of one instance together."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.buffers import instance_buffers
from ism_addon.gpu.buffers.instance_buffers import DrawCall, MultiDrawCall, portions
from ism_addon.resources import INSTANCE_BUFFERS
from ism_addon.scene import Scene
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, random_triangles, transform

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])


@pytest.mark.parametrize("max_triangles", [1, 7, 64, 1000])
def test_portions_cover_each_triangle_of_all_draw_calls_once(max_triangles):
    draw_calls = [DrawCall(5, 100, 0, 3), DrawCall(105, 7, 3, 1), DrawCall(112, 0, 4, 2), DrawCall(112, 4, 6, 50)]
    pieces = list(portions(iter(draw_calls), max_triangles))
    assert all(0 < piece.triangles * piece.instances <= max(max_triangles, piece.instances) for piece in pieces)
    for draw_call in draw_calls:
        own = [piece for piece in pieces if piece.first_instance == draw_call.first_instance]
        assert all(piece.instances == draw_call.instances for piece in own)
        drawn = [k for piece in own for k in range(piece.first_triangle, piece.first_triangle + piece.triangles)]
        assert drawn == list(range(draw_call.first_triangle, draw_call.first_triangle + draw_call.triangles))


@pytest.mark.parametrize("max_triangles", [1, 7, 64, 1000])
def test_portions_cover_each_range_once(max_triangles):
    """Adjacent ranges are joined, and a portion exceeds the maximum by less than one mesh."""
    random = np.random.default_rng(0)
    counts, gaps = random.integers(1, 20, 50), random.integers(0, 2, 50) * 5
    first = np.cumsum(counts + gaps) - counts
    pieces = list(portions(iter([MultiDrawCall(first, counts)]), max_triangles))
    assert all(piece.triangles.sum() < max_triangles + counts.max() for piece in pieces)
    drawn = [
        k
        for piece in pieces
        for f, n in zip(piece.first_triangle, piece.triangles, strict=True)
        for k in range(f, f + n)
    ]
    assert drawn == [k for f, n in zip(first, counts, strict=True) for k in range(f, f + n)]
    joined = pieces[0].first_triangle
    assert max_triangles < 1000 or len(joined) == 1 + np.count_nonzero(gaps[1:])


def mixed_scene() -> Scene:
    """Small meshes of one instance each, some not visible; also a mesh of several instances, and a large one."""
    random = np.random.default_rng(2)
    meshes = [random_triangles(1 + k % 12, size=0.5, seed=k) for k in range(60)]
    meshes[20], meshes[40] = random_triangles(1500, size=0.1), random_triangles(30, size=0.2)
    mesh_ids = np.concatenate([random.permutation(60), np.full(5, 40)])
    transforms = [transform(0.4 * SHEAR, offset) for offset in random.uniform(-2.0, 2.0, (len(mesh_ids), 3))]
    scene = make_scene(meshes, light(), transforms, mesh_ids)
    return replace(scene, instances=replace(scene.instances, visible=np.arange(65) % 9 != 0))


@pytest.mark.parametrize("shortcuts", [True, False])
def test_small_meshes_are_drawn_together_and_look_as_if_drawn_alone(device, monkeypatch, shortcuts):
    scene, view = mixed_scene(), look_at((1.5, -1.5, 1.0))
    settings = replace(SMALL_SETTINGS, shortcuts=shortcuts)
    calls: dict[bool, list] = {True: [], False: []}
    for draw_call in ("draw", "draw_ranges"):
        original = getattr(device, draw_call)
        count_call = lambda *arguments, original=original: (calls[together].append(1), original(*arguments))  # noqa: E731
        device = replace(device, **{draw_call: count_call})
    pictures = {}
    for together in (True, False):
        if not together:
            monkeypatch.setattr(instance_buffers, "MAX_OWNERS_RATIO", 0)
        pictures[together] = draw(device, scene, view, settings)
    assert np.array_equal(pictures[True].target("primitive"), pictures[False].target("primitive"))
    assert np.array_equal(pictures[True].color, pictures[False].color)
    assert len(np.unique(pictures[True].target("primitive")[..., 1])) > 20
    assert len(calls[True]) < 12 < 20 < len(calls[False])


def test_moving_an_instance_keeps_the_table_of_owners(device):
    """Only the transforms are uploaded again."""
    scene, view = mixed_scene(), look_at((1.5, -1.5, 1.0))
    first = draw(device, scene, view)
    matrices = scene.instances.world_from_object.copy()
    matrices[3, :3, 3] += 0.1
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    owners = first.renderer.graph[INSTANCE_BUFFERS].owners
    second = draw(device, moved, view, renderer=first.renderer)
    assert second.renderer.graph[INSTANCE_BUFFERS].owners is owners is not None
    assert np.array_equal(second.color, draw(device, moved, view).color)
