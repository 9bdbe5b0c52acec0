# SPDX-License-Identifier: GPL-3.0-or-later
"""How much memory a picture will take, before it is taken: Linux ends processes that ask for more than there is."""

import ctypes
from collections.abc import Iterable
from pathlib import Path

import moderngl

from ..scene import View
from .frame import Pass
from .gl.render_targets import DEPTH, Target
from .passes.film.accumulate import WIDE_MARGIN, filter_margin
from .passes.shadow_maps.fill_holes import LEVELS

#: Bytes a pixel: of what is known of one light, and of pictures as they are read and handed over.
TARGETS_PER_LIGHT, FULL_SIZE_IMAGES = 11, 100

#: Of a texel of a depth buffer.
DEPTH_BYTES = 4

#: Texels of a map without holes and of the smaller ones that it is made by, two of each size, over its own.
WITH_HALVED = 1.0 + 2.0 * sum(0.25**level for level in range(1, LEVELS + 1))

#: Bytes that are taken without asking.
NEGLIGIBLE_BYTES = 1 << 28

#: KiB of a card's own memory that are free (GL_NVX_gpu_memory_info).
CURRENT_AVAILABLE = 0x9049


def needed(kinds: Iterable[type[Pass]], view: View, fine_pixels: int, lights: int, map_texels: int) -> float:
    """Bytes of a picture that these passes draw, triangles in so many fine pixels, under lights that cast shadows.

    By maps: an atlas of so many texels.
    """
    a_pixel, fixed = float(TARGETS_PER_LIGHT * lights + FULL_SIZE_IMAGES), 0.0
    for kind in kinds:
        for name, target in kind.writes.items():
            if target.divisor:
                a_pixel += texel(target) / target.divisor**2
            elif name in ("triangles", "z"):
                fixed += fine_pixels * texel(target)
            elif name == "splats":
                fixed += map_texels * texel(target)
            elif name == "shadow_maps":
                fixed += map_texels * texel(target) * WITH_HALVED
            elif filter_margin(view.filter_width) >= WIDE_MARGIN:
                a_pixel += texel(target)
    return view.width * view.height * a_pixel + fixed


def texel(target: Target) -> int:
    """Bytes of one."""
    return DEPTH_BYTES if target.dtype == DEPTH else target.components * int(target.dtype[1:])


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
