# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of files that are damaged, hostile, missing or cannot be written; and nothing is lost by them."""

import io
import random
import subprocess
import sys
import tracemalloc
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np
import pytest

from ism_addon import addon, snapshot
from ism_addon.blender import extract
from ism_addon.gpu import __main__ as command_line
from ism_addon.gpu.job import Request
from ism_addon.limits import view_beyond_limits

from ..scenes.small import box_over_plane, pillar_field
from ..studio import MAPS, SMALL_SETTINGS
from ..test_snapshot import rewritten
from ..test_worker import ended
from ..tools import project

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="fills the disk as it is done on Linux")
GONE = "Images that are missing or cannot be read are left out, and the base colour is drawn: 'gone.png'."


@pytest.fixture
def path(tmp_path) -> Path:
    """A snapshot's file."""
    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), SMALL_SETTINGS)
    return path


@pytest.fixture
def blender() -> Iterator[bpy.types.Scene]:
    """The add-on in Blender's factory scene."""
    bpy.ops.wm.read_factory_settings()
    addon.register()
    bpy.context.scene.render.engine = "ISM"
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 24, 16
    yield bpy.context.scene
    addon.unregister()
    bpy.ops.wm.read_factory_settings()


@contextmanager
def disk_with_room_for(size: int) -> Iterator[None]:
    """No file can become larger than that."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@ON_LINUX
def test_a_disk_that_is_full_while_a_snapshot_is_written(blender, path):
    """It is as if nothing had been asked: the older one is there, and no piece of a new one."""
    before = path.read_bytes()
    with pytest.raises(RuntimeError) as report, disk_with_room_for(4000):
        bpy.ops.ism.save_snapshot(filepath=str(path))
    assert str(report.value) == f"Error: The snapshot was not saved: File too large: {path}\n"
    assert path.read_bytes() == before
    assert list(path.parent.iterdir()) == [path]


@pytest.fixture
def told(monkeypatch, capsys) -> Callable[..., str]:
    """told(arguments…): what the command line says of what it refuses."""

    def told(*arguments: object) -> str:
        monkeypatch.setattr(sys, "argv", ["ism_addon.gpu", *map(str, arguments)])
        assert command_line.main() == 1
        (line,) = capsys.readouterr().err.splitlines()
        return line

    return told


@ON_LINUX
def test_a_disk_that_is_full_while_a_picture_is_written(told, path):
    assert told(path, "-o", "/dev/full") == "[Errno 28] No space left on device: '/dev/full'"
    picture = path.with_name("out.png")
    picture.write_text("an older one")
    with disk_with_room_for(100):
        assert told(path, "-o", picture) == f"[Errno 27] File too large: '{picture}'"
    assert picture.read_text() == "an older one"


@ON_LINUX
def test_a_file_that_is_replaced_stays_what_it_is(path):
    """Its mode, and a link to it; one that may not be written to is not."""
    link = path.with_name("link.npz")
    link.symlink_to(path)
    path.chmod(0o600)
    snapshot.save(link, *pillar_field(24, 16), SMALL_SETTINGS)
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o600
    assert snapshot.load(path)[0].triangle_count == pillar_field(24, 16)[0].triangle_count


@ON_LINUX
def test_a_picture_into_a_pipe(path):
    command = [sys.executable, "-m", "ism_addon.gpu", path, "-o", "/dev/stdout"]
    said = subprocess.run(command, cwd=project.ROOT, capture_output=True, timeout=60, check=True)
    assert said.stdout.startswith(b"\x89PNG")


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
    assert told(path) == f"{path} is a snapshot of version 3; this one reads version 2."


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


@pytest.mark.parametrize(
    ("place", "sentence"),
    [
        ("settings/shadow/bias", "{path} holds a number that is too long."),
        ("view/width", "The snapshot's view cannot be used: a picture of {number}×16 pixels cannot be drawn."),
        ("view/filter_width", "{path} holds a number that is too long."),
    ],
)
def test_a_snapshot_of_long_numbers(told, path, place, sentence):
    number = 10**400
    said = told(rewritten(path, told={place: number}))
    assert str(number) in said or said == sentence.format(path=path, number=number)


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
        snapshot.save(path, *scene(24, 16), chance.choice([SMALL_SETTINGS, MAPS]))
        with np.load(path) as members:
            arrays = {name: members[name] for name in members.files if name != "snapshot" and members[name].size}
        told = {chance.choice(TOLD): chance.choice([*ENDS, 0, -1, 10**400]) for _ in range(chance.randrange(3))}
        rewritten(path, arrays=spoilt(arrays, chance), told=told)
        try:
            request = Request(*snapshot.load(path))
        except snapshot.SnapshotError:
            continue
        job = worker.start(request, "client")
        assert ended(job)
        assert job.error == ""
        picture = job.picture()
        assert all(np.isfinite(part).all() for part in (picture.color, picture.depth, picture.normal))
        drawn += 1
    assert drawn > examples / 4


@pytest.mark.parametrize("width", [-1.0, 500.0, 1e30])
def test_a_snapshot_whose_filter_is_none(worker, path, width):
    scene, view, settings = snapshot.load(rewritten(path, told={"view/filter_width": width}))
    nearest = 0 if width < 0.0 else 50
    assert view_beyond_limits(view) == (f"Filter Size cannot be {width:g} px: {nearest} px is used instead.",)
    job = worker.start(Request(scene, view, settings), "client")
    assert ended(job)
    assert job.error == ""
    assert np.isfinite(job.picture().color).all()


def test_images_that_are_missing(blender, tmp_path):
    """The base colour is drawn instead."""
    image = bpy.data.images.new("gone.png", 2, 2)
    image.source, image.filepath = "FILE", str(tmp_path / "gone.png")
    material = bpy.data.materials.new("Painted")
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    surface = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    bpy.data.objects["Cube"].data.materials[0] = material
    assert GONE in extract.scene(bpy.context.evaluated_depsgraph_get()).warnings


def test_libraries_that_are_missing(blender, tmp_path):
    """Of an object, its mesh, its material or a collection: Blender puts something empty in place."""
    library, path = tmp_path / "library.blend", tmp_path / "scene.blend"
    cube = bpy.data.objects["Cube"]
    bpy.data.libraries.write(str(library), {cube, cube.data, cube.data.materials[0]})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, linked):
        linked.objects, linked.meshes, linked.materials = ["Cube"], ["Cube"], ["Material"]
    mesh = bpy.data.meshes.new("Own")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(bpy.data.materials["Material"])
    own = bpy.data.objects.new("Own", mesh), bpy.data.objects.new("Of linked mesh", bpy.data.meshes["Cube"])
    for each in (bpy.data.objects["Cube"], *own):
        bpy.context.collection.objects.link(each)
    assert extract.scene(bpy.context.evaluated_depsgraph_get()).warnings == ()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (sentence,) = extract.scene(bpy.context.evaluated_depsgraph_get()).warnings
    kind, _, names = sentence.partition(": ")
    assert kind == "Linked data that was not found is missing from the picture"
    assert {"'Cube'", "'Material'"} <= set(names.removesuffix(".").replace(" (2)", "").split(", "))
