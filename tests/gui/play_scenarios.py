# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by a Blender with a window: installs the extension from its zip and plays scenarios one after another.

blender --python play_scenarios.py -- ZIP FOLDER MODULE.NAME … Prints a line before each, and at its end writes
NAME/result.json to the folder.
"""

import importlib
import json
import sys
import time
import traceback
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parents[2]))
STEP_INTERVAL = 0.01  # s for which Blender's main loop runs at least between two steps of a scenario
START_INTERVAL = 0.5  # the same before a scenario's first step: Blender shows its window


class Player:
    """A timer, each call of which runs the next step of a scenario."""

    def __init__(self, paths: list[str], folder: Path):
        self.paths, self.folder = paths, folder
        self.begin()

    def begin(self) -> None:
        """Prepare the next scenario."""
        from tests.gui.session import Session

        module, self.name = self.paths.pop(0).split(".")
        print(f"scenario {self.name}", flush=True)
        self.session = Session(self.folder / self.name)
        self.steps = getattr(importlib.import_module(f"tests.gui.scenarios.{module}"), self.name)(self.session)
        self.began = time.perf_counter()

    def __call__(self) -> float | None:
        failure = []
        try:
            next(self.steps)
            return STEP_INTERVAL
        except StopIteration:
            pass
        except Exception:
            failure.append(traceback.format_exc())
        self.end("\n".join([*self.session.failures, *failure]))
        if not self.paths:
            bpy.ops.wm.quit_blender()
            return None
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        self.begin()
        return START_INTERVAL

    def end(self, failure: str) -> None:
        """Write the result."""
        seconds = time.perf_counter() - self.began
        region = self.session.region.width, self.session.region.height
        result = {"failure": failure, "seconds": seconds, "figures": self.session.figures, "region": region}
        result["slow"] = "\n".join(self.session.slow)
        (self.folder / self.name / "result.json").write_text(json.dumps(result))
        self.session.calls.release()


def main() -> None:
    archive, folder, *paths = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(Player(paths, Path(folder)), first_interval=START_INTERVAL, persistent=True)


main()
