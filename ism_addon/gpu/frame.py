# SPDX-License-Identifier: GPL-3.0-or-later
"""The steps of the method. What a pass is, and what it is handed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import moderngl
import numpy as np

from ..sampling import PixelGrid
from ..scene import Change, Scene, View
from ..settings import Method, Settings
from .atlas import Batch
from .gl.context import Device
from .gl.draw_limit import TEXELS_PER_RAY, portions, rectangles
from .gl.frame_uniforms import clip_from_anchor
from .gl.render_targets import Target, Targets, draw_into
from .gl.shader_compiler import bind, compile_program
from .gl.shader_records import Record
from .submission import Submission

#: Depth of the background, as in Cycles' depth pass. m
BACKGROUND_DEPTH = 1e10

#: Pixels along a block: what takes part in a sample, or does not.
TILE_SIZE = 8

#: Points less far than this from a pixel's middle, across and up, are in it. px; a little is left to float32.
SUBPIXEL_RADIUS = 0.49

#: Pixels from one scout to the next, along either side.
PROBE_SPACING = 2

#: Pixels along a block among those that scouted.
PROBES_PER_TILE_SIDE = TILE_SIZE // PROBE_SPACING

#: A block: its column and row, the fine pixel and the place in the pixel of its sample, that sample's number; a chance
#: by which it is drawn, if it is; the light that it is drawn for, and the part that is thought to be seen of that.
TILE = np.dtype(
    [
        *(("block", "f4", 2), ("texel", "f4", 2), ("place", "f4", 2), ("number", "f4")),
        *(("chance", "f4"), ("light", "f4"), ("part", "f4")),
    ]
)

#: The same for Points.
TILE_LAYOUT = "2f 4f 1f 1f 1f 1f", "block", "where", "number", "chance", "light", "part"

#: Samples before which predictions are made: as often as the number of samples has doubled, once the pixels' own rays
#: say more than those that scouted.
RENEWED = {0, *(2**k for k in range(2, 32))}

#: The part that is thought to be seen of a light where rays have not told yet: none was sent, or those sent were few.
UNKNOWN_VISIBILITY = 0.25

#: What a close look found of a light: rays that arrived, and rays.
PROBES = Target(2, "f1", divisor=PROBE_SPACING)

#: Of each light and pixel: the part that it is thought to see, and whether that is in doubt. In eight bits the part
#: would be off by up to 0.002, which stays in the picture until corrections of that size stand out of their noise.
PREDICTION = Target(2, "f2", neutral=(1.0, 0.0))


def from_tile_layout(texels: np.ndarray, blocks: tuple[int, int]) -> np.ndarray:
    """(rows,columns,N) of what a target of so many columns and rows of blocks holds in strips, (H,W,N)."""
    columns, rows = blocks
    return texels.reshape(-1, texels.shape[2])[: columns * rows].reshape(rows, columns, -1)


def tiles_where(chosen: np.ndarray) -> np.ndarray:
    """Rows of TILE for those chosen of (H,W) bool; all but where they are is 0."""
    blocks = np.zeros(np.count_nonzero(chosen), TILE)
    blocks["block"] = np.argwhere(chosen)[:, ::-1]
    return blocks


@dataclass
class Frame:
    """One sample of one picture, as the passes see it."""

    device: Device
    scene: Scene
    view: View
    settings: Settings
    sample: int
    anchor: np.ndarray  # (3,) float64 world
    targets: Targets
    tables: dict[str, Any]  # what passes make that is no target, by name
    counts: dict[str, int]
    grid: PixelGrid  # where in the pixels samples lie
    pace: Submission
    batch: Batch | None = None  # the light points whose maps are in the atlas

    @property
    def blocks(self) -> tuple[int, int]:
        """Columns and rows of them that cover the picture."""
        return -(-self.view.width // TILE_SIZE), -(-self.view.height // TILE_SIZE)

    @property
    def casts_shadows(self) -> bool:
        """Whether anything can stand in a light's way."""
        return bool(
            self.settings.shadow.enabled
            and self.scene.lights.casts_shadow.any()
            and self.scene.instances.casts_shadow.any()
        )

    @property
    def fitted(self) -> bool:
        """Whether light and shadow come from TraceShadows; else they come from the shadow maps."""
        return self.settings.shadow.method == Method.RAY_TRACED

    @property
    def traces(self) -> bool:
        """Whether shadow rays can find anything."""
        return self.casts_shadows and self.fitted

    @property
    def splats(self) -> bool:
        """Whether shadow maps can hold anything that matters."""
        return self.casts_shadows and not self.fitted

    @cached_property
    def occludes(self) -> bool:
        """Whether ambient occlusion can darken anything."""
        ssao = self.settings.ssao
        asked = ssao.enabled and ssao.radius > 0.0 and ssao.intensity > 0.0 and self.scene.world.radiance.any()
        return bool(asked and not (self.settings.shortcuts and self.projected_radius(ssao.radius) < SUBPIXEL_RADIUS))

    def projected_radius(self, radius: float) -> float:
        """How many pixels across or up, at most, anything seen is from points about it, `radius` m away or less."""
        placement, clip = self.tables["placement"], clip_from_anchor(self.view, self.anchor)
        across, up, ahead = np.linalg.norm(clip[[0, 1, 3], :3], axis=1)
        of_boxes = clip[3, :3] @ placement.matrices
        w = of_boxes[:, 3] + clip[3, 3] - np.einsum("nj,nj->n", np.abs(of_boxes[:, :3]), placement.half_sizes)
        nearest = w.min(initial=np.inf) - radius * ahead
        if nearest <= 0.0:
            return np.inf
        # What is seen is within one half of the picture of its middle: so far it goes if only its depth changes.
        return float(radius / nearest * max((across + ahead) * self.view.width, (up + ahead) * self.view.height) / 2.0)

    @property
    def receivers(self) -> dict[str, moderngl.Texture]:
        """What surfaces/receiver.glsl reads."""
        targets = {"position": "position", "normals": "normal", "albedo": "albedo", "triangles": "triangle"}
        textures = {name: self.targets[target] for name, target in targets.items()}
        return {**textures, "memberships": self.tables["placement"].memberships}

    def shared(self, make: type, *parts: Any) -> Any:
        """`make(device, *parts)`: one object for all renderers that use it with the same parts at a time."""
        key = make, *parts
        made = self.device.shared.get(key)
        if made is None:
            made = self.device.shared[key] = make(self.device, *parts)
            self.counts["bytes_uploaded"] += made.bytes
        return made

    def part(self, change: Change) -> object:
        """What stands for one kind of input: equal as long as it did not change."""
        view = self.view
        return {
            Change.MESHES: self.scene.meshes,
            Change.INSTANCES: (self.scene.instances, self.anchor.tobytes()),
            Change.MATERIALS: (self.scene.materials, self.scene.images),
            Change.LIGHTS: (self.scene.lights, self.anchor.tobytes()),
            Change.WORLD: self.scene.world,
            Change.VIEW: (
                view.clip_from_view.tobytes(),
                view.view_from_world.tobytes(),
                (view.width, view.height, view.filter_width, view.transparent),
                self.anchor.tobytes(),
            ),
            Change.SAMPLE: self.sample,
        }[change]


class Pass:
    """One step of the method. Its class, shader file and row in the profile have one name.

    It is drawn again only if what it depends on differs from when it was last drawn: parts of the input,
    sections of the settings, or the resources it reads.
    """

    reads: ClassVar[tuple[str, ...]] = ()
    writes: ClassVar[Mapping[str, Target]] = {}
    makes: ClassVar[tuple[str, ...]] = ()  # resources that are no targets: tables, buffers, atlases
    parts: ClassVar[Mapping[str, tuple[str, ...]]] = {}  # all that is new where of what it reads only this one is
    settings: ClassVar[tuple[str, ...]] = ()
    depends_on: ClassVar[tuple[Change, ...]] = ()
    compares: ClassVar[tuple[str, ...]] = ()  # tables that it reads too, where it does not matter that they were drawn
    # again if they hold the same

    def __init__(self, device: Device):
        self.device = device

    def needed(self, frame: Frame) -> bool:
        """Whether the picture would differ without this pass."""
        return True

    def draw(self, frame: Frame) -> None:
        """Make what the pass writes, and what it makes as the last that it does: it may raise Cancelled."""
        raise NotImplementedError

    def tile_program(self, *records: Record, part: str = "", **constants: int | float) -> moderngl.Program:
        """The program of the file named like this pass, or like a part of it, for draw_tiles."""
        stages = "glsl/tiles.vert", f"{self.name_of(part)}.frag"
        return compile_program(self.device, *stages, records=records, tile_size=TILE_SIZE, **constants)

    def draw_tiles(
        self,
        frame: Frame,
        target: moderngl.Framebuffer,
        program: moderngl.Program,
        blocks: np.ndarray | None = None,
        margin: int = 0,
        block: int = TILE_SIZE,
        rays: float = 1.0,
    ) -> None:
        """Draw the pixels of some blocks, or of all that take part in this sample, see sift, and `margin` px around.

        In a target of lower resolution a block has fewer. A pixel takes the time of so many `rays`, see draw_limit.
        """
        blocks = frame.tables["blocks"] if blocks is None else blocks
        if not len(blocks):
            return
        columns, rows = frame.blocks
        whole = 0, 0, columns * block, rows * block
        draw_into(target)
        own = target.viewport
        if own != whole:
            target.viewport = whole
        self.device.gl.enable(moderngl.PROGRAM_POINT_SIZE)
        size = block + 2 * margin
        bind(program, blocks=(columns, rows), size=float(size))
        try:
            for part in portions(len(blocks), rays * size * size):
                frame.pace.ask(rays * size * size * (part.stop - part.start))
                self.device.points.draw(program, blocks[part], TILE_LAYOUT)
        finally:
            if own != whole:
                target.viewport = own

    def draw_per_tile(
        self, frame: Frame, target: moderngl.Framebuffer, shader: moderngl.VertexArray, **uniforms: Any
    ) -> None:
        """Draw a target that has a texel for each block, in strips, by a shader that asks for its block_here."""
        self.device.gl.enable_only(moderngl.NOTHING)
        bind(shader.program, columns=frame.blocks[0], strip=target.viewport[2], **uniforms)
        self.draw_pixels(frame, target, shader, 2 * TILE_SIZE**2 / TEXELS_PER_RAY)  # of two pictures, about

    def draw_pixels(
        self, frame: Frame, target: moderngl.Framebuffer, shader: moderngl.VertexArray, rays: float = 1.0
    ) -> None:
        """Draw all pixels of a target by the triangle that covers them; each takes the time of so many `rays`."""
        draw_into(target)
        size = target.viewport[2:]
        try:
            for part in rectangles(size, rays):
                frame.pace.ask(rays * part[2] * part[3])
                if part[2:] != size:
                    target.scissor = part
                shader.render(moderngl.TRIANGLES, vertices=3)
        finally:
            if part[2:] != size:
                target.scissor = None

    def full_screen_program(self, *records: Record, part: str = "", **constants: int | float) -> moderngl.VertexArray:
        """The triangle that covers all pixels, shaded by the file named like this pass, or like a part of it."""
        stages = "glsl/full_screen.vert", f"{self.name_of(part)}.frag"
        program = compile_program(self.device, *stages, records=records, **constants)
        return self.device.gl.vertex_array(program, [])

    def name_of(self, part: str = "") -> str:
        """Of the shader file of this pass, which lies beside it, or of a part of it: its path without a suffix."""
        module = type(self).__module__.rpartition(".gpu.")[2]
        return "_".join(filter(None, (module.replace(".", "/"), part)))
