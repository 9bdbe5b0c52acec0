# SPDX-License-Identifier: GPL-3.0-or-later
"""Tuned constants at half and at twice their value: `dev.py bench constants`.

Cost is squared error times processor time, after SAMPLES samples, over that with the constant as it is: above 1 is
worse. It is the geometric mean over the tuning forms of some scenes of the error benchmark.
"""

import argparse
import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from statistics import geometric_mean

from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import View
from tests.docs import record

from .error.ism import ALL_SAMPLES
from .error.metrics import rmse
from .error.stage import Stage, set_up

PASSES = "ism_addon.gpu.passes"
#: By module.
CONSTANTS = {
    f"{PASSES}.light_selection.cull_lights": (
        *("MAX_CULLED_FRACTION", "MIN_RELATIVE_IRRADIANCE", "FAINT_FRACTION"),
        *("FEW_LIGHTS", "MANY_LIGHTS", "MAX_BOUND_OVER_MEAN"),
    ),
    "ism_addon.gpu.culling.light_influence": ("STRONG_FRACTION", "UNKNOWN_VISIBILITY"),
    f"{PASSES}.light_selection.retest_occluded": ("RETEST_PROBABILITY",),
    f"{PASSES}.direct.select_faint_lights": ("MIN_LIGHT_PROBABILITY",),
    f"{PASSES}.direct.ray_correction": ("RAY_THRESHOLD", "MIN_DOUBT"),
    f"{PASSES}.direct.trace_shadows": (
        *("MIN_RAY_PROBABILITY", "MIN_FAINT_RAY_PROBABILITY", "CERTAIN_PROBABILITY", "MAX_CERTAIN_PROBABILITY"),
    ),
    f"{PASSES}.surfaces.select_tiles": ("MIN_TILE_PROBABILITY", "ALWAYS_SAMPLED_FRACTION", "MIN_NEIGHBOUR_RATIO"),
    f"{PASSES}.film.resolve": ("STRATIFICATION_EXPONENT", "SIMILARITY_SHARPNESS"),
}
FACTORS = 0.5, 1.0, 2.0
SCENES = "objects", "thin", "lamps"
SIZE = 320, 180  # px
SAMPLES = 32
TRUTH_SAMPLES = 128


@contextmanager
def multiplied(module: str, name: str, factor: float) -> Iterator[None]:
    """A constant of the package, for a while another one."""
    owner = import_module(module)
    value = getattr(owner, name)
    setattr(owner, name, type(value)(value * factor))
    try:
        yield
    finally:
        setattr(owner, name, value)


def cost(device: Device, stage: Stage) -> float:
    """Squared error, over the squared mean, times seconds of the processor."""
    renderer = Renderer(device)

    def draw(view: View) -> float:
        start = time.process_time()
        for sample in range(SAMPLES):
            for _ in renderer.sample(stage.scene, view, ALL_SAMPLES, sample, Profile()):
                pass
        return time.process_time() - start

    draw(replace(stage.view, clip_from_view=(1.0 + 1e-6) * stage.view.clip_from_view))  # compiles and uploads
    seconds = draw(stage.view)
    found = rmse(renderer.picture()[..., :3], stage.halves) ** 2 * seconds
    renderer.release()
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.constants", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the truth")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    costs: dict[str, dict[float, list[float]]] = {}
    values = {}
    for scene in SCENES:
        stage = set_up(scene, 1, SIZE, TRUTH_SAMPLES, options.output)
        for module, names in CONSTANTS.items():
            for name in names:
                values[name] = getattr(import_module(module), name)
                for factor in FACTORS:
                    with multiplied(module, name, factor):
                        costs.setdefault(name, {}).setdefault(factor, []).append(cost(device, stage))
    rows = {}
    for name, own in costs.items():
        relative = {f: geometric_mean(a / b for a, b in zip(own[f], own[1.0], strict=True)) for f in FACTORS}
        rows[name] = {"value": values[name], "half": relative[0.5], "double": relative[2.0]}
        print(f"{name:26} {values[name]:8g}   half {relative[0.5]:.3f}   double {relative[2.0]:.3f}", flush=True)
    assert all(math.isfinite(row[kind]) for row in rows.values() for kind in ("half", "double"))
    measured = {"scenes": SCENES, "size": SIZE, "samples": SAMPLES, "constants": rows}
    print(record.write(options.output, "constants", device.name, measured))
    return 0


if __name__ == "__main__":
    sys.exit(main())
