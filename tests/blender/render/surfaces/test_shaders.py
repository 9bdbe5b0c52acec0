# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres of each shader that reflects light beside Cycles' picture of them, in each release."""

import bpy
import numpy as np
import pytest

from tests.benchmark.files import FILTER_WIDTH, our_render
from tests.demo.figure6 import quiet_stdout
from tests.scenes.cycles import direct_light
from tests.scenes.materials import spheres
from tests.tables.furnace import Shader, shader

pytestmark = pytest.mark.usefixtures("registered")

COLUMNS, SIDE = 6, 24
#: Of both engines. Their noise is below half of the bound, that of the relative error of a sphere's mean.
OUR_SAMPLES, SAMPLES, BOUND = 64, 256, 0.015
#: Root mean square error of a picture of few samples, of its mean.
HIGHLIGHT_BOUND = 0.2

COLOR, TINT = (0.8, 0.4, 0.2), (0.5, 0.7, 0.9)
ONCE, SEVERAL_TIMES, BECKMANN = ({"distribution": name} for name in ("GGX", "MULTI_GGX", "BECKMANN"))
PAINT = {"Base Color": COLOR, "Roughness": 0.5}
METAL = {**PAINT, "Metallic": 1.0, "Specular Tint": TINT}


def shaders() -> dict[str, Shader]:
    """By name, what this release has."""
    rough = {"Color": COLOR, "Roughness": 0.8}
    cases: dict[str, tuple[str, dict, dict]] = {
        "diffuse": ("Diffuse", {}, {"Color": COLOR}),
        "rough diffuse": ("Diffuse", {}, {"Color": COLOR, "Roughness": 1.0}),
        "glossy": ("Anisotropic", ONCE, rough),
        "glossy, several reflections": ("Anisotropic", SEVERAL_TIMES, rough),
        "glossy along": ("Anisotropic", SEVERAL_TIMES, {**rough, "Anisotropy": 0.6, "Rotation": 0.1}),
        "glossy across": ("Anisotropic", ONCE, {**rough, "Anisotropy": -0.6, "Rotation": 0.1}),
        "glossy, Beckmann": ("Anisotropic", BECKMANN, {**rough, "Roughness": 0.5}),
        "rough glossy, Beckmann": ("Anisotropic", BECKMANN, rough),
        "glass, Beckmann": ("Glass", BECKMANN, rough),
        "glass": ("Glass", ONCE, rough),
        "glass, several reflections": ("Glass", SEVERAL_TIMES, {**rough, "Roughness": 1.0}),
        "sheen": ("Sheen", {"distribution": "MICROFIBER"}, rough),
        "metallic": ("Metallic", SEVERAL_TIMES, {"Base Color": COLOR, "Edge Tint": TINT, "Roughness": 0.5}),
        "metallic along": ("Metallic", ONCE, {"Base Color": COLOR, "Roughness": 0.6, "Anisotropy": 0.7}),
        "paint": ("Principled", SEVERAL_TIMES, PAINT),
        "paint, one reflection": ("Principled", ONCE, {**PAINT, "Roughness": 0.9, "IOR": 2.0}),
        "tinted": ("Principled", SEVERAL_TIMES, {**PAINT, "Specular Tint": TINT, "Specular IOR Level": 0.9}),
        "metal": ("Principled", SEVERAL_TIMES, METAL),
        "metal, one reflection": ("Principled", ONCE, {**METAL, "Roughness": 0.9}),
        "metal along": ("Principled", SEVERAL_TIMES, {**METAL, "Roughness": 0.8, "Anisotropic": 1.0}),
        "coat": ("Principled", SEVERAL_TIMES, {**PAINT, "Coat Weight": 0.8, "Coat Roughness": 0.6, "Coat Tint": TINT}),
        "velvet": ("Principled", SEVERAL_TIMES, {**PAINT, "Sheen Weight": 1.0, "Sheen Tint": TINT}),
        "rough paint": ("Principled", SEVERAL_TIMES, {**PAINT, "Diffuse Roughness": 0.8}),
    }
    if bpy.app.version < (4, 3):
        for name in ("metallic", "metallic along", "rough paint"):
            del cases[name]
    return {name: shader(f"ShaderNodeBsdf{node}", *rest) for name, (node, *rest) in cases.items()}


@pytest.mark.parametrize("light", ["rectangle", "sun"])
def test_spheres_equal_those_of_cycles(light):
    every = shaders()
    with quiet_stdout():
        spheres.build(list(every.values()), COLUMNS, SIDE)
        spheres.LIGHTS[light]()
        bpy.context.scene.render.filter_size = FILTER_WIDTH
        ours, _ = our_render(OUR_SAMPLES)
        theirs = direct_light(SAMPLES, FILTER_WIDTH)[..., :3]
    means = [spheres.squares(picture, SIDE)[: len(every)].mean((1, 2)) for picture in (ours, theirs)]
    errors = dict(zip(every, np.abs(means[0] / means[1] - 1.0).max(-1).tolist(), strict=True))
    assert max(errors.values()) < BOUND, {name: error for name, error in errors.items() if error >= BOUND}


def test_highlights_of_anisotropic_metal_are_predicted():
    """Without a stretch of the predicted highlights, the error of so few samples is six times as large."""
    metal = {**METAL, "Roughness": 0.1, "Anisotropic": 0.8}
    with quiet_stdout():
        spheres.build([shader("ShaderNodeBsdfPrincipled", SEVERAL_TIMES, metal)], 1, SIDE)
        spheres.LIGHTS["rectangle"]()
        few, many = (our_render(samples)[0] for samples in (8, 256))
    assert np.sqrt(np.mean((few - many) ** 2)) < HIGHLIGHT_BOUND * many.mean()
