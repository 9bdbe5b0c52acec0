# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of settings: for a value out of its range the nearest allowed one is used, with a warning.

Blender limits its properties itself. Scripts, snapshots and the command line can set any value, with which a render
might take all memory or never finish.
"""

import heapq
import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import Field, replace
from typing import Any

from .scene import Image, View
from .scene.quoting import shortened
from .settings import SECTIONS, Settings
from .settings.setting_fields import Control, setting_fields

#: Maximum filter width, px. Wider filters are slow and only blur; Blender allows 500.
WIDEST_FILTER = 50.0

#: Width and maximum height of a layer of the texture with all images and their mip levels, which every OpenGL 4.1
#: supports. The height is not a power of two, see driver_variants.py.
TEXTURE_WIDTH, LAYER_LINES = 1 << 14, (1 << 11) - 1

#: Maximum of lines of all images, of 8-bit texels: Mesa's software driver refuses textures of 2 GB.
MAX_TEXTURE_LINES = 15 * LAYER_LINES


def within_limits(settings: Settings) -> Settings:
    """Settings clamped to their ranges."""
    for name in SECTIONS:
        section = getattr(settings, name)
        nearest = {member.name: value for member, _, _, value in _beyond_limits(section)}
        settings = replace(settings, **{name: replace(section, **nearest)})
    return settings


def beyond_limits(settings: Settings) -> tuple[str, ...]:
    """A sentence for each setting that within_limits changes."""
    return tuple(
        f"{control.label} cannot be {shortened(_text(value))}: {_text(nearest)} is used instead."
        for section in (getattr(settings, name) for name in SECTIONS)
        for _, control, value, nearest in _beyond_limits(section)
    )


def view_within_limits(view: View) -> View:
    """The view with its filter width clamped."""
    nearest = min(WIDEST_FILTER, max(0.0, view.filter_width))  # 0 for NaN
    return view if view.filter_width == nearest else replace(view, filter_width=nearest)


def view_beyond_limits(view: View) -> tuple[str, ...]:
    """A sentence if view_within_limits changes the view."""
    nearest = view_within_limits(view).filter_width
    sentence = f"Filter Size cannot be {view.filter_width:g} px: {nearest:g} px is used instead."
    return (sentence,) if view.filter_width != nearest else ()


def images_within_limits(images: Sequence[Image]) -> list[int]:
    """Number of times that each image is halved so that all fit, the largest first; 0: full size."""
    sizes = [image.texels.shape[:2] for image in images]
    lengths = [image.texels.itemsize for image in images]  # of lines, relative to those of 8-bit texels
    lines = sum(length * lines_for(size, 0) for size, length in zip(sizes, lengths, strict=True))
    halved, excess = [0] * len(sizes), lines - MAX_TEXTURE_LINES
    largest = [(-height * width, index) for index, (height, width) in enumerate(sizes)]
    heapq.heapify(largest)
    while excess > 0 and largest:
        _, index = heapq.heappop(largest)
        less = lines_for(sizes[index], halved[index]) - lines_for(sizes[index], halved[index] + 1)
        excess -= lengths[index] * less
        halved[index] += 1
        height, width = level(sizes[index], halved[index])
        if height * width > 1:
            heapq.heappush(largest, (-height * width, index))
    return halved


def images_beyond_limits(images: Sequence[Image]) -> tuple[str, ...]:
    """A sentence if images_within_limits halves any."""
    halved = zip(images, images_within_limits(images), strict=True)
    sizes = Counter((*image.texels.shape[1::-1], 2**times) for image, times in halved if times)
    some = [f"{count} of {width}×{height} px at 1/{divisor} of it" for (width, height, divisor), count in sizes.items()]
    sentence = f"Images are larger than can be drawn together, and some not drawn at their size: {', '.join(some[:3])}"
    more = f", and {len(some) - 3} more sizes" if len(some) > 3 else ""
    return (f"{sentence}{more}.",) if some else ()


def level(size: tuple[int, ...], halved: int) -> tuple[int, int]:
    """Size of an image (H,W) after it is halved `halved` times."""
    return max(size[0] >> halved, 1), max(size[1] >> halved, 1)


def lines_for(size: tuple[int, ...], halved: int) -> int:
    """Lines of the texture for an image (H,W), from the mip level `halved` on."""
    texels = 0
    for times in range(halved, max(size).bit_length()):
        height, width = level(size, times)
        texels += height * width
    return -(-texels // TEXTURE_WIDTH)


def _text(value: Any) -> str:
    return ", ".join(map(_text, value)) if isinstance(value, tuple) else f"{value:,}"


def _beyond_limits(section: Any) -> Iterator[tuple[Field, Control, Any, Any]]:
    """The settings of a section that are out of their range, their values, and the nearest allowed ones."""
    for member, control in setting_fields(type(section)):
        value = getattr(section, member.name)
        nearest = _nearest(value, control)
        if value != nearest:
            yield member, control, value, nearest


def _nearest(value: Any, control: Control) -> Any:
    """The nearest allowed value; the same if it is allowed."""
    if control.low is None or control.high is None:
        return value
    if isinstance(value, tuple):
        return tuple(_nearest(each, control) for each in value)
    nearest = min(control.high, max(control.low, value))  # `low` for NaN
    # Blender stores limits as float32.
    return value if not isinstance(value, int) and math.isclose(value, nearest, rel_tol=1e-6) else nearest
