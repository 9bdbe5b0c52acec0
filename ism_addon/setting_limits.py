# SPDX-License-Identifier: GPL-3.0-or-later
"""What becomes of what is out of its range: whoever asked is told, and the nearest that is in it is drawn.

Blender keeps its properties in their ranges itself. Scripts, snapshots and the command line can ask for anything; drawn
as it is, that might take all memory, or never be done.
"""

import heapq
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import Field, replace
from typing import Any

from .scene import Image, View
from .scene.quoting import shortened
from .settings import SECTIONS, Control, Settings, setting_fields

#: px. Wider ones take long, and show nothing but a blur; Blender has filters of up to 500.
WIDEST_FILTER = 50.0

#: Texels to a line, and lines, of the texture that holds all images and their halved copies: OpenGL 4.1 has room for it
#: everywhere. The lines are no power of two, see buffers.py.
TEXTURE_WIDTH, MAX_TEXTURE_LINES = 1 << 14, (1 << 14) - 1


def within_limits(settings: Settings) -> Settings:
    """The same, but at the end of its range what is beyond it: drawn as it is, it might never be done."""
    for name in SECTIONS:
        section = getattr(settings, name)
        nearest = {member.name: value for member, _, value in _beyond_limits(section)}
        settings = replace(settings, **{name: replace(section, **nearest)})
    return settings


def beyond_limits(settings: Settings) -> tuple[str, ...]:
    """A sentence for each setting that within_limits changes."""
    return tuple(
        f"{control.label} cannot be {shortened(f'{getattr(section, member.name):,}')}: {nearest:,} is used instead."
        for section in (getattr(settings, name) for name in SECTIONS)
        for member, control, nearest in _beyond_limits(section)
    )


def view_within_limits(view: View) -> View:
    """The same, with a pixel filter that can be drawn."""
    nearest = min(WIDEST_FILTER, max(0.0, view.filter_width))  # 0 for what is no number
    return view if view.filter_width == nearest else replace(view, filter_width=nearest)


def view_beyond_limits(view: View) -> tuple[str, ...]:
    """A sentence if view_within_limits changes it."""
    nearest = view_within_limits(view).filter_width
    sentence = f"Filter Size cannot be {view.filter_width:g} px: {nearest:g} px is used instead."
    return (sentence,) if view.filter_width != nearest else ()


def images_within_limits(images: Sequence[Image]) -> list[int]:
    """How often each image is halved so that all fit, the largest first; 0 for those that are drawn as they are."""
    sizes = [image.texels.shape[:2] for image in images]
    halved, left = [0] * len(sizes), sum(lines_for(size, 0) for size in sizes) - MAX_TEXTURE_LINES
    largest = [(-height * width, number) for number, (height, width) in enumerate(sizes)]
    heapq.heapify(largest)
    while left > 0 and largest:
        _, number = heapq.heappop(largest)
        left += lines_for(sizes[number], halved[number] + 1) - lines_for(sizes[number], halved[number])
        halved[number] += 1
        height, width = level(sizes[number], halved[number])
        if height * width > 1:
            heapq.heappush(largest, (-height * width, number))
    return halved


def images_beyond_limits(images: Sequence[Image]) -> tuple[str, ...]:
    """A sentence if images_within_limits halves any."""
    halved = zip(images, images_within_limits(images), strict=True)
    kinds = Counter((*image.texels.shape[1::-1], 2**times) for image, times in halved if times)
    some = [f"{count} of {width}×{height} px at 1/{part} of it" for (width, height, part), count in kinds.items()]
    sentence = f"Images are larger than can be drawn together, and some not drawn at their size: {', '.join(some[:3])}"
    more = f", and {len(some) - 3} more sizes" if len(some) > 3 else ""
    return (f"{sentence}{more}.",) if some else ()


def level(size: tuple[int, ...], halved: int) -> tuple[int, int]:
    """Of an image (H,W), after it was halved so often."""
    return max(size[0] >> halved, 1), max(size[1] >> halved, 1)


def lines_for(size: tuple[int, ...], halved: int) -> int:
    """That an image (H,W) takes, from its copy that was halved so often on."""
    texels = 0
    for times in range(halved, max(size).bit_length()):
        height, width = level(size, times)
        texels += height * width
    return -(-texels // TEXTURE_WIDTH)


def _beyond_limits(section: Any) -> Iterator[tuple[Field, Control, int | float]]:
    """The settings of a section that are out of their range, and the end of it that is nearest."""
    for member, control in setting_fields(type(section)):
        if control.low is not None and control.high is not None:
            value = getattr(section, member.name)
            nearest = min(control.high, max(control.low, value))  # the lower end for what is no number
            # In Blender, an end is a float32.
            if value != nearest and (isinstance(value, int) or not math.isclose(value, nearest, rel_tol=1e-6)):
                yield member, control, nearest
