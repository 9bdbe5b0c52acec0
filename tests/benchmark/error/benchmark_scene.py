# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's scenes, opened: the .blend for Blender's engines, its arrays for ours, and the truth of both."""

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path

import bpy
import numpy as np

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.scene import Scene, View
from tests.demo.figure6 import quiet_stdout
from tests.scenes import corridor, dense, dim_atrium, lamps, objects, thin
from tests.scenes.cycles import direct_light


@dataclass(frozen=True)
class Script:
    """How a scene is made, and how Cycles does it best."""

    build: Callable[[Path, int], None]  # writes the .blend; 0 is what is reported, 1 what parameters are tuned on
    light_tree: bool  # whether Cycles converges faster with it, per second, as measured


SCENES = {
    "atrium": Script(dim_atrium.build, light_tree=True),
    "objects": Script(objects.build, light_tree=False),
    "thin": Script(thin.build, light_tree=True),
    "dense": Script(dense.build, light_tree=False),
    "corridor": Script(corridor.build, light_tree=True),
    "lamps": Script(lamps.build, light_tree=False),
}
#: Cycles' seeds of the truth's halves. Those that compete have others.
SEEDS = (1_000_001, 1_000_002)


@dataclass(frozen=True, eq=False)
class BenchmarkScene:
    """A scene that is open in Blender."""

    name: str
    blend: Path
    scene: Scene
    view: View
    seconds: float  # that reading the scene took
    halves: np.ndarray  # (2,H,W,3) float32: the truth, twice, with independent noise


@dataclass(frozen=True, eq=False)
class OpenedScene:
    """A scene that is open in Blender, as ours reads it."""

    blend: Path
    scene: Scene
    view: View
    seconds: float  # that reading the scene took


def open_scene(name: str, variant: int, size: tuple[int, int], folder: Path) -> OpenedScene:
    """Build a scene in `folder`, and open it."""
    blend = folder / f"{name}-{variant}.blend"
    with quiet_stdout():
        SCENES[name].build(blend, variant)
    render = bpy.context.scene.render
    render.resolution_x, render.resolution_y = size
    with quiet_stdout():
        bpy.ops.wm.save_mainfile(compress=True)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    start = time.perf_counter()
    scene, view = scene_reader.scene(depsgraph), camera.final_view(depsgraph)
    return OpenedScene(blend, scene, view, time.perf_counter() - start)


def set_up(name: str, variant: int, size: tuple[int, int], truth_samples: int, folder: Path) -> BenchmarkScene:
    """Build a scene, open it, and render its truth unless `folder` has it."""
    opened = open_scene(name, variant, size, folder)
    known = folder / "truth" / f"{name}-{variant}-{truth_samples}-{fingerprint(opened.scene, opened.view)}.npy"
    tree = SCENES[name].light_tree
    halves = np.load(known) if known.is_file() else truth(known, opened.view.filter_width, truth_samples, tree)
    with quiet_stdout():
        bpy.ops.wm.open_mainfile(filepath=str(opened.blend))  # with Cycles' settings as they are by default
    return BenchmarkScene(name, **vars(opened), halves=halves)


def truth(path: Path, filter_width: float, samples: int, light_tree: bool) -> np.ndarray:
    """Cycles' direct light of the open file, twice `samples` samples, and kept as an array file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    print(f"rendering the truth of {path.stem.partition('-')[0]}, twice {samples} samples", flush=True)
    with quiet_stdout():
        halves = np.stack(
            [direct_light(samples, filter_width, seed=seed, light_tree=light_tree)[..., :3] for seed in SEEDS]
        )
    unfinished = path.with_suffix(".part")
    with unfinished.open("wb") as file:
        np.save(file, halves)
    unfinished.replace(path)
    return halves


def fingerprint(*parts: object) -> str:
    """The same for the same arrays and numbers: all that a truth depends on besides its samples."""
    digest = hashlib.sha256()
    for part in parts:
        feed(digest, part)
    return digest.hexdigest()[:16]


def feed(digest: "hashlib._Hash", value: object) -> None:
    if is_dataclass(value):
        for member in fields(value):
            feed(digest, getattr(value, member.name))
    elif isinstance(value, tuple):
        for item in value:
            feed(digest, item)
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
    else:
        digest.update(repr(value).encode())
