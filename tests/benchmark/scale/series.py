# SPDX-License-Identifier: GPL-3.0-or-later
"""What grows, from where to where, and what of a picture it changes."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow

from . import scene

#: Of each picture: the first has work of its own, further ones are alike.
SAMPLES = 4


@dataclass(frozen=True)
class Picture:
    """All that can grow. By itself each is a middling one."""

    triangles: int = 100_000
    objects: int = 0
    lamps: int = 3
    virtual_lights: int | None = None  # with any, shadows are those of Imperfect Shadow Maps
    height: int = 360  # px; pictures are 16:9
    ssao_radius: float | None = None  # px in the middle of the picture; without, nothing is darkened
    frames: int = 0  # of a camera that goes around the scene, after the picture

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, px."""
        return self.height * 16 // 9, self.height

    @property
    def pixel(self) -> float:
        """Width of one in the middle of the picture, m."""
        position, target, lens = scene.CAMERA
        return math.dist(position, target) * scene.SENSOR / lens / self.size[0]

    def settings(self) -> Settings:
        """How it is drawn."""
        settings = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=SAMPLES))
        if self.virtual_lights is not None:
            quality = replace(settings.quality, virtual_lights=self.virtual_lights)
            settings = replace(settings, shadow=Shadow(method=Method.SHADOW_MAPS), quality=quality)
        if self.ssao_radius is not None:
            settings = replace(settings, ssao=SSAO(radius=self.ssao_radius * self.pixel))
        return settings


@dataclass(frozen=True)
class Series:
    """One thing that grows."""

    unit: str
    values: tuple[int, ...]
    quick: tuple[int, ...]
    picture: Callable[[int], Picture]


SERIES = {
    "triangles": Series(
        "triangles",
        (10_000, 100_000, 1_000_000, 10_000_000),
        (10_000, 100_000, 1_000_000),
        lambda value: Picture(triangles=value),
    ),
    "objects": Series(
        "instances", (10, 100, 1000, 5000, 20_000), (10, 1000), lambda value: Picture(triangles=10_000, objects=value)
    ),
    "lights": Series("area lights", (1, 5, 20, 100, 500), (1, 20), lambda value: Picture(lamps=value)),
    "virtual_lights": Series(
        "virtual point lights", (16, 64, 256, 1024, 4096), (16, 256), lambda value: Picture(virtual_lights=value)
    ),
    "resolution": Series(
        "lines of the picture", (180, 360, 720, 1080, 2160), (180, 720), lambda value: Picture(height=value)
    ),
    "ssao": Series("px of SSAO's radius", (1, 5, 20, 80, 200), (1, 200), lambda value: Picture(ssao_radius=value)),
    "frames": Series("frames of a turntable", (1, 3, 10, 30, 100), (1, 10), lambda value: Picture(frames=value)),
}
