# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's scenes: a .blend for Blender's engines, its arrays for ours, and their reference images."""

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
from tests.scenes.lights import garden, lanterns, stage, street
from tests.scenes.materials import kitchen, products, tree
from tests.scenes.worlds import court, figures, interior


@dataclass(frozen=True)
class Script:
    """How a scene is built, and how Cycles renders it fastest."""

    build: Callable[[Path, int], None]  # writes the .blend; variant 0 is reported, parameters are tuned on 1
    light_tree: bool  # whether Cycles, as measured, has less error after the same time with it


SCENES = {
    "atrium": Script(dim_atrium.build, light_tree=True),
    "objects": Script(objects.build, light_tree=False),
    "thin": Script(thin.build, light_tree=True),
    "dense": Script(dense.build, light_tree=False),
    "corridor": Script(corridor.build, light_tree=True),
    "lamps": Script(lamps.build, light_tree=False),
    "garden": Script(garden.build, light_tree=False),
    "stage": Script(stage.build, light_tree=True),
    "street": Script(street.build, light_tree=True),
    "lanterns": Script(lanterns.build, light_tree=True),
    "products": Script(products.build, light_tree=True),
    "tree": Script(tree.build, light_tree=False),
    "kitchen": Script(kitchen.build, light_tree=True),
    "figures": Script(figures.build, light_tree=False),
    "court": Script(court.build, light_tree=False),
    "interior": Script(interior.build, light_tree=False),
}
#: Seeds of the two reference images. The renders that are measured have others.
SEEDS = (1_000_001, 1_000_002)


@dataclass(frozen=True, eq=False)
class BenchmarkScene:
    """A scene that is open in Blender, and its reference."""

    name: str
    blend: Path
    scene: Scene
    view: View
    seconds: float  # for reading the scene
    halves: np.ndarray  # (2,H,W,3) float32: two references with independent noise


@dataclass(frozen=True, eq=False)
class OpenedScene:
    """A scene that is open in Blender, as our engine reads it."""

    blend: Path
    scene: Scene
    view: View
    seconds: float  # for reading the scene


def open_scene(name: str, variant: int, size: tuple[int, int], folder: Path) -> OpenedScene:
    """Build a scene in `folder`, open it and read it."""
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
    """Build a scene, open it, and render its reference unless `folder` has it already."""
    opened = open_scene(name, variant, size, folder)
    path = folder / "truth" / f"{name}-{variant}-{truth_samples}-{fingerprint(opened.scene, opened.view)}.npy"
    tree = SCENES[name].light_tree
    halves = np.load(path) if path.is_file() else render_truth(path, opened.view.filter_width, truth_samples, tree)
    with quiet_stdout():
        bpy.ops.wm.open_mainfile(filepath=str(opened.blend))  # it still has Cycles' default settings
    return BenchmarkScene(name, **vars(opened), halves=halves)


def render_truth(path: Path, filter_width: float, samples: int, light_tree: bool) -> np.ndarray:
    """Render the open file's direct light with Cycles, twice with `samples` samples, and save it as an array file."""
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
    """A hash of scenes and views: of all that a reference depends on besides its samples."""
    digest = hashlib.sha256()
    for part in parts:
        feed(digest, part)
    return digest.hexdigest()[:16]


def feed(digest: "hashlib._Hash", value: object) -> None:
    """Update a hash with all arrays and values of dataclasses and tuples."""
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
