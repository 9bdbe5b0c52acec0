# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutation test: puts one error at a time into the product, prints which test fails: python -m tests.tools.mutations

Each mutation is made in a temporary copy of the files, where the tests that should notice it run until one fails. With
--all, all tests run if none of those fails. An exit status of 1 means that a mutation survived.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from . import project

SOURCES = {".py", ".frag", ".vert", ".glsl"}


class Mutation(NamedTuple):
    """A text that the package contains once, in any file, its replacement, and the test files that should notice it."""

    about: str
    old: str
    new: str
    tests: tuple[str, ...]  # names of files in any folder


MUTATIONS = (
    Mutation(
        "a Lambertian surface reflects pi times its light",
        "(INVERSE_PI * irradiance)",
        "irradiance",
        ("test_light_types", "test_picture"),
    ),
    Mutation(
        "shadow rays are weighed without the receiver's cosine",
        "(INVERSE_PI * max(dot(surface.normal, wi), 0.0))",
        "INVERSE_PI",
        ("test_trace_shadows", "test_ray_sampling"),
    ),
    Mutation("Lambert's edge sum has the other sign", "? sum : -sum", "? -sum : sum", ("test_irradiance",)),
    Mutation(
        "an ellipse is lit by its diameters as if they were semi-axes",
        "ellipse_irradiance(centre, 0.5 * u, 0.5 * v",
        "ellipse_irradiance(centre, u, v",
        ("test_irradiance", "test_picture"),
    ),
    Mutation(
        "samples of an area light are uniform in the coordinates of chords, which their density does not say",
        "uv.y = sample_linear(weights, uv.y);",
        "",
        ("test_light_interface",),
    ),
    Mutation(
        "a rare shadow ray counts no more than a frequent one",
        "direct_residual.rgb += correction / rate;",
        "direct_residual.rgb += correction;",
        ("test_trace_shadows", "test_picture"),
    ),
    Mutation(
        "the last light is not drawn",
        "for light in frame[CONTRIBUTING_LIGHTS]:",
        "for light in frame[CONTRIBUTING_LIGHTS][:-1]:",
        ("test_trace_shadows", "test_picture"),
    ),
    Mutation(
        "lights are culled that bring as much as all others",
        "culled > MAX_CULLED_FRACTION * local",
        "culled > local",
        ("test_cull_lights", "test_shortcuts"),
    ),
    Mutation(
        "the bound of a light forgets how large it is",
        "slack = radius + self.radius",
        "slack = radius",
        ("test_cull_lights", "test_shortcuts"),
    ),
    Mutation(
        "tiles are one off",
        "strip * int(gl_FragCoord.y) + int(gl_FragCoord.x);",
        "strip * int(gl_FragCoord.y) + int(gl_FragCoord.x) + 1;",
        ("test_cull_lights", "test_select_tiles", "test_predict_visibility"),
    ),
    Mutation(
        "another world leaves the picture as it was",
        "*(Change.WORLD, Change.VIEW),",
        "*(Change.VIEW,),",
        ("test_edits", "test_reuse"),
    ),
    Mutation(
        "instances that moved are seen where they were",
        "inputs = MESH_BUFFERS, INSTANCE_BUFFERS, POINT_GRAPHS",
        "inputs = MESH_BUFFERS, POINT_GRAPHS",
        ("test_edits", "test_reuse"),
    ),
    Mutation(
        "pixels at a tile's border do not care how rare the tile beside them is",
        ".y / fetch(tile_probabilities, ivec2(tile)).x",
        ".y",
        ("test_accumulate", "test_select_tiles"),
    ),
    Mutation(
        "watts become radiance without pi",
        "/ (np.pi * area)",
        "/ area",
        ("test_radiometry", "test_lights"),
    ),
    Mutation(
        "a spread is taken for its half",
        "half = np.maximum(np.asarray(spread, np.float64), MIN_SPREAD) / 2.0",
        "half = np.maximum(np.asarray(spread, np.float64), MIN_SPREAD) / 4.0",
        ("test_radiometry", "test_irradiance"),
    ),
    Mutation(
        "lights stand in world space among surfaces in anchor space",
        'table["position"] = lights.position - anchor',
        'table["position"] = lights.position',
        ("test_odd_pictures", "test_spread_shadows"),
    ),
    Mutation(
        "normals are turned as positions are",
        "normalize(cofactor * smooth_normal)",
        "normalize(linear * smooth_normal)",
        ("test_gbuffer",),
    ),
    Mutation(
        "sRGB texels are taken for linear ones", "SRGB_BYTES ? linear", "SRGB_BYTES ? stored.rgb", ("test_images",)
    ),
    Mutation(
        "graphs read other constants",
        "differentials, material.first_constant)",
        "differentials, 0)",
        ("test_node_graphs",),
    ),
    Mutation("graphs draw other tiles", "uint(graph + 1 & 31);", "uint(graph + 2 & 31);", ("test_node_graphs",)),
    Mutation(
        "a box that is partly out of the picture is culled",
        "planes[..., 3] + np.einsum",
        "planes[..., 3] - np.einsum",
        ("test_frustum_culling", "test_gbuffer"),
    ),
    Mutation(
        "a chosen point does not stand for those that were not chosen",
        "np.sqrt(cloud.area / np.pi / probabilities[selected])",
        "np.sqrt(cloud.area / np.pi)",
        ("test_select_points", "test_splat"),
    ),
    Mutation(
        "a disc at a map's horizon is dropped where rounding takes its centre out of the map",
        "clamp(square_from_hemisphere(d), -1.0, 1.0)",
        "square_from_hemisphere(d)",
        ("test_splat",),
    ),
    Mutation("glass tints nothing", "DST_COLOR, moderngl.ZERO", "ZERO, moderngl.ONE", ("test_transparency",)),
    Mutation(
        "a transparent film is opaque",
        "mix(opaque, 1.0, film)",
        "1.0",
        ("test_shade", "test_engine"),
    ),
    Mutation(
        "the shadow bias pushes inwards",
        "v += n * (bias * texel_angle",
        "v -= n * (bias * texel_angle",
        ("test_gather", "test_picture"),
    ),
    Mutation(
        "outlines in shadow maps grow as holes are filled",
        "hole && coverage > 0.5",
        "hole && coverage > 0.0",
        ("test_fill_holes",),
    ),
    Mutation(
        "ambient occlusion looks twice as far as its radius",
        "direction * radius * sqrt(c.z)",
        "direction * 2.0 * radius * sqrt(c.z)",
        ("test_ambient_occlusion",),
    ),
    Mutation(
        "what lies behind a light throws a shadow",
        "if (hit.distance < end && next != ignored)",
        "if (hit.distance < 2.0 && next != ignored)",
        ("test_build_bvh", "test_trace_shadows"),
    ),
    Mutation(
        "edges of lamps are filtered to the wrong side",
        "vec2 offset = vec2(x, y) + visibility_texel_and_offset.zw",
        "vec2 offset = vec2(x, y) - visibility_texel_and_offset.zw",
        ("test_filter_emission",),
    ),
    Mutation(
        "a faint light's turns are rarer than they count",
        "unshadowed_diffuse(surface, light, irradiance, color) / tile_probability",
        "unshadowed_diffuse(surface, light, irradiance, color)",
        ("test_faint_lights",),
    ),
    Mutation(
        "renders with a large error have no more than the requested samples",
        "return MAX_REFINEMENT * quality.samples if expected > sufficient",
        "return quality.samples if expected > sufficient",
        ("test_ends",),
    ),
    Mutation(
        "the visibility of many lights is predicted anew however few draws follow",
        "return self.excess_lights == 1.0 or ",
        "return self.excess_lights >= 1.0 or ",
        ("test_select_tiles",),
    ),
)


def source_file(mutation: Mutation, root: Path) -> Path:
    """The file of the package that contains the mutation's text. Raises ValueError unless it is there exactly once."""
    files = [path for path in sorted((root / "ism_addon").rglob("*")) if path.suffix in SOURCES]
    counts = {path: path.read_text("utf-8").count(mutation.old) for path in files}
    found = [path for path, count in counts.items() if count]
    if sum(counts.values()) != 1:
        raise ValueError(f"{mutation.old!r} is {sum(counts.values())} times in the package, in {found}")
    return found[0]


def test_files(names: tuple[str, ...], root: Path) -> list[str]:
    """Paths of test files, from the root. Raises ValueError if one of them does not exist."""
    found = {name: sorted((root / "tests").rglob(f"{name}.py")) for name in names}
    missing = [name for name, paths in found.items() if not paths]
    if missing:
        raise ValueError(f"no tests are called {', '.join(missing)}")
    return [str(path.relative_to(root)) for paths in found.values() for path in paths]


def first_failure(tests: list[str], root: Path, seconds: float) -> str:
    """The first test that fails; "" if none does within that many seconds.

    No bytecode is written: Python takes it for current if a source has the same size and second of change.
    """
    command = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "--tb=line", "-p", "no:cacheprovider", *tests]
    try:
        result = subprocess.run(command, cwd=root, capture_output=True, text=True, errors="replace", timeout=seconds)
    except subprocess.TimeoutExpired:
        return ""
    if result.returncode == 0:
        return ""
    failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", result.stdout, re.M)
    return failed[1] if failed else f"pytest ended with {result.returncode}"


def detecting_test(mutation: Mutation, root: Path, everything: bool, seconds: float) -> str:
    """Make a mutation, run tests, and undo it: the test that fails; "" if none does.

    Raises ValueError if that test also fails without the mutation.
    """
    path = source_file(mutation, root)
    original = path.read_bytes()
    path.write_bytes(original.replace(mutation.old.encode(), mutation.new.encode()))
    try:
        failed = first_failure(test_files(mutation.tests, root), root, seconds)
        failed = failed or (first_failure(["tests"], root, 20.0 * seconds) if everything else "")
    finally:
        path.write_bytes(original)
    if failed and first_failure([failed], root, seconds):
        raise ValueError(f"{failed} fails without a mutation")
    return failed


def run(mutations: dict[int, Mutation], root: Path, everything: bool, seconds: float) -> int:
    """Print a table with a row for each mutation: the number that survived. Raises what `detecting_test` raises."""
    survived = 0
    print("| # | what breaks | where | noticed by |\n|---|---|---|---|", flush=True)
    for number, mutation in mutations.items():
        where = source_file(mutation, root).relative_to(root / "ism_addon")
        noticed = detecting_test(mutation, root, everything, seconds)
        survived += not noticed
        print(f"| {number} | {mutation.about} | {where} | {noticed or '**nobody**'} |", flush=True)
    return survived


def main() -> int:
    """Exit status: 1 if a mutation survived."""
    line = argparse.ArgumentParser(prog="python -m tests.tools.mutations", description=__doc__.partition("\n")[0])
    line.add_argument("numbers", nargs="*", type=int, help="of the mutations, from 1; all if none is given")
    line.add_argument("--all", action="store_true", help="run all tests where those that should notice do not")
    line.add_argument("--seconds", type=float, default=600.0, help="for the tests of one mutation (%(default)s)")
    options = line.parse_args()
    numbers = options.numbers or range(1, len(MUTATIONS) + 1)
    chosen = {number: MUTATIONS[number - 1] for number in numbers}
    with tempfile.TemporaryDirectory() as folder:
        for name in project.files():
            (Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(project.ROOT / name, Path(folder) / name)
        return int(run(chosen, Path(folder), options.all, options.seconds) > 0)


if __name__ == "__main__":
    sys.exit(main())
