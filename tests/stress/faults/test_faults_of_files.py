# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of files that are missing or cannot be written; and nothing is lost by them."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import bpy
import pytest

from ism_addon import addon, snapshot
from ism_addon.atomic_files import atomic_write
from ism_addon.blender.sync import scene_reader
from tests.scenes.small import pillar_field
from tests.support.small_scenes import SMALL_SETTINGS
from tests.tools import project
from tests.tools.new_file import open_empty_file, open_factory_file

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="fills the disk as it is done on Linux")
GONE = "Images that are missing or cannot be read are left out, and the base colour is drawn: 'gone.png'."


@pytest.fixture
def blender() -> Iterator[bpy.types.Scene]:
    """The add-on in Blender's factory scene."""
    open_factory_file()
    addon.register()
    bpy.context.scene.render.engine = "ISM"
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 24, 16
    yield bpy.context.scene
    addon.unregister()
    open_factory_file()


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


def test_a_file_is_on_its_disk_before_it_takes_the_place_of_another(path, monkeypatch):
    """Or after a power cut there would be an empty one."""
    done = []

    def noted(name: str, function):
        monkeypatch.setattr(os, name, lambda *arguments: (done.append(name), function(*arguments)))

    noted("fsync", os.fsync)
    noted("replace", os.replace)
    snapshot.save(path, *pillar_field(24, 16), SMALL_SETTINGS)
    assert done == ["fsync", "replace"]


def test_what_a_killed_process_has_left_is_in_nobodys_way(path):
    """In a container, the next process has the same number."""
    left = path.with_name(f".{os.getpid()}.part")
    left.write_text("half a snapshot")
    snapshot.save(path, *pillar_field(24, 16), SMALL_SETTINGS)
    assert snapshot.load(path)[0].triangle_count == pillar_field(24, 16)[0].triangle_count
    assert sorted(path.parent.iterdir()) == [left, path]


def test_files_that_are_written_at_the_same_time(path):
    """By threads, into one folder: each is whole."""

    def write(number: int) -> None:
        with atomic_write(path.with_name(f"{number % 3}")) as file:
            file.write(b"%d" % (number % 3) * 10_000)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, range(400)))
    path.unlink()
    assert {each.name: each.read_bytes() for each in path.parent.iterdir()} == {
        f"{number}": b"%d" % number * 10_000 for number in range(3)
    }


@contextmanager
def somebody() -> Iterator[None]:
    """Not root, who may write everywhere."""
    before = os.geteuid()
    os.seteuid(os.getuid() or 65534)
    try:
        yield
    finally:
        os.seteuid(before)


@ON_LINUX
def test_a_file_in_a_folder_in_which_no_other_may_be_made():
    """It is written over; a new one cannot be."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder, "out.png")
        place.write_bytes(b"an older one")
        place.chmod(0o666)
        Path(folder).chmod(0o555)
        with somebody():
            with atomic_write(place) as file:
                file.write(b"newer")
            with pytest.raises(PermissionError, match=r"other\.png"), atomic_write(Path(folder, "other.png")):
                pass
        Path(folder).chmod(0o755)
        assert place.read_bytes() == b"newer"


@ON_LINUX
def test_a_picture_into_a_pipe(path):
    command = [sys.executable, "-m", "ism_addon.gpu", path, "-o", "/dev/stdout"]
    said = subprocess.run(command, cwd=project.ROOT, capture_output=True, timeout=60, check=True)
    assert said.stdout.startswith(b"\x89PNG")


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
    assert GONE in scene_reader.scene(bpy.context.evaluated_depsgraph_get()).warnings


def test_libraries_that_are_missing(blender, tmp_path):
    """Of an object, its mesh, its material or a collection: Blender puts something empty in place."""
    library, path = tmp_path / "library.blend", tmp_path / "scene.blend"
    cube = bpy.data.objects["Cube"]
    bpy.data.libraries.write(str(library), {cube, cube.data, cube.data.materials[0]})
    open_empty_file()
    with bpy.data.libraries.load(str(library), link=True) as (_, linked):
        linked.objects, linked.meshes, linked.materials = ["Cube"], ["Cube"], ["Material"]
    mesh = bpy.data.meshes.new("Own")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(bpy.data.materials["Material"])
    own = bpy.data.objects.new("Own", mesh), bpy.data.objects.new("Of linked mesh", bpy.data.meshes["Cube"])
    for each in (bpy.data.objects["Cube"], *own):
        bpy.context.collection.objects.link(each)
    assert scene_reader.scene(bpy.context.evaluated_depsgraph_get()).warnings == ()
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    (sentence,) = scene_reader.scene(bpy.context.evaluated_depsgraph_get()).warnings
    kind, _, names = sentence.partition(": ")
    assert kind == "Linked data that was not found is missing from the picture"
    assert {"'Cube'", "'Material'"} <= set(names.removesuffix(".").replace(" (2)", "").split(", "))
