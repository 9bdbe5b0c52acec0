# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrices between spaces map what their names say, and lose no precision far from the world's origin."""

import numpy as np
import pytest

from ism_addon.spaces import anchor_of, camera_position, orthonormal, view_from_anchor
from tests.support.small_scenes import look_at


def test_the_camera_is_where_the_view_says():
    assert camera_position(look_at((3.0, -2.0, 1.0)).view_from_world) == pytest.approx([3.0, -2.0, 1.0])


@pytest.mark.parametrize("offset", [0.0, 1e3, 1e6, 1e9])
def test_anchor_space_is_near_the_camera_and_loses_no_precision(offset):
    camera = np.array([offset + 3.0, -offset - 2.0, 1.0])
    view = look_at(camera, camera + (-3.0, 2.0, -1.0)).view_from_world
    anchor = anchor_of(camera, 10.0)
    assert np.abs(camera - anchor).max() <= 8.0
    from_anchor = view_from_anchor(view, anchor)
    point = camera + (-1.0, 0.5, 0.25)
    exact = view[:3, :3] @ (point - camera)
    assert from_anchor[:3, :3] @ (point - anchor) + from_anchor[:3, 3] == pytest.approx(
        exact, abs=1e-6 if offset > 1e6 else 1e-9
    )


def test_the_anchor_stays_while_the_camera_moves_a_little():
    anchors = [anchor_of(np.array([x, 0.5, 1.0]), 10.0) for x in np.linspace(-7.0, 7.0, 20)]
    assert all(np.array_equal(anchor, anchors[0]) for anchor in anchors)


def test_the_anchor_takes_any_extent():
    for extent in (0.0, 1e-30, 1e30):
        assert np.isfinite(anchor_of(np.array([1.0, 2.0, 3.0]), extent)).all()


def test_orthonormal_bases_have_no_singularity():
    random = np.random.default_rng(0).normal(size=(1000, 3))
    normals = np.concatenate(
        [random / np.linalg.norm(random, axis=1)[:, None], np.eye(3), -np.eye(3), [[0.0, 0.0, -0.0 - 1.0]]]
    )
    u, v = orthonormal(normals)
    for one, other, product in ((u, u, 1.0), (v, v, 1.0), (u, v, 0.0), (u, normals, 0.0), (v, normals, 0.0)):
        assert np.abs((one * other).sum(1) - product).max() < 1e-12
    assert np.cross(u, v) == pytest.approx(normals, abs=1e-12)
