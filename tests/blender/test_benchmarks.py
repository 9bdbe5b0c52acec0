# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmarks that nothing else runs still do."""

import json
import subprocess
import sys

from tests.tools.project import ROOT


def test_a_picture_of_a_growing_scene_is_measured():
    command = [sys.executable, "-m", "tests.benchmark.scale.point", "frames", "1"]
    told = json.loads(
        subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=120, check=True).stdout
    )
    assert told["triangles"] > 1000
    assert min(told["first sync s"], told["shadows ms"], told["a frame s"], told["peak bytes"]) > 0.0


def test_renders_of_small_meshes_are_measured_beside_cycles(tmp_path):
    command = [sys.executable, "-m", "tests.benchmark.small_meshes", "--output", str(tmp_path)]
    subprocess.run([*command, "--meshes", "20", "--renders", "2"], cwd=ROOT, timeout=120, check=True)
    record = json.loads((tmp_path / "small_meshes.json").read_text())
    rounds = record["rounds"]
    assert record["command"] == "python3 dev.py bench small_meshes --meshes 20 --renders 2"
    assert record["machine"]["opengl"]
    assert len(rounds) == 2
    assert all(min(each["whole"], each["read"], each["BuildBLAS"], each["Cycles"]) > 0.0 for each in rounds)
