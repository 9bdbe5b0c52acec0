# SPDX-License-Identifier: GPL-3.0-or-later
"""EEVEE, in a Blender of its own: pip's bpy draws nothing with it in the background without a graphics card."""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.scenes.cycles import picture_in

from .benchmark_scene import BenchmarkScene
from .engines import Missing, Render

INSIDE = Path(__file__).with_name("eevee_inside.py")
TIMEOUT = 900  # s, for a whole round


class Eevee:
    """Counted: Blender's render call. Not counted: start-up, and a first call that compiles the shaders."""

    name = "EEVEE"

    def __init__(self, stage: BenchmarkScene, samples: tuple[int, ...], blender: str):
        self.stage, self.samples, self.blender = stage, samples, blender

    def start(self) -> dict[str, float]:
        """See whether it draws at all."""
        with tempfile.TemporaryDirectory(dir=self.stage.blend.parent) as folder:
            return {"done once s": self._render(Path(folder), ())["first"]}

    def shots(self, round: int) -> Iterator[Render]:
        """A picture of each number of samples."""
        with tempfile.TemporaryDirectory(dir=self.stage.blend.parent) as folder:
            seconds = self._render(Path(folder), self.samples)["seconds"]
            for samples, spent in zip(self.samples, seconds, strict=True):
                yield Render(samples, spent, picture_in(Path(folder) / f"{samples}.exr")[..., :3])

    def close(self) -> None:
        """Each round's Blender has ended by itself."""

    def _render(self, folder: Path, samples: tuple[int, ...]) -> dict:
        """Let Blender write the pictures: what the first, unused render took, and each of them. Raises Missing."""
        program = shutil.which(self.blender)
        if program is None:
            raise Missing(f"there is no {self.blender} to run")
        arguments = [program, "--background", "--factory-startup", str(self.stage.blend), "--python", str(INSIDE), "--"]
        xvfb = None if {"DISPLAY", "WAYLAND_DISPLAY"} & os.environ.keys() else shutil.which("xvfb-run")
        command = [*([xvfb, "-a"] if xvfb else []), *arguments, str(folder), *map(str, samples)]
        try:
            said = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT)
        except subprocess.TimeoutExpired as reason:
            raise Missing(f"it was not done after {TIMEOUT} s") from reason
        record = folder / "record.json"
        if not record.is_file():
            last = (said.stderr or said.stdout).strip().splitlines()[-1:]
            raise Missing(f"{program} drew nothing ({' '.join(last)})")
        return json.loads(record.read_text())
