# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's figure 6 with our own atrium: python -m tests.demo.figure6 --output FOLDER

(a) without lighting, (b) soft shadows, (c) soft shadows and ambient occlusion, all by Blender's render operator.
"""

import argparse
import os
import re
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.gpu.profile import table
from tests.scenes import atrium, atrium_light

BAR_WIDTH = 30  # characters


def without_lighting(scene: bpy.types.Scene) -> None:
    """Textures only: no lights, a white world and a transparent background."""
    for each in scene.objects:
        each.hide_render = each.hide_render or each.type == "LIGHT"
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scene.render.film_transparent = True
    scene.ism.ssao.enabled = False


def soft_shadows(scene: bpy.types.Scene) -> None:
    """Without ambient occlusion: the world's light is not occluded."""
    scene.ism.ssao.enabled = False


def soft_shadows_ssao(scene: bpy.types.Scene) -> None:
    """With all settings as they are in the file."""


FIGURES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "1-no-lighting": without_lighting,
    "2-soft-shadows": soft_shadows,
    "3-soft-shadows-ssao": soft_shadows_ssao,
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.demo.figure6", description="Render the report's figure 6.")
    parser.add_argument("--output", type=Path, required=True, help="folder of the pictures and the .blend")
    parser.add_argument("--samples", type=int, default=16, help="samples per picture (%(default)s)")
    parser.add_argument("--size", default="1280x720", help="WIDTHxHEIGHT in pixels (%(default)s)")
    options = parser.parse_args()
    width, height = (int(number) for number in options.size.split("x"))
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        blend = saved_atrium(options.output / "atrium.blend")
        pictures = [draw(blend, name, width, height, options.samples) for name in FIGURES]
    finally:
        addon.unregister()
    print("\n".join(str(path) for path in (*pictures, blend)))
    return int(not all(path.is_file() for path in pictures))


def saved_atrium(path: Path) -> Path:
    """The atrium's .blend. It is built if it does not exist, or is older than the scripts that build it."""
    scripts = Path(atrium.__file__).parent.rglob("*.py")
    if not path.is_file() or path.stat().st_mtime < max(script.stat().st_mtime for script in scripts):
        print("building the atrium")
        atrium.build(path)
        atrium_light.set_up_occlusion(bpy.context.scene.ism)
        bpy.context.preferences.filepaths.save_version = 0  # no .blend1 beside the pictures
        bpy.ops.wm.save_mainfile(compress=True)
    return path


def draw(blend: Path, name: str, width: int, height: int, samples: int) -> Path:
    """Render one figure, and print the time of each pass."""
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.ism.render.samples = samples
    FIGURES[name](scene)
    picture = blend.with_name(f"{name}.png")
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.filepath = str(picture)
    picture.unlink(missing_ok=True)
    with progress_bar(name):
        bpy.ops.render.render(write_still=True)
    print(table(statistics()))
    return picture


@contextmanager
def progress_bar(name: str) -> Iterator[None]:
    """Show a progress bar of the samples done, instead of the lines that Blender prints while it renders."""
    start = time.monotonic()

    def show(line: str, *_more: object) -> None:
        if counted := re.search(r"Sample (\d+)/(\d+)", line):
            done, samples = map(int, counted.groups())
            bar = "█" * round(BAR_WIDTH * done / samples)
            seconds = time.monotonic() - start
            print(
                f"\r{name:<20} {bar:·<{BAR_WIDTH}} {done}/{samples}  {seconds:.0f} s ",
                end="",
                file=sys.stderr,
                flush=True,
            )

    bpy.app.handlers.render_stats.append(show)
    try:
        with quiet_stdout():
            yield
    finally:
        bpy.app.handlers.render_stats.remove(show)
        print(file=sys.stderr)


@contextmanager
def quiet_stdout() -> Iterator[None]:
    """Discard what is printed. Blender prints from C, which redirecting sys.stdout does not catch."""
    sys.stdout.flush()
    stdout = os.dup(1)
    try:
        with open(os.devnull, "w") as null:
            os.dup2(null.fileno(), 1)
        yield
    finally:
        os.dup2(stdout, 1)
        os.close(stdout)


if __name__ == "__main__":
    sys.exit(main())
