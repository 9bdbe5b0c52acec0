# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of glossy lobes, in one buffer texture `lobe_tables`: see glsl/materials/lobe_tables.glsl.

`python -m tests.tables` makes lobe_tables.npz, which holds, by roughness r (α = r²) and cosine of the view:

ltc          (32,32,4)   Linearly transformed cosines of GGX without Fresnel. By r and √(1 - cosine): see tests/tables.
albedo       (32,32)     Directional albedo E of GGX without Fresnel, single scattering
mean_albedo  (32,)       Cosine-weighted mean of E
dielectric   (16,16,16)  s of a dielectric's albedo mix(F0, F90, s). The last index is √√F0, of the IOR
schlick      (16,16)     s of the albedo with Schlick's Fresnel, mix(F0, 1, s)
glass        (16,16,16)  Directional albedo of a dielectric with what it transmits, single scattering
mean_glass   (16,16)     Its cosine-weighted mean, by r and √√F0
sheen        (32,32,3)   The transformed cosine of Cycles' sheen: a, b of [[a,0,b],[0,a,0],[0,0,1]], and its albedo R

All but `ltc` are on the grids of Cycles' tables and interpolated linearly as there, with the same errors. So pictures
agree within .1 %, also where these tables differ from the lobe's integrals: E by up to .09 (r .1, cosine .01) and s by
up to .05, but for cosines above .15 by less than .004 (Schlick's .006). Cycles 4.2 to 5.2 have the same tables.
tests/tables/layers.py says how Cycles computes layers from them.
"""

import functools
from pathlib import Path

import numpy as np

from ..gl.shader_compiler import GENERATED, Constants

FILE = Path(__file__).with_name("lobe_tables.npz")


@functools.cache
def tables() -> dict[str, np.ndarray]:
    """The tables by name, float32."""
    with np.load(FILE) as file:
        return dict(file)


@functools.cache
def row_groups() -> dict[str, np.ndarray]:
    """(N,4) float32 rows of the buffer texture by the name of their first row in GLSL."""
    by_name = tables()
    dielectric = by_name["dielectric"]
    # A row has the values of two neighbouring indices of refraction, Schlick's, and glass's of the first of these.
    pairs = np.stack([dielectric[..., :-1], dielectric[..., 1:]], -1).transpose(2, 0, 1, 3)
    schlick = np.broadcast_to(by_name["schlick"][..., None], (*pairs.shape[:-1], 1))
    glass = by_name["glass"][..., :-1, None].transpose(2, 0, 1, 3)
    columns = {
        "LTC_ROWS": by_name["ltc"],
        "ALBEDO_ROWS": np.concatenate([by_name["sheen"], by_name["albedo"][..., None]], -1),
        "MEAN_ALBEDO_ROWS": by_name["mean_albedo"][..., None],
        "SHAPE_ROWS": np.concatenate([pairs, schlick, glass], -1),
        "MEAN_GLASS_ROWS": by_name["mean_glass"][..., None],
    }
    rows = {name: each.reshape(-1, each.shape[-1]) for name, each in columns.items()}
    return {name: np.pad(each, ((0, 0), (0, 4 - each.shape[1]))) for name, each in rows.items()}


def texture_rows() -> np.ndarray:
    """(N,4) float32: the buffer texture's contents."""
    return np.concatenate(list(row_groups().values()))


def layout(_constants: Constants) -> str:
    """The generated file materials/lobe_table_layout.glsl: first rows and sizes of the tables."""
    lines, first = [], 0
    for name, rows in row_groups().items():
        lines.append(f"const int {name} = {first};")
        first += len(rows)
    sizes = {"LTC_SIZE": "ltc", "ALBEDO_SIZE": "albedo", "SHAPE_SIZE": "dielectric"}
    return "\n".join([*lines, *(f"const int {size} = {len(tables()[name])};" for size, name in sizes.items())])


GENERATED["materials/lobe_table_layout.glsl"] = layout
