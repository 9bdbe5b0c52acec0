# SPDX-License-Identifier: GPL-3.0-or-later
"""A second OpenGL draws the same pictures: Mesa's zink, on top of Mesa's Vulkan driver for CPUs, lavapipe.

It compiles our shaders to SPIR-V, and Vulkan's rules for simultaneous reads and writes are strict.
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.settings import SSAO, Method
from tests.scenes.small import SMALL
from tests.support.reference import nrmse
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality
from tests.tools import machine, project

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="zink over lavapipe is Mesa's, under Linux")

#: Bound of the difference of the pictures, as the root of the mean squared error over the mean. Measured: 1e-7 to 4e-7,
#: as the two round differently. One ray of a small picture with another result would be 1e-3.
MAX_ERROR = 1e-3
SETTINGS = {
    Method.RAY_TRACED: with_quality(SMALL_SETTINGS, samples=16),
    Method.SHADOW_MAPS: with_quality(SMALL_SHADOW_MAPS, samples=4),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[tuple[str, Method], Path]:
    """Snapshots of all small scenes for both methods, with ambient occlusion and a wide pixel filter."""
    folder = tmp_path_factory.mktemp("snapshots")
    paths = {}
    for name, make in SMALL.items():
        scene, view = make(48, 32)
        for method, settings in SETTINGS.items():
            path = folder / f"{name} {method}.npz".replace(" ", "_")
            with_occlusion = replace(settings, ssao=SSAO(enabled=True))
            snapshot.save(path, scene, replace(view, filter_width=1.5), with_occlusion)
            paths[name, method] = path
    return paths


@pytest.fixture(scope="module")
def by_zink(files, tmp_path_factory) -> dict[str, np.ndarray]:
    """The pictures that zink draws, by the stem of the snapshot's name."""
    lavapipe = machine.lavapipe()
    assert lavapipe, "zink cannot be tested here without lavapipe, which is in Debian's mesa-vulkan-drivers"
    output = tmp_path_factory.mktemp("zink") / "colors.npz"
    drivers = os.pathsep.join(map(str, lavapipe))
    environment = {"GALLIUM_DRIVER": "zink", "LIBGL_ALWAYS_SOFTWARE": "1", "VK_ICD_FILENAMES": drivers}
    run = subprocess.run(
        [sys.executable, "-m", "tests.support.draw_snapshots", output, *files.values()],
        cwd=project.ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
    return dict(np.load(output))


def test_it_is_another_driver(by_zink, device):
    assert str(by_zink["driver"]).startswith("zink")
    assert not device.name.startswith("zink")


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", SMALL)
def test_it_draws_the_same_picture(device, files, by_zink, name, method):
    path = files[name, method]
    own = draw(device, *snapshot.load(path)).color
    assert nrmse(by_zink[path.stem][..., :3], own[..., :3]) < MAX_ERROR
    assert np.array_equal(by_zink[path.stem][..., 3], own[..., 3])
