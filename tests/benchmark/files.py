# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of .blend files' direct light: `dev.py bench files --files FOLDER`, beside what Cycles renders.

The world is black in both engines, unless `--world` keeps it, and depth of field, motion blur and compositing are
switched off. With `--grey`, all materials are made a grey, diffuse one, which emits what the file's own emits evenly:
what is measured then is lights and geometry.
"""

import argparse
import sys
import tempfile
from pathlib import Path
from statistics import median

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.jobs.png import display_from_linear, write_png
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.scenes.cycles import direct_light, image_pixels, write_as_exr
from tests.scenes.parts.diffuse import make_diffuse

from .error.benchmark_scene import SEEDS
from .error.metrics import noise, rmse

FILTER_WIDTH = 1.5  # px, of the pixel filter
GREY = (0.5, 0.5, 0.5)
#: RMSE / mean of a picture that looks like Cycles'.
CLOSE = 0.08
CLOSE_IN_GREY = 0.05


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.files", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the pictures")
    parser.add_argument("--files", type=Path, required=True, help="a folder of .blend files, or one file")
    parser.add_argument("--width", type=int, default=240, help="of the pictures, in pixels (%(default)s)")
    parser.add_argument("--samples", type=int, default=16, help="of our pictures (%(default)s)")
    parser.add_argument("--truth", type=int, default=256, help="samples of each of two references (%(default)s)")
    parser.add_argument("--world", action="store_true", help="keep the files' worlds")
    parser.add_argument("--grey", action="store_true", help="replace all materials")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        measured = measure_all(options)
    finally:
        addon.unregister()
    rmses, close = [each["rmse"] for each in measured.values()], CLOSE_IN_GREY if options.grey else CLOSE
    print(f"median {median(rmses):.4f}, {sum(e <= close for e in rmses)} of {len(rmses)} within {close:g}")
    measured = {key: getattr(options, key) for key in ("samples", "width", "world", "grey")} | {"files": measured}
    print(record.write(options.output, "files", open_device().name, measured))
    return 0


def measure_all(options: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Measure each file that has a camera."""
    measured = {}
    for path in [options.files] if options.files.is_file() else sorted(options.files.glob("*.blend")):
        with quiet_stdout():
            bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
            simplify(bpy.context.scene, options.width, options.world)
            if options.grey:
                make_all_grey()
        if bpy.context.scene.camera is None:
            print(f"{path.stem}: no camera")
            continue
        measured[path.stem] = measure(path.stem, options)
    return measured


def measure(name: str, options: argparse.Namespace) -> dict[str, float]:
    """Render the open file with both engines, write both pictures beside each other, and return the errors."""
    with quiet_stdout():
        picture, seconds = our_render(options.samples)
        halves = np.stack(
            [direct_light(options.truth, FILTER_WIDTH, seed=seed, light_tree=True)[..., :3] for seed in SEEDS]
        )
    truth = halves.mean(0)
    mean = max(float(truth.mean()), 1e-9)
    error = rmse(picture, halves) if truth.any() else float(picture.any())
    images = picture * (0.3 / mean), truth * (0.3 / mean), np.clip(0.2 + (picture - truth) * (0.2 / mean), 0.0, 1.0)
    beside = np.concatenate(images, axis=1)
    opaque = np.concatenate([beside, np.ones_like(beside[..., :1])], axis=2)
    write_png(options.output / f"{name}.png", display_from_linear(opaque))
    result = {"rmse": error, "noise of the truth": noise(halves) if truth.any() else 0.0, "seconds": seconds}
    print("  ".join([f"{name:28}", *(f"{key} {value:.4f}" for key, value in result.items())]), flush=True)
    return result


def our_render(samples: int) -> tuple[np.ndarray, float]:
    """Render the open file: the picture (H,W,3), bottom row first, and the seconds that the engine took."""
    scene = bpy.context.scene
    scene.render.engine = "ISM"
    scene.ism.render.samples, scene.ism.render.error_threshold = samples, 0.0
    scene.ism.ssao.enabled = False
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        write_as_exr(path)
        return image_pixels(path)[..., :3], statistics()["seconds"]


def simplify(scene: bpy.types.Scene, width: int, keep_world: bool) -> None:
    """Leave the scene's lights and geometry, and its world if that is kept."""
    render = scene.render
    height = width * render.resolution_y / render.resolution_x
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, max(round(height), 1), 100
    render.use_border = render.use_motion_blur = render.use_compositing = render.use_sequencer = False
    render.filter_size = FILTER_WIDTH
    scene.cycles.film_exposure = 1.0
    scene.animation_data_clear()  # it may give the two references the same seed
    scene.view_layers[0].use = True
    scene.view_layers[0].material_override = None
    render.film_transparent = render.film_transparent and not keep_world
    if scene.camera:
        scene.camera.data.dof.use_dof = False
    if not keep_world:
        scene.world = None


def make_all_grey() -> None:
    """Replace all materials, and give one to meshes that have none."""
    for material in bpy.data.materials:
        make_grey(material)
    empty = bpy.data.materials.new("Grey")
    make_grey(empty)
    for mesh in (*bpy.data.meshes, *bpy.data.curves, *bpy.data.metaballs):
        for slot in range(len(mesh.materials)):
            mesh.materials[slot] = mesh.materials[slot] or empty
        if not mesh.materials:
            mesh.materials.append(empty)


def make_grey(material: bpy.types.Material) -> None:
    """Replace a material's nodes by a grey, diffuse one that emits what it emitted, if that is the same everywhere."""
    material.use_nodes = True
    make_diffuse(material, GREY, *emitted(material))


def emitted(material: bpy.types.Material) -> tuple[tuple[float, ...], float]:
    """Colour and strength that a material's shader emits; black and 0 if links give them."""
    output = material.node_tree.get_output_node("CYCLES")
    links = output.inputs["Surface"].links if output else ()
    shader = links[0].from_node if links else None
    names = {
        "ShaderNodeEmission": ("Color", "Strength"),
        "ShaderNodeBsdfPrincipled": ("Emission Color", "Emission Strength"),
    }.get(shader.bl_idname if shader else "")
    if names is None or any(shader.inputs[name].is_linked for name in names):
        return (0.0, 0.0, 0.0), 0.0
    color, strength = (shader.inputs[name].default_value for name in names)
    return tuple(color)[:3], strength if any(tuple(color)[:3]) else 0.0


if __name__ == "__main__":
    sys.exit(main())
