# SPDX-License-Identifier: GPL-3.0-or-later
"""The same world larger, smaller, far away, turned or mirrored is the same picture.

Larger, smaller and far away every ray is the same but for float32's rounding. Turned, ambient occlusion looks along
other directions about a normal; mirrored, pixels take other places on the lights: what is left of their noise is apart.
"""

import math

import numpy as np
import pytest

from ism_addon.settings import Method, Quality, Settings, Shadow
from tests.scenes.small import SMALL
from tests.stress.pictures.comparisons import relative_difference
from tests.stress.pictures.moves import Picture, moved
from tests.support.small_scenes import draw, with_quality

#: By the methods: rays that differ by rounding may meet something else, points in maps may fall to other texels.
METHODS = {
    "rays": Settings(quality=Quality(samples=16, error_threshold=0.0)),
    "maps": Settings(
        shadow=Shadow(method=Method.SHADOW_MAPS),
        quality=Quality(samples=8, error_threshold=0.0, virtual_lights=16, map_size=64, map_points=4096),
    ),
}
#: Enough where each sample is the same.
FEW = {"rays": 16, "maps": 2}
ALL = [pytest.param(scene, method, id=f"{scene}, {method}") for scene in SMALL for method in METHODS]


@pytest.fixture(scope="module")
def originals():
    """Pictures that have been drawn, by scene, method and samples."""
    return {}


@pytest.fixture
def off(device, originals):
    """off(scene, method, linear, offset, samples): how far the moved picture is from the one where it was."""

    def off(
        scene: str, method: str, linear: np.ndarray, offset: np.ndarray | float = 0.0, samples: int | None = None
    ) -> float:
        settings = with_quality(METHODS[method], samples=samples or METHODS[method].quality.samples)
        picture: Picture = *SMALL[scene](96, 64), settings
        key = scene, method, settings.quality.samples
        if key not in originals:
            originals[key] = draw(device, *picture).color
        there = draw(device, *moved(picture, linear, offset)).color
        return relative_difference(there[:, ::-1] if np.linalg.det(linear) < 0.0 else there, originals[key])

    return off


def turn(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """(3,3) about an axis (Rodrigues)."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


@pytest.mark.parametrize("scale", [1e-4, 3e-2, 7.0, 1e3, 1e6])
@pytest.mark.parametrize(("scene", "method"), ALL)
def test_any_scale(off, within, scene, method, scale):
    within(off(scene, method, scale * np.eye(3), samples=FEW[method]), 1e-3)


@pytest.mark.parametrize("offset", [1.23, 1234.5, 1e6 + 1.0 / 3.0])
@pytest.mark.parametrize(("scene", "method"), ALL)
def test_any_offset(off, within, scene, method, offset):
    within(off(scene, method, np.eye(3), offset * np.array([1.0, -1.0, 0.7]), FEW[method]), 1e-3)


@pytest.mark.parametrize("angle", [0.1, 1.1, math.pi / 2.0, 3.0])
@pytest.mark.parametrize(("scene", "method"), ALL)
def test_turned(off, within, scene, method, angle):
    within(off(scene, method, turn((1.0, 2.0, 3.0), angle)), {"rays": 5e-3, "maps": 5e-2}[method])


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize(("scene", "method"), ALL)
def test_mirrored(off, within, scene, method, axis):
    within(off(scene, method, np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))), 0.1)
