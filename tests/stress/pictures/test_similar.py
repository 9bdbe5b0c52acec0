# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that is scaled, moved far away, rotated or mirrored with its camera gives the same picture.

Scaled or moved, it has the same rays, except for float32's rounding. Rotated, ambient occlusion takes other directions
about each normal; mirrored, pixels take other points on the lights: the noise differs.
"""

import math

import numpy as np
import pytest

from ism_addon.settings import Method, Quality, Settings, Shadow
from tests.scenes.small import SMALL
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.moves import Picture, transformed
from tests.support.small_scenes import draw, with_quality

#: The settings of both methods. Rounding may make a ray hit another triangle, or move a point to another map texel.
METHODS = {
    # The axes of a surface's hemisphere do not turn with the scene, so rays to the world would go to other points.
    "rays": Settings(shadow=Shadow(world=False), quality=Quality(samples=16, error_threshold=0.0)),
    "maps": Settings(
        shadow=Shadow(method=Method.SHADOW_MAPS),
        quality=Quality(samples=8, error_threshold=0.0, virtual_lights=16, map_size=64, map_points=4096),
    ),
}
#: Fewer samples suffice where both pictures have the same rays and so the same noise.
FEW_SAMPLES = {"rays": 16, "maps": 2}
ALL_CASES = [pytest.param(scene, method, id=f"{scene}, {method}") for scene in SMALL for method in METHODS]


@pytest.fixture(scope="module")
def originals():
    """A cache of untransformed pictures, by scene, method and samples."""
    return {}


@pytest.fixture
def difference(device, originals):
    """difference(scene, method, linear, offset, samples): relative, of the transformed picture from the original."""

    def difference(
        scene: str, method: str, linear: np.ndarray, offset: np.ndarray | float = 0.0, samples: int | None = None
    ) -> float:
        settings = with_quality(METHODS[method], samples=samples or METHODS[method].quality.samples)
        picture: Picture = *SMALL[scene](96, 64), settings
        key = scene, method, settings.quality.samples
        if key not in originals:
            originals[key] = draw(device, *picture).color
        moved = draw(device, *transformed(picture, linear, offset)).color
        return relative_difference(moved[:, ::-1] if np.linalg.det(linear) < 0.0 else moved, originals[key])

    return difference


def rotation(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """(3,3): a rotation about an axis by an angle in rad, by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


@pytest.mark.parametrize("scale", [1e-4, 3e-2, 7.0, 1e3, 1e6])
@pytest.mark.parametrize(("scene", "method"), ALL_CASES)
def test_any_scale(difference, assert_within, scene, method, scale):
    assert_within(difference(scene, method, scale * np.eye(3), samples=FEW_SAMPLES[method]), 1e-3)


@pytest.mark.parametrize("offset", [1.23, 1234.5, 1e6 + 1.0 / 3.0])
@pytest.mark.parametrize(("scene", "method"), ALL_CASES)
def test_any_offset(difference, assert_within, scene, method, offset):
    assert_within(difference(scene, method, np.eye(3), offset * np.array([1.0, -1.0, 0.7]), FEW_SAMPLES[method]), 1e-3)


@pytest.mark.parametrize("angle", [0.1, 1.1, math.pi / 2.0, 3.0])
@pytest.mark.parametrize(("scene", "method"), ALL_CASES)
def test_rotated(difference, assert_within, scene, method, angle):
    assert_within(difference(scene, method, rotation((1.0, 2.0, 3.0), angle)), {"rays": 5e-3, "maps": 5e-2}[method])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize(("scene", "method"), ALL_CASES)
def test_mirrored(difference, assert_within, scene, method, axis):
    assert_within(difference(scene, method, np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))), 0.1)
