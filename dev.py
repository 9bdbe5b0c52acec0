# SPDX-License-Identifier: GPL-3.0-or-later
"""The project's command line: sets up what a command needs, once, then renders, tests, measures or packs the add-on."""

import argparse
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

if sys.version_info < (3, 11):  # noqa: UP036 - whoever has an older Python deserves a sentence
    sys.exit("dev.py needs Python 3.11 or newer; best are 3.11 and 3.13, which have a bpy.")

from tests.gui import run_scenarios
from tests.gui.scenario import scenarios
from tests.tools import blender_root, extension, machine, project
from tests.tools.environments import Environment, all_environments, environments

BUILD = project.ROOT / "build"
BLENDER_ROOT = BUILD / "blender-trixie"
GUI_RECORD = BUILD / "gui-test"
BENCHMARKS = sorted(
    path.stem
    for path in (project.ROOT / "tests/benchmark").glob("[!_]*")
    if path.suffix == ".py" or (path / "__main__.py").is_file()
)
#: Numbers of random pictures, frames of animations, and repeated renders for `stress`; `test --all` runs fewer.
STRESS_FULL = "--examples=10000", "--frames=100", "--rounds=1000"
WITHOUT_STRESS = ("--ignore=tests/stress",)
#: Static checks: names to Python modules and their arguments.
STATIC_CHECKS = {"ruff": ("ruff", "check"), "ruff's format": ("ruff", "format", "--check"), "mypy": ("mypy",)}
#: pytest's exit status if no test was selected.
NO_TEST_WAS_CHOSEN = 5
#: One test at a time for each core, at most 8 because of their memory. Mesa renders in the thread that calls it.
SIDE_BY_SIDE = "-n=auto", "--maxprocesses=8", "--dist=worksteal"
#: For tests side by side: none of them draws or multiplies matrices with threads of its own.
ONE_THREAD = {"LP_NUM_THREADS": "0", "OPENBLAS_NUM_THREADS": "1"}
#: Exit status if something cannot be tested here, as in automake.
SKIPPED = 77
ANY_PACE = "do not fail for what takes longer in the window than it must"


def demo(output: Path, further: list[str]) -> int:
    """Render the pictures of the demo."""
    return next(environments()).run("tests.demo.figure6", "--output", str(output.resolve()), *further)


def test(chosen: list[str], everything: bool, any_pace: bool) -> int:
    """Run all checks but the stress tests, or the tests that arguments for pytest choose.

    With `everything`: with all releases of bpy, and unless tests are chosen, the stress tests and in a Blender with a
    window too. With `any_pace`, nothing fails there for being slow.
    """
    with ThreadPoolExecutor() as pool:  # what later tests need is installed while the first ones run
        prepared = all_environments(pool) if everything else environments()
        default = next(prepared)
        if everything and not chosen:
            pool.submit(blender_root.install, BLENDER_ROOT)  # if it cannot be, gui_test tries again and reports why
        if not chosen:  # for the tests that build zips, which try again what fails here
            for platform in project.WHEELS:
                pool.submit(extension.wheels_of, default.python, platform)
        checks = {} if chosen else STATIC_CHECKS
        if not default.has_processes:  # mypy would look for packages in the folder of Blender's own
            checks = {name: command for name, command in checks.items() if name != "mypy"}
        checking = {name: pool.submit(default.run, *command) for name, command in checks.items()}
        tested = run_tests(default, chosen, *(() if everything or chosen else WITHOUT_STRESS))
        results = {name: check.result() for name, check in checking.items()} | tested
        for other in prepared if everything else ():
            results |= run_tests(other, chosen, "--override-ini=testpaths=tests/blender", first=False)
    if everything and not chosen:
        results["the window"] = gui_test([], None, BLENDER_ROOT, GUI_RECORD, any_pace)
    return report(results)


def run_tests(environment: Environment, chosen: list[str], *which: str, first: bool = True) -> dict[str, int]:
    """Run pytest in an environment, in parallel where possible: names of the runs to their exit statuses.

    Tests marked alone or any_release are left to the `first` environment, unless they are chosen.
    """
    if chosen or not environment.has_processes:
        return {environment.name: environment.run("pytest", *which, *chosen)}
    together = "-m=not alone" if first else "-m=not alone and not any_release"
    results = {environment.name: environment.run("pytest", *which, together, *SIDE_BY_SIDE, **ONE_THREAD)}
    if first:
        results[f"{environment.name}, one by one"] = environment.run("pytest", *which, "-m=alone")
    return results


def report(results: dict[str, int]) -> int:
    """Print which checks passed, failed and could not be tried: the exit status of all together."""
    idle = [name for name, result in results.items() if result == NO_TEST_WAS_CHOSEN]
    skipped = [name for name, result in results.items() if result == SKIPPED]
    failed = [name for name, result in results.items() if result not in (0, NO_TEST_WAS_CHOSEN, SKIPPED)]
    if len(idle) == len(results):
        failed = idle
    passed = [name for name in results if name not in (*failed, *skipped)]
    for word, names in (("passed", passed), ("not tried", skipped), ("failed", failed)):
        if names:
            print(f"{word}: {', '.join(names)}")
    return int(bool(failed))


def stress(further: list[str]) -> int:
    """Run tests/stress in full."""
    return next(environments()).run("pytest", "tests/stress", *STRESS_FULL, *further)


def bench(name: str, output: Path, further: list[str]) -> int:
    """Run a benchmark of tests/benchmark."""
    environment = next(environments())
    environment.add(*project.PACKAGES["bench"])
    return environment.run(f"tests.benchmark.{name}", "--output", str(output.resolve()), *further)


def docs(names: list[str], records: Path) -> int:
    """Write the documentation's generated parts, with new records of the named benchmarks."""
    return next(environments()).run("tests.docs", "--records", str(records.resolve()), *names)


def gui_test(names: list[str], program: str | None, root: Path, output: Path, any_pace: bool) -> int:
    """Play the named scenarios, or all, in a Blender with a window."""
    every = scenarios()
    if unknown := set(names) - {scenario.name for scenario in every}:
        print(f"There is no scenario {', '.join(unknown)}, but: {', '.join(scenario.name for scenario in every)}")
        return 2
    try:
        if program is None:
            blender_root.install(root.resolve())
        elif shutil.which(program) is None:
            raise blender_root.Missing(f"there is no program {program}")
    except blender_root.Missing as reason:
        print(f"Not tested in a real Blender: {reason}.")
        return SKIPPED
    environment = next(environments())
    (archive,) = extension.build(environment.python, environment.extension, output.resolve() / "zip", ["linux-x64"])
    blender = run_scenarios.Blender(program) if program else run_scenarios.Blender("blender", root.resolve())
    chosen = [scenario for scenario in every if not names or scenario.name in names]
    return int(not run_scenarios.play(chosen, archive, output.resolve(), blender, any_pace))


def pack(output: Path, platforms: list[str]) -> int:
    """Build the extension, a zip for each platform."""
    environment = next(environments())
    for path in extension.build(environment.python, environment.extension, output.resolve(), platforms):
        print(f"{path}  {path.stat().st_size / 1e6:.2f} MB")
    return 0


def main() -> int:
    parser = argparse.ArgumentParser(prog="dev.py", description="Shows, tests and packs the add-on.")
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    verb = verbs.add_parser("demo", help="render the report's figure 6; further arguments: --samples 1, --size 640x360")
    verb.add_argument("--output", type=Path, default=BUILD / "figure6", help="folder of the pictures (%(default)s)")
    about = "run the checks with one bpy; further arguments go to pytest, such as -k name"
    verb = verbs.add_parser("test", help=about, allow_abbrev=False)
    verb.add_argument("--all", action="store_true", help="also stress tests, other bpy releases, and a window")
    verb.add_argument("--any-pace", action="store_true", help=ANY_PACE)
    verbs.add_parser("stress", help="run the stress tests, with more random pictures; further arguments go to pytest")
    verb = verbs.add_parser("gui-test", help="play scenarios in a Blender with a window")
    verb.add_argument("name", nargs="*", help="of a scenario; all, where there is none")
    verb.add_argument("--blender", metavar="PATH", help="a Blender of this machine, instead of one in a root folder")
    verb.add_argument("--root", type=Path, default=BLENDER_ROOT, help="folder of that root (%(default)s)")
    verb.add_argument("--output", type=Path, default=GUI_RECORD, help="folder of the record (%(default)s)")
    verb.add_argument("--any-pace", action="store_true", help=ANY_PACE)
    verb = verbs.add_parser("bench", help="measure; further arguments go to the benchmark")
    verb.add_argument("name", choices=BENCHMARKS)
    verb.add_argument("--output", type=Path, default=BUILD / "benchmark", help="folder of the records (%(default)s)")
    verb = verbs.add_parser("docs", help="write the documentation's generated parts anew")
    verb.add_argument("name", nargs="*", help="of a benchmark whose new record is to be taken first")
    verb.add_argument("--records", type=Path, default=BUILD / "benchmark", help="folder of the records (%(default)s)")
    verb = verbs.add_parser("extension", help="build and validate the extension's zips, one a platform")
    verb.add_argument("--output", type=Path, default=BUILD / "extension", help="folder of the zips (%(default)s)")
    verb.add_argument("--platform", action="append", default=[], choices=project.WHEELS, help="only this platform")
    arguments, further = parser.parse_known_args()
    if further and arguments.verb in ("docs", "extension", "gui-test"):
        parser.error(f"unknown: {' '.join(further)}")
    if arguments.verb == "demo":
        machine.prepare()
        return demo(arguments.output, further)
    if arguments.verb == "bench":
        machine.prepare()
        return bench(arguments.name, arguments.output, further)
    if arguments.verb in ("test", "stress"):
        machine.prepare("git", "glslangValidator", "lavapipe")
        if arguments.verb == "stress":
            return stress(further)
        return test(further, arguments.all, arguments.any_pace)
    machine.prepare("git")
    if arguments.verb == "docs":
        return docs(arguments.name, arguments.records)
    if arguments.verb == "gui-test":
        return gui_test(arguments.name, arguments.blender, arguments.root, arguments.output, arguments.any_pace)
    return pack(arguments.output, arguments.platform)


if __name__ == "__main__":
    sys.exit(main())
