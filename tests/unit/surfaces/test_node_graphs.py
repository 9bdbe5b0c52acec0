# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials with graphs in the G-buffer: each pixel is drawn by the program of its own graph, and by no other."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Image
from ism_addon.shading.builder import Builder, Value, constant
from ism_addon.shading.operations import OPERATIONS, Operation
from tests.scenes.parts.tables import materials_of
from tests.support.small_scenes import draw, light, make_scene, quad, view_from_above

from .test_gbuffer import gbuffer

SIZE = 30, 10
FLAT = (0.25, 0.5, 0.125)


def position_graph(scale=1.0):
    """Red is x, scaled."""
    builder = Builder()
    position = builder.call("vector_scale", builder.call("geometry_position"), constant(scale))
    color = builder.call("combine_xyz", builder.call("separate_x", position), constant(0.5), constant(0.0))
    return finished(builder, color)


def image_graph():
    """Image 0 at a quarter of the coordinates."""
    builder = Builder()
    vector = builder.call("vector_scale", builder.call("uv_map"), constant(0.25))
    return finished(builder, builder.call("color_of", builder.call("image_closest", Value("image"), vector)))


def bumpy_graph():
    """A slope of 1 in x."""
    builder = Builder()
    position, one = builder.call("geometry_position"), constant(1.0)
    normal = builder.call("geometry_normal")
    bump = builder.call("bump", one, one, builder.call("separate_x", position), position, normal, constant(0.1))
    return builder.finish([builder.call("closure_diffuse", constant((0.5, 0.5, 0.5)), bump)])


def finished(builder, color):
    closure = builder.call("closure_diffuse", color, builder.call("geometry_normal"))
    return builder.finish([closure])


def scene_of(graphs):
    """A square for each material from x = -1.5 on: of a graph and its constants, or for None of a plain color."""
    squares = [
        replace(
            quad((k - 1.5, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 2.0, 0.0)),
            materials=np.full(2, k, np.uint32),
            uvs=np.float32([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]]),
        )
        for k in range(len(graphs))
    ]
    unique = tuple(dict.fromkeys(each[0] for each in graphs if each is not None))
    rows = [np.zeros((0, 4)) if each is None else each[1] for each in graphs]
    first = np.cumsum([0, *map(len, rows)])[:-1]
    materials = replace(
        materials_of([FLAT] * len(graphs)),
        graph=np.array([-1 if each is None else unique.index(each[0]) for each in graphs], np.int32),
        first_constant=np.where([len(each) > 0 for each in rows], first, -1).astype(np.int32),
        constants=np.concatenate(rows).astype(np.float32),
    )
    texels = np.zeros((4, 4, 4), np.uint8)
    texels[..., 3] = 255
    texels[0, 0] = 255, 0, 255, 255
    return replace(make_scene(squares, light()), materials=materials, graphs=unique, images=(Image(texels),))


def base_color(device, graphs):
    """(10,30,3), with a third of the width for each of three squares."""
    ours = gbuffer(device, scene_of(graphs), view_from_above(3.0, SIZE))
    return ours["base_color"][:, :3].reshape(SIZE[1], SIZE[0], 3)


def test_graphs_and_plain_colors_side_by_side(device):
    together = base_color(device, [position_graph(), None, image_graph()])
    for k, alone in enumerate((position_graph(), None, image_graph())):
        columns = slice(10 * k + 1, 10 * k + 9)
        assert np.array_equal(together[:, columns], base_color(device, [alone] * 3)[:, columns])
    x = (np.arange(1, 9) + 0.5) / 10.0 - 1.5
    assert np.allclose(together[:, 1:9, 0], np.maximum(x, 0.0), atol=1e-4)
    assert np.allclose(together[:, 11:19], FLAT, atol=1e-4)
    assert np.allclose(together[:, 21:29], (1.0, 0.0, 1.0), atol=1e-4)


def test_all_pixels_are_drawn_where_the_background_is_visible(device):
    view = view_from_above(9.0, SIZE)
    several = gbuffer(device, scene_of([position_graph(), None, image_graph()]), view)
    plain = gbuffer(device, scene_of([None] * 3), view)
    for name in ("depth", "position", "primitive"):
        assert np.array_equal(several[name], plain[name]), name


def test_bumps_change_the_shading_normal_alone(device):
    ours, flat = (gbuffer(device, scene_of([each] * 3), view_from_above(2.0, SIZE)) for each in (bumpy_graph(), None))
    assert np.array_equal(ours["normal"][:, 2:], flat["normal"][:, 2:])
    octahedron = np.array([-0.5, 0.0])  # of the direction (-1, 0, 1)
    assert np.allclose(ours["normal"][:, :2], octahedron, atol=1e-3)


def test_other_constants_compile_nothing(device):
    view = view_from_above(3.0, SIZE)
    first = draw(device, scene_of([None, image_graph(), position_graph(0.5)]), view)
    before, color = set(device.programs), first.color.copy()
    second = draw(device, scene_of([None, image_graph(), position_graph(0.75)]), view, renderer=first.renderer)
    assert set(device.programs) == before
    assert not np.array_equal(color, second.color)


def test_the_tiles_of_graphs_are_found_only_if_there_are_several(device):
    view = view_from_above(3.0, SIZE)
    for graphs, drawn in (([None] * 3, 0), ([position_graph()] * 3, 0), ([position_graph(), None, None], 1)):
        rows = draw(device, scene_of(graphs), view).profile.rows
        assert rows["FindGraphs"].drawn == drawn
        assert rows["UploadAttributes"].drawn == 0


def test_a_graph_that_does_not_compile_is_drawn_in_one_color(device, monkeypatch):
    monkeypatch.setitem(OPERATIONS, "no_such_function", Operation((), "vec3", "arithmetic"))
    builder = Builder()
    broken = finished(builder, builder.call("no_such_function"))
    drawn = draw(device, scene_of([broken, position_graph(), broken]), view_from_above(3.0, SIZE))
    color = gbuffer(device, scene_of([broken, position_graph(), broken]), view_from_above(3.0, SIZE))["base_color"]
    color = color[:, :3].reshape(SIZE[1], SIZE[0], 3)
    assert np.allclose(color[:, 1:9], FLAT, atol=1e-4) and np.allclose(color[:, 21:29], FLAT, atol=1e-4)
    assert np.allclose(color[:, 11:19, 1], 0.5, atol=1e-4)
    (warning,) = drawn.profile.warnings
    assert "cannot compile the nodes of 2 materials" in warning


@pytest.mark.parametrize("count", [40])
def test_more_graphs_than_bits(device, count):
    """40 graphs in narrow strips: each has its own color."""
    graphs = []
    for k in range(count):
        builder = Builder(simplify=False)
        color = constant((0.0, 0.0, 0.0))
        position = builder.call("geometry_true_normal")
        for _ in range(k + 1):
            color = builder.call("vector_add", color, builder.call("vector_scale", position, constant(1.0 / count)))
        graphs.append(finished(builder, color))
    scene = scene_of(graphs)
    view = view_from_above(float(count), (4 * count, 8))
    view = replace(
        view,
        view_from_world=view.view_from_world
        @ np.array(
            [[1.0, 0.0, 0.0, 1.5 - count / 2.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
        ),
    )
    blue = gbuffer(device, scene, view)["base_color"][:, 2].reshape(8, 4 * count)[4, 2::4]
    assert np.allclose(blue, (np.arange(count) + 1.0) / count, atol=1e-3)


def test_images_are_filtered_in_colors_but_not_in_bumps(device):
    builder = Builder()
    image = builder.call(
        "image_linear", Value("image"), builder.call("vector_scale", builder.call("uv_map"), constant(64.0))
    )
    color = builder.call("color_of", image)
    position, one = builder.call("geometry_position"), constant(1.0)
    height = builder.call("separate_x", color)
    bump = builder.call("bump", one, one, height, position, builder.call("geometry_normal"), constant(0.1))
    graph = builder.finish([builder.call("closure_diffuse", color, bump)])
    ours = gbuffer(device, scene_of([graph] * 3), view_from_above(3.0, SIZE))
    assert ours["base_color"][:, 0].std() < 0.01
    assert ours["normal"][:, 0].std() > 0.1


def coated_graph(coated):
    """A diffuse surface below a dielectric, and if it is coated, below a coat."""
    builder = Builder()
    weight, normal = builder.call("geometry_true_normal"), builder.call("geometry_normal")
    ior, roughness, white = constant(1.5), constant(0.3), constant((1.0, 1.0, 1.0))
    lobes = [
        builder.call("closure_diffuse", weight, normal),
        builder.call("closure_dielectric", weight, ior, constant(0.5), white, roughness, normal, parameter=0),
    ]
    if coated:
        lobes.append(builder.call("closure_coat", weight, ior, roughness, normal, parameter=0))
    return builder.finish(lobes)


def test_layers_have_programs_of_the_graphs_that_have_any(device):
    """Where one of 27 graphs has a coat, one program more is compiled for it, and one for what has none."""
    device.forget_programs()
    scene = scene_of([coated_graph(True), coated_graph(False), None])
    drawn = draw(device, scene, view_from_above(3.0, SIZE))
    programs = [dict(each.constants) for each in device.programs if "passes/surfaces/gbuffer.frag" in each.sources]
    assert sorted((each["layers"], each["graph"], each["coat"]) for each in programs) == [
        *((0, 0, 0), (0, 1, 0), (0, 1, 1)),
        *((1, 0, 1), (1, 1, 1)),
    ]
    coat = drawn.target("coat").reshape(SIZE[1], SIZE[0], 4)
    assert coat[:, 1:9].any() and not coat[:, 11:].any()


def overflow(builder, minus_itself):
    """Infinite where x is not 0; or what is no number."""
    value = builder.call("vector_scale", builder.call("geometry_position"), constant(3e38))
    value = builder.call("vector_scale", value, constant(3e38))
    return builder.call("vector_subtract", value, value) if minus_itself else value


def broken_graph(what, minus_itself):
    """A graph of diffuse and metallic closures, of which the color, the roughness or the normal is no number."""
    builder = Builder(simplify=False)
    broken, white, normal = overflow(builder, minus_itself), constant((1.0, 1.0, 1.0)), builder.call("geometry_normal")
    color, roughness = constant((0.5, 0.5, 0.5)), constant(0.3)
    if what == "color":
        color = broken
    elif what == "roughness":
        roughness = builder.call("separate_x", broken)
    else:
        normal = broken
    metal = builder.call("closure_metal", white, color, white, roughness, normal, parameter=1)
    return builder.finish([builder.call("closure_diffuse", color, normal), metal])


@pytest.mark.parametrize("minus_itself", [False, True])
@pytest.mark.parametrize("what", ["color", "roughness", "normal"])
def test_what_is_no_number_does_not_spread(device, what, minus_itself):
    """Such a color is black. Neighbors of the surface look as if it were black, and all targets are finite."""
    view = view_from_above(3.0, SIZE)
    broken = draw(device, scene_of([broken_graph(what, minus_itself), position_graph(), None]), view)
    whole = draw(device, scene_of([position_graph(), position_graph(), None]), view)
    assert np.isfinite(broken.color).all()
    assert np.array_equal(broken.color[:, 11:], whole.color[:, 11:])
    for name in ("base_color", "normal", "position"):
        assert np.isfinite(broken.target(name)).all(), name
    if what == "color":
        assert not broken.target("base_color")[:, 1:9, :3].max() > 0.0
