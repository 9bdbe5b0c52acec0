# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that are thin, vast, doubled, cut or closed, and lights and cameras that stand in them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Lights, LightShape, Mesh, Scene, View
from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.small import basis, mesh, sphere, subdivided_box
from tests.stress.pictures.comparisons import relative_difference, unshadowed
from tests.stress.pictures.test_closed_forms import REFLECTED, UP, strip
from tests.stress.pictures.test_similar import turn
from tests.support import reference_irradiance
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    transform,
    view_from_above,
    with_quality,
)

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=64, error_threshold=0.0))
FLOOR = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
LAMP = light(position=(0.8, -0.6, 3.2), radiance=5.0)
VIEW = look_at((3.0, -3.6, 2.6), size=(96, 64))
BALL = sphere((0.3, 0.2, 0.7), 0.5, 48, 32)


def shining_at_origin(position: np.ndarray, size: float, radiance: float) -> Lights:
    """A square light."""
    right, up, forward = basis(-position)
    lamp = light(position=position, axis_u=size * right, axis_v=size * up, radiance=radiance)
    return replace(lamp, normal=forward[None])


def slivers(count: int) -> Mesh:
    """The floor as triangles from one side to the other, 4 m long and 4 / count m wide."""
    ends = np.linspace(-2.0, 2.0, count + 1)
    rows = np.arange(count)
    one, other = np.column_stack([np.full_like(ends, -2.0), ends]), np.column_stack([np.full_like(ends, 2.0), ends])
    points = np.pad(np.concatenate([one, other]), ((0, 0), (0, 1)))
    first, far = rows, rows + count + 1
    triangles = np.concatenate([np.stack([first, far, far + 1], 1), np.stack([first, far + 1, first + 1], 1)])
    return mesh(points, triangles)


@pytest.mark.parametrize("linear", [np.eye(3), turn((1.0, 2.0, 3.0), 0.4)], ids=["level", "tilted"])
@pytest.mark.parametrize("count", [100, 10_000])
def test_a_floor_of_slivers(device, within, count, linear):
    """Up to 4 m long and 0.4 mm wide."""
    matrices = [transform(linear)] * 2
    view = look_at((3.0, -3.6, 2.6), size=(96, 64), across=math.radians(20.0))  # its border is not seen
    plain, thin = (
        draw(device, make_scene([floor, BALL], LAMP, matrices), view).color for floor in (FLOOR, slivers(count))
    )
    within(relative_difference(thin, plain), 1e-3)


@pytest.mark.parametrize("width", [1e-4, 1e-5, 1e-6])
def test_a_sliver_of_aspect_1e7(device, within, width):
    """A needle 10 m long that lies on the floor changes next to nothing."""
    needle = mesh(np.array([[-5.0, 0.1, 0.3], [5.0, 0.1, 0.3], [5.0, 0.1 + width, 0.3]]), np.array([[0, 1, 2]]))
    plain, thin = (
        draw(device, make_scene(things, LAMP), VIEW, SETTINGS).color for things in ([FLOOR], [FLOOR, needle])
    )
    within(relative_difference(thin, plain), 2e-2)


@pytest.mark.parametrize("distance", [0.5, 5.0])
def test_vast_triangles_beside_tiny_ones(device, within, distance):
    """A floor of 1,000 km under a cloud of triangles of a millimetre, against one of 100 m, beyond which it is dark."""
    cloud, lamp = random_triangles(3000, 0.1 * distance, 1e-3), light(position=(0.16 * distance, 0.0, 0.6 * distance))
    lamp, pictures = replace(lamp, axis_u=0.2 * distance * lamp.axis_u, axis_v=0.2 * distance * lamp.axis_v), []
    for side in (1e2, 1e6):
        floor = quad((-side / 2, -side / 2, -0.1 * distance), (side, 0, 0), (0, side, 0))
        view = look_at(distance * np.array([0.6, -0.7, 0.3]), size=(96, 64))
        pictures.append(draw(device, make_scene([floor, cloud], lamp), view, SETTINGS).color)
    within(relative_difference(*pictures), 2e-3)


@pytest.mark.parametrize("linear", [np.eye(3), turn((1.0, 2.0, 3.0), 0.4)], ids=["level", "tilted"])
def test_faces_that_lie_on_each_other(device, within, linear):
    """Two floors at one place do not shadow each other."""
    twice = slivers(7)
    matrices = [transform(linear)] * 3
    one = draw(device, make_scene([FLOOR, BALL], LAMP, matrices[:2]), VIEW, SETTINGS).color
    two = draw(device, make_scene([FLOOR, BALL, twice], LAMP, matrices), VIEW, SETTINGS).color
    within(relative_difference(two, one), 1e-3)


#: Shadow maps have holes, and texels that are wide: of all light so much may come through.
BOTH = pytest.mark.parametrize(
    ("settings", "leak"),
    [(SETTINGS, 1e-9), (with_quality(SMALL_SHADOW_MAPS, virtual_lights=48, map_size=128, map_points=16384), 0.2)],
    ids=["rays", "maps"],
)


def leaked(device, scene: Scene, view: View, settings: Settings) -> float:
    """What part of the light comes through."""
    shaded, whole = (draw(device, each, view, settings).color[..., :3].mean() for each in (scene, unshadowed(scene)))
    return float(shaded / whole)


def box(low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    return subdivided_box(low, high, 3)


def test_a_light_in_the_plane_of_a_wall(device, within):
    """A light that lies in a floor and shines up, as if the floor were not there."""
    lamp = light(axis_v=(0.0, 1.0, 0.0), position=(0.3, 0.2, 0.0), radiance=5.0)
    roof = quad((-2, -2, 1.5), (4, 0, 0), (0, 4, 0))
    view = look_at((3.0, -3.6, 0.7), (0.0, 0.0, 0.8), size=(96, 64))
    scene = make_scene([FLOOR, roof], lamp)
    within(
        relative_difference(
            draw(device, scene, view, SETTINGS).color, draw(device, unshadowed(scene), view, SETTINGS).color
        ),
        1e-3,
    )


@BOTH
def test_a_light_in_a_closed_box(device, within, settings, leak):
    """Nothing of it comes out."""
    scene = make_scene([FLOOR, box((-0.4, -1.2, 2.6), (2.0, 0.0, 3.8))], LAMP)
    within(leaked(device, scene, VIEW, settings), leak)


def test_a_light_that_is_cut(device, within):
    """A box hides one half of it: what is left is the other half."""
    lamp = light(position=(0.0, 0.0, 2.0), radiance=5.0)
    half = box((-1.0, -1.0, 1.9), (0.0, 1.0, 2.1))
    scene = replace(make_scene([FLOOR, half], lamp))
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view = view_from_above(0.6, (24, 24), height=1.5)
    # What of the half that is left is above the box's rim, which lies below it, is hidden as well: not straight below.
    picture = draw(device, scene, view, with_quality(SETTINGS, samples=128)).color[..., 0]
    places = ((np.arange(24) + 0.5) / 24 - 0.5) * 0.6
    truth = np.zeros((24, 24))
    for row, column in np.ndindex(truth.shape):
        x, y = places[column], places[row]
        begins = max(-x * 0.1 / 1.9, 0.0)  # as the rim at z = 1.9 hides it
        part = 0.5 - begins
        truth[row, column] = (
            5.0 * REFLECTED * reference_irradiance.irradiance(np.array([x, y, 0.0]), UP, strip(lamp, part))
        )
    within(float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean()), 1e-2)


@pytest.mark.parametrize("height", [0.0, 1e-6, 1e-3])
def test_a_light_on_a_box(device, within, height):
    """It touches the box's top from below the roof, shines at it from next to nothing, and lights nothing else."""
    lamp = light(position=(0.0, 0.0, 0.5 + height), radiance=5.0, axis_u=(0.4, 0, 0), axis_v=(0, -0.4, 0))
    scene = make_scene([FLOOR, box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.5))], lamp)
    drawn = draw(device, scene, VIEW, SETTINGS)
    low = drawn.target("position")[..., 2] < drawn.target("position")[..., 2].max() - 0.05
    within(float(drawn.color[..., :3][low].max() / 5.0), 1e-3)


def test_a_camera_in_a_closed_room(device, within):
    """Without a light it is black, whatever shines outside."""
    scene = make_scene(
        [box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)), FLOOR], join_lights(LAMP, light(position=(0.0, 0.0, 8.0)))
    )
    picture = draw(device, scene, look_at((0.3, -0.7, 0.6), size=(64, 48)), SETTINGS).color
    within(float(picture[..., :3].max()), 0.0)


@pytest.mark.parametrize("gap", [0.0, 1e-7])
@pytest.mark.parametrize("linear", [np.eye(3), turn((1.0, 2.0, 3.0), 0.4), 1e3 * turn((2.0, 1.0, 0.5), 1.0)])
@BOTH
def test_a_room_of_six_walls_does_not_leak(device, within, linear, gap, settings, leak):
    """Boxes that meet at their edges, all but for a gap of float32's size, under lamps on all sides."""
    thick, walls = 0.1, []
    for axis in range(3):
        for side in (-1.0, 1.0):
            low, high = np.full(3, -1.0 - thick), np.full(3, 1.0 + thick)
            low[axis], high[axis] = sorted([side * (1.0 + gap), side * (1.0 + thick)])
            for other in range(axis):  # those before it go over the edge
                low[other], high[other] = -1.0, 1.0
            walls.append(subdivided_box(low, high, 1))
    lamps = None
    scale = float(np.cbrt(np.linalg.det(linear)))
    for way in np.concatenate([np.eye(3), -np.eye(3)]) + (0.1, 0.2, 0.3):
        lamp = shining_at_origin(linear @ (3.0 * way), scale, 50.0)
        lamps = lamp if lamps is None else join_lights(lamps, lamp)
    view = look_at(linear @ (0.7, -0.8, 0.6), linear @ (-0.5, 0.4, -0.3), (64, 48), math.radians(90.0))
    clip = view.clip_from_view.copy()
    clip[2, 3] *= scale
    scene = make_scene(walls, lamps, [transform(linear)] * 6)
    within(leaked(device, scene, replace(view, clip_from_view=clip), settings), leak)


@pytest.mark.parametrize("width", [1e-2, 1e-3, 1e-4])
def test_the_shadow_of_a_wire(device, within, width):
    """However thin, it takes from all the floor together what it hides of the light."""
    lamp = light(position=(0.0, 0.0, 2.0), axis_u=(0.2, 0, 0), axis_v=(0, -0.2, 0), radiance=5.0)
    wire = quad((-0.5 * width, -5.0, 0.2), (width, 0, 0), (0, 10.0, 0))
    scene = make_scene([quad((-9, -9, 0), (18, 0, 0), (0, 18, 0)), wire], lamp)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view, settings = view_from_above(0.4, (64, 64)), with_quality(SMALL_SETTINGS, samples=256)
    open_floor = draw(device, unshadowed(scene), view, SMALL_SETTINGS).color[..., 0]  # without noise
    missing = (open_floor - draw(device, scene, view, settings).color[..., 0]).sum() / open_floor.sum()
    within(abs(float(missing) - width / 0.9 / 0.4), 1e-3)


@pytest.mark.parametrize("degrees", [1.0, 0.1, 0.01])
def test_a_grazing_receiver(device, within, degrees):
    """A floor that the light all but misses shadows itself nowhere."""
    angle = math.radians(degrees)
    lamp = shining_at_origin(5.0 * np.array([math.cos(angle), 0.0, math.sin(angle)]), 0.02, 1e6)
    scene, view = make_scene([slivers(50)], lamp), view_from_above(2.0, (48, 48))
    shaded, whole = (draw(device, each, view, SETTINGS).color for each in (scene, unshadowed(scene)))
    within(relative_difference(shaded, whole), 1e-3)


@pytest.mark.parametrize("around", [8, 24, 128])
def test_a_ball_does_not_shadow_itself(device, within, around):
    """Smooth, of few triangles or many: where its light ends, it ends by the normals."""
    ball, lamp = (
        sphere((0.0, 0.0, 0.0), 1.0, around, around // 2),
        shining_at_origin(np.array([3.0, -3.0, 1.0]), 0.3, 20.0),
    )
    scene, view = make_scene([ball], lamp), look_at((0.0, -4.0, 0.5), size=(96, 64))
    shaded, whole = (draw(device, each, view, SETTINGS).color for each in (scene, unshadowed(scene)))
    within(relative_difference(shaded, whole), 2e-2)


def sheets(device, distance: float, apart_by: float, behind: bool) -> tuple[np.ndarray, np.ndarray]:
    """Two sheets across the view, seen from one side; and the first alone. The light is on the first one's side."""
    sheet = [quad((-9, y, -9), (18, 0, 0), (0, 0, 18)) for y in (0.0, apart_by)]
    lamp = light(LightShape.ELLIPSE, (3.0, -distance, 5.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), radiance=1e4)
    view = look_at((0.0, distance if behind else -distance, 0.1), size=(64, 48), across=math.radians(8.0))
    clip = view.clip_from_view.copy()
    clip[2, 2:] = [-(1e3 + 0.1) / (1e3 - 0.1), -2.0 * 1e3 * 0.1 / (1e3 - 0.1)]
    lamp = replace(lamp, normal=np.array([[0.0, 1.0, 0.0]]))
    view = replace(view, clip_from_view=clip)
    two, one = (draw(device, make_scene(sheet[:count], lamp), view, SETTINGS) for count in (2, 1))
    return two, one


def test_two_sheets_a_millimetre_apart(device, within):
    """A hundred metres away: the near one is seen, and lit as if alone; the far one's back is dark."""
    front, alone = sheets(device, 100.0, 1e-3, False)
    assert set(np.unique(front.target("primitive")[..., 0])) <= {1, 2}
    within(relative_difference(front.color, alone.color), 1e-3)
    back, _ = sheets(device, 100.0, 1e-3, True)
    within(float(back.color[..., :3].max() / alone.color[..., :3].mean()), 1e-6)
