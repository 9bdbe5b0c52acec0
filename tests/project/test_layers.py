# SPDX-License-Identifier: GPL-3.0-or-later
"""The house's laws: who may import whom and why, one name for a pass and its shaders, and what no file may hold."""

import ast
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.tools import project

ADDON = project.ROOT / "ism_addon"
MAP = ADDON / "__init__.py"
MODULES = sorted(set(ADDON.rglob("*.py")) - {MAP})
STAGES = ADDON / "gpu" / "passes"
#: Files of passes, and what several of a stage share.
PASSES = sorted(path for path in STAGES.glob("*/*.py") if path.stem != "__init__")
SHADERS = sorted(path for path in ADDON.rglob("*") if path.suffix in {".frag", ".vert", ".glsl"})
OF_PASSES = [path for path in SHADERS if path.is_relative_to(STAGES)]
#: What every pass may draw with, by a method of Pass of this name: all pixels, or the blocks that take part.
COMMON = {"full_screen.vert": "full_screen_program", "tiles.vert": "tile_program"}
#: Shaders that have the name of a step of their pass.
STEPS = {"visibility_buffer": "gbuffer", "pull": "fill_holes", "push": "fill_holes"}
#: Files of a folder, at most.
MOST_FILES = 14
SOURCES = [name for name in project.files() if Path(name).suffix in {".py", ".frag", ".vert", ".geom", ".glsl"}]
#: Those of modules and of tests.
FOLDERS = sorted({Path(name).parent.as_posix() for name in SOURCES if name.startswith(("ism_addon/", "tests/"))})
PURE = (
    "atomic_files",
    "quoting",
    "color",
    "settings",
    "render_passes",
    "setting_limits",
    "scene",
    "spaces",
    "radiometry",
    "parallel",
    "sampling",
    "choices",
    "old_names",
    "snapshot",
)


@dataclass(frozen=True)
class Floor:
    """What modules may import besides the standard library: parts of ism_addon, packages, and why no more."""

    ours: tuple[str, ...]
    packages: tuple[str, ...]
    reason: str


BLENDER_PACKAGES = ("bpy", "bpy_extras", "bl_operators", "bl_ui", "mathutils", "gpu", "gpu_extras")
FLOORS = {
    **dict.fromkeys(
        PURE, Floor(PURE, ("numpy",), "the method's data and mathematics must be testable without Blender and OpenGL")
    ),
    "gpu": Floor((*PURE, "gpu"), ("numpy", "moderngl"), "the pipeline must run without Blender, on a snapshot alone"),
    "blender": Floor(
        (*PURE, "blender", "gpu.jobs.job", "gpu.jobs.render_thread"),
        ("numpy", *BLENDER_PACKAGES),
        "the worker's thread owns OpenGL: in Blender's main thread our calls would land in Blender's own context",
    ),
    "ui": Floor(
        ("atomic_files", "choices", "old_names", "settings", "render_passes", "resources", "resource_types", "ui"),
        BLENDER_PACKAGES,
        "panels must show, and tests of them run, without OpenGL",
    ),
    "presets": Floor((), ("bpy",), "Blender runs them as scripts, which belong to no package"),
    "addon": Floor(("blender", "ui"), ("bpy",), "it is the order of registration, and how that is undone"),
}


def name_of(module: Path) -> str:
    """The dotted name below ism_addon; a package's own module is called like the package."""
    parts = module.relative_to(ADDON).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(module: Path) -> list[tuple[int, str]]:
    """(line, name) of each import: names of ours begin with a dot and are counted from ism_addon."""
    package = module.relative_to(ADDON).parts[:-1]
    found = []
    for node in ast.walk(ast.parse(module.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.append((node.lineno, node.module or ""))
        elif isinstance(node, ast.ImportFrom):
            base = [*package[: len(package) + 1 - node.level], *(node.module or "").split(".")]
            whole = "".join(f".{part}" for part in base if part)
            # `from package import name` may mean a module or something that the package defines.
            found += [(node.lineno, f"{whole}.{alias.name}" if is_package(whole) else whole) for alias in node.names]
    return found


def is_package(name: str) -> bool:
    return (ADDON.joinpath(*name.split(".")) / "__init__.py").exists()


def allowed(name: str, floor: Floor) -> bool:
    if name.startswith("."):
        return any(f"{name}.".startswith(f".{ours}.") for ours in floor.ours)
    top = name.split(".")[0]
    return top in sys.stdlib_module_names or top in floor.packages


def test_the_map_imports_nothing():
    assert imports_of(MAP) == [], "whoever imports one part must not get others with it"


@pytest.mark.parametrize("module", MODULES, ids=name_of)
def test_imports_only_what_its_floor_may(module):
    floor = FLOORS[name_of(module).split(".")[0]]
    for line, name in imports_of(module):
        assert name.split(".")[0] != "ism_addon", f"{module.name}:{line}: as an extension our package has another name"
        assert allowed(name, floor), f"{module.relative_to(project.ROOT)}:{line} imports {name}, but {floor.reason}"


@pytest.mark.parametrize("path", PASSES, ids=name_of)
def test_passes_never_import_one_another(path):
    for line, imported in imports_of(path):
        other = re.fullmatch(r"\.gpu\.passes\.(\w+)\.(\w+)(\..*)?", imported)
        assert other is None or not defines_a_pass(STAGES / other[1] / f"{other[2]}.py"), (
            f"{path.name}:{line} imports {imported}, but passes meet in targets only: else none can be left out"
        )


def defines_a_pass(path: Path) -> bool:
    return "(Pass):" in path.read_text("utf-8")


@pytest.mark.parametrize("path", PASSES, ids=name_of)
def test_a_pass_that_draws_has_a_shader_of_its_name_beside_it(path):
    source = path.read_text("utf-8")
    draws = any(f"self.{way}(" in source for way in COMMON.values()) or "compile_program(" in source
    assert draws == any(belongs(shader, path) for shader in OF_PASSES)


@pytest.mark.parametrize("shader", COMMON)
def test_a_vertex_shader_without_a_pass_is_what_passes_share(shader):
    tree = ast.parse((ADDON / "gpu" / "frame.py").read_text("utf-8"))
    ways = {node.name: ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    assert [name for name, body in ways.items() if f"'glsl/{shader}'" in body] == [COMMON[shader]]


@pytest.mark.parametrize("shader", OF_PASSES, ids=lambda path: path.name)
def test_a_shader_has_the_name_of_its_pass(shader):
    assert any(belongs(shader, path) for path in PASSES), f"no pass beside it is called {shader.stem}"


def belongs(shader: Path, path: Path) -> bool:
    """resolve_neighbours.frag belongs to resolve.py beside it."""
    name = STEPS.get(shader.stem, shader.stem)
    return shader.parent == path.parent and (name == path.stem or name.startswith(f"{path.stem}_"))


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_is_seen_at_a_glance(folder):
    files = [path for path in (project.ROOT / folder).iterdir() if path.is_file() and path.name != "__init__.py"]
    assert len(files) <= MOST_FILES


@pytest.mark.parametrize("folder", [folder for folder in FOLDERS if folder.startswith("tests/unit/")])
def test_unit_tests_lie_where_what_they_test_lies(folder):
    """By the folder's name: tests/unit/film holds tests of ism_addon/gpu/passes/film."""
    assert any(path.is_dir() for path in ADDON.rglob(Path(folder).name))


@pytest.mark.parametrize("module", ["ism_addon.gpu", "ism_addon.gpu.jobs.render_thread"])
def test_the_pipeline_starts_without_blender_and_opengl(module):
    names = ("bpy", "mathutils", "moderngl", "glcontext")
    question = f"import sys, {module}; print([name for name in {names} if name in sys.modules])"
    answer = subprocess.run([sys.executable, "-c", question], cwd=project.ROOT, capture_output=True, text=True)
    assert (answer.stdout.strip(), answer.stderr) == ("[]", "")


@pytest.mark.parametrize("name", [name for name in SOURCES if name.endswith(".py")])
def test_the_first_line_names_the_licence(name):
    first = (project.ROOT / name).read_text("utf-8").partition("\n")[0]
    assert first == "# SPDX-License-Identifier: GPL-3.0-or-later"


@pytest.mark.parametrize("name", SOURCES)
def test_a_file_holds_one_idea(name):
    lines = (project.ROOT / name).read_text("utf-8").count("\n")
    assert lines <= 300, f"{name} has {lines} lines: look for the second idea in it"


@pytest.mark.parametrize("shader", SHADERS, ids=lambda path: path.name)
def test_shaders_are_ascii(shader):
    """Drivers need not take anything else, not even in a comment."""
    assert shader.read_bytes().isascii()


FOREIGN = re.compile(
    r"://[a-z.]*(debian|pypi|pythonhosted|npmjs)\.|(^|[ \"'(=`])/(work|farm|root|home|tmp)/|\.\./shared", re.M
)


def test_no_file_names_a_registry_or_a_machine():
    found = []
    for name in project.files():
        content = (project.ROOT / name).read_bytes()
        if b"\0" not in content and (match := FOREIGN.search(content.decode("utf-8"))):
            found.append(f"{name}: {match[0].strip()}")
    assert not found, "what holds on one machine only must not be in the project"
