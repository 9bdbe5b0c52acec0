# SPDX-License-Identifier: GPL-3.0-or-later
"""Each field of `settings` is a property in Blender, and is read back from it."""

from dataclasses import asdict, astuple, fields

import bpy
import pytest

from ism_addon import addon, settings
from ism_addon.blender.render import read_settings
from ism_addon.choices import Choice
from ism_addon.settings.setting_fields import setting_fields
from ism_addon.ui import panels, properties
from tests.tools.new_file import open_empty_file

GROUPS = {
    "shadow": settings.Shadow(),
    "ssao": settings.SSAO(),
    "render": settings.FINAL,
    "viewport": settings.VIEWPORT,
    "": settings.Settings(),
}
ALL_SETTINGS = [
    pytest.param(name, member, control, id=f"{name}.{member.name}")
    for name, defaults in GROUPS.items()
    for member, control in setting_fields(type(defaults))
]


def group_of(scene, name):
    """The property group scene.ism.NAME, or scene.ism for ""."""
    return getattr(scene.ism, name) if name else scene.ism


pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene():
    return open_empty_file()


def other_value(control, default):
    """A value within the range, other than the default."""
    if isinstance(default, bool):
        return not default
    if isinstance(default, Choice):
        return next(choice for choice in type(default) if choice is not default)
    if isinstance(default, tuple):
        return tuple((each + control.high) / 2 for each in default)
    return type(default)(default + 1) if default + 1 <= control.high else type(default)((default + control.low) / 2)


def change_all(scene):
    for name, defaults in GROUPS.items():
        for member, control in setting_fields(type(defaults)):
            setattr(group_of(scene, name), member.name, other_value(control, getattr(defaults, member.name)))


def approximately(value):
    """Equals a value up to the precision of float32, in which Blender stores its properties."""
    return pytest.approx(value, rel=1e-6) if isinstance(value, float | tuple) else value


def is_equal(ours, theirs):
    return astuple(ours) == tuple(approximately(value) for value in astuple(theirs))


def test_defaults(scene):
    for use, quality in (("render", settings.FINAL), ("viewport", settings.VIEWPORT)):
        read = read_settings.read(scene, use)
        assert is_equal(read.shadow, settings.Shadow())
        assert is_equal(read.ssao, settings.SSAO())
        assert is_equal(read.quality, settings.Quality(*astuple(quality)[: len(fields(settings.Quality))]))
        assert read.debug_view == settings.Settings().debug_view


@pytest.mark.parametrize("name, member, control", ALL_SETTINGS)
def test_a_property_has_the_name_limits_and_unit_of_its_field(scene, name, member, control):
    rna = group_of(scene, name).bl_rna.properties[member.name]
    default = getattr(GROUPS[name], member.name)
    assert (rna.name, rna.description) == (control.label, control.meaning)
    assert rna.is_animatable
    assert (tuple(rna.default_array) if isinstance(default, tuple) else rna.default) == approximately(default)
    if rna.type == "ENUM":
        items = [(item.identifier, item.name, item.description) for item in rna.enum_items]
        assert items == [(choice.value, choice.label, choice.meaning) for choice in type(default)]
        return
    type_ = type(default[0]) if isinstance(default, tuple) else type(default)
    assert {"BOOLEAN": bool, "INT": int, "FLOAT": float}[rna.type] is type_
    if rna.type != "BOOLEAN":
        assert (rna.hard_min, rna.hard_max) == pytest.approx((control.low, control.high))
        assert rna.soft_max == pytest.approx(control.high if control.soft_high is None else control.soft_high)
        assert rna.subtype == control.unit


def test_units_follow_the_scene(scene):
    ssao = scene.ism.ssao.bl_rna.properties
    assert (ssao["radius"].unit, ssao["cone_angle"].unit) == ("LENGTH", "ROTATION")


@pytest.mark.parametrize("name, member, control", [each for each in ALL_SETTINGS if each.id != "viewport.resolution"])
def test_values_are_read_back_within_their_range(scene, name, member, control):
    group, default = group_of(scene, name), getattr(GROUPS[name], member.name)

    def read_back():
        read = read_settings.read(scene, "render" if name == "render" else "viewport")
        section = {"render": read.quality, "viewport": read.quality, "": read}.get(name) or getattr(read, name)
        return getattr(section, member.name)

    setattr(group, member.name, other_value(control, default))
    assert type(read_back()) is type(default)
    assert read_back() == approximately(other_value(control, default))
    if control.high is not None:
        for out_of_range, limit in ((control.low - 1, control.low), (min(control.high * 2, 2**31 - 1), control.high)):
            is_color = isinstance(default, tuple)
            setattr(group, member.name, (out_of_range,) * 3 if is_color else type(default)(out_of_range))
            assert read_back() == pytest.approx((limit,) * 3 if is_color else limit)


def test_an_unknown_choice_is_refused(scene):
    with pytest.raises(TypeError, match="SHADOW_MAPS"):
        scene.ism.shadow.method = "NONSENSE"
    assert scene.ism.shadow.method == settings.Shadow().method


@pytest.mark.parametrize(
    ("method", "shadow", "sampling"),
    [
        ("RAY_TRACED", ["method", "world"], ["samples", "error_threshold", "time_limit"]),
        (
            "SHADOW_MAPS",
            ["method", "sky_dome", "splat_size", "bias", "fill_holes", "fill_threshold"],
            ["samples", "error_threshold", "time_limit", "virtual_lights", "map_size", "map_points"],
        ),
    ],
)
def test_panels_show_the_settings_of_the_method(scene, method, shadow, sampling):
    scene.ism.shadow.method = method
    assert panels.ISM_RENDER_PT_shadow.shown(scene) == shadow
    assert panels.ISM_RENDER_PT_sampling_render.shown(scene) == sampling
    assert panels.ISM_RENDER_PT_sampling_viewport.shown(scene) == [*sampling, "resolution"]


def test_render_and_viewport_quality_are_independent(scene):
    scene.ism.viewport.samples = 3
    assert read_settings.read(scene, "viewport").quality.samples == 3
    assert is_equal(read_settings.read(scene, "render").quality, settings.FINAL)


def test_a_debug_view_is_for_the_viewport_alone(scene):
    scene.ism.debug_view = "raw_occlusion"
    assert read_settings.read(scene, "viewport").debug_view is settings.DebugView.RAW_OCCLUSION
    assert read_settings.read(scene, "render").debug_view is settings.DebugView.SAMPLE_COLOR


@pytest.mark.parametrize(("resolution", "pixels"), [("100", 1), ("50", 2), ("25", 4)])
def test_a_resolution_sets_the_pixel_size(scene, resolution, pixels):
    scene.ism.viewport.resolution = resolution
    assert read_settings.pixel_size(scene) == pixels
    assert not hasattr(scene.ism.render, "resolution")


def test_settings_are_saved_in_the_file(scene, tmp_path):
    change_all(scene)
    before = {use: read_settings.read(scene, use) for use in ("render", "viewport")}
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "turned.blend"))
    open_empty_file()
    assert read_settings.read(bpy.context.scene, "render") != before["render"]
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "turned.blend"))
    for use, expected in before.items():
        assert asdict(read_settings.read(bpy.context.scene, use)) == asdict(expected)


def test_a_copied_scene_keeps_its_settings(scene):
    change_all(scene)
    assert read_settings.read(scene.copy(), "render") == read_settings.read(scene, "render")


@pytest.mark.parametrize("name, member, control", ALL_SETTINGS)
def test_keyframes_animate_settings(scene, name, member, control):
    default = getattr(GROUPS[name], member.name)
    path = ".".join(filter(None, ("ism", name, member.name)))
    for frame, value in ((1, default), (11, other_value(control, default))):
        setattr(group_of(scene, name), member.name, value)
        assert scene.keyframe_insert(path, frame=frame)
    for frame, value in ((1, default), (11, other_value(control, default))):
        scene.frame_set(frame)
        evaluated = bpy.context.evaluated_depsgraph_get().scene_eval
        evaluated_value = getattr(group_of(evaluated, name), member.name)
        assert (tuple(evaluated_value) if isinstance(value, tuple) else evaluated_value) == approximately(value)


def test_undo_restores_the_old_value(scene):
    bpy.ops.ed.undo_push(message="before")
    bpy.context.scene.ism.ssao.radius = 7.0
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert bpy.context.scene.ism.ssao.radius == pytest.approx(settings.SSAO().radius)


def test_property_groups_are_gone_after_unregister():
    properties_before = set(properties.CLASSES)
    addon.unregister()
    try:
        assert not hasattr(bpy.types.Scene, "ism")
        assert all(not cls.is_registered for cls in properties_before)
    finally:
        addon.register()
