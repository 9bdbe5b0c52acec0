# SPDX-License-Identifier: GPL-3.0-or-later
"""A snapshot is data: refused in a sentence or drawn, whatever is in it, and never larger in memory than as a file."""

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
    ("harm", "sentence"),
    [
        (lambda whole: whole[: len(whole) // 2], "{} is not a snapshot: File is not a zip file."),
        (lambda whole: b"", "{} is not a snapshot: File is not a zip file."),
        (lambda whole: whole.replace(b"NUMPY", b"NUMPI"), "{} is not a snapshot: Bad CRC-32 for file 'snapshot.npy'."),
    ],
    ids=["truncated", "empty", "corrupt"],
)
def test_a_snapshot_that_is_damaged(told, path, harm, sentence):
    path.write_bytes(harm(path.read_bytes()))
    assert told(path) == sentence.format(path)


def test_a_snapshot_of_later_times(told, path):
    rewritten(path, told={"version": snapshot.VERSION + 1})
    assert told(path) == f"{path} is a snapshot of version 4; this one reads version 3."


def test_a_snapshot_that_is_not_there(told, tmp_path):
    assert told(tmp_path / "none.npz") == f"[Errno 2] No such file or directory: '{tmp_path / 'none.npz'}'"


class Spell:
    """What a pickle may hold: unpickled, it would call anything."""

    def __reduce__(self):
        return pytest.fail, ("a snapshot has been executed",)


def member(shape: str = "(4,)", dtype: str = "'<f4'", data: bytes = bytes(16)) -> bytes:
    """An .npy whose header says anything."""
    header = f"{{'descr': {dtype}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header + data


def pickled() -> bytes:
    spell = io.BytesIO()
    np.save(spell, np.array([Spell()], object), allow_pickle=True)
    return spell.getvalue()


@pytest.mark.parametrize("packing", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA, zipfile.ZIP_DEFLATED])
def test_a_snapshot_that_is_packed(told, path, packing):
    """What unpacks to more than the file could be anything: the sizes that an archive tells may be wrong."""
    with zipfile.ZipFile(path, "w", packing) as archive:
        archive.writestr("snapshot.npy", bytes(20_000_000))
    whole = path.read_bytes()
    path.write_bytes(whole.replace((20_000_000).to_bytes(4, "little"), (100).to_bytes(4, "little")))
    tracemalloc.start()
    try:
        assert told(path) == f"{path} is not a snapshot: its arrays are compressed."
        assert tracemalloc.get_traced_memory()[1] < 2**20
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("place", ["settings/shadow/bias", "view/width", "view/filter_width", "settings/debug_view"])
@pytest.mark.parametrize("long", [10**400, "a" * 5000, [0] * 5000], ids=["number", "word", "list"])
def test_a_snapshot_of_long_values(told, path, place, long):
    """The sentence says where, and quotes no more than can be read."""
    said = told(rewritten(path, told={place: long}))
    assert f"The snapshot's {place}" in said or f"The snapshot's {place.partition('/')[0]} cannot be used" in said
    assert str(long)[:20] in said
    assert len(said) < 400


def test_a_snapshot_of_an_unknown_setting_with_a_long_name(told, path):
    said = told(rewritten(path, told={f"settings/{'long ' * 1000}": 1}))
    assert said.startswith("The snapshot's settings has long long")
    assert len(said) < 200


def test_a_reason_without_words_has_a_name(told, path, monkeypatch):
    """As that of a file for which there is no memory."""

    def no_memory(*_arguments):
        raise MemoryError

    monkeypatch.setattr(snapshot, "_members", no_memory)
    assert told(path) == f"{path} is not a snapshot: MemoryError."


@pytest.mark.skipif(sys.platform == "win32", reason="devices are files elsewhere")
def test_what_is_no_plain_file_is_not_read(told, tmp_path):
    """It might have no end, or never begin."""
    os.mkfifo(tmp_path / "pipe")
    for path in (Path(os.devnull).with_name("zero"), tmp_path / "pipe", tmp_path):
        assert told(path) == f"{path} is not a snapshot: it is no plain file."


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
def test_a_snapshot_that_is_hostile(told, path, name, content, sentence):
    """Nothing of it is executed, and reading takes no more memory than a few times its file."""
    with zipfile.ZipFile(path) as archive:
        members = {each: archive.read(each) for each in archive.namelist()} | {name: content}
    with zipfile.ZipFile(path, "w") as archive:
        for each, data in members.items():
            archive.writestr(each, data)
    tracemalloc.start()
    try:
        said = told(path)
        assert tracemalloc.get_traced_memory()[1] < 2**20 + 20 * path.stat().st_size
    finally:
        tracemalloc.stop()
    assert said.startswith(f"{path} is not a snapshot: ")
    assert sentence in said


#: Numbers at the ends of what a snapshot may hold, and between.
ENDS = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-45, 1e-38, 1e-9, 1e5, -1e9, 1e9, 1e15, 3e38)


#: Other numbers that it holds.
TOLD = ("view/filter_width", "settings/shadow/bias", "settings/ssao/radius", "settings/quality/error_threshold")

#: The same of whole numbers; most others would only be refused.
WHOLE = {"b": (0, 1), "u": (0, 0, 1, 1, 255), "i": (0, 0, 1, -1, 2**31 - 1)}


def spoilt(arrays: dict[str, np.ndarray], chance: random.Random) -> dict[str, np.ndarray]:
    """Some of the arrays, with other numbers in places."""
    changed = {}
    for name in chance.sample(sorted(arrays), chance.randint(1, 3)):
        changed[name] = array = arrays[name].copy()
        for _ in range(chance.choice([1, 2, array.size])):
            index = np.unravel_index(chance.randrange(array.size), array.shape)
            array[index] = chance.choice(ENDS if array.dtype.kind == "f" else WHOLE[array.dtype.kind])
    return changed


@pytest.mark.parametrize("scene", [box_over_plane, pillar_field])
def test_snapshots_of_any_numbers(worker, tmp_path, examples, scene):
    """Refused in a sentence, or drawn: no pixel is not finite, and no drawing fails."""
    path, chance, drawn = tmp_path / "scene.npz", random.Random(2026), 0
    for _ in range(examples):
        snapshot.save(path, *scene(24, 16), chance.choice([SMALL_SETTINGS, SMALL_SHADOW_MAPS]))
        with np.load(path) as members:
            arrays = {name: members[name] for name in members.files if name != "snapshot" and members[name].size}
        told = {chance.choice(TOLD): chance.choice([*ENDS, 0, -1, 10**400]) for _ in range(chance.randrange(3))}
        rewritten(path, arrays=spoilt(arrays, chance), told=told)
        try:
            request = Request(*snapshot.load(path), RENDER_PASSES)
        except snapshot.SnapshotError:
            continue
        job = worker.start(request, "client")
        assert wait_for_end(job)
        assert job.error == ""
        assert all(np.isfinite(image).all() for image in job.picture().passes.values())
        drawn += 1
    assert drawn > examples / 4


@pytest.mark.parametrize("width", [-1.0, 500.0, 1e30])
def test_a_snapshot_whose_filter_is_none(worker, path, width):
    scene, view, settings = snapshot.load(rewritten(path, told={"view/filter_width": width}))
    nearest = 0 if width < 0.0 else 50
    assert view_beyond_limits(view) == (f"Filter Size cannot be {width:g} px: {nearest} px is used instead.",)
    job = worker.start(Request(scene, view, settings), "client")
    assert wait_for_end(job)
    assert job.error == ""
    assert np.isfinite(job.picture().color).all()
