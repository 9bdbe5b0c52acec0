# SPDX-License-Identifier: GPL-3.0-or-later
"""Another OpenGL draws the same pictures: Mesa's zink, which asks Vulkan, by Mesa's Vulkan for processors, lavapipe.

It compiles our shaders to SPIR-V, and Vulkan's rules for what is read and written at the same time are strict.
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

#: Most that the pictures may differ by, as the root of the mean squared error over the mean. Measured: 1e-7 to 4e-7, as
#: the two round otherwise. One ray of a small picture that is decided otherwise would be 1e-3.
MOST = 1e-3
SETTINGS = {
    Method.RAY_TRACED: with_quality(SMALL_SETTINGS, samples=16),
    Method.SHADOW_MAPS: with_quality(SMALL_SHADOW_MAPS, samples=4),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[tuple[str, Method], Path]:
    """Snapshots of all small scenes with the settings of both methods, with creases and a wide filter."""
    folder = tmp_path_factory.mktemp("snapshots")
    found = {}
    for name, make in SMALL.items():
        scene, view = make(48, 32)
        for method, settings in SETTINGS.items():
            path = folder / f"{name} {method}.npz".replace(" ", "_")
            chosen = replace(settings, ssao=SSAO(enabled=True))
            snapshot.save(path, scene, replace(view, filter_width=1.5), chosen)
            found[name, method] = path
    return found


@pytest.fixture(scope="module")
def by_zink(files, tmp_path_factory) -> dict[str, np.ndarray]:
    """By file's name, the colours that zink draws."""
    lavapipe = machine.lavapipe()
    assert lavapipe, "zink cannot be tried here without lavapipe, which is in Debian's mesa-vulkan-drivers"
    output = tmp_path_factory.mktemp("zink") / "colors.npz"
    drivers = os.pathsep.join(map(str, lavapipe))
    chosen = {"GALLIUM_DRIVER": "zink", "LIBGL_ALWAYS_SOFTWARE": "1", "VK_ICD_FILENAMES": drivers}
    run = subprocess.run(
        [sys.executable, "-m", "tests.support.draw_snapshots", output, *files.values()],
        cwd=project.ROOT,
        env={**os.environ, **chosen},
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stderr
    return dict(np.load(output))


def test_it_is_another(by_zink, device):
    assert str(by_zink["driver"]).startswith("zink")
    assert not device.name.startswith("zink")


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", SMALL)
def test_it_draws_the_same_picture(device, files, by_zink, name, method):
    path = files[name, method]
    own = draw(device, *snapshot.load(path)).color
    assert nrmse(by_zink[path.stem][..., :3], own[..., :3]) < MOST
    assert np.array_equal(by_zink[path.stem][..., 3], own[..., 3])
