# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads lights. Scaled ones look as in Cycles.

Sheared lights emit uniformly from their parallelogram or ellipse. In Cycles, points sampled on a sheared rectangle lie
off its plane, and rays intersect another shape than is sampled.
"""

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from ... import radiometry
from ...scene import LightImage, LightProfile, Lights, LightShape
from ...scene.limits import MAX_EMISSION, is_within, spans_plane
from . import light_nodes
from .diagnostics import Diagnostics
from .light_images import LightImages
from .light_linking import LightLinks, warn_of_many_groups

#: Blender's shapes: ours, and whether the height is a separate property.
SHAPES = {
    "SQUARE": (LightShape.RECTANGLE, False),
    "RECTANGLE": (LightShape.RECTANGLE, True),
    "DISK": (LightShape.ELLIPSE, False),
    "ELLIPSE": (LightShape.ELLIPSE, True),
}

#: One light, by the fields of Lights; its profile is a LightProfile or None, its image a LightImage or None.
Row = dict[str, Any]


class LightReader:
    """Reads lights, incrementally, with warnings about what they ask for that is not drawn."""

    def __init__(self, links: LightLinks) -> None:
        self._links, self._images = links, LightImages()
        self._rows: list[tuple[list[Row], Diagnostics]] = []
        self._object_rows: dict[int, int] = {}  # row of each light that is not an instance, by session_uid

    def reset(self) -> None:
        """To be called before all lights are added."""
        self._rows.clear()
        self._links.reset()
        self._object_rows.clear()

    def add(self, instance: bpy.types.DepsgraphObjectInstance) -> None:
        """Add one light or instance of a light."""
        if not instance.is_instance:
            self._object_rows[instance.object.original.session_uid] = len(self._rows)
        self._rows.append(self._read(instance.object, instance.matrix_world))

    def update(self, source: bpy.types.Object) -> None:
        """Read a light that is not an instance again; ignored if it was not added, so it is not visible."""
        index = self._object_rows.get(source.original.session_uid)
        if index is not None:
            self._rows[index] = self._read(source, source.matrix_world)

    def table(self, findings: Diagnostics) -> Lights:
        """All lights that emit."""
        for _, issues in self._rows:
            findings.merge(issues)
        indices: dict[LightProfile | LightImage | None, int] = {None: -1}
        indices |= {each: index for index, each in enumerate(self.profiles())}
        indices |= {each: index for index, each in enumerate(self.images())}
        rows = (row for rows, _ in self._rows for row in rows)
        return Lights.of_rows(row | {name: indices[row[name]] for name in ("profile", "image")} for row in rows)

    def profiles(self) -> tuple[LightProfile, ...]:
        """The profiles of all lights: the same objects for the same files."""
        return tuple(self._distinct("profile"))

    def images(self) -> tuple[LightImage, ...]:
        """The images of all lights: the same objects until forget_images."""
        return tuple(self._distinct("image"))

    def forget_images(self) -> None:
        """Some image has changed: all lights are added again."""
        self._images.forget()

    def _distinct(self, name: str) -> dict[Any, None]:
        return dict.fromkeys(row[name] for rows, _ in self._rows for row in rows if row[name] is not None)

    def _read(self, source: bpy.types.Object, matrix_world: Any) -> tuple[list[Row], Diagnostics]:
        return _read(source, np.array(matrix_world, np.float64), self._links, self._images)


def _read(
    source: bpy.types.Object, world_from_light: np.ndarray, links: LightLinks, images: LightImages
) -> tuple[list[Row], Diagnostics]:
    """The rows of a light with its matrix (4,4); none if it has no size or emits nothing."""
    findings, light = Diagnostics(), source.data
    portal = hasattr(light, "cycles") and light.cycles.is_portal  # Cycles can be switched off
    if portal or not source.visible_diffuse:
        return [], findings  # as in Cycles, where portals only guide rays to the world
    shader = light_nodes.read(light, source.name, images, findings)
    power = watts(light) * shader.factor
    if not power.any():
        return [], findings
    linked = [links.of_light((source,), role) for role in ("receiver", "blocker")]
    if None in linked:
        warn_of_many_groups(findings, source.name)
    row = ROWS[light.type](light, world_from_light, power)
    if row is None or not np.isfinite((row["spread"], row["blend"])).all():
        findings.warn(LEFT_OUT[light.type], source.name)
        return [], findings
    if light.type == "AREA" and not radiometry.is_perpendicular(row["axis_u"], row["axis_v"]):
        findings.warn("Sheared area lights shine evenly from what they look like, which Cycles' do not", source.name)
    if not is_within(row["emission"], MAX_EMISSION).all():
        findings.warn(f"{light.type.capitalize()} lights too bright to be drawn are left out", source.name)
        return [], findings
    receivers, blockers = (-1 if group is None else group for group in linked)
    row |= Row(
        receivers=receivers,
        blockers=blockers,
        visible_camera=source.visible_camera,
        falloff_power=shader.falloff_power,
        falloff_smooth=shader.falloff_smooth,
        profile=shader.profile,
        profile_axes=np.eye(3),
        image=shader.image,
    )
    if shader.profile is not None and (axes := _axes(world_from_light)) is not None:
        row |= Row(profile_axes=axes)
    return _by_shadow(row, light), findings


def _by_shadow(row: Row, light: bpy.types.Light) -> list[Row]:
    """A light as two: one whose shadow is black, and one without a shadow, which leaves the shadow its colour."""
    controls = getattr(light, "ism", None)  # only while the add-on is registered
    if controls is None or not light.use_shadow:
        return [row | Row(casts_shadow=light.use_shadow, shadow_softness=1.0)]
    left = 1.0 - controls.shadow_density * (1.0 - np.array(controls.shadow_color, np.float64))
    parts = [
        row | Row(emission=row["emission"] * fraction, casts_shadow=shadow, shadow_softness=controls.shadow_softness)
        for fraction, shadow in ((1.0 - left, True), (left, False))
    ]
    return [part for part in parts if part["emission"].any()]


def watts(light: bpy.types.Light) -> np.ndarray:
    """(3,) linear: colour × energy, and since Blender 4.5 × exposure and the colour of its temperature."""
    power = np.array(light.color, np.float64) * light.energy * 2.0 ** getattr(light, "exposure", 0.0)
    if getattr(light, "use_temperature", False):
        power *= np.array(light.temperature_color, np.float64)
    return power


def _area_row(light: bpy.types.AreaLight, world_from_light: np.ndarray, power: np.ndarray) -> Row | None:
    """What describes an area light; None if it has no area or no direction."""
    shape, has_height = SHAPES[light.shape]
    axis_u = world_from_light[:3, 0] * light.size
    axis_v = world_from_light[:3, 1] * (light.size_y if has_height else light.size)
    backwards = world_from_light[:3, 2]
    depth = np.linalg.norm(backwards)
    sides = np.linalg.norm([axis_u, axis_v], axis=1)
    area = box = float(sides.prod())
    if shape is LightShape.ELLIPSE:
        area *= np.pi / 4
    has_size = is_within(sides).all() and spans_plane(axis_u[None], axis_v[None]).item()
    if not (has_size and is_within(world_from_light).all() and depth > 0):
        return None
    # A sheared light emits the same power from less area.
    if not radiometry.is_perpendicular(axis_u, axis_v):
        power = power * (box / np.linalg.norm(np.cross(axis_u, axis_v)))
    # Without normalisation, the power is per square metre.
    radiant_area = area if getattr(light, "normalize", True) else 1.0
    return Row(
        shape=shape,
        position=world_from_light[:3, 3],
        axis_u=axis_u,
        axis_v=axis_v,
        normal=-backwards / depth,
        emission=radiometry.area_light_radiance(power, radiant_area),
        spread=light.spread,
        blend=0.0,
        radius=0.0,
        soft_falloff=False,
    )


def _point_row(light: bpy.types.PointLight, world_from_light: np.ndarray, power: np.ndarray) -> Row | None:
    """What describes a point light; None if it is nowhere."""
    position, radius = world_from_light[:3, 3], light.shadow_soft_size
    if not is_within(np.append(position, radius)).all():
        return None
    return Row(
        shape=LightShape.POINT,
        position=position,
        axis_u=(1.0, 0.0, 0.0),
        axis_v=(0.0, 1.0, 0.0),
        normal=(0.0, 0.0, -1.0),
        emission=power * radiometry.point_light_factor(radius, getattr(light, "normalize", True)),
        spread=np.pi,
        blend=0.0,
        radius=radius,
        soft_falloff=light.use_soft_falloff,
    )


def _spot_row(light: bpy.types.SpotLight, world_from_light: np.ndarray, power: np.ndarray) -> Row | None:
    """What describes a spot light; None if it is nowhere, or has no direction."""
    row, axes = _point_row(light, world_from_light, power), _axes(world_from_light)
    if row is None or axes is None:
        return None
    u, v, normal = axes
    return row | Row(
        shape=LightShape.SPOT, axis_u=u, axis_v=v, normal=normal, spread=light.spot_size, blend=light.spot_blend
    )


def _axes(world_from_light: np.ndarray) -> np.ndarray | None:
    """(3,3): x, y and -z of a light's space, of which the last is a unit vector; None if they span no space."""
    axes = world_from_light[:3, :3].T
    lengths = np.linalg.norm(axes, axis=1)
    if not (is_within(lengths).all() and lengths.min() > 0.0):
        return None
    axes = axes / (lengths[2] * np.array([[1.0], [1.0], [-1.0]]))
    return axes if is_within(axes).all() and spans_plane(axes[:1], axes[1:2]).item() else None


def _sun_row(light: bpy.types.SunLight, world_from_light: np.ndarray, power: np.ndarray) -> Row | None:
    """What describes a sun; None if it has no direction. Its power is an irradiance, W/m²."""
    backwards = world_from_light[:3, 2]
    length = np.linalg.norm(backwards)
    if not (is_within(backwards).all() and length > 0.0):
        return None
    return Row(
        shape=LightShape.SUN,
        position=(0.0, 0.0, 0.0),
        axis_u=(1.0, 0.0, 0.0),
        axis_v=(0.0, 1.0, 0.0),
        normal=-backwards / length,
        emission=power * radiometry.sun_light_factor(light.angle, getattr(light, "normalize", True)),
        spread=min(light.angle, np.pi),
        blend=0.0,
        radius=0.0,
        soft_falloff=False,
    )


#: By Blender's type of light: what reads the fields of Lights that depend on the type.
ROWS: dict[str, Callable[[Any, np.ndarray, np.ndarray], Row | None]] = {
    "AREA": _area_row,
    "POINT": _point_row,
    "SPOT": _spot_row,
    "SUN": _sun_row,
}

#: By Blender's type of light: what is said of one without a row.
LEFT_OUT = {
    "AREA": "Area lights without a size, or of one beyond measure, are left out",
    "POINT": "Point lights of a radius or at a position beyond measure are left out",
    "SPOT": "Spot lights of a radius, at a position, of a scale or of a cone beyond measure are left out",
    "SUN": "Suns without a direction, or of an angle beyond measure, are left out",
}
