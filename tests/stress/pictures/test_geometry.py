# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme geometry: thin, huge, coincident or closed meshes, and lights and cameras that lie in or on them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Lights, LightShape, Mesh, Scene, View
from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.small import basis, mesh, sphere, subdivided_box
from tests.stress.pictures.comparisons import relative_difference, without_shadows
from tests.stress.pictures.test_closed_forms import BRDF, UP, visible_strip
from tests.stress.pictures.test_similar import rotation
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
LIGHT = light(position=(0.8, -0.6, 3.2), radiance=5.0)
VIEW = look_at((3.0, -3.6, 2.6), size=(96, 64))
BALL = sphere((0.3, 0.2, 0.7), 0.5, 48, 32)


def shining_at_origin(position: np.ndarray, size: float, radiance: float) -> Lights:
    """A square light at a position (3,) that faces the origin; its size is in m."""
    right, up, forward = basis(-position)
    area_light = light(position=position, axis_u=size * right, axis_v=size * up, radiance=radiance)
    return replace(area_light, normal=forward[None])


def slivers(count: int) -> Mesh:
    """The floor as triangles from one side to the other, 4 m long and 4 / count m wide."""
    ends = np.linspace(-2.0, 2.0, count + 1)
    rows = np.arange(count)
    sides = [np.column_stack([np.full_like(ends, -2.0), ends]), np.column_stack([np.full_like(ends, 2.0), ends])]
    points = np.pad(np.concatenate(sides), ((0, 0), (0, 1)))
    left, right = rows, rows + count + 1
    triangles = np.concatenate([np.stack([left, right, right + 1], 1), np.stack([left, right + 1, left + 1], 1)])
    return mesh(points, triangles)


@pytest.mark.parametrize("linear", [np.eye(3), rotation((1.0, 2.0, 3.0), 0.4)], ids=["level", "tilted"])
@pytest.mark.parametrize("count", [100, 10_000])
def test_a_floor_of_slivers(device, assert_within, count, linear):
    """A floor of triangles 4 m long and down to 0.4 mm wide looks like one of two triangles."""
    matrices = [transform(linear)] * 2
    view = look_at((3.0, -3.6, 2.6), size=(96, 64), field_of_view=math.radians(20.0))  # the floor fills the view
    plain, thin = (
        draw(device, make_scene([floor, BALL], LIGHT, matrices), view).color for floor in (FLOOR, slivers(count))
    )
    assert_within(relative_difference(thin, plain), 1e-3)


@pytest.mark.parametrize("width", [1e-4, 1e-5, 1e-6])
def test_a_sliver_of_aspect_1e7(device, assert_within, width):
    """A triangle 10 m long, 0.3 m above the floor, hardly changes the picture."""
    needle = mesh(np.array([[-5.0, 0.1, 0.3], [5.0, 0.1, 0.3], [5.0, 0.1 + width, 0.3]]), np.array([[0, 1, 2]]))
    plain, thin = (
        draw(device, make_scene(meshes, LIGHT), VIEW, SETTINGS).color for meshes in ([FLOOR], [FLOOR, needle])
    )
    assert_within(relative_difference(thin, plain), 2e-2)


@pytest.mark.parametrize("distance", [0.5, 5.0])
def test_huge_triangles_beside_tiny_ones(device, assert_within, distance):
    """Triangles of 1 mm over a floor of 1,000 km or of 100 m: the light illuminates nothing farther away."""
    cloud, size = random_triangles(3000, 0.1 * distance, 1e-3), 0.2 * distance
    area_light = light(position=(0.16 * distance, 0.0, 0.6 * distance))
    area_light = replace(area_light, axis_u=size * area_light.axis_u, axis_v=size * area_light.axis_v)
    pictures = []
    for side in (1e2, 1e6):
        floor = quad((-side / 2, -side / 2, -0.1 * distance), (side, 0, 0), (0, side, 0))
        view = look_at(distance * np.array([0.6, -0.7, 0.3]), size=(96, 64))
        pictures.append(draw(device, make_scene([floor, cloud], area_light), view, SETTINGS).color)
    assert_within(relative_difference(*pictures), 2e-3)


@pytest.mark.parametrize("linear", [np.eye(3), rotation((1.0, 2.0, 3.0), 0.4)], ids=["level", "tilted"])
def test_coincident_faces(device, assert_within, linear):
    """Two coincident floors do not shadow each other."""
    second_floor = slivers(7)
    matrices = [transform(linear)] * 3
    one = draw(device, make_scene([FLOOR, BALL], LIGHT, matrices[:2]), VIEW, SETTINGS).color
    two = draw(device, make_scene([FLOOR, BALL, second_floor], LIGHT, matrices), VIEW, SETTINGS).color
    assert_within(relative_difference(two, one), 1e-3)


#: Both methods, and the fraction of light that may leak: shadow maps have holes and wide texels.
BOTH_METHODS = pytest.mark.parametrize(
    ("settings", "max_leak"),
    [(SETTINGS, 1e-9), (with_quality(SMALL_SHADOW_MAPS, virtual_lights=48, map_size=128, map_points=16384), 0.2)],
    ids=["rays", "maps"],
)


def leaked_fraction(device, scene: Scene, view: View, settings: Settings) -> float:
    """The fraction of the unshadowed light that arrives in spite of the shadows."""
    shadowed, unshadowed = (
        draw(device, each, view, settings).color[..., :3].mean() for each in (scene, without_shadows(scene))
    )
    return float(shadowed / unshadowed)


def box(low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    return subdivided_box(low, high, 3)


def test_a_light_in_the_plane_of_a_wall(device, assert_within):
    """A light in the plane of a floor that shines upwards is not shadowed by the floor."""
    area_light = light(axis_v=(0.0, 1.0, 0.0), position=(0.3, 0.2, 0.0), radiance=5.0)
    roof = quad((-2, -2, 1.5), (4, 0, 0), (0, 4, 0))
    view = look_at((3.0, -3.6, 0.7), (0.0, 0.0, 0.8), size=(96, 64))
    scene = make_scene([FLOOR, roof], area_light)
    assert_within(
        relative_difference(
            draw(device, scene, view, SETTINGS).color, draw(device, without_shadows(scene), view, SETTINGS).color
        ),
        1e-3,
    )


@BOTH_METHODS
def test_a_light_in_a_closed_box(device, assert_within, settings, max_leak):
    """No light leaves the box."""
    scene = make_scene([FLOOR, box((-0.4, -1.2, 2.6), (2.0, 0.0, 3.8))], LIGHT)
    assert_within(leaked_fraction(device, scene, VIEW, settings), max_leak)


@pytest.mark.parametrize("shape", [LightShape.POINT, LightShape.RECTANGLE], ids=["point", "rectangle"])
@pytest.mark.parametrize("around", [16, 200, 850])
def test_no_ray_passes_between_the_triangles_of_a_ball(device, around, shape):
    """A light in a ball of up to 360,000 triangles, tilted so that nothing is aligned."""
    ball = sphere((0.0, 0.0, 0.0), 1.0, around, around // 4)
    matrices = np.array([transform(), transform(rotation((1.0, 2.0, 3.0), 0.4), (0.0, 0.0, 2.0))])
    one = light(shape, (0.1, 0.03, 2.0), (0.3, 0.0, 0.0), (0.0, -0.3, 0.0))
    scene = make_scene([quad((-8, -8, 0), (16, 0, 0), (0, 16, 0)), ball], one, matrices)
    view = view_from_above(12.0, (400, 400), height=0.5)
    assert not draw(device, scene, view, SETTINGS).color[..., :3].any()


def test_a_light_that_a_box_cuts(device, assert_within):
    """A box encloses one half of a light: the other half illuminates the floor."""
    area_light = light(position=(0.0, 0.0, 2.0), radiance=5.0)
    half = box((-1.0, -1.0, 1.9), (0.0, 1.0, 2.1))
    scene = replace(make_scene([FLOOR, half], area_light))
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view = view_from_above(0.6, (24, 24), height=1.5)
    # The box reaches 0.1 m below the light: from points at x < 0 its rim hides a little of the other half too.
    picture = draw(device, scene, view, with_quality(SETTINGS, samples=128)).color[..., 0]
    positions = ((np.arange(24) + 0.5) / 24 - 0.5) * 0.6
    truth = np.zeros((24, 24))
    for row, column in np.ndindex(truth.shape):
        x, y = positions[column], positions[row]
        hidden = max(-x * 0.1 / 1.9, 0.0)  # by the rim at z = 1.9
        fraction = 0.5 - hidden
        truth[row, column] = (
            5.0 * BRDF * reference_irradiance.irradiance(np.array([x, y, 0.0]), UP, visible_strip(area_light, fraction))
        )
    assert_within(float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean()), 1e-2)


@pytest.mark.parametrize("height", [0.0, 1e-6, 1e-3])
def test_a_light_on_a_box(device, assert_within, height):
    """A light on the top of a box, or just above it, illuminates only the top."""
    area_light = light(position=(0.0, 0.0, 0.5 + height), radiance=5.0, axis_u=(0.4, 0, 0), axis_v=(0, -0.4, 0))
    scene = make_scene([FLOOR, box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.5))], area_light)
    drawn = draw(device, scene, VIEW, SETTINGS)
    below_top = drawn.target("position")[..., 2] < drawn.target("position")[..., 2].max() - 0.05
    assert_within(float(drawn.color[..., :3][below_top].max() / 5.0), 1e-3)


def test_a_camera_in_a_closed_room(device, assert_within):
    """The room has no light inside: it is black, whatever lights are outside."""
    scene = make_scene(
        [box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)), FLOOR], join_lights(LIGHT, light(position=(0.0, 0.0, 8.0)))
    )
    picture = draw(device, scene, look_at((0.3, -0.7, 0.6), size=(64, 48)), SETTINGS).color
    assert_within(float(picture[..., :3].max()), 0.0)


@pytest.mark.parametrize("gap", [0.0, 1e-7])
@pytest.mark.parametrize("linear", [np.eye(3), rotation((1.0, 2.0, 3.0), 0.4), 1e3 * rotation((2.0, 1.0, 0.5), 1.0)])
@BOTH_METHODS
def test_a_room_of_six_walls_does_not_leak(device, assert_within, linear, gap, settings, max_leak):
    """Boxes that meet at their edges, or have gaps of float32's rounding, with lights on all sides."""
    thick, walls = 0.1, []
    for axis in range(3):
        for side in (-1.0, 1.0):
            low, high = np.full(3, -1.0 - thick), np.full(3, 1.0 + thick)
            low[axis], high[axis] = sorted([side * (1.0 + gap), side * (1.0 + thick)])
            for other in range(axis):  # walls of earlier axes cover the edges
                low[other], high[other] = -1.0, 1.0
            walls.append(subdivided_box(low, high, 1))
    lights = None
    scale = float(np.cbrt(np.linalg.det(linear)))
    for direction in np.concatenate([np.eye(3), -np.eye(3)]) + (0.1, 0.2, 0.3):
        area_light = shining_at_origin(linear @ (3.0 * direction), scale, 50.0)
        lights = area_light if lights is None else join_lights(lights, area_light)
    view = look_at(linear @ (0.7, -0.8, 0.6), linear @ (-0.5, 0.4, -0.3), (64, 48), math.radians(90.0))
    clip = view.clip_from_view.copy()
    clip[2, 3] *= scale
    scene = make_scene(walls, lights, [transform(linear)] * 6)
    assert_within(leaked_fraction(device, scene, replace(view, clip_from_view=clip), settings), max_leak)


@pytest.mark.parametrize("width", [1e-2, 1e-3, 1e-4])
def test_the_shadow_of_a_wire(device, assert_within, width):
    """However thin a wire is, the floor loses in total as much light as the wire blocks."""
    area_light = light(position=(0.0, 0.0, 2.0), axis_u=(0.2, 0, 0), axis_v=(0, -0.2, 0), radiance=5.0)
    wire = quad((-0.5 * width, -5.0, 0.2), (width, 0, 0), (0, 10.0, 0))
    scene = make_scene([quad((-9, -9, 0), (18, 0, 0), (0, 18, 0)), wire], area_light)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view, settings = view_from_above(0.4, (64, 64)), with_quality(SMALL_SETTINGS, samples=256)
    unshadowed = draw(device, without_shadows(scene), view, SMALL_SETTINGS).color[..., 0]  # without noise
    missing = (unshadowed - draw(device, scene, view, settings).color[..., 0]).sum() / unshadowed.sum()
    assert_within(abs(float(missing) - width / 0.9 / 0.4), 1e-3)


@pytest.mark.parametrize("degrees", [1.0, 0.1, 0.01])
def test_a_grazing_receiver(device, assert_within, degrees):
    """A floor that is illuminated at a grazing angle does not shadow itself."""
    angle = math.radians(degrees)
    area_light = shining_at_origin(5.0 * np.array([math.cos(angle), 0.0, math.sin(angle)]), 0.02, 1e6)
    scene, view = make_scene([slivers(50)], area_light), view_from_above(2.0, (48, 48))
    shadowed, unshadowed = (draw(device, each, view, SETTINGS).color for each in (scene, without_shadows(scene)))
    # Cards round what is left of the closed form differently with shadows. A shadow removes a sixteenth or more.
    assert_within(abs(float(shadowed[..., :3].mean() / unshadowed[..., :3].mean()) - 1.0), 1e-3)
    assert_within(float((1.0 - shadowed[..., :3] / unshadowed[..., :3]).max()), 0.03)


@pytest.mark.parametrize("samples", [64, 256])
def test_shadows_on_what_is_smaller_than_a_pixel(device, assert_within, samples):
    """Boxes a third of a pixel wide, half of them in a shadow, are as bright as in a picture eight times as fine."""
    centres = np.random.default_rng(3).uniform(-0.8, 0.8, (120, 3))
    boxes = [subdivided_box(tuple(centre - 0.03), tuple(centre + 0.03), 1) for centre in centres]
    shade = subdivided_box((-0.8, -0.8, 1.4), (0.0, 0.8, 1.5), 1)
    scene = make_scene([shade, *boxes], light(LightShape.POINT, (0.0, 0.0, 6.0), radius=0.02, radiance=100.0))
    view, fine_view = (look_at((0.9, -2.2, 1.6), size=(side * 4, side * 3), filter_width=1.5) for side in (8, 64))
    coarse = draw(device, scene, view, with_quality(SETTINGS, samples=samples)).color[..., :3].mean()
    fine = draw(device, scene, fine_view, with_quality(SETTINGS, samples=8)).color[..., :3].mean()
    assert_within(abs(float(coarse / fine) - 1.0), 0.02)


@pytest.mark.parametrize("segments", [8, 24, 128])
def test_a_ball_does_not_shadow_itself(device, assert_within, segments):
    """A smooth sphere of few or many triangles: its terminator follows the smooth normals."""
    ball = sphere((0.0, 0.0, 0.0), 1.0, segments, segments // 2)
    area_light = shining_at_origin(np.array([3.0, -3.0, 1.0]), 0.3, 20.0)
    scene, view = make_scene([ball], area_light), look_at((0.0, -4.0, 0.5), size=(96, 64))
    shadowed, unshadowed = (draw(device, each, view, SETTINGS).color for each in (scene, without_shadows(scene)))
    assert_within(relative_difference(shadowed, unshadowed), 2e-2)


def sheets(device, distance: float, gap: float, from_behind: bool) -> tuple[np.ndarray, np.ndarray]:
    """Pictures of two parallel sheets, and of the first alone. The light is on the side of the first."""
    meshes = [quad((-9, y, -9), (18, 0, 0), (0, 0, 18)) for y in (0.0, gap)]
    area_light = light(LightShape.ELLIPSE, (3.0, -distance, 5.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), radiance=1e4)
    view = look_at((0.0, distance if from_behind else -distance, 0.1), size=(64, 48), field_of_view=math.radians(8.0))
    clip = view.clip_from_view.copy()
    clip[2, 2:] = [-(1e3 + 0.1) / (1e3 - 0.1), -2.0 * 1e3 * 0.1 / (1e3 - 0.1)]
    area_light = replace(area_light, normal=np.array([[0.0, 1.0, 0.0]]))
    view = replace(view, clip_from_view=clip)
    two, one = (draw(device, make_scene(meshes[:count], area_light), view, SETTINGS) for count in (2, 1))
    return two, one


def test_two_sheets_a_millimetre_apart(device, assert_within):
    """From 100 m away only the near sheet is visible, lit as if alone; the back of the far sheet is dark."""
    front, alone = sheets(device, 100.0, 1e-3, False)
    assert set(np.unique(front.target("primitive")[..., 0])) <= {1, 2}
    assert_within(relative_difference(front.color, alone.color), 1e-3)
    back, _ = sheets(device, 100.0, 1e-3, True)
    assert_within(float(back.color[..., :3].max() / alone.color[..., :3].mean()), 1e-6)
