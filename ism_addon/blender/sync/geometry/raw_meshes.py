# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays of evaluated meshes as Blender stores them, and how several are joined into one."""

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np


class Raw(NamedTuple):
    """A mesh of V vertices, F faces and L corners."""

    positions: np.ndarray  # (V,3) float32
    vertices: np.ndarray  # (L,) uint32: the vertex of each corner
    faces: int
    sides: int  # 3 or 4 if all faces have that many, else 0
    triangles: np.ndarray | None  # (T,3) int32 into the corners, Blender's triangulation; None for 3 or 4 sides
    triangle_face: np.ndarray | None  # (T,) int32: the face of each triangle; None for 3 or 4 sides
    domain: str  # of the normals, Blender's name
    normals: np.ndarray  # (V,3) float32 for POINT, (F,3) for FACE, (L,3) for CORNER
    flat: np.ndarray | None  # (F,) bool: flat-shaded faces; None if they are shaded by their face normals
    slots: np.ndarray | None  # (F,) int32: the material slot of each face; None if all have the first
    uvs: np.ndarray | None  # (L,2) float32
    materials: tuple[int, ...]  # of the slots, into Materials
    attributes: np.ndarray | None = None  # (L,A,4) float32, see attributes.py

    @property
    def layout(self) -> tuple:
        """Meshes of the same layout can be joined."""
        attributes = 0 if self.attributes is None else self.attributes.shape[1]
        return self.sides, self.domain, self.flat is None, self.slots is None, self.uvs is None, attributes

    @property
    def triangle_count(self) -> int:
        """Triangles of all faces."""
        return len(self.triangles) if self.triangles is not None else self.faces * (self.sides - 2)


def joined(raws: Sequence[Raw]) -> Raw:
    """Meshes of the same layout as one, with slots clipped to the existing ones."""
    if len(raws) == 1:
        (raw,) = raws
        return raw if raw.slots is None else raw._replace(slots=np.clip(raw.slots, 0, len(raw.materials) - 1))
    (
        positions,
        vertices,
        counts,
        sides,
        triangles,
        triangle_face,
        domains,
        normals,
        flat,
        slots,
        uvs,
        materials,
        attributes,
    ) = zip(*raws, strict=True)
    if slots[0] is None:
        materials, all_slots = [each[:1] for each in materials], np.zeros(sum(counts), np.int32)
    else:
        all_slots = np.concatenate(slots)
    lengths = [len(each) for each in materials]
    last = np.subtract(lengths, 1).repeat(counts)
    return Raw(
        positions=np.concatenate(positions),
        vertices=concatenated(vertices, [len(each) for each in positions]),
        faces=sum(counts),
        sides=sides[0],
        triangles=None if sides[0] else concatenated(triangles, [len(each) for each in vertices]),
        triangle_face=None if sides[0] else concatenated(triangle_face, counts),
        domain=domains[0],
        normals=np.concatenate(normals),
        flat=None if flat[0] is None else np.concatenate(flat),
        slots=np.clip(all_slots, 0, last) + starts(lengths).repeat(counts),
        uvs=None if uvs[0] is None else np.concatenate(uvs),
        materials=tuple(chain.from_iterable(materials)),
        attributes=None if attributes[0] is None else np.concatenate(attributes),
    )


def starts(lengths: Sequence[int]) -> np.ndarray:
    """The first index of each array in their concatenation."""
    return np.cumsum(lengths) - lengths


def concatenated(indices: Sequence[np.ndarray], lengths: Sequence[int]) -> np.ndarray:
    """Indices into arrays of these lengths, as indices into the concatenation of the arrays."""
    first = starts(lengths).repeat([len(each) for each in indices])
    result = np.concatenate(indices)
    return result + first.astype(result.dtype).reshape(-1, *[1] * (result.ndim - 1))
