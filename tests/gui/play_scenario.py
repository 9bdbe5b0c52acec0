# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by a Blender with a window: installs the extension from its zip and plays one scenario.

blender --python play_scenario.py -- ZIP MODULE NAME FOLDER. Writes result.json to FOLDER, unless Blender crashes.
"""

import importlib
import json
import sys
import time
import traceback
from collections.abc import Generator
from pathlib import Path

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parents[2]))
STEP_INTERVAL = 0.01  # s for which Blender's main loop runs at least between two steps of a scenario


class Player:
    """Plays a scenario: a timer, each call of which runs the next step."""

    def __init__(self, steps: Generator, session: "object", folder: Path):
        self.steps, self.session, self.folder = steps, session, folder
        self.began = time.perf_counter()

    def __call__(self) -> float | None:
        try:
            next(self.steps)
            return STEP_INTERVAL
        except StopIteration:
            self.end("\n".join(self.session.failures))
        except Exception:
            self.end("\n".join([*self.session.failures, traceback.format_exc()]))
        return None

    def end(self, failure: str) -> None:
        seconds = time.perf_counter() - self.began
        region = self.session.region.width, self.session.region.height
        result = {"failure": failure, "seconds": seconds, "figures": self.session.figures, "region": region}
        result["slow"] = "\n".join(self.session.slow)
        (self.folder / "result.json").write_text(json.dumps(result))
        bpy.ops.wm.quit_blender()


def main() -> None:
    archive, module, name, folder = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
    bpy.context.preferences.view.show_splash = False

    from tests.gui.session import Session

    session = Session(Path(folder))
    steps = getattr(importlib.import_module(f"tests.gui.scenarios.{module}"), name)(session)
    bpy.app.timers.register(Player(steps, session, Path(folder)), first_interval=0.5, persistent=True)


main()
