# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of each shader that reflects light, by roughness and type of light, beside Cycles: `dev.py bench spheres`.

A picture for each light and shader, with a sphere for each roughness: in one picture of all, adaptive sampling would
leave few samples to most. Their errors are those of means of blocks of 8×8 pixels. Those that the noise of Cycles'
picture limits are measured again, in smaller pictures of more samples.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.jobs.png import display_from_linear, write_png
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.docs.sphere_table import is_doubtful, rows
from tests.scenes.cycles import direct_light
from tests.scenes.materials import spheres
from tests.tables.furnace import Shader, shader

from .error.benchmark_scene import SEEDS
from .files import FILTER_WIDTH, our_render

#: Pixels along the sides of a sphere's square, and of a block.
SIDE, BLOCK = 24, 8
#: Blocks that reflect less than this fraction of what the brightest one of their sphere does are left out.
MIN_LEVEL = 0.05
#: By which references are refined.
MORE_SAMPLES = 10
ROUGHNESS = (0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0)

COLOR, TINT = (0.8, 0.4, 0.2), (0.5, 0.7, 0.9)
ONCE, SEVERAL_TIMES = {"distribution": "GGX"}, {"distribution": "MULTI_GGX"}
METAL = {"Base Color": COLOR, "Metallic": 1.0}


def principled(options: dict[str, object], inputs: dict[str, object], roughness: str = "Roughness") -> Callable:
    """Makes a Principled BSDF of a roughness."""
    return lambda value: shader("ShaderNodeBsdfPrincipled", options, {"Roughness": 0.5, **inputs, roughness: value})


def node(name: str, options: dict[str, object], **inputs: object) -> Callable[[float], Shader]:
    """Makes a shader of a roughness."""
    return lambda value: shader(f"ShaderNodeBsdf{name}", options, {"Color": COLOR, **inputs, "Roughness": value})


#: By name, what makes the shader of a roughness.
SHADERS: dict[str, Callable[[float], Shader]] = {
    "Diffuse BSDF": node("Diffuse", {}),
    "Glossy BSDF": node("Anisotropic", ONCE),
    "Glossy BSDF, multiscatter": node("Anisotropic", SEVERAL_TIMES),
    "Glossy BSDF, anisotropic": node("Anisotropic", SEVERAL_TIMES, Anisotropy=0.6, Rotation=0.1),
    "Glass BSDF, its reflection": node("Glass", SEVERAL_TIMES),
    "Sheen BSDF": node("Sheen", {}),
    "Metallic BSDF": lambda value: shader(
        "ShaderNodeBsdfMetallic", SEVERAL_TIMES, {"Base Color": COLOR, "Edge Tint": TINT, "Roughness": value}
    ),
    "Principled BSDF": principled(SEVERAL_TIMES, {"Base Color": COLOR}),
    "Principled BSDF, metal": principled(ONCE, METAL),
    "Principled BSDF, anisotropic metal": principled(SEVERAL_TIMES, {**METAL, "Anisotropic": 0.8}),
    "Principled BSDF, coat": principled(SEVERAL_TIMES, {"Base Color": COLOR, "Coat Weight": 1.0}, "Coat Roughness"),
    "Principled BSDF, sheen": principled(SEVERAL_TIMES, {"Base Color": COLOR, "Sheen Weight": 1.0}, "Sheen Roughness"),
}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.spheres", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the pictures")
    parser.add_argument("--lights", nargs="+", choices=spheres.LIGHTS, default=list(spheres.LIGHTS), help="only these")
    parser.add_argument("--shaders", nargs="+", choices=SHADERS, default=list(SHADERS), help="only these")
    parser.add_argument("--samples", type=int, default=1024, help="of our pictures (%(default)s)")
    parser.add_argument("--truth", type=int, default=400, help="samples of each of two references (%(default)s)")
    parser.add_argument("--finest", type=int, default=40000, help="samples where their noise matters (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    opengl, measured = open_device().name, dict[str, dict[str, dict[str, dict[str, float]]]]()
    try:
        for light in options.lights:  # each takes minutes: what is measured is recorded
            measured[light] = measure(light, options)
            written = record.write(options.output, "spheres", opengl, {"samples": options.samples, "cases": measured})
    finally:
        addon.unregister()
    print(rows(measured))
    print(written)
    return 0


def measure(light: str, options: argparse.Namespace) -> dict[str, dict[str, dict[str, float]]]:
    """Errors under a light, by shader and roughness."""
    return {name: measure_shader(light, name, options) for name in options.shaders}


def measure_shader(light: str, name: str, options: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Errors of a shader under a light, by roughness.

    References have more samples where their noise may be what is measured.
    """
    errors, cases, truth = dict[float, dict[str, float]](), list(ROUGHNESS), options.truth
    while cases and truth <= options.finest:
        errors |= dict(zip(cases, compare_all(light, name, cases, truth, options), strict=True))
        cases = [case for case in cases if is_doubtful(errors[case])]
        truth *= MORE_SAMPLES
    return {str(roughness): errors[roughness] for roughness in ROUGHNESS}


def compare_all(
    light: str, name: str, cases: list[float], truth: int, options: argparse.Namespace
) -> Iterator[dict[str, float]]:
    """Errors of spheres of a shader and these roughnesses, with references of `truth` samples.

    Pictures of both engines and of the difference are written.
    """
    with quiet_stdout():
        spheres.build([SHADERS[name](roughness) for roughness in cases], len(ROUGHNESS), SIDE)
        spheres.LIGHTS[light]()
        bpy.context.scene.render.filter_size = FILTER_WIDTH
        ours, _ = our_render(options.samples)
        halves = [direct_light(truth, FILTER_WIDTH, seed=seed)[..., :3] for seed in SEEDS]
    theirs = np.mean(halves, 0)
    beside = np.concatenate([ours, theirs, np.clip(0.2 + 4.0 * (ours - theirs), 0.0, 1.0)])
    opaque = np.concatenate([beside, np.ones_like(beside[..., :1])], axis=2)
    write_png(options.output / f"spheres-{light}-{list(SHADERS).index(name)}-{truth}.png", display_from_linear(opaque))
    squares = [spheres.squares(picture, SIDE)[: len(cases)] for picture in (ours, *halves)]
    return ({**compare(*case), "truth": truth} for case in zip(*squares, strict=True))


def compare(ours: np.ndarray, *halves: np.ndarray) -> dict[str, float]:
    """Errors of squares (S,S,3): of blocks the median relative error and its noise, and RMSE / mean.

    The noise follows from the halves' differences in pixels. There are too few blocks for theirs to tell it.
    """
    theirs = np.mean(halves, 0)
    deviations = 0.5 * (halves[0] - halves[1]).mean(2, keepdims=True)
    blocks, truth, variances = block_means(ours), block_means(theirs), block_means(deviations**2)
    lit = truth > MIN_LEVEL * truth.max()
    return {
        "error": float(np.median(np.abs(blocks / truth - 1.0)[lit])),
        "noise": float(np.median((np.sqrt(variances) / (BLOCK * truth))[lit])),
        "rmse": float(np.sqrt(np.mean((ours - theirs) ** 2)) / theirs.mean()),
    }


def block_means(square: np.ndarray) -> np.ndarray:
    """(S/8,S/8) means of the blocks of a square (S,S,C)."""
    count = len(square) // BLOCK
    return square.reshape(count, BLOCK, count, BLOCK, -1).mean((1, 3, 4))


if __name__ == "__main__":
    sys.exit(main())
