# SPDX-License-Identifier: GPL-3.0-or-later
"""How instances are drawn: in portions, small meshes that stand once together."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.buffers import instance_buffers
from ism_addon.gpu.buffers.instance_buffers import DrawCall, MultiDrawCall, portions
from ism_addon.resources import INSTANCE_BUFFERS
from ism_addon.scene import Scene
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, make_scene, random_triangles, transform

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])


@pytest.mark.parametrize("most", [1, 7, 64, 1000])
def test_portions_are_all_triangles_of_all_draws_once(most):
    draws = [DrawCall(5, 100, 0, 3), DrawCall(105, 7, 3, 1), DrawCall(112, 0, 4, 2), DrawCall(112, 4, 6, 50)]
    parts = list(portions(iter(draws), most))
    assert all(0 < part.triangles * part.instances <= max(most, part.instances) for part in parts)
    for draw_call in draws:
        own = [part for part in parts if part.first_instance == draw_call.first_instance]
        assert all(part.instances == draw_call.instances for part in own)
        drawn = [k for part in own for k in range(part.first_triangle, part.first_triangle + part.triangles)]
        assert drawn == list(range(draw_call.first_triangle, draw_call.first_triangle + draw_call.triangles))


@pytest.mark.parametrize("most", [1, 7, 64, 1000])
def test_portions_are_all_ranges_once(most):
    """Those that follow one another are one, and a portion is larger than asked for by less than a mesh at most."""
    random = np.random.default_rng(0)
    counts, gaps = random.integers(1, 20, 50), random.integers(0, 2, 50) * 5
    first = np.cumsum(counts + gaps) - counts
    parts = list(portions(iter([MultiDrawCall(first, counts)]), most))
    assert all(part.triangles.sum() < most + counts.max() for part in parts)
    drawn = [
        k for part in parts for f, n in zip(part.first_triangle, part.triangles, strict=True) for k in range(f, f + n)
    ]
    assert drawn == [k for f, n in zip(first, counts, strict=True) for k in range(f, f + n)]
    whole = parts[0].first_triangle
    assert most < 1000 or len(whole) == 1 + np.count_nonzero(gaps[1:])


def assorted() -> Scene:
    """Small meshes that stand once, some that nobody sees, between one that stands often and a large one."""
    random = np.random.default_rng(2)
    meshes = [random_triangles(1 + k % 12, size=0.5, seed=k) for k in range(60)]
    meshes[20], meshes[40] = random_triangles(1500, size=0.1), random_triangles(30, size=0.2)
    numbers = np.concatenate([random.permutation(60), np.full(5, 40)])
    places = [transform(0.4 * SHEAR, offset) for offset in random.uniform(-2.0, 2.0, (len(numbers), 3))]
    scene = make_scene(meshes, light(), places, numbers)
    return replace(scene, instances=replace(scene.instances, visible=np.arange(65) % 9 != 0))


@pytest.mark.parametrize("skip", [True, False])
def test_small_meshes_are_drawn_together_and_the_picture_is_that_of_each_alone(device, monkeypatch, skip):
    scene, view = assorted(), look_at((1.5, -1.5, 1.0))
    settings = replace(SMALL_SETTINGS, shortcuts=skip)
    calls: dict[bool, list] = {True: [], False: []}
    for draw_call in ("draw", "draw_ranges"):
        real = getattr(device, draw_call)
        counting = lambda *what, real=real: (calls[together].append(1), real(*what))  # noqa: E731
        device = replace(device, **{draw_call: counting})
    pictures = {}
    for together in (True, False):
        if not together:
            monkeypatch.setattr(instance_buffers, "MAX_OWNERS_RATIO", 0)
        pictures[together] = draw(device, scene, view, settings)
    assert np.array_equal(pictures[True].target("primitive"), pictures[False].target("primitive"))
    assert np.array_equal(pictures[True].color, pictures[False].color)
    assert len(np.unique(pictures[True].target("primitive")[..., 1])) > 20
    assert len(calls[True]) < 12 < 20 < len(calls[False])


def test_an_instance_that_moves_leaves_what_its_small_mesh_is_known_by(device):
    """Only what stands elsewhere is uploaded."""
    scene, view = assorted(), look_at((1.5, -1.5, 1.0))
    first = draw(device, scene, view)
    matrices = scene.instances.world_from_object.copy()
    matrices[3, :3, 3] += 0.1
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    owners = first.renderer.graph[INSTANCE_BUFFERS].owners
    second = draw(device, moved, view, renderer=first.renderer)
    assert second.renderer.graph[INSTANCE_BUFFERS].owners is owners is not None
    assert np.array_equal(second.color, draw(device, moved, view).color)
