# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders are reloaded on request, and an error in one is reported in one line."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from ism_addon.gpu.gl import shader_compiler
from tests.scenes.small import pillar_field
from tests.support.jobs import LONG, request, wait_for_end, wait_for_picture
from tests.support.small_scenes import SMALL_SETTINGS


@pytest.fixture
def shaders(tmp_path, monkeypatch):
    """A copy of the shaders' folder, which the compiler reads and tests may edit."""
    monkeypatch.setattr(shader_compiler, "FOLDER", shutil.copytree(shader_compiler.FOLDER, tmp_path / "gpu"))
    return shader_compiler.FOLDER


def edit(shader: Path, old: str, new: str) -> None:
    text = shader.read_text()
    assert old in text
    shader.write_text(text.replace(old, new))


def test_shaders_are_reloaded(worker, shaders):
    settings = replace(SMALL_SETTINGS, debug_view="base_color")
    before = worker.start(request(settings), "client")
    assert wait_for_end(before)
    edit(shaders / "passes/film/debug_image.frag", "texel.rgb, 1.0);", "vec3(0.25), 1.0);")
    not_reloaded = worker.start(request(settings, pillar_field), "client")
    assert wait_for_end(not_reloaded)
    assert not_reloaded.picture().color[..., :3].max() > 0.26
    worker.reload()
    after = worker.start(request(settings), "client")
    assert wait_for_end(after)
    assert after.error == ""
    assert after.picture().color[..., :3].max() == pytest.approx(0.25, abs=1e-3)


def test_an_error_in_a_shader_is_one_line_and_can_be_fixed(worker, shaders):
    original = (shaders / "passes/film/shade.frag").read_text()
    edit(shaders / "passes/film/shade.frag", "void main() {", "void main() {\n    nonsense;")
    line = (shaders / "passes/film/shade.frag").read_text().splitlines().index("    nonsense;") + 1
    worker.reload()
    broken = worker.start(request(), "client")
    assert wait_for_end(broken)
    assert f"does not compile: shade.frag, line {line}: " in broken.error
    assert "nonsense" in broken.error
    assert "\n" not in broken.error
    (shaders / "passes/film/shade.frag").write_text(original)
    worker.reload()
    repaired = worker.start(request(), "client")
    assert wait_for_end(repaired)
    assert repaired.error == ""


def test_an_error_is_located_in_the_included_file(worker, shaders):
    edit(shaders / "glsl/maths/luminance.glsl", "{", "{ nonsense;")
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert re.search(r"does not compile: luminance.glsl, line \d+: .*nonsense", job.error)


def test_a_missing_shader_is_one_line(worker, shaders):
    (shaders / "passes/film/shade.frag").unlink()
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert "shade.frag does not compile: " in job.error
    assert "\n" not in job.error


def test_reloading_leaves_a_running_job_alone(worker):
    long_job = worker.start(request(LONG), "final render")
    assert wait_for_picture(long_job)
    samples_before = long_job.samples_done
    for _ in range(3):
        worker.reload()
        assert wait_for_end(worker.start(request(), "viewport"))
    assert not long_job.finished
    assert long_job.samples_done > samples_before
