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

from . import project
from .mutation_table import MUTATIONS, Mutation

SOURCES = {".py", ".frag", ".vert", ".glsl"}


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
