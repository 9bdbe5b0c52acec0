# SPDX-License-Identifier: GPL-3.0-or-later
"""Graphs are simplified when they are built, and have no constants."""

import numpy as np
import pytest

import ism_addon.shading  # noqa: F401 # registers the operations
from ism_addon.shading.builder import Builder, Value, constant
from ism_addon.shading.node_graph import NUMBERS, Instruction, Location, NodeGraph

IMAGE = Value("image", constant=3.0)


def texture(builder, scale=(1.0, 1.0, 1.0)):
    """The colour of an image at scaled coordinates."""
    place = builder.call("vector_multiply", builder.call("uv_map"), constant(scale))
    return builder.call("color_of", builder.call("image_linear", IMAGE, place))


def operations(graph):
    return [each.operation for each in graph.instructions]


def test_operations_of_constants_are_folded():
    builder = Builder()
    result = builder.call("blend_mix", constant(0.25), constant((1.0, 2.0, 3.0)), constant((5.0, 2.0, -1.0)))
    assert result.is_constant and np.allclose(result.constant, (2.0, 2.0, 2.0))
    assert builder.call("math_divide", constant(1.0), constant(0.0)).constant == 0.0
    assert builder.call("math_logarithm", constant(float("nan")), constant(2.0)).constant == 0.0


@pytest.mark.parametrize("factor", [0.0, 1.0])
def test_what_a_mix_leaves_out_is_left_out(factor):
    builder = Builder()
    color = builder.call("blend_mix", constant(factor), texture(builder), constant((0.5, 0.5, 0.5)))
    assert color.equals(0.5) if factor else operations(finished(builder, color)) == TEXTURE


TEXTURE = ["uv_map", "image_linear", "color_of", "geometry_normal", "closure_diffuse"]


def closure(builder, color):
    return builder.call("closure_diffuse", color, builder.call("geometry_normal"))


def finished(builder, color):
    return builder.finish([closure(builder, color)])[0]


def test_factors_of_one_and_zero():
    builder = Builder()
    assert operations(finished(builder, texture(builder))) == TEXTURE
    assert builder.call("vector_scale", texture(builder), constant(0.0)).equals(0.0)
    place = builder.call("uv_map")
    assert builder.call("vector_add", place, constant((0.0, 0.0, 0.0))) == place


def test_without_simplification_the_graph_is_the_same_for_all_constants():
    graphs = set()
    for scale, factor in ((1.0, 0.0), (2.0, 1.0), (0.0, 0.5)):
        builder = Builder(simplify=False)
        color = builder.call("blend_mix", constant(factor), texture(builder, [scale] * 3), constant([factor] * 3))
        graphs.add(finished(builder, color))
    assert len(graphs) == 1


def test_materials_that_differ_in_constants_share_a_graph():
    graphs, numbers = [], []
    for scale in ((2.0, 3.0, 1.0), (2.0, 2.0, 2.0)):
        builder = Builder()
        graph, constants = builder.finish([closure(builder, texture(builder, scale))])
        graphs.append(graph)
        numbers.append(constants)
    assert graphs[0] == graphs[1] and hash(graphs[0]) == hash(graphs[1])
    assert numbers[0].dtype == np.float32 and not np.array_equal(*numbers)
    place = graphs[0].locations[graphs[0].constants.index("image")]
    assert numbers[0][place.row, place.first] == 3.0


def test_equal_operations_are_shared_unless_they_have_constants():
    builder = Builder()
    assert builder.call("uv_map") == builder.call("uv_map")
    assert builder.call("uv_map", parameter=1) != builder.call("uv_map")
    place = builder.call("uv_map")
    one, other = (builder.call("vector_scale", place, constant(3.0)) for _ in range(2))
    assert one != other, "each may be changed"
    assert builder.call("vector_add", one, other) == builder.call("vector_add", one, other)


def test_numbers_fill_the_rows_of_vectors():
    graph = NodeGraph((), ("float", "vec3", "float", "vec4", "float", "table", "float", "image"))
    expected = (
        Location(0, 0),
        Location(1, 0),
        Location(1, 3),
        Location(2, 0),
        Location(0, 1),
        Location(3, 0),
        Location(0, 2),
        Location(0, 3),
    )
    assert graph.locations == expected
    assert graph.rows == 3 + NUMBERS["table"] // 4
    assert NodeGraph((), ()).rows == 0


def test_a_substitute_is_reported_only_where_it_is_used():
    builder = Builder()
    value = builder.substitute(constant(0.25), "one is not known")
    unused = builder.call("mix_float", constant(0.0), constant(1.0), value)
    assert unused.equals(1.0)
    used = builder.call("math_add", value, value)
    assert builder.notes([used, value]) == ["one is not known"] and builder.notes([unused]) == []
    color = builder.call("grey", used)
    graph, constants = builder.finish([closure(builder, color)])
    assert operations(graph) == ["math_add", "grey", "geometry_normal", "closure_diffuse"]
    assert sorted(constants.ravel()[:3].tolist()) == [0.0, 0.25, 0.25]


def test_the_estimate_of_a_value():
    builder = Builder()
    color = builder.call("vector_scale", texture(builder), constant(0.5))
    estimate = builder.estimate(color, lambda name, _: np.full(4, 0.5) if name == "image_linear" else np.zeros(3))
    assert np.allclose(estimate, 0.25)


@pytest.mark.parametrize(
    ("instruction", "fault"),
    [
        (Instruction("no_such", ()), "not known"),
        (Instruction("math_add", (-1,)), "operands"),
        (Instruction("math_add", (-1, -3)), "operands"),
        (Instruction("math_add", (-1, 0)), "operands"),
        (Instruction("grey", (-2,)), "operands"),
    ],
)
def test_graphs_that_cannot_be_are_refused(instruction, fault):
    with pytest.raises(ValueError, match=fault):
        NodeGraph((instruction,), ("float", "vec3"))
