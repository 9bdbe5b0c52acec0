# SPDX-License-Identifier: GPL-3.0-or-later
"""The developer's door: sets up all that is needed, once, then shows, tests or packs the add-on.

python3 dev.py demo        renders the atrium of the report's figure 6
python3 dev.py test        ruff, mypy and all tests, with each release of bpy
python3 dev.py extension   builds the extension's zips
"""

import argparse
import sys
from pathlib import Path

if sys.version_info < (3, 11):
    sys.exit("dev.py needs Python 3.11 or newer; best is 3.11 or 3.13, which have a bpy.")

from tests.tools import extension, machine, project
from tests.tools.environments import environments

FIGURE = project.ROOT / "build" / "figure6"
NO_TESTS_CHOSEN = 5  # pytest's exit status


def demo(output: Path) -> int:
    """Render the demo's pictures."""
    return next(environments()).run("tests.demo.figure6", "--output", str(output))


def test(chosen: list[str]) -> int:
    """Run all checks, or with arguments for pytest the tests they choose."""
    default, *others = environments()
    results = {}
    if not chosen:
        results["ruff"] = default.run("ruff", "check", ".")
        results["mypy"] = default.run("mypy")
    results[default.name] = default.run("pytest", *chosen)
    for other in others:
        results[other.name] = other.run("pytest", "--override-ini=testpaths=tests/blender", *chosen)
    if chosen and set(results.values()) != {NO_TESTS_CHOSEN}:
        results = {name: 0 if result == NO_TESTS_CHOSEN else result for name, result in results.items()}
    failed = [name for name, result in results.items() if result]
    print(f"failed: {', '.join(failed)}" if failed else f"all well: {', '.join(results)}")
    return int(bool(failed))


def pack() -> int:
    """Build the extension for every platform."""
    environment = next(environments())
    for path in extension.build(environment.python, environment.extension, extension.BUILD):
        print(f"{path.relative_to(project.ROOT)}  {path.stat().st_size / 1e6:.2f} MB")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(prog="dev.py", description="Shows, tests and packs the add-on.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    verb = verbs.add_parser("demo", help="render the atrium of the report's figure 6")
    verb.add_argument("--output", type=Path, default=FIGURE, help="folder of the pictures")
    verbs.add_parser("test", help="run all checks; further arguments go to pytest, such as -k name")
    verbs.add_parser("extension", help="build and validate the extension's zips, one a platform")
    arguments, further = parser.parse_known_args()
    if further and arguments.verb != "test":
        parser.error(f"unknown: {' '.join(further)}")
    machine.prepare()
    match arguments.verb:
        case "demo":
            return demo(arguments.output.resolve())
        case "test":
            return test(further)
        case _:
            return pack()


if __name__ == "__main__":
    sys.exit(main())
