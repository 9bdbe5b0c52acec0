# SPDX-License-Identifier: GPL-3.0-or-later
"""The method's steps in the demo's atrium, for docs/method.md: python -m tests.demo.steps --output FOLDER

Each picture is a JPEG of a debug view, drawn without Blender's render operator.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.choices import DebugView
from ism_addon.color import srgb_from_linear
from ism_addon.gpu.__main__ import draw
from ism_addon.gpu.jobs.job import Request
from ism_addon.settings import Quality, Settings

from .figure6 import quiet_stdout, saved_atrium

SIZE = 640, 360
#: By debug view: samples to draw. The first sample has no residual.
SAMPLES = {
    DebugView.PRIMITIVE: 1,
    DebugView.PROBE_PREDICTION: 1,
    DebugView.DIRECT_PREDICTION: 1,
    DebugView.DIRECT_RESIDUAL: 2,
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.demo.steps", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the pictures and the .blend")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(saved_atrium(options.output / "atrium.blend")))
        render = bpy.context.scene.render
        render.resolution_x, render.resolution_y = SIZE
        depsgraph = bpy.context.evaluated_depsgraph_get()
        scene, view = scene_reader.scene(depsgraph), camera.final_view(depsgraph)
    finally:
        addon.unregister()
    for debug_view, samples in SAMPLES.items():
        settings = replace(Settings(), quality=Quality(samples=samples), debug_view=debug_view)
        picture, job = draw(Request(scene, view, settings))
        if picture is None:
            sys.exit(job.error)
        print(save(picture.color, options.output / file_name(debug_view)))
    return 0


def file_name(debug_view: DebugView) -> str:
    """The name of a debug view's picture."""
    return f"{debug_view.label.lower().replace(' ', '-')}.jpg"


def save(color: np.ndarray, path: Path) -> Path:
    """Save linear light (H,W,4) as a JPEG."""
    image = bpy.data.images.new(path.stem, SIZE[0], SIZE[1])
    encoded = np.ones((*SIZE[::-1], 4), np.float32)
    encoded[..., :3] = srgb_from_linear(np.clip(color[..., :3], 0.0, 1.0))
    image.pixels.foreach_set(encoded.ravel())
    image.filepath_raw, image.file_format = str(path), "JPEG"
    with quiet_stdout():
        image.save(quality=85)
    return path


if __name__ == "__main__":
    sys.exit(main())
