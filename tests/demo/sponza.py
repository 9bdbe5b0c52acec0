# SPDX-License-Identifier: GPL-3.0-or-later
"""The report's figure 6 with its own scene, for docs/method.md: python -m tests.demo.sponza FILE --output FOLDER

(a) without lighting, (b) soft shadows by imperfect shadow maps of 105 virtual lights, (c) with ambient occlusion,
(d) by the default method, (e) by Cycles without bounces. The file must have lights, a world and a camera.
"""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import bpy

from ism_addon import addon

from .figure6 import progress_bar, quiet_stdout, without_lighting

REPORT = Path(addon.__file__).parent / "presets" / "ism" / "quality" / "Report_2013.py"
SIZE = 960, 540
SMOOTH_SAMPLES, SAMPLES, CYCLES_SAMPLES = 16, 64, 128
#: The part of the world's light that the walls of the hall let in, about: the report's method does not shadow it.
AMBIENT = 0.25
#: Of ambient occlusion: the radius, m, and the intensity, for a hall in which the world's light is weak.
OCCLUSION_RADIUS, OCCLUSION_INTENSITY = 2.5, 2.0


def textures_only(scene: bpy.types.Scene) -> None:
    """Without gloss, in the even light of a white world that nothing occludes."""
    without_lighting(scene)
    for material in bpy.data.materials:
        for node in material.node_tree.nodes if material.use_nodes else ():
            if node.type == "BSDF_PRINCIPLED":
                node.inputs["Specular IOR Level"].default_value = 0.0
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0
    scene.ism.shadow.world = False


def soft_shadows(scene: bpy.types.Scene) -> None:
    """By the report's method and numbers of lights and maps, but with more samples, for smooth edges."""
    exec(compile(REPORT.read_text("utf-8"), REPORT.name, "exec"), {"bpy": bpy})
    scene.ism.render.samples = SMOOTH_SAMPLES
    scene.ism.shadow.world, scene.ism.ssao.enabled = False, False
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value *= AMBIENT


def with_occlusion(scene: bpy.types.Scene) -> None:
    """The same, and ambient occlusion of the world's light."""
    soft_shadows(scene)
    scene.ism.ssao.enabled = True
    scene.ism.ssao.radius, scene.ism.ssao.intensity = OCCLUSION_RADIUS, OCCLUSION_INTENSITY


def default_method(scene: bpy.types.Scene) -> None:
    """With the settings of a new file, but more samples."""
    scene.ism.render.samples = SAMPLES


def cycles(scene: bpy.types.Scene) -> None:
    """Direct light, as the default method has it."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.max_bounces = CYCLES_SAMPLES, 0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.sample_clamp_direct = 0.0


FIGURES: dict[str, Callable[[bpy.types.Scene], None]] = {
    "sponza-1-no-lighting": textures_only,
    "sponza-2-soft-shadows": soft_shadows,
    "sponza-3-soft-shadows-ssao": with_occlusion,
    "sponza-4-ray-traced": default_method,
    "sponza-5-cycles": cycles,
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.demo.sponza", description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path, help="the .blend, see docs/method.md")
    parser.add_argument("--output", type=Path, required=True, help="folder of the pictures")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        for name, set_up in FIGURES.items():
            print(draw(options.file, options.output / f"{name}.jpg", set_up))
    finally:
        addon.unregister()
    return 0


def draw(file: Path, picture: Path, set_up: Callable[[bpy.types.Scene], None]) -> Path:
    """Render one figure of the file. Returns its path."""
    with quiet_stdout():
        bpy.ops.wm.open_mainfile(filepath=str(file), load_ui=False)
    scene = bpy.context.scene
    scene.render.engine = "ISM"
    (scene.render.resolution_x, scene.render.resolution_y), scene.render.resolution_percentage = SIZE, 100
    set_up(scene)
    image = scene.render.image_settings
    image.file_format, image.color_mode, image.quality = "JPEG", "RGB", 92
    scene.render.filepath = str(picture)
    with progress_bar(picture.stem):
        bpy.ops.render.render(write_still=True)
    return picture


if __name__ == "__main__":
    sys.exit(main())
