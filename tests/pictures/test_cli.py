# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: pictures from snapshots, without Blender; a failure prints one line and sets the exit status."""

import os
import signal
import struct
import subprocess
import sys
import time
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ism_addon import setting_limits, snapshot
from ism_addon.gpu.__main__ import main
from ism_addon.gpu.jobs.png import display_from_linear, write_png
from ism_addon.scene import Image
from ism_addon.settings import SSAO, DebugView, Method
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw
from tests.tools import project

SETTINGS = replace(SMALL_SETTINGS, ssao=SSAO())


@pytest.fixture
def scene_file(tmp_path) -> Path:
    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), SETTINGS)
    return path


@pytest.fixture
def call(monkeypatch, capsys, tmp_path):
    """call(arguments…): runs the command line; its exit status, stdout and stderr."""

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["ism_addon.gpu", *map(str, arguments)])
        try:
            status = main()
        except SystemExit as end:
            status = end.code
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        return status, captured.out, captured.err

    return run


def read_png(path: Path) -> np.ndarray:
    """(H,W,4) uint8, bottom row first, of an unfiltered PNG; checks the CRC of each chunk."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    offset, compressed, size = 8, b"", (0, 0)
    while offset < len(data):
        (length,) = struct.unpack_from(">I", data, offset)
        chunk_type, body = data[offset + 4 : offset + 8], data[offset + 8 : offset + 8 + length]
        assert struct.unpack_from(">I", data, offset + 8 + length)[0] == zlib.crc32(chunk_type + body)
        if chunk_type == b"IHDR":
            size = struct.unpack_from(">II", body)
            assert body[8:] == bytes((8, 6, 0, 0, 0))
        compressed += body if chunk_type == b"IDAT" else b""
        offset += 12 + length
    rows = np.frombuffer(zlib.decompress(compressed), np.uint8).reshape(size[1], 1 + 4 * size[0])
    assert not rows[:, 0].any()
    return rows[:, 1:].reshape(size[1], size[0], 4)[::-1]


def test_the_picture_is_that_of_the_renderer(call, scene_file, tmp_path, device):
    out = tmp_path / "out.png"
    assert call(scene_file, "-o", out) == (0, "", "")
    expected = display_from_linear(draw(device, *box_over_plane(24, 16), SETTINGS).color)
    assert np.array_equal(read_png(out), expected)


def test_it_runs_as_a_module(scene_file, tmp_path):
    """As a user runs it, in a new interpreter."""
    out = tmp_path / "out.png"
    command = [sys.executable, "-m", "ism_addon.gpu", str(scene_file), "-o", str(out), "--profile"]
    run = subprocess.run(command, cwd=project.ROOT, capture_output=True, text=True, timeout=60)
    assert (run.returncode, run.stderr) == (0, "")
    assert "TraceShadows" in run.stdout
    assert read_png(out).shape == (16, 24, 4)


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal as it is done elsewhere")
def test_ctrl_c_prints_one_line(scene_file, tmp_path):
    out = tmp_path / "out.png"
    script = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"  # pytest's parent may ignore it
    script += "; import runpy; runpy.run_module('ism_addon.gpu', run_name='__main__')"
    command = [sys.executable, "-c", script, str(scene_file), "-o", str(out), "--samples", "65536"]
    run = subprocess.Popen(command, cwd=project.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        time.sleep(2.0)
        run.send_signal(signal.SIGINT)
        output = run.communicate(timeout=10.0)
    finally:
        run.kill()
    assert (run.returncode, *output) == (130, "", "Interrupted.\n")
    assert not out.exists()


def test_in_an_ascii_locale(scene_file, tmp_path):
    """Python reads files in the locale's encoding, which is not UTF-8 here, as in Japanese Windows."""
    out = tmp_path / "out.png"
    ascii_only = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-m", "ism_addon.gpu", str(scene_file), "-o", str(out), "--shadow-method", "SHADOW_MAPS"]
    run = subprocess.run(command, cwd=project.ROOT, env={**os.environ, **ascii_only}, capture_output=True, timeout=60)
    assert (run.returncode, run.stderr) == (0, b"")
    assert read_png(out).shape == (16, 24, 4)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only EGL can be hidden by an environment variable")
def test_without_opengl_it_prints_an_error(scene_file, tmp_path):
    out = tmp_path / "out.png"
    hidden = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent", "LIBGL_DRIVERS_PATH": "/nonexistent"}
    command = [sys.executable, "-m", "ism_addon.gpu", str(scene_file), "-o", str(out)]
    run = subprocess.run(
        command, cwd=project.ROOT, env={**os.environ, **hidden}, capture_output=True, text=True, timeout=60
    )
    assert run.returncode == 1
    assert run.stderr.startswith("OpenGL 4.1 could not be opened")
    assert len(run.stderr.splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize("target", DebugView)
def test_every_target_can_be_shown(call, scene_file, tmp_path, target):
    out = tmp_path / "out.png"
    assert call(scene_file, "-o", out, "--show", target)[0] == 0
    assert read_png(out).shape == (16, 24, 4)


def test_an_unknown_target_is_refused_with_the_known_ones(call, scene_file, tmp_path):
    status, _, error = call(scene_file, "-o", tmp_path / "out.png", "--show", "nonsense")
    assert status != 0
    assert "nonsense" in error
    assert "occlusion" in error
    assert not (tmp_path / "out.png").exists()


def test_the_profile_has_a_line_for_each_pass(call, scene_file, tmp_path, device):
    status, out, _ = call(scene_file, "-o", tmp_path / "out.png", "--profile")
    assert status == 0
    drawn = draw(device, *box_over_plane(24, 16), SETTINGS)
    lines = {line.split()[0]: line.split() for line in out.splitlines()}
    for name, row in drawn.profile.rows.items():
        assert lines[name][1:4] == [str(row.drawn), str(row.reused), str(row.skipped)]
    assert f"{drawn.profile.counts['triangles_drawn']:,} triangles drawn" in out
    assert "virtual lights" not in out  # rays need none
    assert (
        "8 virtual lights"
        in call(scene_file, "-o", tmp_path / "out.png", "--profile", "--shadow-method", "shadow_maps")[1]
    )


def test_flags_change_settings(call, scene_file, tmp_path, device):
    out = tmp_path / "out.png"
    assert (
        call(
            scene_file, "-o", out, "--no-ssao-enabled", "--shadow-bias", "2", "--virtual-lights", "5", "--samples", "2"
        )[0]
        == 0
    )
    changed = replace(
        SETTINGS,
        ssao=SSAO(enabled=False),
        shadow=replace(SETTINGS.shadow, bias=2.0),
        quality=replace(SETTINGS.quality, virtual_lights=5, samples=2),
    )
    assert np.array_equal(read_png(out), display_from_linear(draw(device, *box_over_plane(24, 16), changed).color))


@pytest.mark.parametrize("method", Method)
def test_the_method_is_chosen_by_its_name(call, scene_file, tmp_path, device, method):
    out = tmp_path / "out.png"
    assert call(scene_file, "-o", out, "--shadow-method", method.lower())[0] == 0
    changed = replace(SETTINGS, shadow=replace(SETTINGS.shadow, method=method))
    assert np.array_equal(read_png(out), display_from_linear(draw(device, *box_over_plane(24, 16), changed).color))


def test_an_unknown_method_is_refused_with_the_known_ones(call, scene_file, tmp_path):
    status, _, error = call(scene_file, "-o", tmp_path / "out.png", "--shadow-method", "nonsense")
    assert status != 0
    assert "nonsense is none of RAY_TRACED, SHADOW_MAPS" in error
    assert not (tmp_path / "out.png").exists()


def test_another_size_keeps_the_horizontal_field_of_view(call, scene_file, tmp_path, device):
    out = tmp_path / "out.png"
    assert call(scene_file, "-o", out, "--size", "48x32")[0] == 0
    assert np.array_equal(read_png(out), display_from_linear(draw(device, *box_over_plane(48, 32), SETTINGS).color))


@pytest.mark.parametrize("size", ["", "0x5", "5x0", "-3x4", "5", "axb", "1x2x3"])
def test_an_invalid_size(call, scene_file, tmp_path, size):
    status, _, error = call(scene_file, "-o", tmp_path / "out.png", f"--size={size}")
    assert status != 0
    assert error


@pytest.mark.parametrize("value", [("--samples", "x"), ("--samples", "1.5"), ("--ssao-radius", "")])
def test_settings_that_are_not_numbers(call, scene_file, tmp_path, value):
    status, _, error = call(scene_file, "-o", tmp_path / "out.png", *value)
    assert status != 0
    assert error
    assert not (tmp_path / "out.png").exists()


@pytest.mark.parametrize(
    ("flag", "value", "nearest"),
    [
        ("--samples", "0", "1"),
        ("--virtual-lights", "-3", "1"),
        ("--map-size", "0", "8"),
        ("--map-points", "1000000000", "1048576"),
        ("--ssao-radius", "nan", "0"),
    ],
)
def test_settings_out_of_their_range_are_reported_and_clamped(call, scene_file, tmp_path, flag, value, nearest):
    pictures = []
    for given in (value, nearest):
        out = tmp_path / f"{given}.png"
        status, _, error = call(scene_file, "-o", out, flag, given)
        assert status == 0
        assert len(error.splitlines()) == (given == value)
        pictures.append(read_png(out))
    assert np.array_equal(*pictures)


def test_bad_snapshots(call, tmp_path):
    garbage, other = tmp_path / "garbage.npz", tmp_path / "other.npz"
    garbage.write_bytes(b"not a zip")
    np.savez(other, something=np.zeros(3))
    for path in (garbage, other, tmp_path / "missing.npz", tmp_path):
        status, out, error = call(path, "-o", tmp_path / "out.png")
        assert (status, out) == (1, "")
        assert str(path) in error
        assert len(error.strip().splitlines()) == 1
    assert not (tmp_path / "out.png").exists()


def test_an_output_that_cannot_be_written(call, scene_file, tmp_path):
    status, _, error = call(scene_file, "-o", tmp_path / "no folder" / "out.png")
    assert status == 1
    assert "no folder" in error


def test_the_scenes_warnings_are_printed(call, tmp_path):
    scene, view = box_over_plane(24, 16)
    path = tmp_path / "scene.npz"
    snapshot.save(path, replace(scene, warnings=("The mesh Cube has no triangles and is left out.",)), view, SETTINGS)
    status, _, error = call(path, "-o", tmp_path / "out.png")
    assert status == 0
    assert "Cube" in error


def test_reduced_images_are_reported(call, tmp_path, monkeypatch):
    scene, view = box_over_plane(24, 16)
    path = tmp_path / "scene.npz"
    snapshot.save(path, replace(scene, images=(Image(np.zeros((256, 256, 4), np.uint8)),)), view, SETTINGS)
    monkeypatch.setattr(setting_limits, "MAX_TEXTURE_LINES", 3)
    status, _, error = call(path, "-o", tmp_path / "out.png")
    assert status == 0
    assert error.endswith("some not drawn at their size: 1 of 256×256 px at 1/2 of it.\n")


def test_display_values_are_srgb_with_straight_alpha(tmp_path):
    color = np.array(
        [[[0.0, 0.0, 0.0, 0.0], [0.25, 0.5, 1.0, 1.0], [0.125, 0.25, 0.5, 0.5], [9.0, -1.0, 0.002, 1.0]]], np.float32
    )
    displayed = display_from_linear(color)
    assert displayed[0, 0].tolist() == [0, 0, 0, 0]
    assert displayed[0, 1].tolist() == [137, 188, 255, 255]
    assert displayed[0, 2, :3].tolist() == displayed[0, 1, :3].tolist()
    assert displayed[0, 3].tolist() == [255, 0, 7, 255]
    write_png(tmp_path / "a.png", displayed)
    assert np.array_equal(read_png(tmp_path / "a.png"), displayed)
