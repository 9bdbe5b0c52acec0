# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme meshes, views and area lights."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ism_addon.scene import Lights, LightShape, Mesh, Scene, View
from ism_addon.settings import Settings
from tests.scenes.small import SMALL, mesh, sphere, subdivided_box
from tests.stress.pictures.moves import transformed
from tests.stress.pictures.test_geometry import LIGHT, shining_at_origin, slivers
from tests.stress.pictures.test_similar import rotation
from tests.support.small_scenes import join_lights, light, look_at, make_scene, quad, random_triangles, transform

SIZE = 64, 48
VIEW = look_at((3.0, -3.6, 2.6), size=SIZE)
FLOOR = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
LOW_LIGHT = light(position=(-1.0, 0.3, 2.0), radiance=2.0)


def on_floor(
    *meshes: Mesh, lights: Lights = LIGHT, linear: np.ndarray | None = None, floor: Mesh = FLOOR, view: View = VIEW
) -> tuple[Scene, View]:
    """Meshes on a floor, each transformed by `linear` (3,3)."""
    return make_scene([floor, *meshes], lights, [transform(), *[transform(linear) for _ in meshes]]), view


def ball(segments: int) -> Mesh:
    """A smooth sphere of `segments` quads around its axis."""
    return sphere((0.0, 0.0, 0.7), 0.5, segments, segments // 2)


def grazing_light(degrees: float) -> tuple[Scene, View]:
    """Triangles under a light at an elevation of `degrees`."""
    angle = math.radians(degrees)
    return on_floor(
        random_triangles(30, 0.3),
        lights=shining_at_origin(6.0 * np.array([math.cos(angle), 0.2, math.sin(angle)]), 0.3, 3e3),
    )


def wires(width: float) -> tuple[Scene, View]:
    """Three parallel bars of square cross-section over the floor."""
    return on_floor(*(subdivided_box((x, -1.5, 0.8), (x + width, 1.5, 0.8 + width), 1) for x in (-0.5, 0.1, 0.6)))


def blades(width: float) -> tuple[Scene, View]:
    """Forty upright triangles."""
    corners = [[(x, -0.4, 0.0), (x + width, -0.4, 0.0), (x, 0.3, 0.9)] for x in np.linspace(-1.0, 1.0, 40)]
    return on_floor(mesh(np.reshape(corners, (-1, 3)), np.arange(120).reshape(-1, 3)))


def light_of_size(size: float) -> tuple[Scene, View]:
    """A square light of this width, whose power is the same for all widths below a metre."""
    area_light = light(
        position=(0.8, -0.6, 3.2), axis_u=(size, 0, 0), axis_v=(0, -size, 0), radiance=5.0 / min(size**2, 1.0)
    )
    return on_floor(random_triangles(60, 0.6), lights=area_light)


def light_of_spread(angle: float) -> tuple[Scene, View]:
    return on_floor(ball(48), lights=replace(LIGHT, spread=np.array([angle], np.float32)))


def light_of_power(factor: float) -> tuple[Scene, View]:
    return on_floor(ball(48), lights=replace(LIGHT, emission=np.float32(factor) * LIGHT.emission))


def scaled_scene(factor: float) -> tuple[Scene, View]:
    return transformed((*SMALL["sphere in corner"](*SIZE), Settings()), factor * np.eye(3))[:2]


def box_under(lights: Lights) -> tuple[Scene, View]:
    return on_floor(subdivided_box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.5), 2), lights=lights)


def room() -> tuple[Scene, View]:
    """A lit room, with the camera inside."""
    walls = subdivided_box((-2.0, -2.0, -0.1), (2.0, 2.0, 2.5), 3)
    view = look_at((1.5, -1.6, 1.6), (0.0, 0.0, 0.6), SIZE, math.radians(80.0))
    return make_scene([walls, ball(24)], light(position=(0.3, 0.2, 2.3), radiance=5.0)), view


LONG_LIGHT = light(position=(0.2, 0.0, 2.5), axis_u=(2.0, 0, 0), axis_v=(0, -0.02, 0), radiance=100.0)
ELLIPTICAL_LIGHT = light(LightShape.ELLIPSE, (0.4, -0.5, 2.5), (1.5, 0, 0), (0, -0.2, 0), radiance=10.0)
LIGHT_ABOVE_BOX = light(position=(0.0, 0.0, 0.501), axis_u=(0.4, 0, 0), axis_v=(0, -0.4, 0), radiance=5.0)
FOUR_LIGHTS = join_lights(
    join_lights(LIGHT, LOW_LIGHT), join_lights(light(position=(1.0, 1.3, 1.0), radiance=0.5), ELLIPTICAL_LIGHT)
)
WIDE_FLOOR = quad((-500, -500, 0), (1000, 0, 0), (0, 1000, 0))
LINEAR_MAPS = {
    "mirrored": np.diag([-1.0, 1.0, 1.0]),
    "turned inside out": -np.eye(3),
    "squeezed": np.diag([1.0, 0.01, 1.0]),
    "sheared": np.array([[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
}

CASES: dict[str, Callable[[], tuple[Scene, View]]] = {
    **{name: partial(make, *SIZE) for name, make in SMALL.items()},
    **{f"a smooth ball, {segments} triangles around": partial(on_floor, ball(segments)) for segments in (6, 12, 96)},
    **{f"a ball that is {name}": partial(on_floor, ball(24), linear=linear) for name, linear in LINEAR_MAPS.items()},
    **{f"light from {degrees} degrees above the floor": partial(grazing_light, degrees) for degrees in (0.5, 3.0)},
    **{f"wires of {width} m": partial(wires, width) for width in (1e-1, 1e-2, 2e-3)},
    **{f"blades of {width} m": partial(blades, width) for width in (1e-2, 1e-3)},
    **{f"a light of {size} m": partial(light_of_size, size) for size in (1e-3, 3e-2, 5.0, 100.0)},
    **{f"a light with a spread of {angle}": partial(light_of_spread, angle) for angle in (0.2, 1.0, 2.5)},
    **{f"a light of {factor:g} times the power": partial(light_of_power, factor) for factor in (1e-6, 1e6, 1e12)},
    **{f"all things {factor:g} times as large": partial(scaled_scene, factor) for factor in (1e-4, 1e5)},
    "a light a hundred times as long as it is wide": partial(on_floor, ball(48), lights=LONG_LIGHT),
    "an ellipse of light": partial(on_floor, ball(48), lights=ELLIPTICAL_LIGHT),
    "a light that a box cuts": partial(on_floor, subdivided_box((-0.2, -1.5, 3.1), (0.8, 0.5, 3.3), 2)),
    "a light a millimetre above a box": partial(box_under, join_lights(LIGHT, LIGHT_ABOVE_BOX)),
    "a light that nothing shadows": partial(
        on_floor, ball(48), lights=join_lights(LIGHT, replace(LOW_LIGHT, casts_shadow=np.zeros(1, bool)))
    ),
    "a light in a closed box": partial(on_floor, subdivided_box((-0.4, -1.2, 2.6), (2.0, 0.0, 3.8), 2)),
    "four lights": partial(on_floor, random_triangles(80, 0.7), lights=FOUR_LIGHTS),
    "slivers of half a millimetre": partial(on_floor, slivers(8000), ball(24), linear=rotation((1.0, 2.0, 3.0), 0.05)),
    "a crowd of small triangles": partial(on_floor, random_triangles(5000, 1.0, 0.02)),
    "a kilometre of floor": partial(on_floor, ball(24), floor=WIDE_FLOOR),
    "two sheets a millimetre apart": partial(on_floor, quad((-1, -1, 1e-3), (2, 0, 0), (0, 2, 0))),
    "a camera in a room": room,
}
