# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged and hostile snapshots: refused with one line or drawn. Nothing is executed, and memory is bounded."""

import io
import os
import random
import sys
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.gpu.jobs.job import Request
from ism_addon.render_passes import RENDER_PASSES
from ism_addon.setting_limits import view_beyond_limits
from tests.scenes.small import box_over_plane, pillar_field
from tests.support.jobs import wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS
from tests.unit.test_snapshot import rewritten


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        (lambda data: data[: len(data) // 2], "{} is not a snapshot: File is not a zip file."),
        (lambda data: b"", "{} is not a snapshot: File is not a zip file."),
        (lambda data: data.replace(b"NUMPY", b"NUMPI"), "{} is not a snapshot: Bad CRC-32 for file 'snapshot.npy'."),
    ],
    ids=["truncated", "empty", "corrupt"],
)
def test_a_damaged_snapshot(cli_error, snapshot_path, damage, sentence):
    snapshot_path.write_bytes(damage(snapshot_path.read_bytes()))
    assert cli_error(snapshot_path) == sentence.format(snapshot_path)


def test_a_snapshot_of_a_later_version(cli_error, snapshot_path):
    rewritten(snapshot_path, values={"version": snapshot.VERSION + 1})
    assert cli_error(snapshot_path) == f"{snapshot_path} is a snapshot of version 4; this one reads version 3."


def test_a_missing_snapshot(cli_error, tmp_path):
    assert cli_error(tmp_path / "none.npz") == f"[Errno 2] No such file or directory: '{tmp_path / 'none.npz'}'"


class CodeInPickle:
    """Unpickling it calls a function, as a hostile pickle may."""

    def __reduce__(self):
        return pytest.fail, ("a snapshot has been executed",)


def member(shape: str = "(4,)", dtype: str = "'<f4'", data: bytes = bytes(16)) -> bytes:
    """An .npy file with this shape and dtype in its header, whether or not they match the data."""
    header = f"{{'descr': {dtype}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + data


def pickled() -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.array([CodeInPickle()], object), allow_pickle=True)
    return buffer.getvalue()


@pytest.mark.parametrize("compression", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA, zipfile.ZIP_DEFLATED])
def test_a_compressed_snapshot(cli_error, snapshot_path, compression):
    """It is refused, as its uncompressed size is not known: the archive may state a wrong one."""
    with zipfile.ZipFile(snapshot_path, "w", compression) as archive:
        archive.writestr("snapshot.npy", bytes(20_000_000))
    data = snapshot_path.read_bytes()
    snapshot_path.write_bytes(data.replace((20_000_000).to_bytes(4, "little"), (100).to_bytes(4, "little")))
    tracemalloc.start()
    try:
        assert cli_error(snapshot_path) == f"{snapshot_path} is not a snapshot: its arrays are compressed."
        assert tracemalloc.get_traced_memory()[1] < 2**20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", ["settings/shadow/bias", "view/width", "view/filter_width", "settings/debug_view"])
@pytest.mark.parametrize("value", [10**400, "a" * 5000, [0] * 5000], ids=["number", "word", "list"])
def test_a_snapshot_with_long_values(cli_error, snapshot_path, name, value):
    """The message says where the value is, and quotes only its beginning."""
    message = cli_error(rewritten(snapshot_path, values={name: value}))
    assert f"The snapshot's {name}" in message or f"The snapshot's {name.partition('/')[0]} cannot be used" in message
    assert str(value)[:20] in message
    assert len(message) < 400


def test_a_snapshot_with_a_long_unknown_setting(cli_error, snapshot_path):
    message = cli_error(rewritten(snapshot_path, values={f"settings/{'long ' * 1000}": 1}))
    assert message.startswith("The snapshot's settings has long long")
    assert len(message) < 200


def test_an_error_without_a_message_is_named(cli_error, snapshot_path, monkeypatch):
    """Such as a MemoryError: the message gives the exception's name."""

    def no_memory(*_arguments):
        raise MemoryError

    monkeypatch.setattr(snapshot, "_members", no_memory)
    assert cli_error(snapshot_path) == f"{snapshot_path} is not a snapshot: MemoryError."


@pytest.mark.skipif(sys.platform == "win32", reason="devices are files elsewhere")
def test_a_device_or_pipe_is_not_read(cli_error, tmp_path):
    """Reading it might never end or never begin."""
    os.mkfifo(tmp_path / "pipe")
    for path in (Path(os.devnull).with_name("zero"), tmp_path / "pipe", tmp_path):
        assert cli_error(path) == f"{path} is not a snapshot: it is no plain file."


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("snapshot.npy", pickled(), "cannot create an OBJECT array from memory buffer"),
        ("view/clip_from_view.npy", member("(2000000000,)"), "cannot reshape array of size 4"),
        ("view/clip_from_view.npy", member("(-4, -4)"), "can only specify one unknown dimension"),
        ("view/clip_from_view.npy", member("(4," * 999), "is not a snapshot"),
        ("view/clip_from_view.npy", member("(4,)*10**9"), "malformed node"),
        ("view/clip_from_view.npy", member("__import__('os')"), "malformed node"),
        ("snapshot.npy", member("(200000,)", "'|u1'", b"[" * 200_000), "maximum recursion depth exceeded"),
        ("snapshot.npy", member("(10000,)", "'|u1'", b"9" * 10_000), "Exceeds the limit"),
    ],
    ids=["pickle", "claims 8 GB", "less than none", "unended", "made long", "a call", "deep", "a long number"],
)
def test_a_hostile_snapshot(cli_error, snapshot_path, name, content, sentence):
    """Nothing of it is executed, and reading takes no more memory than a few times its file."""
    with zipfile.ZipFile(snapshot_path) as archive:
        members = {each: archive.read(each) for each in archive.namelist()} | {name: content}
    with zipfile.ZipFile(snapshot_path, "w") as archive:
        for each, data in members.items():
            archive.writestr(each, data)
    tracemalloc.start()
    try:
        message = cli_error(snapshot_path)
        assert tracemalloc.get_traced_memory()[1] < 2**20 + 20 * snapshot_path.stat().st_size
    finally:
        tracemalloc.stop()
    assert message.startswith(f"{snapshot_path} is not a snapshot: ")
    assert sentence in message


#: Extreme and ordinary floating-point values for a snapshot's arrays.
FLOATS = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-45, 1e-38, 1e-9, 1e5, -1e9, 1e9, 1e15, 3e38)

#: Paths of numbers outside of its arrays.
SCALARS = ("view/filter_width", "settings/shadow/bias", "settings/ssao/radius", "settings/quality/error_threshold")

#: Integer values by kind of dtype; most others would only be refused.
INTEGERS = {"b": (0, 1), "u": (0, 0, 1, 1, 255), "i": (0, 0, 1, -1, 2**31 - 1)}


def with_random_values(arrays: dict[str, np.ndarray], rng: random.Random) -> dict[str, np.ndarray]:
    """One to three of the arrays, with random values at some or all indices."""
    changed = {}
    for name in rng.sample(sorted(arrays), rng.randint(1, 3)):
        changed[name] = array = arrays[name].copy()
        for _ in range(rng.choice([1, 2, array.size])):
            index = np.unravel_index(rng.randrange(array.size), array.shape)
            array[index] = rng.choice(FLOATS if array.dtype.kind == "f" else INTEGERS[array.dtype.kind])
    return changed


@pytest.mark.parametrize("scene", [box_over_plane, pillar_field])
def test_snapshots_with_random_values(worker, tmp_path, examples, scene):
    """Refused, or drawn without an error and with finite pixels."""
    snapshot_path, rng, drawn = tmp_path / "scene.npz", random.Random(2026), 0
    for _ in range(examples):
        snapshot.save(snapshot_path, *scene(24, 16), rng.choice([SMALL_SETTINGS, SMALL_SHADOW_MAPS]))
        with np.load(snapshot_path) as members:
            arrays = {name: members[name] for name in members.files if name != "snapshot" and members[name].size}
        changes = {rng.choice(SCALARS): rng.choice([*FLOATS, 0, -1, 10**400]) for _ in range(rng.randrange(3))}
        rewritten(snapshot_path, arrays=with_random_values(arrays, rng), values=changes)
        try:
            request = Request(*snapshot.load(snapshot_path), RENDER_PASSES)
        except snapshot.SnapshotError:
            continue
        job = worker.start(request, "client")
        assert wait_for_end(job)
        assert job.error == ""
        assert all(np.isfinite(image).all() for image in job.picture().passes.values())
        drawn += 1
    assert drawn > examples / 4


@pytest.mark.parametrize("width", [-1.0, 500.0, 1e30])
def test_a_snapshot_with_an_impossible_filter_width(worker, snapshot_path, width):
    scene, view, settings = snapshot.load(rewritten(snapshot_path, values={"view/filter_width": width}))
    nearest = 0 if width < 0.0 else 50
    assert view_beyond_limits(view) == (f"Filter Size cannot be {width:g} px: {nearest} px is used instead.",)
    job = worker.start(Request(scene, view, settings), "client")
    assert wait_for_end(job)
    assert job.error == ""
    assert np.isfinite(job.picture().color).all()
