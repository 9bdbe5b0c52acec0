# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes, and their rendering without a render thread: what tests of passes share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ism_addon.gpu.gl.shader_records import OCTAHEDRON_STEPS
from ism_addon.resources import NORMAL, RESOURCES, TILES
from ism_addon.scene import Image, Lights, LightShape, Mesh, Scene, View, World
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.scenes.parts.tables import instances_of, materials_of
from tests.scenes.small import basis, mesh, perspective

#: The shapes of area lights.
AREA_SHAPES = LightShape.RECTANGLE, LightShape.ELLIPSE

#: One sample and few points, for tests of something else. No error threshold: all samples are drawn if there are more.
SMALL_SETTINGS = Settings(
    quality=Quality(samples=1, error_threshold=0.0, virtual_lights=8, map_size=32, map_points=2048),
    ssao=SSAO(enabled=False),
    shadow=Shadow(world=False),
)

#: The same with imperfect shadow maps.
SMALL_SHADOW_MAPS = replace(SMALL_SETTINGS, shadow=Shadow(method=Method.SHADOW_MAPS))


@dataclass
class Drawn:
    """A renderer after drawing, and the profile of its passes."""

    renderer: object
    profile: object
    samples: int

    @property
    def color(self) -> np.ndarray:
        """(H,W,4), bottom row first."""
        return self.renderer.picture()

    def target(self, name: str) -> np.ndarray:
        """(H,W,components) of any target, bottom row first; of "normal" octahedra, of "primitive" indices."""
        targets, target = self.renderer.graph.targets, NORMAL if name == "primitive" else RESOURCES[name]
        texels = read_texels(targets[target], targets.sizes.get(target, (1, 1)))
        if name == "primitive":
            return texels[..., 2:]
        if name == "normal":
            return np.ascontiguousarray(texels[..., :2]).view(np.int16) / float(OCTAHEDRON_STEPS)
        return texels if texels.dtype == np.uint32 else texels.astype(float)

    @property
    def drawn_tiles(self) -> np.ndarray:
        """(rows,columns) bool: the tiles that the last sample drew."""
        tiles = self.renderer.graph[TILES]
        is_drawn = np.zeros(self.renderer.last[0].tiles[::-1], bool)
        column, row = tiles["tile"].astype(int).T
        is_drawn[row, column] = True
        return is_drawn


def read_texels(texture, size: tuple[int, int]) -> np.ndarray:
    """(H,W,components) of a texture, which may be larger than `size`."""
    dtype = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "u4": np.uint32}[texture.dtype]
    texels = np.frombuffer(texture.read(alignment=1), dtype).reshape(*texture.size[::-1], texture.components)
    return texels[: size[1], : size[0]]


def write_texels(texture, rows: np.ndarray) -> None:
    """Write rows (H,W) or (H,W,components) into a texture, which may be larger."""
    texture.write(np.ascontiguousarray(rows), (0, 0, rows.shape[1], rows.shape[0]), alignment=1)


def draw(
    device, scene: Scene, view: View, settings: Settings = SMALL_SETTINGS, renderer=None, last: int | None = None
) -> Drawn:
    """Draw all samples of a picture, or those up to index `last`, on this thread."""
    from ism_addon.gpu.profile import Profile
    from ism_addon.gpu.renderer import Renderer

    renderer, profile = renderer or Renderer(device), Profile()
    samples = settings.quality.samples if last is None else last + 1
    for sample in range(samples):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
    return Drawn(renderer, profile, samples)


def with_quality(settings: Settings, **changes: float) -> Settings:
    """The settings with these changes of quality."""
    return replace(settings, quality=replace(settings.quality, **changes))


def quad(corner: Sequence[float], u: Sequence[float], v: Sequence[float], uv: float = 1.0) -> Mesh:
    """A parallelogram from `corner` along u and v, facing u × v, with texture coordinates from 0 to `uv`."""
    corner, u, v = (np.asarray(vector, float) for vector in (corner, u, v))
    flat = mesh(np.array([corner, corner + u, corner + u + v, corner + v]), np.array([[0, 1, 2], [0, 2, 3]]))
    uvs = uv * np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], np.float32)
    return replace(flat, uvs=uvs)


def make_scene(
    meshes: Sequence[Mesh],
    lights: Lights | None = None,
    matrices: np.ndarray | None = None,
    mesh_ids: Sequence[int] | None = None,
    world: float = 0.0,
    base_color: Sequence[float] = (0.6, 0.6, 0.6),
    image: Image | None = None,
    emission: Sequence[float] = (0.0, 0.0, 0.0),
) -> Scene:
    """A scene of one material; each mesh once, or an instance of `mesh_ids` for each of `matrices` (I,4,4)."""
    ids = np.arange(len(meshes)) if mesh_ids is None else np.array(mesh_ids)
    return Scene(
        meshes=tuple(meshes),
        instances=instances_of(ids, matrices),
        materials=materials_of([base_color], [-1 if image is None else 0], [emission]),
        images=() if image is None else (image,),
        lights=no_lights() if lights is None else lights,
        world=World.even(np.full(3, world, np.float32)),
    )


def light(
    shape: LightShape = LightShape.RECTANGLE,
    position: Sequence[float] = (0.0, 0.0, 2.0),
    axis_u: Sequence[float] = (1.0, 0.0, 0.0),
    axis_v: Sequence[float] = (0.0, -1.0, 0.0),
    radiance: float = 1.0,
    spread: float = math.pi,
    casts_shadow: bool = True,
    receivers: int = -1,
    blockers: int = -1,
    radius: float = 0.0,
    soft_falloff: bool = False,
    shadow_softness: float = 1.0,
    visible_camera: bool = False,
    blend: float = 0.0,
    falloff_power: int = 0,
    falloff_smooth: float = 0.0,
    profile: int = -1,
    image: int = -1,
) -> Lights:
    """One light that shines along axis_u × axis_v."""
    normal = np.cross(axis_u, axis_v)
    return Lights(
        shape=np.array([shape], np.int32),
        position=np.array([position], np.float64),
        axis_u=np.array([axis_u], np.float64),
        axis_v=np.array([axis_v], np.float64),
        normal=np.array([normal / np.linalg.norm(normal)]),
        emission=np.full((1, 3), radiance, np.float32),
        spread=np.array([spread], np.float32),
        blend=np.array([blend], np.float32),
        radius=np.array([radius], np.float64),
        soft_falloff=np.array([soft_falloff]),
        falloff_power=np.array([falloff_power], np.int32),
        falloff_smooth=np.array([falloff_smooth], np.float32),
        profile=np.array([profile], np.int32),
        profile_axes=np.eye(3)[None],
        image=np.array([image], np.int32),
        shadow_softness=np.array([shadow_softness], np.float32),
        casts_shadow=np.array([casts_shadow]),
        visible_camera=np.array([visible_camera]),
        receivers=np.array([receivers], np.int32),
        blockers=np.array([blockers], np.int32),
    )


def no_lights() -> Lights:
    """Lights without a row."""
    lights = light()
    return Lights(**{name: value[:0].copy() for name, value in vars(lights).items()})


def join_lights(first: Lights, second: Lights) -> Lights:
    """All lights of both."""
    return Lights(**{name: np.concatenate([value, getattr(second, name)]) for name, value in vars(first).items()})


def look_at(
    position: Sequence[float],
    target: Sequence[float] = (0.0, 0.0, 0.0),
    size: tuple[int, int] = (32, 24),
    field_of_view: float = math.radians(50.0),
    **more: object,
) -> View:
    """A perspective camera at `position` that looks at `target`, not vertically; `field_of_view`: horizontal."""
    right, up, forward = basis(np.subtract(target, position))
    view_from_world = np.eye(4)
    view_from_world[:3, :3] = right, up, -forward
    view_from_world[:3, 3] = -view_from_world[:3, :3] @ position
    clip_from_view = perspective(field_of_view, size[0] / size[1], 0.1, 100.0)
    return View(clip_from_view, view_from_world, *size, **{"filter_width": 0.01, **more})


def view_from_above(width_m: float, size: tuple[int, int] = (32, 32), height: float = 10.0, **more: object) -> View:
    """An orthographic camera above the origin that looks down: x to the right, y up, square pixels."""
    clip_from_view = np.diag([2.0 / width_m, 2.0 / width_m * size[0] / size[1], -1.0 / height, 1.0])
    clip_from_view[2, 3] = -1.0
    view_from_world = np.eye(4)
    view_from_world[2, 3] = -height
    return View(clip_from_view, view_from_world, *size, **{"filter_width": 0.01, **more})


def transform(linear: np.ndarray | None = None, offset: Sequence[float] = (0.0, 0.0, 0.0)) -> np.ndarray:
    """(4,4): a linear map (3,3), then a translation."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) if linear is None else linear
    matrix[:3, 3] = offset
    return matrix


def with_shadow(**changes: object) -> Settings:
    """SMALL_SHADOW_MAPS with these changes of shadow settings."""
    return replace(SMALL_SHADOW_MAPS, shadow=replace(SMALL_SHADOW_MAPS.shadow, **changes))


def first_frame(device, scene: Scene, settings: Settings = SMALL_SETTINGS, size: tuple[int, int] = (32, 24)):
    """A renderer that has drawn nothing, and the frame of its first sample: for tests that execute single passes."""
    from ism_addon.gpu.profile import Profile
    from ism_addon.gpu.renderer import Renderer

    renderer = Renderer(device)
    return renderer, renderer.frame(scene, look_at((0.0, -4.0, 3.0), size=size), settings, 0, Profile())


def random_triangles(count: int = 200, extent: float = 1.0, size: float = 0.3, seed: int = 0) -> Mesh:
    """Random triangles of about `size`, in a cube around the origin: `extent` is half its side."""
    random = np.random.default_rng(seed)
    corners = random.uniform(-extent, extent, (count, 1, 3)) + random.uniform(-size, size, (count, 3, 3))
    return mesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
