# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations in GLSL have the results of their references."""

import numpy as np
import pytest

import ism_addon.shading  # noqa: F401 # registers the operations
from ism_addon.shading.operations import OPERATIONS, evaluate
from tests.unit.shading import glsl_functions

COUNT = 400
#: Operations of constants.
NAMES = [name for name, each in OPERATIONS.items() if each.reference is not None]
#: Numbers at which operations have special cases.
SPECIAL = np.array([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0])
#: Results from which on float32's digits do not suffice.
LARGE = 1e5
SIZES = {"float": 1, "vec3": 3, "vec4": 4}


def random_operands(types, seed):
    """Numbers around 0 and 1; in a third of the rows, special ones."""
    random = np.random.default_rng(seed)
    for type_ in types:
        shape = COUNT, SIZES[type_]
        values = np.where(random.random(shape) < 0.5, random.normal(0.0, 3.0, shape), random.random(shape))
        special = random.random((COUNT, 1)) < 0.33
        yield np.where(special, random.choice(SPECIAL, shape), values).astype(np.float32).astype(np.float64)


@pytest.mark.parametrize("name", NAMES)
def test_the_shader_has_the_results_of_the_reference(device, name):
    operation = OPERATIONS[name]
    types = [type_ for type_ in operation.operands if type_ != "table"]
    operands = list(random_operands(types, len(name)))
    table = np.random.default_rng(0).random((256, 4)).astype(np.float32)
    has_table = len(types) < len(operation.operands)
    rows = [[column[k] if column.shape[1] > 1 else float(column[k, 0]) for column in operands] for k in range(COUNT)]
    tables = [table.astype(np.float64)] if has_table else []
    expected = np.array([np.ravel(evaluate(name, *tables, *row)) for row in rows])
    arguments = ["0"] * has_table + [f"a{k}" for k in range(len(types))]
    uniforms = {"graph_constants": device.buffer_from(table)} if has_table else {}
    call = f"{name}({', '.join(arguments)})"
    ours = glsl_functions.evaluate(device, f"nodes/{operation.file}.glsl", call, operands, **uniforms)
    ours = ours[:, : expected.shape[1]]
    scale = np.maximum(np.abs(expected).max(1, keepdims=True), 1.0)
    is_close = (np.abs(ours - expected) < 1e-3 * scale) | (np.abs(expected) > LARGE)
    # float32 can be on the other side of a step.
    assert is_close.all(1).mean() > 0.99, (np.array(rows, object)[~is_close.all(1)], expected[~is_close.all(1)])
