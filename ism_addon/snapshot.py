# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots: scene, view and settings in one .npz file, from which an image can be rendered again.

Every array is a member, named by its path ("scene/meshes/0/positions"). All other values are JSON in the member
"snapshot". It is read according to the dataclasses' type hints and ArraySpecs. Members are not compressed, so no
array can be larger than the file.
"""

import json
import math
import os
import stat
import zipfile
from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass
from enum import StrEnum
from pathlib import Path
from typing import IO, Any, get_args, get_origin, get_type_hints

import numpy as np

from . import old_names
from .atomic_files import atomic_write
from .scene import Scene, View
from .scene.arrays import Arrays, ArraySpec, array_specs
from .scene.limits import MAX_DISTANCE, is_invertible, spans_plane
from .scene.quoting import shortened
from .settings import Settings

VERSION = 3
#: The oldest version that can be read. Its settings have other names, and its lights fewer fields.
PREVIOUS_VERSION = 2


#: Of materials without rows of all of them, the fields of graphs that rays read.
GRAPHS = {"transparency": "transparency", "emission": "emission_graph"}


class SnapshotError(ValueError):
    """The file is not a snapshot that this version can read. The message is one sentence."""


def save(path: str | Path, scene: Scene, view: View, settings: Settings) -> None:
    """Write a snapshot. `load` returns identical arrays. Raises OSError; then `path` keeps its contents."""
    arrays: dict[str, np.ndarray] = {}
    values = {"scene": scene, "view": view, "settings": settings}
    encoded = {"version": VERSION, **{name: _to_json(value, name, arrays) for name, value in values.items()}}
    text = np.frombuffer(json.dumps(encoded, allow_nan=False).encode(), np.uint8)
    # numpy.savez leaves the archive open when the disk is full, and raises again when it is freed.
    with atomic_write(path) as file, zipfile.ZipFile(file, "w") as archive:
        for name, array in {"snapshot": text, **arrays}.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)


def load(path: str | Path) -> tuple[Scene, View, Settings]:
    """Read and validate a snapshot. Raises SnapshotError, or OSError if the file cannot be opened."""
    state = os.stat(path)
    if not stat.S_ISREG(state.st_mode):  # such as /dev/zero, which has no end
        raise SnapshotError(f"{path} is not a snapshot: it is no plain file.")
    with open(path, "rb") as file:
        try:
            arrays = _members(file, state.st_size)
            encoded = json.loads(arrays.pop("snapshot").tobytes())
            version = encoded["version"]
        except Exception as error:  # zipfile, numpy and json raise various errors on invalid bytes
            raise SnapshotError(
                f"{path} is not a snapshot: {shortened(str(error) or type(error).__name__)}."
            ) from error
    if version == PREVIOUS_VERSION:
        encoded["settings"] = old_names.current(encoded.get("settings"))
        encoded["scene"], arrays = old_names.current_scene(encoded.get("scene")), old_names.current_arrays(arrays)
    elif version != VERSION:
        raise SnapshotError(
            f"{path} is a snapshot of version {shortened(str(version))}; this one reads version {VERSION}."
        )
    scene, view, settings = (
        _from_json(type_, encoded.get(name), name, arrays)
        for name, type_ in (("scene", Scene), ("view", View), ("settings", Settings))
    )
    _check_indices(scene)
    _check_vectors(scene)
    _check_view(view)
    return scene, view, settings


def _members(file: IO[bytes], size: int) -> dict[str, np.ndarray]:
    """The file's arrays. Raises ValueError if they are larger than the file."""
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
    """The array of a member. numpy's own reader would allocate as much memory as the header claims."""
    version = np.lib.format.read_magic(content)
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_columns, dtype = header(content)
    return np.frombuffer(content.read(), dtype).reshape(shape, order="F" if by_columns else "C")


def _to_json(value: Any, path: str, arrays: dict[str, np.ndarray]) -> Any:
    """A value as JSON. Its arrays are stored in `arrays` by their paths."""
    if is_dataclass(value):
        return {
            member.name: _to_json(getattr(value, member.name), f"{path}/{member.name}", arrays)
            for member in fields(value)
        }
    if isinstance(value, tuple):
        return [_to_json(item, f"{path}/{index}", arrays) for index, item in enumerate(value)]
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return None
    return value.item() if isinstance(value, np.generic) else value


def _from_json(type_: Any, encoded: Any, path: str, arrays: dict[str, np.ndarray]) -> Any:
    """The value of this type that `_to_json` has encoded."""
    if isinstance(type_, type) and is_dataclass(type_):
        return _built_object(type_, encoded, path, arrays)
    if get_origin(type_) is tuple:
        if not isinstance(encoded, list):
            raise SnapshotError(f"The snapshot's {path} is not a list.")
        item = get_args(type_)[0]
        return tuple(_from_json(item, each, f"{path}/{index}", arrays) for index, each in enumerate(encoded))
    if issubclass(type_, StrEnum):
        if encoded not in list(type_):
            raise SnapshotError(
                f"The snapshot's {path} is {shortened(repr(encoded))}, none of {shortened(', '.join(type_))}."
            )
        return type_(encoded)
    if type_ is float and type(encoded) is int and abs(encoded) < MAX_DISTANCE:
        encoded = float(encoded)
    if type(encoded) is not type_ or (type_ is float and not math.isfinite(encoded)):
        raise SnapshotError(f"The snapshot's {path} is {shortened(repr(encoded))}, which is no {type_.__name__}.")
    return encoded


def _built_object(type_: type, encoded: Any, path: str, arrays: dict[str, np.ndarray]) -> Any:
    if not isinstance(encoded, dict):
        raise SnapshotError(f"The snapshot has no {path}.")
    if unknown := set(encoded) - {member.name for member in fields(type_)}:
        raise SnapshotError(
            f"The snapshot's {path} has {shortened(', '.join(sorted(unknown)))}, unknown to this version."
        )
    hints, specs = get_type_hints(type_), array_specs(type_)
    lengths: dict[str, int] = {}
    values = {}
    for member in fields(type_):
        member_path = f"{path}/{member.name}"
        if member.name in specs:
            values[member.name] = _array(specs[member.name], member_path, lengths, arrays)
        elif member.name in encoded:
            values[member.name] = _from_json(hints[member.name], encoded[member.name], member_path, arrays)
        elif member.default is MISSING:
            raise SnapshotError(f"The snapshot has no {member_path}.")
    try:
        return type_(**values)
    except ValueError as error:
        raise SnapshotError(f"The snapshot's {path} cannot be used: {shortened(str(error))}.") from error


def _array(spec: ArraySpec, path: str, lengths: dict[str, int], arrays: dict[str, np.ndarray]) -> np.ndarray:
    """The array of a field, validated; `lengths` collects the lengths of the layouts' letters."""
    if path not in arrays:
        raise SnapshotError(f"The snapshot has no {path}.")
    if (fault := spec.fault(arrays[path], lengths)) is not None:
        raise SnapshotError(f"The snapshot's {path} {fault}.")
    return np.ascontiguousarray(arrays[path])


def _check_vectors(scene: Scene) -> None:
    """Raise if a mesh or a light has no size."""
    matrices = scene.instances.world_from_object
    if not np.allclose(matrices[:, 3], (0.0, 0.0, 0.0, 1.0), atol=0.01) or not is_invertible(matrices[:, :3, :3]).all():
        raise SnapshotError("The snapshot's scene/instances/world_from_object flattens a mesh, or does not place it.")
    if not spans_plane(scene.lights.axis_u, scene.lights.axis_v).all():
        raise SnapshotError("The snapshot's scene/lights have one without a size.")


def _check_view(view: View) -> None:
    """Raise if the view is not rigid, or the projection is neither perspective nor orthographic."""
    rotation, last_row = view.view_from_world[:3, :3], view.view_from_world[3]
    if not (
        np.allclose(rotation @ rotation.T, np.eye(3), atol=0.01)
        and np.allclose(last_row, (0.0, 0.0, 0.0, 1.0), atol=0.01)
    ):
        raise SnapshotError("The snapshot's view/view_from_world is not rigid.")
    (x, y, z), depth = np.diag(view.clip_from_view)[:3], view.clip_from_view[2, 3]
    perspective = tuple(view.clip_from_view[3]) == (0.0, 0.0, -1.0, 0.0) and z <= -1.0 and depth < 0.0
    orthographic = tuple(view.clip_from_view[3]) == (0.0, 0.0, 0.0, 1.0) and z < 0.0
    if min(abs(x), abs(y)) * MAX_DISTANCE < 1.0 or not (perspective or orthographic):
        raise SnapshotError("The snapshot's view/clip_from_view is neither a perspective nor an orthographic view.")


def _check_indices(scene: Scene) -> None:
    """Raise if an index is out of range."""
    for index, mesh in enumerate(scene.meshes):
        path = f"scene/meshes/{index}"
        if not len(mesh.triangles):
            raise SnapshotError(f"The snapshot's {path} has no triangles.")
        for name in ("uvs", "attributes"):
            if len(getattr(mesh, name)) not in (0, len(mesh.triangles)):
                raise SnapshotError(f"The snapshot's {path}/{name} has another length than its triangles.")
    if len(scene.instances.attributes) not in (0, scene.instances.row_count):
        raise SnapshotError("The snapshot's scene/instances/attributes has another length than its instances.")
    for path, record in _records(scene, "scene"):
        for name, spec in array_specs(type(record)).items():
            indices = getattr(record, name)
            if spec.into == "" or not indices.size:
                continue
            end = spec.into if isinstance(spec.into, int) else _length(name, spec.into, record, scene)
            if not (spec.first <= int(indices.min()) and int(indices.max()) < end):
                raise SnapshotError(f"The snapshot's {path}/{name} leads outside {spec.first} to {end - 1}.")
    _check_graphs(scene)
    texels = {"images": [image.texels for image in scene.images]}
    texels["light_images"] = [image.colors for image in scene.light_images]
    for name, images in texels.items():
        if empty := [index for index, each in enumerate(images) if each.size == 0]:
            raise SnapshotError(f"The snapshot's scene/{name}/{empty[0]} has no texels.")


def _check_graphs(scene: Scene) -> None:
    """Raise if a material has no constants where its graph reads them, or a constant is no index of an image."""
    read = [
        each.parameter
        for graph in scene.graphs
        for each in graph.instructions
        if each.operation == "instance_attribute"
    ]
    if not all(0 <= index < scene.instances.attributes.shape[1] for index in read):
        raise SnapshotError("The snapshot's scene/graphs read attributes of instances that it has not.")
    table = scene.materials
    graphs, first_constants = table.graph, table.first_constant
    for name in ("transparency", "emission"):
        own, first = getattr(table, GRAPHS[name]), getattr(table, f"{name}_constant")
        if len(own) not in (0, table.row_count):
            raise SnapshotError(f"The snapshot's scene/materials/{name} has another length than its materials.")
        graphs, first_constants = np.append(graphs, own), np.append(first_constants, first)
    _check_constants(scene, "materials", graphs, first_constants, table.constants)
    _check_constants(scene, "world", scene.world.graph, scene.world.first_constant, scene.world.constants)


def _check_constants(
    scene: Scene, owner: str, graphs: np.ndarray, first_constants: np.ndarray, constants: np.ndarray
) -> None:
    """Raise if the constants of any graph of an owner are not all there, or name an image that is not."""
    for row in np.flatnonzero(graphs >= 0):
        graph, first = scene.graphs[graphs[row]], int(first_constants[row])
        own = constants[max(first, 0) : max(first, 0) + graph.rows]
        if len(own) < graph.rows:
            raise SnapshotError(f"The snapshot's scene/{owner}/first_constant leads outside of its constants: {first}.")
        for (row_index, first_number), type_ in zip(graph.locations, graph.constants, strict=True):
            if type_ == "image" and own[row_index, first_number] not in range(len(scene.images)):
                raise SnapshotError(f"The snapshot's scene/{owner}/constants name an image that it has not.")


def _records(value: Any, path: str) -> Iterator[tuple[str, Arrays]]:
    """All records within a value, with their paths."""
    if isinstance(value, Arrays):
        yield path, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _records(item, f"{path}/{index}")
    elif is_dataclass(value):
        for member in fields(value):
            yield from _records(getattr(value, member.name), f"{path}/{member.name}")


def _length(name: str, into: str, record: Arrays, scene: Scene) -> int:
    """Length of the target of a field of indices: another array of its record, or a tuple or record of the scene."""
    target = getattr(record if into in array_specs(type(record)) and into != name else scene, into)
    return target.row_count if isinstance(target, Arrays) else len(target)
