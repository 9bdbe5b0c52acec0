# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules of the code: which modules may import which, names of passes and shaders, and what files may contain."""

import ast
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.tools import project

ADDON = project.ROOT / "ism_addon"
ROOT_MODULE = ADDON / "__init__.py"
MODULES = sorted(set(ADDON.rglob("*.py")) - {ROOT_MODULE})
PASS_ROOT = ADDON / "gpu" / "passes"
#: Modules of passes, and modules that several passes of a folder share.
PASSES = sorted(path for path in PASS_ROOT.glob("*/*.py") if path.stem != "__init__")
SHADERS = sorted(path for path in ADDON.rglob("*") if path.suffix in {".frag", ".vert", ".glsl"})
PASS_SHADERS = [path for path in SHADERS if path.is_relative_to(PASS_ROOT)]
#: Vertex shaders that passes share, and the method of Pass that uses each: for all pixels, some tiles, or instances.
COMMON = {
    "full_screen.vert": "full_screen_program",
    "tiles.vert": "tile_source",
    "instances.vert": "instance_program",
}
#: Shaders that are named after a part of their pass, and that pass.
INTERNAL_SHADERS = {"pull": "fill_holes", "push": "fill_holes"}
#: Limit of the files in a folder.
MAX_FILES = 14
SOURCES = [name for name in project.files() if Path(name).suffix in {".py", ".frag", ".vert", ".geom", ".glsl"}]
#: Folders of the product's and the tests' sources.
FOLDERS = sorted({Path(name).parent.as_posix() for name in SOURCES if name.startswith(("ism_addon/", "tests/"))})
PURE = (
    "atomic_files",
    "color",
    "half_floats",
    "shading",
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
    "resource_types",
    "resources",
)


@dataclass(frozen=True)
class Layer:
    """What modules may import besides the standard library: modules of ism_addon, packages, and why no more."""

    ours: tuple[str, ...]
    packages: tuple[str, ...]
    reason: str


BLENDER_PACKAGES = ("bpy", "bpy_extras", "bl_operators", "bl_ui", "mathutils", "gpu", "gpu_extras")
LAYERS = {
    **dict.fromkeys(
        PURE, Layer(PURE, ("numpy",), "the method's data and mathematics must be testable without Blender and OpenGL")
    ),
    "gpu": Layer((*PURE, "gpu"), ("numpy", "moderngl"), "the pipeline must run without Blender, on a snapshot alone"),
    "blender": Layer(
        (*PURE, "blender", "gpu.jobs.job", "gpu.jobs.render_thread"),
        ("numpy", *BLENDER_PACKAGES),
        "the worker's thread owns OpenGL: in Blender's main thread our calls would land in Blender's own context",
    ),
    "ui": Layer(
        (
            *("atomic_files", "choices", "old_names", "settings", "render_passes", "resources", "resource_types"),
            *("scene.limits", "ui"),
        ),
        BLENDER_PACKAGES,
        "panels must show, and tests of them run, without OpenGL",
    ),
    "presets": Layer((), ("bpy",), "Blender runs them as scripts, which belong to no package"),
    "addon": Layer(("blender", "ui"), ("bpy",), "it only registers and unregisters the others"),
}


def module_name(module: Path) -> str:
    """The dotted name below ism_addon. That of an __init__.py is the package's."""
    parts = module.relative_to(ADDON).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def find_imports(module: Path) -> list[tuple[int, str]]:
    """(line, name) of each import. Names of our modules begin with a dot and are relative to ism_addon.

    Imports that only type checkers follow are left out.
    """
    package = module.relative_to(ADDON).parts[:-1]
    found, tree = [], ast.parse(module.read_text("utf-8"))
    type_checking = [
        node for node in ast.walk(tree) if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
    ]
    skipped = {id(node) for branch in type_checking for part in branch.body for node in ast.walk(part)}
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.append((node.lineno, node.module or ""))
        elif isinstance(node, ast.ImportFrom):
            parts = [*package[: len(package) + 1 - node.level], *(node.module or "").split(".")]
            base = "".join(f".{part}" for part in parts if part)
            # `from package import name` may mean a module or something that the package defines.
            found += [(node.lineno, f"{base}.{alias.name}" if is_package(base) else base) for alias in node.names]
    return found


def is_package(name: str) -> bool:
    return (ADDON.joinpath(*name.split(".")) / "__init__.py").exists()


def is_allowed(name: str, layer: Layer) -> bool:
    if name.startswith("."):
        return any(f"{name}.".startswith(f".{ours}.") for ours in layer.ours)
    top = name.split(".")[0]
    return top in sys.stdlib_module_names or top in layer.packages


def test_the_root_module_imports_nothing():
    assert find_imports(ROOT_MODULE) == [], "importing one module must not import others"


@pytest.mark.parametrize("module", MODULES, ids=module_name)
def test_a_module_imports_only_what_its_layer_may(module):
    layer = LAYERS[module_name(module).split(".")[0]]
    for line, name in find_imports(module):
        assert name.split(".")[0] != "ism_addon", f"{module.name}:{line}: as an extension our package has another name"
        assert is_allowed(name, layer), f"{module.relative_to(project.ROOT)}:{line} imports {name}, but {layer.reason}"


@pytest.mark.parametrize("path", PASSES, ids=module_name)
def test_passes_never_import_one_another(path):
    for line, imported in find_imports(path):
        other = re.fullmatch(r"\.gpu\.passes\.(\w+)\.(\w+)(\..*)?", imported)
        assert other is None or not defines_a_pass(PASS_ROOT / other[1] / f"{other[2]}.py"), (
            f"{path.name}:{line} imports {imported}, but passes must share only targets: else none can be left out"
        )


def defines_a_pass(path: Path) -> bool:
    return "(Pass):" in path.read_text("utf-8")


@pytest.mark.parametrize("path", PASSES, ids=module_name)
def test_a_pass_that_draws_has_a_shader_of_its_name_beside_it(path):
    source = path.read_text("utf-8")
    methods = *COMMON.values(), "tile_program"
    draws = any(f".{method}(" in source for method in methods) or "compile_program(" in source
    assert draws == any(belongs(shader, path) for shader in PASS_SHADERS)


@pytest.mark.parametrize("shader", COMMON)
def test_each_common_vertex_shader_has_its_method(shader):
    tree = ast.parse((ADDON / "gpu" / "frame.py").read_text("utf-8"))
    methods = {node.name: ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
    assert [name for name, body in methods.items() if f"'glsl/{shader}'" in body] == [COMMON[shader]]


@pytest.mark.parametrize("shader", PASS_SHADERS, ids=lambda path: path.name)
def test_a_shader_has_the_name_of_its_pass(shader):
    assert any(belongs(shader, path) for path in PASSES), f"no pass beside it is called {shader.stem}"


def belongs(shader: Path, path: Path) -> bool:
    """resolve_neighbours.frag belongs to resolve.py beside it."""
    name = INTERNAL_SHADERS.get(shader.stem, shader.stem)
    return shader.parent == path.parent and (name == path.stem or name.startswith(f"{path.stem}_"))


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_holds_few_files(folder):
    files = [path for path in (project.ROOT / folder).iterdir() if path.is_file() and path.name != "__init__.py"]
    assert len(files) <= MAX_FILES


@pytest.mark.parametrize("folder", [folder for folder in FOLDERS if folder.startswith("tests/unit/")])
def test_folders_of_unit_tests_are_named_like_the_tested_folders(folder):
    """For example, tests/unit/film tests ism_addon/gpu/passes/film."""
    assert any(path.is_dir() for path in ADDON.rglob(Path(folder).name))


BLENDER, OPENGL = ("bpy", "mathutils"), ("moderngl", "glcontext")


@pytest.mark.parametrize(
    ("module", "names"),
    [
        ("ism_addon.gpu", BLENDER + OPENGL),
        ("ism_addon.gpu.jobs.render_thread", BLENDER + OPENGL),
        ("tests.benchmark.gpu", BLENDER),
    ],
)
def test_the_pipeline_starts_without_blender_and_opengl(module, names):
    """A benchmark of it needs OpenGL, and machines with a graphics card may not have Blender."""
    script = f"import sys, {module}; print([name for name in {names} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", script], cwd=project.ROOT, capture_output=True, text=True)
    assert (run.stdout.strip(), run.stderr) == ("[]", "")


@pytest.mark.parametrize("name", [name for name in SOURCES if name.endswith(".py")])
def test_the_first_line_names_the_licence(name):
    first = (project.ROOT / name).read_text("utf-8").partition("\n")[0]
    assert first == "# SPDX-License-Identifier: GPL-3.0-or-later"


@pytest.mark.parametrize("name", SOURCES)
def test_a_file_is_short(name):
    lines = (project.ROOT / name).read_text("utf-8").count("\n")
    assert lines <= 300, f"{name} has {lines} lines: split it by subject"


@pytest.mark.parametrize("shader", SHADERS, ids=lambda path: path.name)
def test_shaders_are_ascii(shader):
    """Drivers need not accept other characters, not even in comments."""
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
    assert not found, "paths and addresses of one machine must not be in the project"
