# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme point lights, spots and suns over a floor with a ball or triangles, for comparisons with Cycles."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ism_addon.scene import Lights, LightShape, Scene, View
from tests.scenes.small import basis, sphere, subdivided_box
from tests.support.small_scenes import join_lights, light, look_at, make_scene, quad, random_triangles

VIEW = look_at((3.0, -3.6, 2.6), size=(64, 48))
FLOOR = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
BALL = sphere((0.0, 0.0, 0.7), 0.5, 48, 24)
CLOSED_BOX = subdivided_box((-0.4, -1.2, 2.6), (2.0, 0.0, 3.8), 2)
ABOVE = (0.8, -0.6, 3.2)


def over_floor(lights: Lights, *things: object) -> tuple[Scene, View]:
    """The floor and things, by default the ball, in this light."""
    return make_scene([FLOOR, *(things or (BALL,))], lights), VIEW


def point(radius: float, position: tuple[float, float, float] = ABOVE, **more: object) -> Lights:
    return light(LightShape.POINT, position, radiance=5.0, radius=radius, **more)


def spot(angle: float, blend: float, radius: float = 0.0, scale: float = 1.0, height: float = 3.2) -> Lights:
    """A spot that shines at the middle of the floor; `scale`: of the width of its cone."""
    position = height / 3.2 * np.array(ABOVE)
    right, up, forward = basis(np.array([0.0, 0.0, 0.1]) - position)
    made = light(LightShape.SPOT, position, scale * right, up, 20.0, angle, radius=radius, blend=blend)
    return replace(made, normal=forward[None])


def sun(angle: float, elevation: float = 70.0) -> Lights:
    """A sun at this elevation, in degrees."""
    tilt = math.radians(90.0 - elevation)
    return light(LightShape.SUN, axis_v=(0.0, -math.cos(tilt), math.sin(tilt)), radiance=3.0, spread=angle)


def without_shadow(lights: Lights) -> Lights:
    return replace(lights, casts_shadow=np.zeros(len(lights.shape), bool))


TRIANGLES = random_triangles(60, 0.6)
MIXED = join_lights(
    join_lights(point(0.1), spot(0.7, 0.3, 0.1)), join_lights(sun(0.1), light(position=(-1.0, 0.3, 2.0)))
)

CASES: dict[str, Callable[[], tuple[Scene, View]]] = {
    **{f"a point of {radius:g} m": partial(over_floor, point(radius)) for radius in (0.0, 1e-3, 0.05, 0.6)},
    "a point of 0.6 m with soft falloff": partial(over_floor, point(0.6, soft_falloff=True)),
    "a point over triangles": partial(over_floor, point(0.2), TRIANGLES),
    "a point ten centimetres above the floor": partial(over_floor, point(0.0, (0.9, -0.6, 0.1))),
    "a sphere that almost touches the floor": partial(over_floor, point(0.3, (0.9, -0.6, 0.301))),
    "a sphere around all things": partial(over_floor, point(9.0)),
    "a point in a closed box": partial(over_floor, join_lights(point(0.1), point(0.2, (-1.5, 1.0, 2.0))), CLOSED_BOX),
    "a point that nothing shadows": partial(over_floor, without_shadow(point(0.1))),
    **{f"a spot of {angle:g}, hard": partial(over_floor, spot(angle, 0.0)) for angle in (0.1, 0.5, 3.1)},
    **{f"a spot of {angle:g} that fades": partial(over_floor, spot(angle, 1.0)) for angle in (0.5, 3.1)},
    "a spot of 0.3 m": partial(over_floor, spot(0.6, 0.4, 0.3)),
    "an elliptical spot": partial(over_floor, spot(0.6, 0.4, 0.0, 2.0)),
    "an elliptical spot of 0.2 m": partial(over_floor, spot(0.6, 0.4, 0.2, 0.5)),
    "a spot near the ball": partial(over_floor, spot(1.2, 0.2, 0.05, 1.0, 1.3), TRIANGLES),
    **{f"a sun of {angle:g}": partial(over_floor, sun(angle)) for angle in (0.0, 0.0092, 0.5, 2.5, math.pi)},
    "a sun over triangles": partial(over_floor, sun(0.05), TRIANGLES),
    **{f"a low sun of {angle:g}": partial(over_floor, sun(angle, 3.0), TRIANGLES) for angle in (0.0, 0.0092, 0.5)},
    "a sun that nothing shadows": partial(over_floor, without_shadow(sun(0.1))),
    "lights of all types": partial(over_floor, MIXED, TRIANGLES),
}
