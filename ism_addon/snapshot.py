# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene, view and settings to one .npz file and back: all that a picture is made of, so a bug report is a file.

Every array is a member of its own, named by where it stands ("scene/meshes/0/positions"); all else is JSON
in the member "snapshot". The dataclasses' type hints and arrays' facts say how to read it back.
Members are not compressed, so no array can be larger than the file that claims to hold it.
"""

import json
import math
import os
import stat
import zipfile
from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import IO, Any, get_args, get_origin, get_type_hints

import numpy as np

from . import old_names
from .atomic_files import atomic_write
from .scene import Scene, View
from .scene.arrays import ArrayFacts, Arrays, array_facts
from .scene.limits import MAX_DISTANCE, is_invertible, spans_plane
from .scene.quoting import shortened
from .settings import Choice, Settings

VERSION = 3
#: This one is read, too: its settings have other names.
BEFORE = 2


class SnapshotError(ValueError):
    """The file is no snapshot that this version can read: the message is one sentence."""


def save(path: str | Path, scene: Scene, view: View, settings: Settings) -> None:
    """Write a snapshot. Arrays come back from `load` bit for bit. Raises OSError; what was there before then stays."""
    arrays: dict[str, np.ndarray] = {}
    parts = {"scene": scene, "view": view, "settings": settings}
    told = {"version": VERSION, **{name: _to_json(part, name, arrays) for name, part in parts.items()}}
    text = np.frombuffer(json.dumps(told, allow_nan=False).encode(), np.uint8)
    # numpy's own savez would leave the archive open when the disk is full, to complain about it later.
    with atomic_write(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, array in {"snapshot": text, **arrays}.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)


def load(path: str | Path) -> tuple[Scene, View, Settings]:
    """Read a snapshot and check all of it. Raises SnapshotError, or OSError if the file cannot be opened."""
    state = os.stat(path)
    if not stat.S_ISREG(state.st_mode):  # such as /dev/zero, which never ends
        raise SnapshotError(f"{path} is not a snapshot: it is no plain file.")
    with open(path, "rb") as file:
        try:
            arrays = _members(file, state.st_size)
            told = json.loads(arrays.pop("snapshot").tobytes())
            version = told["version"]
        except Exception as error:  # whatever zipfile, numpy and json raise on bytes that are not theirs
            raise SnapshotError(
                f"{path} is not a snapshot: {shortened(str(error) or type(error).__name__)}."
            ) from error
    if version == BEFORE:
        told["settings"] = old_names.current(told.get("settings"))
    elif version != VERSION:
        raise SnapshotError(
            f"{path} is a snapshot of version {shortened(str(version))}; this one reads version {VERSION}."
        )
    scene, view, settings = (
        _from_json(kind, told.get(name), name, arrays)
        for name, kind in (("scene", Scene), ("view", View), ("settings", Settings))
    )
    _check_indices(scene)
    _check_vectors(scene)
    _check_view(view)
    return scene, view, settings


def _members(file: IO[bytes], size: int) -> dict[str, np.ndarray]:
    """The file's arrays, none of which can be larger than the file."""
    arrays = {}
    with zipfile.ZipFile(file) as archive:
        members = archive.infolist()
        if sum(member.file_size for member in members) > size:
            raise ValueError("its arrays are larger than the file")
        if any(member.compress_type != zipfile.ZIP_STORED for member in members):
            raise ValueError("its arrays are compressed")
        for member in members:
            with archive.open(member) as content:
                arrays[member.filename.removesuffix(".npy")] = _member(content)
    return arrays


def _member(content: IO[bytes]) -> np.ndarray:
    """The array of a file's member: numpy's own reader would ask for as much memory as its header claims."""
    version = np.lib.format.read_magic(content)
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_columns, dtype = header(content)
    return np.frombuffer(content.read(), dtype).reshape(shape, order="F" if by_columns else "C")


def _to_json(value: Any, place: str, arrays: dict[str, np.ndarray]) -> Any:
    """A value as JSON, its arrays put aside under the names of their places."""
    if is_dataclass(value):
        return {
            member.name: _to_json(getattr(value, member.name), f"{place}/{member.name}", arrays)
            for member in fields(value)
        }
    if isinstance(value, tuple):
        return [_to_json(item, f"{place}/{index}", arrays) for index, item in enumerate(value)]
    if isinstance(value, np.ndarray):
        arrays[place] = value
        return None
    return value.item() if isinstance(value, np.generic) else value


def _from_json(kind: Any, told: Any, place: str, arrays: dict[str, np.ndarray]) -> Any:
    """The value of a type that `_to_json` told of."""
    if isinstance(kind, type) and is_dataclass(kind):
        return _built_object(kind, told, place, arrays)
    if get_origin(kind) is tuple:
        if not isinstance(told, list):
            raise SnapshotError(f"The snapshot's {place} is not a list.")
        item = get_args(kind)[0]
        return tuple(_from_json(item, each, f"{place}/{index}", arrays) for index, each in enumerate(told))
    if issubclass(kind, Choice):
        if told not in list(kind):
            raise SnapshotError(f"The snapshot's {place} is {shortened(repr(told))}, none of {', '.join(kind)}.")
        return kind(told)
    if kind is float and type(told) is int and abs(told) < MAX_DISTANCE:
        told = float(told)
    if type(told) is not kind or (kind is float and not math.isfinite(told)):
        raise SnapshotError(f"The snapshot's {place} is {shortened(repr(told))}, which is no {kind.__name__}.")
    return told


def _built_object(kind: type, told: Any, place: str, arrays: dict[str, np.ndarray]) -> Any:
    if not isinstance(told, dict):
        raise SnapshotError(f"The snapshot has no {place}.")
    if unknown := set(told) - {member.name for member in fields(kind)}:
        raise SnapshotError(
            f"The snapshot's {place} has {shortened(', '.join(sorted(unknown)))}, unknown to this version."
        )
    hints, facts = get_type_hints(kind), array_facts(kind)
    lengths: dict[str, int] = {}
    values = {}
    for member in fields(kind):
        where = f"{place}/{member.name}"
        if member.name in facts:
            values[member.name] = _array(facts[member.name], where, lengths, arrays)
        elif member.name in told:
            values[member.name] = _from_json(hints[member.name], told[member.name], where, arrays)
        elif member.default is MISSING:
            raise SnapshotError(f"The snapshot has no {where}.")
    try:
        return kind(**values)
    except ValueError as error:
        raise SnapshotError(f"The snapshot's {place} cannot be used: {shortened(str(error))}.") from error


def _array(facts: ArrayFacts, place: str, lengths: dict[str, int], arrays: dict[str, np.ndarray]) -> np.ndarray:
    """An array that is as its field says; the letters' lengths are kept in `lengths`."""
    if place not in arrays:
        raise SnapshotError(f"The snapshot has no {place}.")
    if (fault := facts.fault(arrays[place], lengths)) is not None:
        raise SnapshotError(f"The snapshot's {place} {fault}.")
    return np.ascontiguousarray(arrays[place])


def _check_vectors(scene: Scene) -> None:
    """Meshes and lights have a size."""
    matrices = scene.instances.world_from_object
    if not np.allclose(matrices[:, 3], (0.0, 0.0, 0.0, 1.0), atol=0.01) or not is_invertible(matrices[:, :3, :3]).all():
        raise SnapshotError("The snapshot's scene/instances/world_from_object flattens a mesh, or does not place it.")
    if not spans_plane(scene.lights.axis_u, scene.lights.axis_v).all():
        raise SnapshotError("The snapshot's scene/lights have one without a size.")


def _check_view(view: View) -> None:
    """The camera is turned and moved, no more, and its projection is one."""
    turn, last = view.view_from_world[:3, :3], view.view_from_world[3]
    if not (np.allclose(turn @ turn.T, np.eye(3), atol=0.01) and np.allclose(last, (0.0, 0.0, 0.0, 1.0), atol=0.01)):
        raise SnapshotError("The snapshot's view/view_from_world is not rigid.")
    (x, y, z), depth = np.diag(view.clip_from_view)[:3], view.clip_from_view[2, 3]
    perspective = tuple(view.clip_from_view[3]) == (0.0, 0.0, -1.0, 0.0) and z <= -1.0 and depth < 0.0
    orthographic = tuple(view.clip_from_view[3]) == (0.0, 0.0, 0.0, 1.0) and z < 0.0
    if min(abs(x), abs(y)) * MAX_DISTANCE < 1.0 or not (perspective or orthographic):
        raise SnapshotError("The snapshot's view/clip_from_view is neither a perspective nor an orthographic view.")


def _check_indices(scene: Scene) -> None:
    """No index may lead outside what it leads into."""
    for index, mesh in enumerate(scene.meshes):
        place = f"scene/meshes/{index}"
        if not len(mesh.triangles):
            raise SnapshotError(f"The snapshot's {place} has no triangles.")
        if len(mesh.uvs) not in (0, len(mesh.triangles)):
            raise SnapshotError(f"The snapshot's {place}/uvs has another length than its triangles.")
    for place, record in _records(scene, "scene"):
        for name, facts in array_facts(type(record)).items():
            indices = getattr(record, name)
            if facts.into == "" or not indices.size:
                continue
            end = facts.into if isinstance(facts.into, int) else _length(facts.into, record, scene)
            if not (facts.first <= int(indices.min()) and int(indices.max()) < end):
                raise SnapshotError(f"The snapshot's {place}/{name} leads outside {facts.first} to {end - 1}.")
    for index, image in enumerate(scene.images):
        if image.texels.size == 0:
            raise SnapshotError(f"The snapshot's scene/images/{index} has no texels.")


def _records(value: Any, place: str) -> Iterator[tuple[str, Arrays]]:
    """All records within a value, and where they are."""
    if isinstance(value, Arrays):
        yield place, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _records(item, f"{place}/{index}")
    elif is_dataclass(value):
        for member in fields(value):
            yield from _records(getattr(value, member.name), f"{place}/{member.name}")


def _length(name: str, record: Arrays, scene: Scene) -> int:
    """Of what indices of a record lead into: an array of its own, or a tuple or a record of the scene."""
    target = getattr(record if name in array_facts(type(record)) else scene, name)
    return target.row_count if isinstance(target, Arrays) else len(target)
