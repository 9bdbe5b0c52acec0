# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled light culling: which lights can change which tiles, and by how much. The others are left out.

As in tiled shading (Olsson & Assarsson 2011), a tile's surfaces are bounded by boxes, and their normals by cones, see
`surface_bounds`. A few coarse shadow rays then tell which lights arrive at all. A light that may be hidden is probed by
ProbeVisibility if it could be a large part of a tile's light, and by RetestOccluded now and then if not. Lights that
are negligible in a tile, all of them together, are left out for good.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import moderngl
import numpy as np

from ....parallel import parallel_map
from ....sampling import PIXEL_INCREMENTS, fixed_point, rd_sequence
from ....scene import Change
from ...culling.surface_bounds import LightBounds, SurfaceBounds, irradiance_bound
from ...frame import BACKGROUND_DEPTH, PROBES, RENEWED, TILE_SIZE, UNKNOWN_VISIBILITY, Frame, Pass, from_tile_layout
from ...gl.context import Device
from ...gl.render_targets import Target, pixels
from ...gl.shader_compiler import bind
from ...gl.shader_records import CASTER, LIGHT, MEMBERSHIP

#: Lights that bring less than this part of a block's light, all together, are left out there. Blocks are not taken
#: for darker than this part of the picture's mean.
MAX_CULLED_FRACTION = 1e-3
MIN_RELATIVE_IRRADIANCE = 0.1

#: A light that may bring no more than this part of a block's light is predicted for the block as a whole.
FAINT_FRACTION = 0.01

#: What a block shows is bounded in two parts, near and far, if the farthest depth is the nearest times this.
DEPTH_SPLIT_RATIO = 1.1

#: Lights are looked for from one block of so many, along either side of the picture; of more lights than a few, only
#: those that arrive at any of fewer blocks, where these are many: a small picture's would leave out what they miss.
FINE_TILE_SPACING = 2
COARSE_TILE_SPACING = 4
FEW_LIGHTS = 16
MANY_LIGHTS = 64

#: Of each light that rays are sent to: its number, and the place on it.
TILE_PROBES = Target(3, "u4")

#: What bounds a block.
TILE_BOUNDS = Target(4, "f4", divisor=TILE_SIZE, strips=True)

#: Pairs of a light and a block that are weighed at a time: as many as processors keep close at hand.
PAIRS_AT_A_TIME = 1 << 15

#: A light that may bring as much as this part of a block's light is looked for by ProbeVisibility wherever it may be.
STRONG_FRACTION = 0.1

#: So many times the picture's mean light is as bright as any.
MAX_BOUND_OVER_MEAN = 100.0

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


@dataclass(frozen=True)
class LightInfluence:
    """What a light may do to each block of the picture: arrays (rows, columns)."""

    worth: np.ndarray  # bool: whether it counts at all
    against_dim: np.ndarray  # float32: how much it could be at most, against what is dim there; 1 if it is more
    part: np.ndarray  # float32: of the light there, or of the picture's mean, that it could be at most; 1 if it is more
    bright: (
        np.ndarray
    )  # float32: of the picture's mean light, that it could be at most; MAX_BOUND_OVER_MEAN if it is more
    seen: np.ndarray  # float32: the part that is thought to be seen of it about the block

    @cached_property
    def dim(self) -> np.ndarray:
        """(rows,columns) bool: whether it counts so little that a block's pixels need no prediction of their own."""
        return self.worth & (self.against_dim < 1.0)

    @property
    def scouted(self) -> np.ndarray:
        """(rows,columns) bool: whether ProbeVisibility has to look closely."""
        return self.worth & ~self.dim & ((self.part >= STRONG_FRACTION) | (self.seen > 0.0))


class CullLights(Pass):
    """For each light that counts anywhere, where it does."""

    reads = ("position", "normal", "placement", "depth", "lights", "casters")
    writes = {
        "lowest": TILE_BOUNDS,  # corner of the box around what a block shows; in alpha, whether any
        "highest": TILE_BOUNDS,
        "facing": TILE_BOUNDS,  # axis of the cone of its normals; in alpha, its cosine
        **{f"far_{name}": TILE_BOUNDS for name in ("lowest", "highest", "facing")},
    }
    makes = ("reach", "reaching")
    settings = ("shortcuts",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def __init__(self, device: Device):
        super().__init__(device)
        #: Of all samples so far; and the luminance (lights,rows,columns) of the irradiance that is possible there.
        self.bounds: SurfaceBounds | None = None
        self.most = np.zeros((0, 0, 0), np.float32)
        #: Parts (rows,columns) of lights that are seen about blocks, and the luminance that is thought to arrive.
        self.arrives: dict[int, np.ndarray] = {}
        self.light = np.zeros((0, 0), np.float32)

    @cached_property
    def surfaces(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            tile_size=TILE_SIZE, background_depth=BACKGROUND_DEPTH, depth_split_ratio=DEPTH_SPLIT_RATIO
        )

    @cached_property
    def rays(self) -> moderngl.VertexArray:
        return self.full_screen_program(LIGHT, CASTER, MEMBERSHIP, part="rays")

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def draw(self, frame: Frame) -> None:
        if frame.sample not in RENEWED:  # surfaces come to light
            return
        frame.tables["reach"] = self.reached(frame) if frame.settings.shortcuts else without_culling(frame)
        frame.tables["reaching"] = tuple(sorted(frame.tables["reach"]))

    def reached(self, frame: Frame) -> dict[int, LightInfluence]:
        """By all that was seen so far."""
        seen = self.look(frame)
        if frame.sample == 0:
            self.bounds = seen
            self.most, guess = self.light_on(frame, seen, np.flatnonzero(seen.seen))
            self.arrives = self.probe_coarsely(frame)
            there = sum((self.arrives[light] * guess[light] for light in self.arrives), np.zeros(frame.blocks[::-1]))
            self.light = neighbourhood(there).mean((2, 3))
        else:
            spotted = frame.tables["spotted"] if frame.traces else {}
            for light, rays in self.probe_rays(frame, np.array(list(spotted), int), FINE_TILE_SPACING).items():
                part = neighbourhood_visibility(rays, frame.scene.lights.spread[light] < np.pi)
                self.arrives[light] = np.maximum(self.arrives[light], self.by_blocks(frame, part))
            new = np.flatnonzero(~self.bounds.hold(seen))
            self.bounds = self.bounds.joined(seen)
            self.most = np.maximum(self.most, self.light_on(frame, self.bounds, new)[0])
        return self.weighed()

    def light_on(self, frame: Frame, bounds: SurfaceBounds, which: np.ndarray) -> list[np.ndarray]:
        """Arrays (lights, rows, columns) of bounds and of estimates, for some surfaces: see surface_bounds.py."""
        some, all_lamps = (
            bounds.some(which),
            LightBounds.of(frame.scene.lights, frame.anchor, frame.scene.working_space),
        )
        count, step = len(frame.scene.lights.shape), max(PAIRS_AT_A_TIME // max(len(which), 1), 1)
        columns, rows = frame.blocks
        found = np.zeros((2, count, rows, columns), np.float32)

        def fill(first: int) -> None:
            lights = slice(first, min(first + step, count))
            near_and_far = np.zeros((2, lights.stop - first, 2, rows * columns), np.float32)
            near_and_far.reshape(2, -1, 2 * rows * columns)[..., which] = irradiance_bound(some, all_lamps[lights])
            found[:, lights] = near_and_far.max(2).reshape(2, -1, rows, columns)

        parallel_map(fill, range(0, count, step), count * len(which))
        return list(found)

    def look(self, frame: Frame) -> SurfaceBounds:
        """What the blocks show, each nearby and far off."""
        shown = {name: frame.targets[name] for name in ("position", "depth")}
        self.draw_per_tile(frame, frame.targets.into(*self.writes), self.surfaces, **shown)
        self.device.wait()
        found = [from_tile_layout(frame.targets.read(name), frame.blocks) for name in self.writes]
        near_and_far = np.array(found).reshape(2, 3, -1, 4)
        return SurfaceBounds.of(*near_and_far.swapaxes(0, 1).reshape(3, -1, 4))

    def probe_coarsely(self, frame: Frame) -> dict[int, np.ndarray]:
        """(rows,columns) of each light that reaches any: the part that is seen of it about a block."""
        casts, narrow = frame.scene.lights.casts_shadow & frame.traces, frame.scene.lights.spread < np.pi
        reaching = np.flatnonzero(self.most.any((1, 2)))
        asked = reaching[casts[reaching]]
        if (
            len(asked) > FEW_LIGHTS
            and np.prod([-(-count // COARSE_TILE_SPACING) for count in frame.blocks]) >= MANY_LIGHTS
        ):
            arrived = self.probe_rays(frame, asked, COARSE_TILE_SPACING)
            sent = {light: rays.any() for light, rays in arrived.items()}
            asked = np.array([k for k in asked if arrived[k][..., 0].any() or (narrow[k] and not sent[k])], int)
        rays = self.probe_rays(frame, asked, FINE_TILE_SPACING)
        certain = {light: np.full(frame.blocks[::-1], 0.0 if casts[light] else 1.0, np.float32) for light in reaching}
        return certain | {k: self.by_blocks(frame, neighbourhood_visibility(rays[k], narrow[k])) for k in rays}

    @staticmethod
    def by_blocks(frame: Frame, found: np.ndarray) -> np.ndarray:
        """(rows,columns) for each block, of what rays from every FINE_TILE_SPACING-th have found."""
        columns, rows = frame.blocks
        return found.repeat(FINE_TILE_SPACING, 0).repeat(FINE_TILE_SPACING, 1)[:rows, :columns]

    def probe_rays(self, frame: Frame, lights: np.ndarray, apart: int) -> dict[int, np.ndarray]:
        """(rows,columns,2) of each light: rays that arrived from every block, or each so far apart, and rays."""
        gl, (columns, rows) = self.device.gl, (-(-count // apart) for count in frame.blocks)
        gl.enable_only(moderngl.NOTHING)
        places, found = rd_sequence(0, len(frame.scene.lights.shape), 2), {}
        for first in range(0, len(lights), self.device.texture_size // rows):
            some = lights[first : first + self.device.texture_size // rows]
            asked = TILE_PROBES.create(gl, (len(some), 1))
            rows_asked = np.array([(light, *fixed_point(places[light])) for light in some], np.uint32)
            asked.write(rows_asked, viewport=(0, 0, len(some), 1))
            bind(
                self.rays.program,
                **frame.receivers,
                lights=frame.tables["lights"],
                asked=asked,
                rows=rows,
                apart=apart * TILE_SIZE,
                offset=(apart * TILE_SIZE // 2, apart * TILE_SIZE // 2),
                pixel_steps=fixed_point(PIXEL_INCREMENTS),
                **frame.tables["casters"],
            )
            size = columns, len(some) * rows
            strips = PROBES.create(gl, size)
            target = gl.framebuffer([strips])
            target.viewport = 0, 0, *size
            self.draw_pixels(frame, target, self.rays)
            self.device.wait()
            of_lights = pixels(strips)[: size[1], : size[0]]
            found |= zip(some, of_lights.reshape(len(some), rows, columns, 2), strict=True)
        return found

    def weighed(self) -> dict[int, LightInfluence]:
        """Which lights count where, by the most that each can bring."""
        shown, found = self.bounds.seen.reshape(2, *self.light.shape).any(0), {}
        average = max(float(self.light[shown].mean()) if shown.any() else 0.0, FLOAT32_TINY)
        whole = np.maximum(self.light, average)
        there, left_out = np.maximum(self.light, MIN_RELATIVE_IRRADIANCE * average), np.zeros_like(self.light)
        parts = self.most / whole
        for light in np.argsort(parts.sum((1, 2))):  # the faintest first
            left_out += self.most[light]
            worth = (self.most[light] > 0.0) & (left_out > MAX_CULLED_FRACTION * there)
            if worth.any():
                part = np.minimum(parts[light], 1.0)
                seen = self.arrives.setdefault(int(light), np.zeros_like(part))
                against_dim = np.minimum(self.most[light] / np.maximum(FAINT_FRACTION * there, FLOAT32_TINY), 1.0)
                bright = np.minimum(self.most[light], MAX_BOUND_OVER_MEAN * average) / average
                found[int(light)] = LightInfluence(worth, against_dim, part, bright, seen)
        return found


def without_culling(frame: Frame) -> dict[int, LightInfluence]:
    """As if all lights counted for all blocks."""
    whole = np.ones(frame.blocks[::-1], np.float32)
    all_of_it = LightInfluence(whole > 0.0, whole, whole, whole, whole)
    return {light: replace(all_of_it) for light in range(len(frame.scene.lights.shape))}


def neighbourhood_visibility(rays: np.ndarray, narrow: bool) -> np.ndarray:
    """(H,W): of rays (H,W,2), those that arrived and all, the part that arrived among each one and its neighbours.

    A light's `narrow` cone may light what lies between points that it sends nothing to.
    """
    arrived, sent = (neighbourhood(number).sum((2, 3)) for number in np.moveaxis(rays, 2, 0))
    return np.where(narrow & (sent == 0.0), UNKNOWN_VISIBILITY, arrived / np.maximum(sent, 1.0))


def neighbourhood(values: np.ndarray) -> np.ndarray:
    """(H,W,3,3): each one of (H,W) and its eight neighbours; beyond the border, those at it."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, mode="edge"), (3, 3))
