# SPDX-License-Identifier: GPL-3.0-or-later
"""The developer's door: sets up what is needed, once, then shows, tests or packs the add-on."""

import argparse
import sys
from pathlib import Path

if sys.version_info < (3, 11):  # noqa: UP036 - whoever has an older Python deserves a sentence
    sys.exit("dev.py needs Python 3.11 or newer; best are 3.11 and 3.13, which have a bpy.")

from tests.tools import extension, machine, project
from tests.tools.environments import environments

#: pytest's exit status for it.
NO_TEST_WAS_CHOSEN = 5


def demo(output: Path) -> int:
    """Render the demo's pictures."""
    return next(environments()).run("tests.demo.figure6", "--output", str(output.resolve()))


def test(chosen: list[str]) -> int:
    """Run all checks, or with arguments for pytest the tests that they choose."""
    default, *others = environments()
    results = {} if chosen else {"ruff": default.run("ruff", "check")}
    results[default.name] = default.run("pytest", *chosen)
    for other in others:
        results[other.name] = other.run("pytest", "--override-ini=testpaths=tests/blender", *chosen)
    idle = [name for name, result in results.items() if result == NO_TEST_WAS_CHOSEN]
    failed = [name for name, result in results.items() if result not in (0, NO_TEST_WAS_CHOSEN)]
    if len(idle) == len(results):
        failed = idle
    print(f"failed: {', '.join(failed)}" if failed else f"passed: {', '.join(results)}")
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
    verb = verbs.add_parser("demo", help="render the report's figure 6: an atrium without and with shadows")
    verb.add_argument("--output", type=Path, default=extension.BUILD / "figure6", help="folder of the pictures")
    verbs.add_parser("test", help="run all checks; further arguments go to pytest, such as -k name")
    verbs.add_parser("extension", help="build and validate the extension's zips, one a platform")
    arguments, further = parser.parse_known_args()
    if further and arguments.verb != "test":
        parser.error(f"unknown: {' '.join(further)}")
    machine.prepare()
    if arguments.verb == "demo":
        return demo(arguments.output)
    return test(further) if arguments.verb == "test" else pack()


if __name__ == "__main__":
    sys.exit(main())
