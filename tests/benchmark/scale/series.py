# SPDX-License-Identifier: GPL-3.0-or-later
"""The parameters of a picture that grow, and their values."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow

from . import scene

#: Of each picture. The first sample does additional work; the further ones cost the same.
SAMPLES = 4


@dataclass(frozen=True)
class Picture:
    """All parameters that can grow, with medium values as defaults."""

    triangles: int = 100_000
    objects: int = 0
    lights: int = 3
    virtual_lights: int | None = None  # None: ray-traced shadows; otherwise imperfect shadow maps
    height: int = 360  # px; pictures are 16:9
    ssao_radius: float | None = None  # px in the middle of the picture; None: no ambient occlusion
    frames: int = 0  # of a camera that orbits the scene, drawn after the picture

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, px."""
        return self.height * 16 // 9, self.height

    @property
    def pixel_width(self) -> float:
        """In the middle of the picture, m."""
        position, target, lens = scene.CAMERA
        return math.dist(position, target) * scene.SENSOR / lens / self.size[0]

    def settings(self) -> Settings:
        """The settings that the picture is drawn with."""
        settings = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=SAMPLES))
        if self.virtual_lights is not None:
            quality = replace(settings.quality, virtual_lights=self.virtual_lights)
            settings = replace(settings, shadow=Shadow(method=Method.SHADOW_MAPS), quality=quality)
        if self.ssao_radius is not None:
            ssao = SSAO(radius=self.ssao_radius * self.pixel_width)
            settings = replace(settings, shadow=replace(settings.shadow, world=False), ssao=ssao)
        return settings


@dataclass(frozen=True)
class Series:
    """One parameter that grows: its unit, its values, and the picture of each value."""

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
    "lights": Series("area lights", (1, 5, 20, 100, 500), (1, 20), lambda value: Picture(lights=value)),
    "virtual_lights": Series(
        "virtual point lights", (16, 64, 256, 1024, 4096), (16, 256), lambda value: Picture(virtual_lights=value)
    ),
    "resolution": Series(
        "lines of the picture", (180, 360, 720, 1080, 2160), (180, 720), lambda value: Picture(height=value)
    ),
    "ssao": Series("px of SSAO's radius", (1, 5, 20, 80, 200), (1, 200), lambda value: Picture(ssao_radius=value)),
    "frames": Series("frames of a turntable", (1, 3, 10, 30, 100), (1, 10), lambda value: Picture(frames=value)),
}
