# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of instances and materials with usual values."""

from collections.abc import Sequence

import numpy as np

from ism_addon.scene import Instances, Materials


def instances_of(
    mesh: Sequence[int] | np.ndarray,
    world_from_object: np.ndarray | None = None,
    **others: Sequence[bool] | Sequence[int] | np.ndarray,
) -> Instances:
    """Instances of meshes (I,) where they are, visible, with shadows and without links, but for the `others`."""
    count = len(mesh)
    usual = {
        "visible": np.ones(count, bool),
        "casts_shadow": np.ones(count, bool),
        "groups": np.zeros(count),
        "visible_diffuse": np.ones(count, bool),
        "receivers": np.full(count, -1),
        "blockers": np.full(count, -1),
    }
    matrices = np.tile(np.eye(4), (count, 1, 1)) if world_from_object is None else world_from_object
    return Instances.of(mesh=mesh, world_from_object=matrices, **usual | others)


def materials_of(
    base_color: Sequence[Sequence[float]] | np.ndarray,
    image: Sequence[int] | np.ndarray | None = None,
    emission: Sequence[Sequence[float]] | np.ndarray | None = None,
) -> Materials:
    """Materials of these base colors, or images, that emit nothing unless there is an `emission` (M,3)."""
    count = len(base_color)
    return Materials.of(
        base_color=base_color,
        image=np.full(count, -1) if image is None else image,
        emission=np.zeros((count, 3)) if emission is None else emission,
        graph=np.full(count, -1),
        first_constant=np.full(count, -1),
        constants=[],
    )
