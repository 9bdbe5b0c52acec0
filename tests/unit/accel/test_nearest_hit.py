# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera rays find the nearest triangle that the camera sees, compared with a test of every triangle."""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.rays import distances, random_rays, reference_hits
from tests.support.small_scenes import light, make_scene, random_triangles, transform


def instanced(count: int):
    """Random triangles in `count` instances."""
    random = np.random.default_rng(count)
    matrices = np.stack([transform(0.5 * np.eye(3), random.uniform(-1.0, 1.0, 3)) for _ in range(count)])
    return make_scene([random_triangles(60, seed=2)], light(), matrices, [0] * count)


@pytest.mark.parametrize("scene", [make_scene([random_triangles(300)], light()), instanced(40)], ids=["mesh", "many"])
def test_the_nearest_triangle_is_found(device, scene):
    starts, ends = random_rays(500)
    ours = distances(device, scene, starts, ends)
    margin, theirs = reference_hits(scene, scene.instances.visible, starts, ends)
    wrong = np.abs(ours - theirs) > 1e-4
    assert wrong.mean() < 0.02, "but for rays that pass close to an edge"
    assert 0.1 < (margin > 0.0).mean() < 0.99
    assert (ours[margin < -1e-4] == 1.0).all()


def test_invisible_instances_are_not_found(device):
    scene = instanced(40)
    visible = np.arange(40) % 2 == 0
    scene = replace(scene, instances=replace(scene.instances, visible=visible))
    starts, ends = random_rays(500)
    ours = distances(device, scene, starts, ends)
    _, theirs = reference_hits(scene, visible, starts, ends)
    _, all_instances = reference_hits(scene, np.ones(40, bool), starts, ends)
    assert (np.abs(ours - theirs) > 1e-4).mean() < 0.02
    assert (np.abs(ours - all_instances) > 1e-4).mean() > 0.1
