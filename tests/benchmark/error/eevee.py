# SPDX-License-Identifier: GPL-3.0-or-later
"""EEVEE, in a separate Blender process: without a GPU, pip's bpy cannot render with EEVEE in the background."""

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.scenes.cycles import image_pixels

from .benchmark_scene import BenchmarkScene
from .engines import Missing, Render

INSIDE = Path(__file__).with_name("eevee_inside.py")
TIMEOUT = 900  # s, for all renders of a round


class Eevee:
    """Counted: Blender's render call. Not counted: start-up, and a first call that compiles the shaders."""

    name = "EEVEE"

    def __init__(self, benchmark_scene: BenchmarkScene, samples: tuple[int, ...], blender: str):
        self.blend, self.samples, self.blender = benchmark_scene.blend, samples, blender

    def start(self) -> dict[str, float]:
        """Render once, to find out whether EEVEE works here. Raises Missing."""
        with tempfile.TemporaryDirectory(dir=self.blend.parent) as folder:
            return {"done once s": self._render(Path(folder), ())["first"]}

    def renders(self, round: int) -> Iterator[Render]:
        """A render for each number of samples."""
        with tempfile.TemporaryDirectory(dir=self.blend.parent) as folder:
            seconds = self._render(Path(folder), self.samples)["seconds"]
            for samples, spent in zip(self.samples, seconds, strict=True):
                yield Render(samples, spent, image_pixels(Path(folder) / f"{samples}.exr")[..., :3])

    def close(self) -> None:
        """Nothing to free: each round's Blender has ended."""

    def _render(self, folder: Path, samples: tuple[int, ...]) -> dict:
        """Let Blender write the pictures. Returns seconds: of a first, unused render and of each. Raises Missing."""
        program = shutil.which(self.blender)
        if program is None:
            raise Missing(f"there is no {self.blender} to run")
        arguments = [program, "--background", "--factory-startup", str(self.blend), "--python", str(INSIDE), "--"]
        xvfb = None if {"DISPLAY", "WAYLAND_DISPLAY"} & os.environ.keys() else shutil.which("xvfb-run")
        command = [*([xvfb, "-a"] if xvfb else []), *arguments, str(folder), *map(str, samples)]
        try:
            process = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT)
        except subprocess.TimeoutExpired as reason:
            raise Missing(f"it was not done after {TIMEOUT} s") from reason
        record = folder / "record.json"
        if not record.is_file():
            last = (process.stderr or process.stdout).strip().splitlines()[-1:]
            raise Missing(f"{program} drew nothing ({' '.join(last)})")
        return json.loads(record.read_text())
