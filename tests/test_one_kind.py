# SPDX-License-Identifier: GPL-3.0-or-later
"""Nothing that a scene has more or less of makes Mesa's software driver compile a shader again."""

import os
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ism_addon.gpu import one_kind

from .tools import project

#: Draws pictures of one size, one after the other, and prints how many files the driver's cache has after each.
DRAW = """
import os, sys, time
from pathlib import Path
from ism_addon.gpu.context import open_device
from tests.studio import MAPS, SMALL_SETTINGS, both, draw, light, look, quad, rubble, stage, with_quality

FLOOR, FOLDER = quad((-3, -3, 0), (6, 0, 0), (0, 6, 0)), Path(os.environ["MESA_SHADER_CACHE_DIR"])

def files():
    return sum(path.is_file() for path in FOLDER.rglob("*"))

def settled():
    "The driver writes them in a thread of its own."
    before, now = -1, files()
    while now != before:
        time.sleep(0.1)
        before, now = now, files()
    return now

device, size = open_device(), (int(sys.argv[1]), int(sys.argv[2]))
settings = with_quality(SMALL_SETTINGS, samples=6) if sys.argv[3] == "rays" else with_quality(MAPS, samples=2)
view = look((3.0, -3.0, 3.0), size=size, filter_width=1.5)
for lights, triangles in ((3, 20), (3, 20), (5, 3000), (3, 3000), (1, 20), (2, 200), (4, 20), (5, 3000)):
    lamps = light()
    for number in range(lights - 1):
        lamps = both(lamps, light(position=(0.4 * number - 0.8, 0.3 * number - 0.5, 2.0 + 0.1 * number)))
    assert draw(device, stage([FLOOR, rubble(triangles)], lamps), view, settings).color.any()
    print(settled())
"""


@pytest.mark.parametrize("method", ["rays", "maps"])
@pytest.mark.parametrize("size", [(90, 60), (64, 32)], ids=["odd sizes", "powers of two"])
def test_another_picture_compiles_nothing(opened_device, tmp_path, size, method):
    """The same scene again, and others with tables small and large, and another number of lights.

    The third scene has what the first had not, a large mesh and faint lights, which have programs of their own.
    """
    if "llvmpipe" not in opened_device.name:
        pytest.skip("only Mesa's cache is counted")
    asked = subprocess.run(
        [sys.executable, "-c", DRAW, *map(str, size), method],
        cwd=project.ROOT,
        env=os.environ | {"MESA_SHADER_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert asked.returncode == 0, asked.stderr
    first, again, *others = map(int, asked.stdout.split())
    assert first > 20
    assert again == first
    assert others == [others[0]] * len(others)


@given(count=st.integers(0, 1 << 20), each=st.sampled_from([4, 8, 16]))
def test_buffers_are_hardly_larger_than_asked_for(count, each):
    rows = one_kind.rows(count, each)
    size = rows * each
    assert count <= rows <= max(count + 1 + 256 // each, 256 // each + 1)
    assert size & (size - 1)
    assert size >> 8 & 255


@given(texels=st.integers(1, 1 << 14))
def test_sides_are_hardly_longer_than_asked_for(texels):
    side = one_kind.side(texels)
    assert texels <= side <= max(texels + 1, 3)
    assert side & (side - 1)
