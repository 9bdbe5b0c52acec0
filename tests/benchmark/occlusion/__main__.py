# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of ambient occlusion, beside closed forms and beside rays of the same radius: `dev.py bench occlusion`.

It asserts nothing; tests/unit/occlusion has bounds.
"""

import argparse
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.choices import OcclusionSampling
from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import OCCLUSION
from ism_addon.scene import Scene, View
from ism_addon.settings import SSAO, Settings, Shadow
from tests.benchmark.error.benchmark_scene import open_scene
from tests.benchmark.error.ism import ALL_SAMPLES
from tests.docs import record
from tests.scenes.worlds import figures
from tests.scenes.worlds.closed_occlusion import CLOSED_FORMS
from tests.support import reference

SCENE, SIZE = "figures", (640, 360)
#: The scene without all but its statues and the ground.
STATUES = "statues on a plane"
#: As in the requirement: m, with attenuation.
LOOK = SSAO(radius=0.5, cone_angle=math.pi, attenuation=1.0)
SAMPLES, CLOSED_SAMPLES = (1, 16, 64), 256
PASSES = "AmbientOcclusion", "BlurOcclusion", "TraceOcclusion", "FilterOcclusion"


def settings(ssao: SSAO) -> Settings:
    return replace(ALL_SAMPLES, ssao=ssao, shadow=Shadow(world=False), occlusion_pass=True)


def pictures(
    device: Device, scene: Scene, view: View, ssao: SSAO, samples: Sequence[int]
) -> Iterator[tuple[np.ndarray, float]]:
    """The render pass AO (H,W) after each of these numbers of samples, and ms of a sample's passes so far."""
    renderer, profile = Renderer(device), Profile()
    for sample in range(max(samples)):
        for _ in renderer.sample(scene, view, settings(ssao), sample, profile):
            pass
        if sample + 1 in samples:
            milliseconds = sum(profile.rows[name].ms for name in PASSES) / (sample + 1)
            yield renderer.images([OCCLUSION])["AO"][..., 0], milliseconds
    renderer.release()


def rms(values: np.ndarray) -> float:
    return float(np.sqrt((values**2).mean()))


def closed_forms(device: Device) -> dict[str, dict[str, float]]:
    """RMS errors after CLOSED_SAMPLES, by scene and sampling, on one side of edges."""
    errors: dict[str, dict[str, float]] = {}
    for name, make in CLOSED_FORMS.items():
        case = make()
        surface = reference.surfaces(case.scene, case.view)
        truth = case.open_at(surface.position, surface.geometric_normal).reshape(case.view.height, case.view.width)
        inside = np.isfinite(truth) & (surface.triangle >= 0).reshape(truth.shape)
        for axis in (0, 1):
            for step in (-1, 1):
                inside &= np.roll(inside, step, axis)
        errors[name] = {"darkening": rms(1.0 - truth[inside])}
        for sampling in OcclusionSampling:
            ssao = replace(case.ssao, sampling=sampling)
            ((left, _),) = pictures(device, case.scene, case.view, ssao, [CLOSED_SAMPLES])
            errors[name][sampling] = rms((left - truth)[inside])
    return errors


def scenes(folder: Path) -> Iterator[tuple[str, Scene, View]]:
    """By name, what is measured beside rays."""
    opened = open_scene(SCENE, 0, SIZE, folder)
    yield SCENE, opened.scene, opened.view
    figures.keep_statues()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    yield STATUES, scene_reader.scene(depsgraph), camera.final_view(depsgraph)


def beside_rays(device: Device, scene: Scene, view: View, truth_samples: int) -> dict[str, object]:
    """RMS errors after each of SAMPLES, and ms of a sample, by sampling; truth: rays of many samples."""
    exact = replace(LOOK, sampling=OcclusionSampling.TRACED)
    ((truth, _),) = pictures(device, scene, view, exact, [truth_samples])
    seen, results = truth > 0.0, dict[str, object]()
    results["darkening"] = rms(1.0 - truth[seen])
    for sampling in OcclusionSampling:
        measured = list(pictures(device, scene, view, replace(LOOK, sampling=sampling), SAMPLES))
        errors = {str(count): rms((left - truth)[seen]) for count, (left, _) in zip(SAMPLES, measured, strict=True)}
        results[sampling] = {"errors": errors, "ms": measured[-1][1]}
    return results


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.occlusion", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record")
    parser.add_argument("--truth", type=int, default=1024, help="samples of the reference (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    addon.register()
    try:
        with tempfile.TemporaryDirectory() as folder:
            rays = {name: beside_rays(device, *case, options.truth) for name, *case in scenes(Path(folder))}
        results = {"closed forms": closed_forms(device), "rays": rays}
    finally:
        addon.unregister()
    print(results)
    print(record.write(options.output, "occlusion", device.name, {"size": SIZE, **results}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
