# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that the world lights, alone or with lights."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ism_addon.scene import LightShape, Mesh, Scene, View, World
from ism_addon.settings import Settings
from tests.scenes.small import subdivided_box
from tests.stress.pictures.moves import transformed
from tests.support.small_scenes import light, make_scene, quad, random_triangles

from .meshes import VIEW, ball, blades, on_floor, wires

COLOR = np.array([0.3, 0.5, 0.9], np.float32)
#: A room without a ceiling: deep, so that little of the world is seen from its floor.
WALLS = [
    quad((-1, -1, 0), (2, 0, 0), (0, 0, 1.5)),
    quad((-1, 1, 0), (2, 0, 0), (0, 0, 1.5)),
    quad((-1, -1, 0), (0, 2, 0), (0, 0, 1.5)),
    quad((1, -1, 0), (0, 2, 0), (0, 0, 1.5)),
]


def in_a_world(case: tuple[Scene, View], keeps_lights: bool = False) -> tuple[Scene, View]:
    """A case, without its lights if it does not keep them."""
    scene, view = case
    lights = scene.lights if keeps_lights else scene.lights.select(slice(0))
    return replace(scene, lights=lights, world=World.even(COLOR)), view


def of(*meshes: Mesh) -> tuple[Scene, View]:
    """Meshes on a floor."""
    return in_a_world(on_floor(*meshes))


def scaled(factor: float, offset: float) -> tuple[Scene, View]:
    """A ball, scaled and moved, and its view with it."""
    scene, view, _ = transformed((*of(ball(24)), Settings()), factor * np.eye(3), np.full(3, offset))
    return scene, view


CASES: dict[str, Callable[[], tuple[Scene, View]]] = {
    "the world over a ball": partial(of, ball(24)),
    "the world over a ball of few faces": partial(of, ball(6)),
    "the world over boxes": partial(of, subdivided_box((-0.6, -0.5, 0.0), (0.2, 0.3, 0.9), 1)),
    "the world over triangles": partial(of, random_triangles(40, 0.4)),
    "the world over wires": lambda: in_a_world(wires(0.05)),
    "the world over blades": lambda: in_a_world(blades(0.02)),
    "the world in a room without a ceiling": partial(of, *WALLS),
    "the world below": lambda: in_a_world((make_scene([quad((-1, -1, 0.5), (0, 2, 0), (2, 0, 0)), ball(24)]), VIEW)),
    "the world over a millimetre": partial(scaled, 1e-3, 0.0),
    "the world over a kilometre": partial(scaled, 1e3, 0.0),
    "the world far away": partial(scaled, 1.0, 1e4),
    "the world and a light": lambda: in_a_world(on_floor(ball(24)), keeps_lights=True),
    "the world and a sun": lambda: in_a_world(
        on_floor(ball(24), lights=light(LightShape.SUN, spread=0.02, radiance=2.0)), keeps_lights=True
    ),
}
