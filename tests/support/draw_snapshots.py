# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws snapshots in a separate process, which may use another OpenGL driver: draw_snapshots OUTPUT.npz SNAPSHOT…

The output has the colours (H,W,4) float32 of each snapshot, by its file's stem, and the driver's name, by "driver".
"""

import sys
from pathlib import Path

import numpy as np

from ism_addon import snapshot
from ism_addon.gpu.gl.context import open_device
from tests.support.small_scenes import draw


def main() -> None:
    output, *paths = map(Path, sys.argv[1:])
    device = open_device()
    with device.gl:
        colors = {path.stem: draw(device, *snapshot.load(path)).color for path in paths}
        device.check()
    device.close()
    np.savez(output, driver=np.array(device.name), **colors)


if __name__ == "__main__":
    main()
