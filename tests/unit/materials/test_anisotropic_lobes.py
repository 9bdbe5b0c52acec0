# SPDX-License-Identifier: GPL-3.0-or-later
"""The transform by which lobes of anisotropic microfacets are predicted."""

import numpy as np
import pytest

from tests.unit.shading.glsl_functions import evaluate

#: A transformed direction. a0: roughness, a1: aspect, a2: the direction to the camera, a3: the direction.
CALL = """isotropic_from_anisotropic(
    Gloss(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 1.5, a0, 1.0, 0.0, vec4(0.0)),
    Microfacets(mat3(1.0), vec2(1.0), false), a1, a2) * a3"""


def transformed(device, roughness: float, aspect: float, to_camera: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(N,3): transformed directions (N,3), for directions to the camera (N,3)."""
    same = (np.full(len(directions), value) for value in (roughness, aspect))
    return evaluate(device, "materials/gloss.glsl", CALL, [*same, to_camera, directions], {"rare_lobes": 1})[:, :3]


def unit_vectors(count: int) -> np.ndarray:
    vectors = np.random.default_rng(1).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_lobes_of_equal_roughness_along_both_axes_stay_as_they_are(device):
    to_camera, directions = unit_vectors(200), unit_vectors(400)[200:]
    assert transformed(device, 0.3, 1.0, to_camera, directions) == pytest.approx(directions, abs=1e-4)


def test_the_mirror_direction_stays_the_same(device):
    to_camera = unit_vectors(200)
    to_camera = to_camera[to_camera[:, 2] > 0.1]
    mirror = to_camera * (-1.0, -1.0, 1.0)
    assert transformed(device, 0.3, 0.5, to_camera, mirror) == pytest.approx(mirror, abs=1e-4)


def test_lobes_of_a_smooth_surface_that_the_camera_faces_are_stretched_along_the_axes(device):
    directions, to_camera = unit_vectors(50), np.tile((0.0, 0.0, 1.0), (50, 1))
    result = transformed(device, 0.01, 0.5, to_camera, directions)
    assert result == pytest.approx(directions * (0.5, 2.0, 1.0), abs=1e-3)


@pytest.mark.parametrize("roughness", [0.01, 0.2, 0.5, 1.0])
def test_at_grazing_angles_and_beyond_the_transform_is_not_singular(device, roughness):
    """Also where a silhouette's smooth normal faces away. A singular one makes corrections that stay visible."""
    to_camera = unit_vectors(500) * (1.0, 1.0, 0.1)
    to_camera /= np.linalg.norm(to_camera, axis=1, keepdims=True)
    axes = [transformed(device, roughness, 0.4, to_camera, np.tile(axis, (500, 1))) for axis in np.eye(3)]
    matrices = np.stack(axes, 2)
    # What is stretched along one axis shrinks along the other.
    assert np.linalg.det(matrices) == pytest.approx(1.0, abs=1e-2)
    assert np.abs(matrices).max() < 20.0
