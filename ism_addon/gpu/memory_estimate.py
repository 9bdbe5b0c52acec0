# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates the memory of a render before it is allocated: Linux kills processes that run out of memory."""

import ctypes
import math
from collections.abc import Collection, Iterable
from pathlib import Path

import moderngl

from ..choices import Method
from ..resource_types import Target
from ..resources import (
    SHADOW_MAP_SPLATS,
    SHADOW_MAPS,
    SUBSAMPLE_EMISSION,
    TRANSMITTED_COLOR,
    VISIBILITY_BUFFER,
    VISIBILITY_DEPTH,
)
from ..resources.world import BACKGROUND, OCCLUSION_DISTANCE, WORLD_PREDICTION, WORLD_RESIDUAL
from ..sampling.pixel_grid import has_wide_filter
from ..scene import Scene, View
from ..settings import Settings
from .frame import Pass
from .gl.context import Device
from .material_inputs import ALL_LOBES, lobe_targets
from .occlusion import unused_targets
from .passes.film.accumulate import ROWS, SAMPLES
from .passes.occlusion.trace_occlusion import SAMPLES_KEPT
from .passes.shadow_maps.atlas import batches
from .passes.shadow_maps.fill_holes import PULLED, PUSHED

#: Bytes per pixel: of the targets of one light, with an irradiance cache, and of images on the CPU while they are read
#: back and copied.
TARGETS_PER_LIGHT, FULL_SIZE_IMAGES = 13, 100

#: Bytes that are allocated without a check.
NEGLIGIBLE_BYTES = 1 << 28

#: GPU_MEMORY_INFO_CURRENT_AVAILABLE_VIDMEM_NVX: free graphics memory, KiB (GL_NVX_gpu_memory_info).
CURRENT_AVAILABLE = 0x9049


def needed(targets: Collection[Target], view: View, fine_pixels: int, lights: int, map_texels: int) -> float:
    """Bytes that a render with these targets takes.

    `fine_pixels`: of the visibility buffer. `lights`: that rays are traced to. `map_texels`: of the shadow map atlas.
    """
    wide, pixels = has_wide_filter(view.filter_width), view.width * view.height
    texels = dict.fromkeys((VISIBILITY_BUFFER, VISIBILITY_DEPTH, TRANSMITTED_COLOR), fine_pixels)
    texels[SHADOW_MAP_SPLATS] = map_texels
    texels |= {target: map_texels / 4**level for level, target in enumerate([SHADOW_MAPS, *PULLED])}
    texels |= {target: map_texels / 4**level for level, target in enumerate(PUSHED, 1)}
    texels |= dict.fromkeys((*SAMPLES, *ROWS), pixels if wide else 0) | dict.fromkeys(
        (SUBSAMPLE_EMISSION, *ALL_LOBES, WORLD_PREDICTION, WORLD_RESIDUAL), pixels
    )
    target_bytes = sum(
        target.texel_bytes * (pixels / target.divisor**2 if target.divisor else texels[target]) for target in targets
    )
    kept = SAMPLES_KEPT * OCCLUSION_DISTANCE.texel_bytes if OCCLUSION_DISTANCE in targets else 0
    return target_bytes + pixels * (TARGETS_PER_LIGHT * lights + FULL_SIZE_IMAGES + kept)


def required_bytes(
    device: Device, scene: Scene, view: View, settings: Settings, pass_types: Iterable[type[Pass]], fine_pixels: int
) -> tuple[float, int]:
    """Bytes that an image of these passes takes, and the number of lights that rays are traced to."""
    casting = int(scene.lights.casts_shadow.sum()) if settings.shadow.enabled else 0
    traced, map_texels = settings.shadow.method is Method.RAY_TRACED, 0
    if casting and not traced:
        points = max(settings.quality.virtual_lights, casting)
        atlas, *_ = batches(points, settings.quality.map_size, device.texture_size)
        map_texels = math.prod(atlas.size)
    lights = casting if traced else 0
    targets = {output for pass_type in pass_types for output in pass_type.outputs if isinstance(output, Target)}
    targets -= set(ALL_LOBES) - set(lobe_targets(scene))
    targets -= {TRANSMITTED_COLOR} if not scene.tints.any() else set()
    targets -= {BACKGROUND} if scene.world.graph[1] < 0 else set()
    targets -= unused_targets(settings, scene.lights)
    return needed(targets, view, fine_pixels, lights, map_texels), lights


def free(gl: moderngl.Context) -> int | None:
    """Free bytes of main memory and of the graphics card. Drivers move to main memory what does not fit on the card.

    None where there is no /proc/meminfo.
    """
    meminfo = Path("/proc/meminfo")
    lines = meminfo.read_text("ascii").splitlines() if meminfo.exists() else []
    kilobytes = [int(line.split()[1]) for line in lines if line.startswith("MemAvailable:")]
    if not kilobytes:
        return None
    card_kilobytes = ctypes.c_int()
    if "GL_NVX_gpu_memory_info" in gl.extensions:
        get_integer = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))
        get_integer(gl.mglo._context.load("glGetIntegerv"))(CURRENT_AVAILABLE, card_kilobytes)
    return 1024 * (kilobytes[0] + card_kilobytes.value)


def check(gl: moderngl.Context, required: float, view: View, lights: int) -> None:
    """Raises MemoryError, with a sentence, if a render that needs `required` more bytes would exceed free memory."""
    if required <= NEGLIGIBLE_BYTES or (available := free(gl)) is None or required <= available:
        return
    lit = f" under {lights} lights that cast shadows" if lights > 1 else ""
    raise MemoryError(
        f"{view.width}×{view.height} pixels{lit} take {required / 1e9:.1f} GB of memory, "
        f"of which {available / 1e9:.1f} GB are free: a smaller picture takes less"
    )
