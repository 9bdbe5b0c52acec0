# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures that are computed. Their details are larger than pixels."""

from collections.abc import Iterator

import bpy

from .case import NodeCase, options_of

#: The inputs that vary of a texture: its vector, or its only number, or both.
POINTS = {"1D": (0,), "2D": (0,), "3D": (0,), "4D": (0, 1)}


def move(node: bpy.types.Node) -> None:
    """Give a texture a mapping of its own."""
    own = node.texture_mapping
    own.translation, own.rotation, own.scale = (0.3, 0.1, 0.2), (0.2, 0.4, 0.8), (1.5, 0.7, 1.2)


def cases() -> Iterator[NodeCase]:
    """All cases."""
    yield from noise_cases()
    yield from voronoi_cases()
    for dimensions, varied in POINTS.items():
        for output in range(2):
            yield NodeCase("ShaderNodeTexWhiteNoise", {"noise_dimensions": dimensions}, output, varied, is_whole=True)
    yield NodeCase("ShaderNodeTexWhiteNoise", varied=(), label="unlinked")
    for type_ in ("2D", "3D"):
        orientation = 0.7 if type_ == "2D" else (0.3, -0.8, 0.5)
        for output in range(3):
            for anisotropy in (1.0, 0.6, 0.0):
                fixed = {"Scale": 0.7, "Frequency": 1.3, "Anisotropy": anisotropy, "Orientation": orientation}
                yield NodeCase("ShaderNodeTexGabor", {"gabor_type": type_}, output, (0,), fixed, label=f"{anisotropy}")
    for type_ in ("Noise", "Voronoi", "Gabor"):
        yield NodeCase(f"ShaderNodeTex{type_}", varied=(), fixed={"Scale": 3.0, "Detail": 0.0}, label="unlinked")
        yield NodeCase(f"ShaderNodeTex{type_}", varied=(0,), fixed={"Scale": 1.0}, prepare=move, label="own mapping")


def noise_cases() -> Iterator[NodeCase]:
    """All dimensions, types and outputs, distortion, and details that are whole numbers."""
    fixed = {"Scale": 1.2, "Detail": 1.6, "Roughness": 0.7, "Lacunarity": 1.7, "Offset": 0.8, "Gain": 1.6}
    name = "ShaderNodeTexNoise"
    for dimensions, varied in POINTS.items():
        common = {"noise_dimensions": dimensions}
        for output in range(2):
            for options in options_of(name, "noise_type", "normalize"):
                yield NodeCase(name, {**common, **options}, output, varied, fixed)
            distorted = {**fixed, "Distortion": 0.4}
            yield NodeCase(name, common, output, varied, distorted, label="distorted")
        for detail in (0.0, 1.0):
            yield NodeCase(name, common, 1, varied, {**fixed, "Detail": detail, "Roughness": 1.4}, label=f"{detail}")
    inputs = {"Scale": 1.0, "Detail": 1.0}
    for index in range(1, 6):
        options = {"noise_type": "HYBRID_MULTIFRACTAL"}
        yield NodeCase(name, options, 0, (0, index), inputs, low=0.5, label=f"varied {index}")


def voronoi_cases() -> Iterator[NodeCase]:
    """All dimensions, features, metrics and outputs; with and without octaves and normalization."""
    name, single = "ShaderNodeTexVoronoi", {"Scale": 1.0, "Randomness": 0.9, "Smoothness": 0.7, "Exponent": 1.3}
    octaves = {**single, "Detail": 0.6, "Roughness": 0.6, "Lacunarity": 1.8}
    for dimensions, varied in POINTS.items():
        common = {"voronoi_dimensions": dimensions}
        for options in options_of(name, "feature"):
            for output in range(4):
                yield NodeCase(name, {**common, **options}, output, varied, single)
                yield NodeCase(name, {**common, **options}, output, varied, octaves, label="octaves")
            normalized = {**common, **options, "normalize": True}
            for output in range(2):
                yield NodeCase(name, normalized, output, varied, octaves, label="octaves")
            has_metric = dimensions != "1D" and options["feature"] in ("F1", "F2", "SMOOTH_F1")
            for metric in options_of(name, "distance") if has_metric else ():
                yield NodeCase(name, {**normalized, **metric}, 0, varied, single)
    yield NodeCase(name, {"feature": "SMOOTH_F1"}, 1, (0,), {"Scale": 1.0, "Smoothness": 0.0}, label="not smooth")
