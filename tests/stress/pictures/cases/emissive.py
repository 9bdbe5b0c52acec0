# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that meshes light, which the camera sees too."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from ism_addon.scene import Mesh, Scene, View
from tests.scenes.parts.tables import materials_of
from tests.scenes.small import mesh, sphere, subdivided_box
from tests.support.small_scenes import light, make_scene, quad, transform

from .meshes import FLOOR, VIEW, ball

WARM = (4.0, 2.0, 1.0)
GREY = 0.7, 0.7, 0.7
LAMP = sphere((0.9, -0.6, 1.3), 0.3, 16, 8)
#: Panes of a window, and the bars between them, which see the panes from close by.
PANES = [quad((x, 1.0, z), (0.9, 0, 0), (0, 0, 0.9)) for x in (-1.0, 0.1) for z in (0.1, 1.1)]
BARS = [
    subdivided_box((-1.05, 0.85, 0.0), (1.05, 1.02, 0.1), 1),
    subdivided_box((-1.05, 0.85, 1.0), (1.05, 1.02, 1.1), 1),
    subdivided_box((-0.1, 0.85, 0.0), (0.1, 1.02, 2.0), 1),
]


def triangle(*corners: tuple[float, float, float]) -> Mesh:
    return mesh(np.array(corners), np.array([[0, 1, 2]]))


def lit_by(*emitters: Mesh, others: tuple[Mesh, ...] = (), base: float = 0.0) -> tuple[Scene, View]:
    """Emitters, which reflect `base`, over a floor with other meshes."""
    emitting = [replace(each, materials=np.ones(len(each.triangles), np.uint32)) for each in emitters]
    scene = make_scene([FLOOR, *others, *emitting], light().select(slice(0)))
    materials = materials_of([GREY, (base, base, base)], emission=[(0.0, 0.0, 0.0), WARM])
    return replace(scene, materials=materials), VIEW


def instanced() -> tuple[Scene, View]:
    """Two instances of an emitter, one of which is mirrored and flattened."""
    scene, view = lit_by(LAMP, others=(ball(24),))
    flat = transform(np.diag([-1.0, 1.0, 0.2]), (0.2, 0.0, 0.4))
    instances = replace(
        scene.instances,
        mesh=np.array([0, 1, 2, 2], np.int32),
        world_from_object=np.stack([np.eye(4), np.eye(4), np.eye(4), flat]),
        **{
            name: np.repeat(getattr(scene.instances, name), [1, 1, 2])
            for name in ("visible", "casts_shadow", "groups", "visible_diffuse", "receivers", "blockers")
        },
    )
    return replace(scene, instances=instances), view


CASES: dict[str, Callable[[], tuple[Scene, View]]] = {
    "an emissive triangle": partial(lit_by, triangle((0.1, -0.9, 0.3), (1.0, -0.5, 0.5), (0.6, -0.2, 1.3))),
    "an emissive quad": partial(lit_by, quad((0.4, -1.0, 1.2), (0, 0.8, 0), (0.8, 0, 0.2)), others=(ball(24),)),
    "an emissive quad seen from both sides": partial(lit_by, quad((-0.5, -0.9, 0.2), (1, 0, 0), (0, 0.2, 1))),
    "an emissive box on the floor": partial(lit_by, subdivided_box((0.2, -0.9, 0.0), (0.9, -0.2, 0.5), 1), base=0.5),
    "an emissive ball": partial(lit_by, LAMP, others=(ball(24),), base=0.5),
    "an emissive ball of 960 triangles": partial(lit_by, sphere((0.9, -0.6, 1.3), 0.3, 30, 17), others=(ball(24),)),
    "an emissive ball that almost touches the floor": partial(lit_by, sphere((0.4, -0.5, 0.41), 0.4, 24, 12)),
    "emissive slats": partial(lit_by, *(quad((x, -1.4, 0.6), (0.2, 0, 0), (0, 2.4, 0.1)) for x in (-0.6, 0.0, 0.6))),
    "two emissive meshes": partial(lit_by, LAMP, subdivided_box((-0.9, -1.0, 0.0), (-0.4, -0.5, 0.2), 1)),
    "a window": partial(lit_by, *PANES, others=tuple(BARS)),
    "instances of an emissive mesh": instanced,
}
