# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's properties, made from the fields of `settings`: `scene.ism.shadow`, `.ssao`, `.render`, `.viewport`.

`render` and `viewport` have the quality settings; `.debug_view` shows a render target. `light.ism` has the controls of
a light's shadow. Every property can be animated, and an edit redraws the 3D viewports.
"""

from dataclasses import Field
from typing import Any

import bpy

from .. import settings
from ..choices import Choice
from ..scene.limits import MAX_SOFTNESS
from ..settings.setting_fields import Control, setting_fields
from . import redraw


def _property(member: Field, control: Control, default: Any) -> Any:
    """The bpy property for a field. `bool` is tested first, because it is a subclass of `int`."""
    facts = {"name": control.label, "description": control.meaning, "default": default, "update": redraw.viewports}
    if isinstance(default, bool):
        return bpy.props.BoolProperty(**facts)
    if isinstance(default, Choice):
        items = [(choice.value, choice.label, choice.meaning) for choice in type(default)]
        return bpy.props.EnumProperty(items=items, **facts)
    ranges = {"min": control.low, "max": control.high, "soft_max": control.soft_high}
    facts |= {name: limit for name, limit in ranges.items() if limit is not None}
    if isinstance(default, tuple):
        return bpy.props.FloatVectorProperty(subtype=control.unit, size=len(default), **facts)
    if isinstance(default, int):
        return bpy.props.IntProperty(subtype=control.unit, **facts)
    return bpy.props.FloatProperty(subtype=control.unit, precision=3, **facts)


def _group(name: str, defaults: Any) -> type:
    """A PropertyGroup class with the fields of `defaults`' section, and its values as defaults."""
    members = {
        member.name: _property(member, control, getattr(defaults, member.name))
        for member, control in setting_fields(type(defaults))
    }
    return type(name, (bpy.types.PropertyGroup,), {"__annotations__": members, "__doc__": type(defaults).__doc__})


ISMShadow = _group("ISMShadow", settings.Shadow())
ISMSSAO = _group("ISMSSAO", settings.SSAO())
ISMRender = _group("ISMRender", settings.FINAL)
ISMViewport = _group("ISMViewport", settings.VIEWPORT)


class ISMSettings(bpy.types.PropertyGroup):
    """Settings of the ISM render engine."""

    shadow: bpy.props.PointerProperty(type=ISMShadow)
    ssao: bpy.props.PointerProperty(type=ISMSSAO)
    render: bpy.props.PointerProperty(type=ISMRender)
    viewport: bpy.props.PointerProperty(type=ISMViewport)
    debug_view: _property(*next(setting_fields(settings.Settings)), settings.Settings.debug_view)


class ISMLight(bpy.types.PropertyGroup):
    """Controls of a light's shadow. With their defaults it is that of the light's size, and black."""

    shadow_softness: bpy.props.FloatProperty(
        name="Softness",
        description="Factor of the light's size that only its shadow sees. 0: hard, without noise; 1: as in Cycles",
        default=1.0,
        min=0.0,
        max=MAX_SOFTNESS,
        soft_max=4.0,
        update=redraw.viewports,
    )
    shadow_color: bpy.props.FloatVectorProperty(
        name="Color",
        description="What is left of the light in its full shadow, for red, green and blue. Black: as in Cycles",
        subtype="COLOR",
        default=(0.0, 0.0, 0.0),
        min=0.0,
        max=1.0,
        update=redraw.viewports,
    )
    shadow_density: bpy.props.FloatProperty(
        name="Density",
        description="How much of the shadow is drawn. 0: none; 1: as in Cycles",
        subtype="FACTOR",
        default=1.0,
        min=0.0,
        max=1.0,
        update=redraw.viewports,
    )


CLASSES = (ISMShadow, ISMSSAO, ISMRender, ISMViewport, ISMSettings, ISMLight)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.ism = bpy.props.PointerProperty(type=ISMSettings)
    bpy.types.Light.ism = bpy.props.PointerProperty(type=ISMLight)


def unregister() -> None:
    del bpy.types.Light.ism, bpy.types.Scene.ism
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
