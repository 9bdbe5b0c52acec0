# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a picture will take, before it is taken: Linux ends processes that ask for more than there is."""

import ctypes
from collections.abc import Iterable
from pathlib import Path

import moderngl

from ..resource_types import Target
from ..resources import SHADOW_MAP_SPLATS, SHADOW_MAPS, VISIBILITY_BUFFER, VISIBILITY_DEPTH
from ..scene import View
from .passes.film.accumulate import ROWS, SAMPLES, WIDE_MARGIN, filter_margin
from .passes.shadow_maps.fill_holes import PULLED, PUSHED

#: Bytes a pixel: of what is known of one light, and of pictures as they are read and handed over.
TARGETS_PER_LIGHT, FULL_SIZE_IMAGES = 11, 100

#: Bytes that are taken without asking.
NEGLIGIBLE_BYTES = 1 << 28

#: KiB of a card's own memory that are free (GL_NVX_gpu_memory_info).
CURRENT_AVAILABLE = 0x9049


def needed(targets: Iterable[Target], view: View, fine_pixels: int, lights: int, map_texels: int) -> float:
    """Bytes of a picture with these targets, `fine_pixels` in its visibility buffer, under lights that cast shadows.

    By maps: an atlas of so many texels.
    """
    wide = filter_margin(view.filter_width) >= WIDE_MARGIN
    texels = {VISIBILITY_BUFFER: fine_pixels, VISIBILITY_DEPTH: fine_pixels, SHADOW_MAP_SPLATS: map_texels}
    texels |= {target: map_texels / 4**level for level, target in enumerate([SHADOW_MAPS, *PULLED])}
    texels |= {target: map_texels / 4**level for level, target in enumerate(PUSHED, 1)}
    texels |= dict.fromkeys((*SAMPLES, *ROWS), view.width * view.height if wide else 0)
    pixels = view.width * view.height
    own = sum(
        target.texel_bytes * (pixels / target.divisor**2 if target.divisor else texels[target]) for target in targets
    )
    return own + pixels * (TARGETS_PER_LIGHT * lights + FULL_SIZE_IMAGES)


def free(gl: moderngl.Context) -> int | None:
    """Bytes that can be taken: the machine's, to which drivers move what is too much for the card, and the card's.

    None where the system does not say it as Linux does.
    """
    told = Path("/proc/meminfo")
    lines = told.read_text("ascii").splitlines() if told.exists() else []
    kilobytes = [int(line.split()[1]) for line in lines if line.startswith("MemAvailable:")]
    if not kilobytes:
        return None
    of_card = ctypes.c_int()
    if "GL_NVX_gpu_memory_info" in gl.extensions:
        ask = ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.POINTER(ctypes.c_int))
        ask(gl.mglo._context.load("glGetIntegerv"))(CURRENT_AVAILABLE, of_card)
    return 1024 * (kilobytes[0] + of_card.value)


def check(gl: moderngl.Context, wanted: float, view: View, lights: int) -> None:
    """Raises MemoryError, with a sentence, if a picture that takes so many bytes more would take all there is."""
    if wanted <= NEGLIGIBLE_BYTES or (most := free(gl)) is None or wanted <= most:
        return
    lit = f" under {lights} lights that cast shadows" if lights > 1 else ""
    raise MemoryError(
        f"{view.width}×{view.height} pixels{lit} take {wanted / 1e9:.1f} GB of memory, "
        f"of which {most / 1e9:.1f} GB are free: a smaller picture takes less"
    )
