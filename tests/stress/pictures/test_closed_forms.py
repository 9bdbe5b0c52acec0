# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures against closed forms: unshadowed light, penumbrae, ambient occlusion in a corner, a white furnace."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial, reduce

import numpy as np
import pytest

from ism_addon.gpu.passes.film.accumulate import RELATIVE_VARIANCE
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Lights, LightShape, Scene, View
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support import reference_irradiance
from tests.support.emission import spot_attenuation
from tests.support.small_scenes import (
    AREA_SHAPES,
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)
from tests.unit.environment.test_ambient_occlusion import (
    HEMISPHERE_SSAO,
    corner,
    half_resolution_surface,
    mean_occlusion,
)

FLOOR = quad((-50, -50, 0), (100, 0, 0), (0, 100, 0))
#: Radiance over irradiance of the floor, whose base colour is 0.6.
BRDF = 0.6 / math.pi
UP = np.array([0.0, 0.0, 1.0])


def pixel_positions(width: float, pixels: int) -> np.ndarray:
    """(pixels,) m: x of the pixel centres of a picture from above, `width` m wide."""
    return ((np.arange(pixels) + 0.5) / pixels - 0.5) * width


@pytest.mark.parametrize("shape", AREA_SHAPES, ids=["rectangle", "ellipse"])
@pytest.mark.parametrize("size", [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6])
def test_irradiance_of_a_floor(device, assert_within, shape, size):
    """A floor 1 m below a light of this size, from almost a point to almost a whole sky."""
    area_light = light(shape, (0.0, 0.0, 1.0), (size, 0, 0), (0, -0.7 * size, 0), radiance=1.0 / min(size**2, 1.0))
    picture = draw(device, make_scene([FLOOR], area_light), view_from_above(4.0, (9, 1))).color[0, :, 0]
    points = np.column_stack([pixel_positions(4.0, 9), np.zeros((9, 2))])
    truth = [
        BRDF * area_light.emission[0, 0] * reference_irradiance.irradiance(point, UP, area_light) for point in points
    ]
    assert_within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


@pytest.mark.parametrize("height", [1e-6, 1e-4, 1e-2])
def test_a_light_that_almost_touches_the_floor(device, assert_within, height):
    """Points under a light at this height: it fills almost the whole hemisphere."""
    area_light = light(position=(0.0, 0.0, height))
    picture = draw(device, make_scene([FLOOR], area_light), view_from_above(0.8, (9, 1))).color[0, :, 0]
    points = np.column_stack([pixel_positions(0.8, 9), np.zeros((9, 2))])
    truth = [BRDF * reference_irradiance.irradiance(point, UP, area_light) for point in points]
    assert_within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


def visible_strip(area_light: Lights, fraction: float) -> Lights:
    """The strip of a rectangular light towards +u that has this fraction of its width."""
    offset = 0.5 * (1.0 - fraction) * area_light.axis_u
    return replace(area_light, position=area_light.position + offset, axis_u=fraction * area_light.axis_u)


@pytest.mark.parametrize(
    ("settings", "bound"),
    [
        (with_quality(SMALL_SETTINGS, samples=256), 5e-3),
        (with_quality(SMALL_SHADOW_MAPS, samples=8, virtual_lights=32, map_size=128, map_points=1 << 15), 5e-2),
    ],
    ids=["rays", "maps"],
)
def test_the_penumbra_of_a_half_plane(device, assert_within, settings, bound):
    """A half-plane midway between floor and light: the visible fraction of the light grows linearly with x."""
    area_light = light(position=(0.0, 0.0, 2.0))
    plane = quad((-4, -4, 1), (4, 0, 0), (0, 8, 0))
    scene = make_scene([quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), plane], area_light)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    picture = draw(device, scene, view_from_above(1.6, (48, 8)), settings).color[..., 0]
    truth = np.zeros((8, 48))
    for row, column in np.ndindex(truth.shape):
        x, y = pixel_positions(1.6, 48)[column], pixel_positions(1.6 / 6.0, 8)[row]
        if (fraction := float(np.clip(x + 0.5, 0.0, 1.0))) > 0.0:
            strip = visible_strip(area_light, fraction)
            truth[row, column] = BRDF * reference_irradiance.irradiance(np.array([x, y, 0.0]), UP, strip)
    assert_within(float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean()), bound)


#: Sample counts after which the error of a penumbra is checked.
SAMPLE_COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 96, 128, 256, 512, 1024, 2048)


def irradiance_past_edge(x: float, y: float, across: np.ndarray) -> float:
    """Irradiance at (x, y, 0) by a square light at z = 2 that is partly hidden by a half-plane at z = 1.

    The half-plane's edge is over the origin; `across` (2,) is perpendicular to the edge and points to its open side.
    """
    corners = [np.array(corner) for corner in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    side, visible = [corner @ across + across @ (x, y) for corner in corners], []
    for k in range(4):
        if side[k] >= 0.0:
            visible.append(corners[k])
        if (side[k] >= 0.0) != (side[k - 3] >= 0.0):
            visible.append(corners[k] + (corners[k - 3] - corners[k]) * side[k] / (side[k] - side[k - 3]))
    polygon = np.array([(*(corner - (x, y)), 2.0) for corner in visible])
    return abs(reference_irradiance.edge_sum(polygon, UP)) if len(visible) > 2 else 0.0


def square_past_edge(view: View, across: np.ndarray) -> tuple[np.ndarray, float]:
    """(H,W) irradiance of a view's pixels by a square light past the edge; and without it: see irradiance_past_edge."""
    axis = pixel_positions(1.0, view.width)
    unshadowed = reference_irradiance.irradiance(np.zeros(3), UP, light())
    return np.array([[irradiance_past_edge(x, y, across[:2]) for x in axis] for y in axis]), unshadowed


#: Nodes and weights of Gauss-Legendre quadrature on [-1, 1].
NODES, NODE_WEIGHTS = np.polynomial.legendre.leggauss(16)


def cut_cap(axis: np.ndarray, sine: float, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The part of a cap on the side of a plane to which `normal` (3,) points: directions (N,3), solid angles (N,).

    In the gnomonic projection around the cap's axis it is a disc cut by a straight line.
    """
    tangent, radius = normal - axis * (normal @ axis), sine / math.sqrt(1.0 - sine**2)
    length = float(np.linalg.norm(tangent))
    first = math.asin(float(np.clip(-(normal @ axis) / (length * radius), -1.0, 1.0)))
    half = 0.5 * (math.pi / 2.0 - first)
    angle = first + half * (NODES[:, None] + 1.0)  # along the circle, to a chord parallel to the line
    x, chord = radius * np.sin(angle), radius * np.cos(angle)
    y, areas = chord * NODES, half * chord**2 * NODE_WEIGHTS[:, None] * NODE_WEIGHTS
    directions = axis + (x * tangent[:, None, None] + y * np.cross(axis, tangent)[:, None, None]).T / length
    squares = 1.0 + x**2 + y**2
    return (directions / np.sqrt(squares.T)[..., None]).reshape(-1, 3), (areas / squares**1.5).T.ravel()


def cap_past_edge(one: Lights, view: View, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same by a sphere, a spot or a sun."""
    axis, result = pixel_positions(1.0, view.width), np.zeros((2, view.height, view.width))
    for row, column in np.ndindex(result.shape[1:]):
        point = np.array([axis[column], axis[row], 0.0])
        distance, sine, to = 1.0, math.sin(one.spread[0] / 2.0), -one.normal[0]
        if one.shape[0] != LightShape.SUN:
            distance = float(np.linalg.norm(one.position[0] - point))
            sine, to = one.radius[0] / distance, (one.position[0] - point) / distance
        past = across + UP * (across @ point)  # normal of the plane through the point and the half-plane's edge
        for which, normal in enumerate((past, -past)):
            directions, solid_angles = cut_cap(to, sine, normal)
            weight = directions[:, 2] * solid_angles / (math.pi * sine**2 * distance**2)
            if one.shape[0] == LightShape.SPOT:
                weight *= spot_attenuation(-directions, one, 0)
            result[which, row, column] = weight.sum()
    return result[0], result.sum(0)


def filtered(picture: np.ndarray, view: View) -> np.ndarray:
    """(H,W), smoothed as much as by the view's pixel filter, see film/accumulate.py: three taps along each axis."""
    side = 0.5 * view.filter_width**2 / 12.0 / RELATIVE_VARIANCE
    for _ in range(2):
        padded = np.pad(picture, ((1, 1), (0, 0)), mode="edge")
        picture = (picture + side * (padded[2:] - 2.0 * picture + padded[:-2])).T
    return picture


SPHERE = light(LightShape.POINT, radius=0.5)
SPOT = light(LightShape.SPOT, radius=0.5, spread=1.0, blend=0.5)
SUN = light(LightShape.SUN, axis_v=(0.0, -0.94, 0.34), spread=0.5)
#: By name: a light, and its irradiance of a view's pixels past an edge, and without the edge.
PENUMBRAE: dict[str, tuple[Lights, Callable[[View, np.ndarray], tuple[np.ndarray, np.ndarray | float]]]] = {
    "square": (light(), square_past_edge),
    "sphere": (SPHERE, partial(cap_past_edge, SPHERE)),
    "spot": (SPOT, partial(cap_past_edge, SPOT)),
    "sun": (SUN, partial(cap_past_edge, SUN)),
}


#: Angles of edges, side by side in one picture, and its pixels: those compared of each edge, and half of those between.
EDGES = np.radians([0.0, 33.0, 90.0])
EDGE_PIXELS, MARGIN = 40, 2


def edges(one: Lights) -> tuple[Scene, View]:
    """The light past an edge of each of these angles, and its picture from above. Each light sees its edge only.

    The compared pixels of each are 1 m wide.
    """
    pitch = (EDGE_PIXELS + 2 * MARGIN) / EDGE_PIXELS  # m
    meshes, lights = [], []
    for index, angle in enumerate(EDGES):
        offset = np.array([(index - 0.5 * (len(EDGES) - 1)) * pitch, 0.0, 0.0])
        across = np.array([math.cos(angle), math.sin(angle), 0.0])
        along = np.array([-math.sin(angle), math.cos(angle), 0.0])
        corner_of_plate = offset + UP - 4.0 * across - 4.0 * along
        meshes += [
            quad(offset - (0.5 * pitch, 0.5 * pitch, 0.0), (pitch, 0, 0), (0, pitch, 0)),
            quad(corner_of_plate, 4.0 * across, 8.0 * along),
        ]
        group = np.array([index], np.int32)
        lights.append(replace(one, position=one.position + offset, receivers=group, blockers=group))
    scene = make_scene(meshes, reduce(join_lights, lights))
    groups = (1 << np.arange(len(EDGES), dtype=np.uint32)).repeat(2)
    scene = replace(
        scene, instances=replace(scene.instances, visible=np.tile([True, False], len(EDGES)), groups=groups)
    )
    height = EDGE_PIXELS + 2 * MARGIN
    return scene, view_from_above(len(EDGES) * pitch, (len(EDGES) * height, height), filter_width=1.5)


@pytest.mark.parametrize("name", PENUMBRAE)
def test_penumbrae_converge_without_bias(device, assert_within, name):
    """The error at edges of any angle falls as that of randomised quasi-Monte Carlo, and no bias is left.

    On caps of directions samples are less even than on a square.
    """
    (one, irradiance), is_square = PENUMBRAE[name], name == "square"
    scene, view = edges(one)
    of_edge = view_from_above(1.0, (EDGE_PIXELS, EDGE_PIXELS), filter_width=1.5)
    expected = []
    for angle in EDGES:
        visible, unshadowed = irradiance(of_edge, np.array([math.cos(angle), math.sin(angle), 0.0]))
        brightest, fraction = np.max(unshadowed), visible / unshadowed
        expected.append((filtered(visible, of_edge) / brightest, (fraction > 0.02) & (fraction < 0.98), brightest))
    renderer, profile, settings = Renderer(device), Profile(), with_quality(SMALL_SETTINGS, samples=SAMPLE_COUNTS[-1])
    for sample in range(SAMPLE_COUNTS[-1]):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
        if sample + 1 in SAMPLE_COUNTS:
            pictures = np.split(renderer.picture()[..., 0], len(EDGES), 1)
            for picture, (truth, penumbra, brightest) in zip(pictures, expected, strict=True):
                compared = picture[MARGIN:-MARGIN, MARGIN:-MARGIN] / (BRDF * brightest)
                error = (compared - truth)[penumbra]
                root_mean_square = float(np.sqrt((error**2).mean()))
                assert_within(root_mean_square * (sample + 1) ** 0.65, 0.2 if is_square else 0.32)
                if sample + 1 == SAMPLE_COUNTS[-1]:
                    assert_within(root_mean_square, 0.0016)
                    assert_within(abs(float(error.mean())), 0.0003)


def occluded_by_wall(distance: np.ndarray, radius: float) -> np.ndarray:
    """Occluded fraction of the ambient occlusion samples at points `distance` m from an infinite, perpendicular wall.

    The component c of a sample's direction along the wall's normal has the density 2/pi sqrt(1-c²). A sample at the
    distance s is behind the wall if c s > distance, and s² is uniform up to radius².
    """
    c = (np.arange(20_000) + 0.5) / 20_000
    fraction = np.maximum(1.0 - (distance[:, None] / (radius * c)) ** 2, 0.0)
    return (2.0 / np.pi * np.sqrt(1.0 - c**2) * fraction).mean(1)


def test_ambient_occlusion_in_a_corner(device, assert_within):
    scene, view = corner()
    measured = mean_occlusion(device, scene, view, HEMISPHERE_SSAO)
    surface, rows = half_resolution_surface(scene, view)
    position = surface.position[rows]
    distance = np.where(position[..., 2] < 1e-6, -position[..., 1], position[..., 2])
    near = (distance < 0.6) & (distance > 0.03)
    error = measured[near] - (1.0 - occluded_by_wall(distance[near], 0.5))
    assert near.sum() > 500
    assert_within(abs(float(error.mean())), 0.015)
    assert_within(float(np.sqrt((error**2).mean())), 0.05)
    assert_within(float(np.abs(measured[distance > 0.6] - 1.0).max()), 1e-3)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("ssao", [SSAO(enabled=False), SSAO()], ids=["without", "with"])
def test_white_furnace(device, assert_within, name, ssao):
    """White meshes under a white world are as bright as the world; ambient occlusion may only darken."""
    scene, view = SMALL[name](96, 64)
    white = replace(
        make_scene(scene.meshes, world=1.0, base_color=(1.0, 1.0, 1.0)),
        instances=scene.instances,
    )
    picture = draw(device, white, view, replace(SMALL_SETTINGS, ssao=ssao)).color[..., :3]
    assert_within(float((picture - 1.0).max()), 1e-5)
    if not ssao.enabled:
        assert_within(float((1.0 - picture).max()), 1e-5)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [1, 2, 16, 64])
def test_shadows_add_no_light(device, assert_within, name, samples):
    """No pixel is brighter than with the same samples and no shadows; the bound is relative to the unshadowed mean."""
    scene, view = SMALL[name](96, 64)
    settings = replace(with_quality(SMALL_SETTINGS, samples=samples), shortcuts=False)
    unshadowed = draw(device, scene, view, replace(settings, shadow=replace(settings.shadow, enabled=False))).color
    shadowed = draw(device, scene, view, settings).color
    assert_within(float((shadowed - unshadowed)[..., :3].max() / unshadowed[..., :3].mean()), 1e-5)
