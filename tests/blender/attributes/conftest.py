# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures that add squares."""

import pytest

from .squares import OUTPUTS, SQUARE, shader_of


@pytest.fixture
def squares(empty_scene, add):
    """squares(type, names, …): objects that show outputs of attributes, one for each."""

    def build(type_, names, outputs=OUTPUTS, shader="ShaderNodeEmission"):
        built = []
        for x, name in enumerate(names):
            for y, output in enumerate(outputs):
                thing = add(f"{name} {output}", SQUARE)
                thing.location = x, y, 0.0
                thing.data.materials.append(shader_of(type_, name, output, shader))
                built.append(thing)
        return built

    return build


@pytest.fixture
def hidden(squares):
    """hidden(names): squares that show attributes of their instancers, the color alone; below the picture."""

    def build(names):
        built = squares("INSTANCER", names, ["Color"])
        for each in built:
            each.hide_render = each.hide_viewport = True
            each.location = 0.0, 0.0, 0.0
        return built

    return build
