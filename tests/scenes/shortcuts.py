# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures for which much work can be skipped or reused: the cases of `dev.py bench skip`.

Each case has the counts that are expected. Tests assert them on small pictures; the benchmark measures the time saved.
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
from tests.scenes.rooms import IDLE, SIZE, VISIBLE_ROOM, room_corner, rooms
from tests.scenes.small import sphere
from tests.scenes.small import view as look_at

Picture = tuple[Scene, View, Settings]
SAMPLES = 16
IDLE_LIGHTS = 195

#: The room beyond the wall behind the camera.
ROOM_BEHIND_CAMERA = (VISIBLE_ROOM[0] - 1, *VISIBLE_ROOM[1:])

#: Most bytes uploaded: for each triangle, its BVH nodes included; and for instances, lights and materials together.
BYTES_PER_TRIANGLE = 64
OTHER_BYTES = 1 << 18


@dataclass(frozen=True)
class Case:
    """A picture, drawn by a new renderer or after another picture, and what is expected of it."""

    name: str
    picture: Picture
    before: Picture | None = None
    drawn: frozenset[str] | None = None  # exactly the passes that must be drawn
    never: frozenset[str] = frozenset()  # passes that must not be drawn
    equal: dict[str, int] = field(default_factory=dict)  # counts and their exact values
    at_most: dict[str, int] = field(default_factory=dict)  # counts and their upper bounds


def function_title(function: object) -> str:
    """A function's name in words."""
    return function.__name__.replace("_", " ")


def settings(method: Method = Method.RAY_TRACED, samples: int = SAMPLES) -> Settings:
    """The defaults, with a fixed number of samples. Ambient occlusion darkens the world's light."""
    base = Settings(quality=Quality(samples=samples, error_threshold=0.0))
    return replace(base, shadow=replace(base.shadow, method=method, world=False))


def cases(width: int = 640, height: int = 360, idle_lights: int = IDLE_LIGHTS) -> Iterator[Case]:
    """All cases, at a resolution, with so many lights that do not contribute."""
    scene, view = rooms({}, width, height)
    lit = scene, view, settings()
    pixels = width * height
    in_view = SAMPLES * scene.triangle_count // 4  # the other rooms are outside the frustum
    yield Case("first picture", lit, equal={"lights_used": 5}, at_most={"triangles_drawn": in_view})
    sky = look_at((0.6, 0.4, 40.0), (0.6, 9.0, 80.0), width, height)
    none = {"lights_used": 0, "pairs_traced": 0, "retests": 0}
    yield Case("nothing but background", (scene, sky, settings()), equal=none)
    yield from (edited(edit, *lit[:2], method) for method in Method for edit in EDITS)
    for remove in WITHOUT_LIGHT + WITHOUT_SHADOWS:
        without, options = remove(scene, settings())
        never = {
            *("BuildBLAS", "BuildTLAS"),
            *("ProbeVisibility", "RetestOccluded", "PredictVisibility", "MatchPredictions"),
        }
        yield Case(function_title(remove), (without, view, options), never=frozenset(never), equal={"pairs_traced": 0})
    for remove in WITHOUT_OCCLUSION:
        without, options = remove(scene, settings())
        if remove is not tiny_radius:  # inside a room, a surface may be so close that the radius covers pixels
            yield Case(function_title(remove), (without, view, options), never=frozenset(OCCLUSION))
    with_ball, triangles = with_ball_behind_camera(scene)
    at_most = {"bytes_uploaded": BYTES_PER_TRIANGLE * (triangles - len(with_ball.meshes[-1].triangles)) + OTHER_BYTES}
    yield Case("a dense ball next door", (with_ball, view, settings()), at_most=at_most)
    for why in IDLE:
        with_idle, _ = rooms({why: idle_lights}, width, height)
        retests = {"hidden": 4 * pixels, "faint": pixels}.get(why, 0)
        used = 5 + (idle_lights // 10 if why == "faint" else 0)  # in dark tiles some may contribute
        at_most = {"retests": retests, "lights_used": used}
        yield Case(f"{idle_lights} lights {why}", (with_idle, view, settings()), at_most=at_most)


def with_ball_behind_camera(scene: Scene) -> tuple[Scene, int]:
    """The scene with a ball of many triangles in the unlit room behind the camera, and how many all meshes have."""
    ball, instances = sphere((0.0, 0.0, 0.0), 0.8, 300, 200), scene.instances
    matrix = np.eye(4)
    matrix[:3, 3] = room_corner(ROOM_BEHIND_CAMERA) + SIZE / 2.0
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
    """A first sample, drawn after the first sample of the unedited scene."""
    one_sample = settings(method, 1)
    drawn = frozenset(SHARED[method][edit] | FIRST[method][edit])
    return Case(
        f"{function_title(edit)}, {method.label}", (*edit(scene, view), one_sample), (scene, view, one_sample), drawn
    )
