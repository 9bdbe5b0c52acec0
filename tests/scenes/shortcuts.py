# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of which much can be left out, or taken from the one before: the cases of `dev.py bench skip`.

Each has the counts that must hold; tests assert them on small pictures, the benchmark reports what they save on large.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from ism_addon.scene import Scene, View
from ism_addon.settings import Method, Quality, Settings
from tests.scenes.changes import (
    EDITS,
    FIRST,
    OCCLUSION,
    SHARED,
    WITHOUT_LIGHT,
    WITHOUT_OCCLUSION,
    WITHOUT_SHADOWS,
    Edit,
    tiny_radius,
)
from tests.scenes.rooms import IDLE, SEEN, SIZE, corner_of, rooms
from tests.scenes.small import sphere
from tests.scenes.small import view as looking

Picture = tuple[Scene, View, Settings]
SAMPLES = 16
IDLE_LIGHTS = 195

#: A room beyond the wall behind the camera.
NEXT_DOOR = (SEEN[0] - 1, *SEEN[1:])

#: What may be uploaded for each triangle, its part of a tree included; and for instances, lights and materials.
BYTES_A_TRIANGLE = 64
OTHER_BYTES = 1 << 18


@dataclass(frozen=True)
class Case:
    """A picture, perhaps after another by the same renderer, and what must hold of it."""

    name: str
    picture: Picture
    before: Picture | None = None
    drawn: frozenset[str] | None = None  # the passes that must be drawn
    never: frozenset[str] = frozenset()  # those that must not be
    equal: dict[str, int] = field(default_factory=dict)  # counts that must be just so
    at_most: dict[str, int] = field(default_factory=dict)  # or no more than this


def words(function: object) -> str:
    return function.__name__.replace("_", " ")


def settings(method: Method = Method.RAY_TRACED, samples: int = SAMPLES) -> Settings:
    """The defaults, with so many samples whatever their error."""
    base = Settings(quality=Quality(samples=samples, error_threshold=0.0))
    return replace(base, shadow=replace(base.shadow, method=method))


def cases(width: int = 640, height: int = 360) -> Iterator[Case]:
    """All of them, at a size."""
    scene, view = rooms({}, width, height)
    whole = scene, view, settings()
    pixels = width * height
    of_them = SAMPLES * scene.triangle_count // 4  # the other rooms are beside the picture
    yield Case("first picture", whole, equal={"lights_used": 5}, at_most={"triangles_drawn": of_them})
    sky = looking((0.6, 0.4, 40.0), (0.6, 9.0, 80.0), width, height)
    nothing = {"lights_used": 0, "pairs_traced": 0, "retests": 0}
    yield Case("nothing but background", (scene, sky, settings()), equal=nothing)
    yield from (edited(edit, *whole[:2], method) for method in Method for edit in EDITS)
    for lack in WITHOUT_LIGHT + WITHOUT_SHADOWS:
        lacking, without = lack(scene, settings())
        never = {"BuildBLAS", "BuildTLAS", "ProbeVisibility", "RetestOccluded", "PredictVisibility"}
        yield Case(words(lack), (lacking, view, without), never=frozenset(never), equal={"pairs_traced": 0})
    for lack in WITHOUT_OCCLUSION:
        lacking, without = lack(scene, settings())
        if lack is not tiny_radius:  # in a room, a camera may be as close as it likes to what it sees
            yield Case(words(lack), (lacking, view, without), never=frozenset(OCCLUSION))
    beside, triangles = with_ball_next_door(scene)
    at_most = {"bytes_uploaded": BYTES_A_TRIANGLE * (triangles - len(beside.meshes[-1].triangles)) + OTHER_BYTES}
    yield Case("a dense ball next door", (beside, view, settings()), at_most=at_most)
    for why in IDLE:
        lit, _ = rooms({why: IDLE_LIGHTS}, width, height)
        looked_for = {"hidden": 4 * pixels, "faint": pixels}.get(why, 0)
        used = 5 + (IDLE_LIGHTS // 10 if why == "faint" else 0)  # here and there in the dark they may count
        at_most = {"retests": looked_for, "lights_used": used}
        yield Case(f"{IDLE_LIGHTS} lights {why}", (lit, view, settings()), at_most=at_most)


def with_ball_next_door(scene: Scene) -> tuple[Scene, int]:
    """A ball of many triangles in the room behind the camera's, into which no light of ours shines; and all meshes'."""
    ball, instances = sphere((0.0, 0.0, 0.0), 0.8, 300, 200), scene.instances
    matrix = np.eye(4)
    matrix[:3, 3] = corner_of(NEXT_DOOR) + SIZE / 2.0
    added = replace(
        instances,
        mesh=np.append(instances.mesh, np.int32(len(scene.meshes))),
        world_from_object=np.concatenate([instances.world_from_object, matrix[None]]),
        visible=np.append(instances.visible, True),
        casts_shadow=np.append(instances.casts_shadow, True),
        groups=np.append(instances.groups, np.uint32(0)),
    )
    meshes = (*scene.meshes, ball)
    return replace(scene, meshes=meshes, instances=added), sum(len(mesh.triangles) for mesh in meshes)


def edited(edit: Edit, scene: Scene, view: View, method: Method) -> Case:
    """A first sample after the same one before an edit."""
    one = settings(method, 1)
    drawn = frozenset(SHARED[method][edit] | FIRST[method][edit])
    return Case(f"{words(edit)}, {method.label}", (*edit(scene, view), one), (scene, view, one), drawn)
