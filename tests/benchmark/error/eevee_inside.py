# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender, `blender -b FILE -P eevee_inside.py -- FOLDER SAMPLES…`: writes a picture for each, and times."""

import json
import sys
import time
from pathlib import Path

import bpy


def render(samples: int, path: Path) -> float:
    """Render with EEVEE, then write the picture. Returns the seconds of the render call."""
    scene = bpy.context.scene
    scene.eevee.taa_render_samples = samples
    start = time.perf_counter()
    bpy.ops.render.render()
    seconds = time.perf_counter() - start
    bpy.data.images["Render Result"].save_render(str(path))
    return seconds


def main() -> None:
    folder, *samples = sys.argv[sys.argv.index("--") + 1 :]
    scene = bpy.context.scene
    scene.render.engine = "BLENDER_EEVEE_NEXT" if (4, 2) <= bpy.app.version < (5, 0) else "BLENDER_EEVEE"
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
    first = render(1, Path(folder) / "first.exr")
    seconds = [render(int(count), Path(folder) / f"{count}.exr") for count in samples]
    (Path(folder) / "record.json").write_text(json.dumps({"first": first, "seconds": seconds}))


main()
