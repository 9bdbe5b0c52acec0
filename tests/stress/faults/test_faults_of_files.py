# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are missing or cannot be written: the message, and that existing files are kept."""

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
IMAGE_WARNING = "Images that are missing or cannot be read are magenta, as in Blender: 'gone.png'."


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
def file_size_limit(size: int) -> Iterator[None]:
    """As on a full disk, no file can become larger than `size` bytes."""
    import resource

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@ON_LINUX
def test_a_full_disk_while_a_snapshot_is_written(blender, snapshot_path):
    """The older snapshot is kept, and no partial file is left."""
    before = snapshot_path.read_bytes()
    with pytest.raises(RuntimeError) as report, file_size_limit(4000):
        bpy.ops.ism.save_snapshot(filepath=str(snapshot_path))
    assert str(report.value) == f"Error: The snapshot was not saved: File too large: {snapshot_path}\n"
    assert snapshot_path.read_bytes() == before
    assert list(snapshot_path.parent.iterdir()) == [snapshot_path]


@ON_LINUX
def test_a_full_disk_while_a_picture_is_written(cli_error, snapshot_path):
    assert cli_error(snapshot_path, "-o", "/dev/full") == "[Errno 28] No space left on device: '/dev/full'"
    picture = snapshot_path.with_name("out.png")
    picture.write_text("an older one")
    with file_size_limit(100):
        assert cli_error(snapshot_path, "-o", picture) == f"[Errno 27] File too large: '{picture}'"
    assert picture.read_text() == "an older one"


@ON_LINUX
def test_a_replaced_file_keeps_its_mode_and_links(snapshot_path):
    """A symbolic link to it still is one."""
    link = snapshot_path.with_name("link.npz")
    link.symlink_to(snapshot_path)
    snapshot_path.chmod(0o600)
    snapshot.save(link, *pillar_field(24, 16), SMALL_SETTINGS)
    assert link.is_symlink()
    assert snapshot_path.stat().st_mode & 0o777 == 0o600
    assert snapshot.load(snapshot_path)[0].triangle_count == pillar_field(24, 16)[0].triangle_count


def test_a_file_is_on_disk_before_it_replaces_another(snapshot_path, monkeypatch):
    """Otherwise a power cut could leave an empty file."""
    calls = []

    def record(name: str, function):
        monkeypatch.setattr(os, name, lambda *arguments: (calls.append(name), function(*arguments)))

    record("fsync", os.fsync)
    record("replace", os.replace)
    snapshot.save(snapshot_path, *pillar_field(24, 16), SMALL_SETTINGS)
    assert calls == ["fsync", "replace"]


def test_a_temporary_file_of_a_killed_process_does_no_harm(snapshot_path):
    """In a container the next process may have the same id, which is in the name of the temporary file."""
    leftover = snapshot_path.with_name(f".{os.getpid()}.part")
    leftover.write_text("half a snapshot")
    snapshot.save(snapshot_path, *pillar_field(24, 16), SMALL_SETTINGS)
    assert snapshot.load(snapshot_path)[0].triangle_count == pillar_field(24, 16)[0].triangle_count
    assert sorted(snapshot_path.parent.iterdir()) == [leftover, snapshot_path]


def test_files_that_are_written_at_the_same_time(snapshot_path):
    """Threads write into one folder: each file is complete."""

    def write(index: int) -> None:
        with atomic_write(snapshot_path.with_name(f"{index % 3}")) as file:
            file.write(b"%d" % (index % 3) * 10_000)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, range(400)))
    snapshot_path.unlink()
    assert {each.name: each.read_bytes() for each in snapshot_path.parent.iterdir()} == {
        f"{index}": b"%d" % index * 10_000 for index in range(3)
    }


@contextmanager
def unprivileged_user() -> Iterator[None]:
    """Another user than root, who may write everywhere."""
    before = os.geteuid()
    os.seteuid(os.getuid() or 65534)
    try:
        yield
    finally:
        os.seteuid(before)


@ON_LINUX
def test_a_writable_file_in_a_read_only_folder():
    """The file is overwritten; a new one cannot be made."""
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder, "out.png")
        output.write_bytes(b"an older one")
        output.chmod(0o666)
        Path(folder).chmod(0o555)
        with unprivileged_user():
            with atomic_write(output) as file:
                file.write(b"newer")
            with pytest.raises(PermissionError, match=r"other\.png"), atomic_write(Path(folder, "other.png")):
                pass
        Path(folder).chmod(0o755)
        assert output.read_bytes() == b"newer"


@ON_LINUX
def test_a_picture_into_a_pipe(snapshot_path):
    command = [sys.executable, "-m", "ism_addon.gpu", snapshot_path, "-o", "/dev/stdout"]
    completed = subprocess.run(command, cwd=project.ROOT, capture_output=True, timeout=60, check=True)
    assert completed.stdout.startswith(b"\x89PNG")


def test_images_that_are_missing(blender, tmp_path):
    """A warning says that they are magenta, as in Blender."""
    image = bpy.data.images.new("gone.png", 2, 2)
    image.source, image.filepath = "FILE", str(tmp_path / "gone.png")
    material = bpy.data.materials.new("Painted")
    material.use_nodes = True
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    surface = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(texture.outputs["Color"], surface.inputs["Base Color"])
    bpy.data.objects["Cube"].data.materials[0] = material
    assert IMAGE_WARNING in scene_reader.scene(bpy.context.evaluated_depsgraph_get()).warnings


def test_libraries_that_are_missing(blender, tmp_path):
    """Blender replaces linked data of a missing library by empty data-blocks; a warning names them."""
    library, blend_path = tmp_path / "library.blend", tmp_path / "scene.blend"
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
    bpy.ops.wm.save_as_mainfile(filepath=str(blend_path))
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(blend_path))
    (warning,) = scene_reader.scene(bpy.context.evaluated_depsgraph_get()).warnings
    issue, _, names = warning.partition(": ")
    assert issue == "Linked data that was not found is missing from the picture"
    assert {"'Cube'", "'Material'"} <= set(names.removesuffix(".").replace(" (2)", "").split(", "))
