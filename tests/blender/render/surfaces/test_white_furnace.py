# SPDX-License-Identifier: GPL-3.0-or-later
"""The model of glossy materials in tests/tables beside Cycles: a white environment, and light of single directions."""

import bpy
import numpy as np
import pytest

from tests.tables import furnace, ggx, layers, lookup, sheen
from tests.tables.layers import Principled

COUNT = 4
SAMPLES = 256
#: Coats of Cycles 4.2 differ: see layers.py.
COATS = bpy.app.version >= (4, 5)


def random_principled(random: np.random.Generator, kind: str) -> Principled:
    """Materials that differ in roughness, colour and distribution, and in the inputs that `kind` names."""
    chosen = {
        "plain": {},
        "metal": {"metallic": 1.0, "specular_tint": random.random(3)},
        "tint": {"specular_tint": 1.2 * random.random(3), "ior": random.uniform(1.1, 2.5)},
        "level": {"specular_ior_level": random.random(), "ior": random.uniform(1.1, 2.5)},
        "below 1": {"specular_ior_level": random.choice([0.5, 0.8]), "ior": random.uniform(0.5, 0.95)},
        "sheen": {
            "sheen_weight": random.random(),
            "sheen_roughness": random.uniform(0.2, 1.0),
            "sheen_tint": random.random(3),
        },
        "coat": {
            "coat_weight": random.random(),
            "coat_roughness": random.random(),
            "coat_ior": random.uniform(1.1, 2.5),
            "coat_tint": random.random(3),
        },
    }
    chosen["all"] = {**chosen["tint"], **chosen["sheen"], **chosen["coat"], "metallic": random.random()}
    roughness, multiscatter = random.uniform(0.1, 1.0), bool(random.random() < 0.7)
    return Principled(random.random(3), roughness=roughness, multiscatter=multiscatter, **chosen[kind])


def distribution(multiscatter: bool) -> dict[str, object]:
    return {"distribution": "MULTI_GGX" if multiscatter else "GGX"}


def principled_shader(inputs: Principled) -> furnace.Shader:
    """Blender's labels are the fields' names in upper and lower case."""
    values = dict(vars(inputs))
    options = distribution(values.pop("multiscatter"))
    label = {"ior": "IOR", "specular_ior_level": "Specular IOR Level", "coat_ior": "Coat IOR"}
    labelled = {label.get(name, name.replace("_", " ").title()): value for name, value in values.items()}
    return furnace.shader("ShaderNodeBsdfPrincipled", options, labelled)


@pytest.mark.parametrize("cosine", [0.95, 0.5, 0.12])
def test_layers_reflect_what_cycles_reflects(cosine):
    random = np.random.default_rng(int(100.0 * cosine))
    shaders, expected, kinds = [], [], []
    for kind in ("plain", "metal", "tint", "level", "below 1", "sheen", *(("coat", "all") if COATS else ())):
        for _ in range(COUNT):
            material = random_principled(random, kind)
            shaders.append(principled_shader(material))
            expected.append(layers.principled(material, cosine))
            kinds.append(kind)
    for multiscatter in (True, False, True, False):
        color, tint, roughness = random.random(3), random.random(3), random.uniform(0.1, 1.0)
        options, inputs = distribution(multiscatter), {"Color": color, "Roughness": roughness}
        shaders.append(furnace.shader("ShaderNodeBsdfGlossy", options, inputs))
        expected.append(layers.glossy(color, roughness, cosine, multiscatter))
        kinds.append("glossy")
        if hasattr(bpy.types, "ShaderNodeBsdfMetallic"):  # since 4.3
            options = {**options, "fresnel_type": "F82"}
            inputs = {"Base Color": color, "Edge Tint": tint, "Roughness": roughness}
            shaders.append(furnace.shader("ShaderNodeBsdfMetallic", options, inputs))
            expected.append(layers.metal(color, tint, roughness, cosine, multiscatter))
            kinds.append("metallic")
    rendered = furnace.white_furnace(shaders, cosine, SAMPLES)
    errors = np.abs(np.array(expected) / rendered - 1.0).max(1)
    for kind in dict.fromkeys(kinds):  # of the largest errors, noise is the most
        own = errors[[index for index, each in enumerate(kinds) if each == kind]]
        assert np.median(own) < 0.005, f"{kind}: {own}"
        assert own.max() < 0.025, f"{kind}: {own}"


def random_directions(random: np.random.Generator) -> np.ndarray:
    directions = random.normal(size=(5, 3))
    directions[:, 2] = 0.1 + np.abs(directions[:, 2])
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("cosine", [0.999, 0.3, 0.03])
def test_lobes_are_those_of_cycles(cosine):
    """GGX and sheen, by light from single directions, at any roughness."""
    random = np.random.default_rng(1)
    directions, roughness = random_directions(random), random.uniform(0.2, 1.0, COUNT)
    rough = [{"Roughness": each, "Color": np.ones(3)} for each in roughness]
    glossy = [furnace.shader("ShaderNodeBsdfGlossy", distribution(False), inputs) for inputs in rough]
    rest = [furnace.shader("ShaderNodeBsdfSheen", {}, inputs) for inputs in rough]
    rendered = furnace.under_suns([*glossy, *rest], cosine, directions)[..., 0]
    expected = ggx.evaluate(ggx.direction(np.array(cosine)), directions[:, None], roughness**2)
    assert rendered[:, :COUNT] == pytest.approx(expected, rel=1e-3)
    sheens = rendered[:, COUNT:].T
    expected = sheen.evaluate(lookup.sheen_ltc(roughness, np.full(COUNT, cosine)), directions)
    assert sheens == pytest.approx(expected, rel=2e-3, abs=1e-6)
