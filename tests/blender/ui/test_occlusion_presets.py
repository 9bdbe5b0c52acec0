# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of ambient occlusion."""

from pathlib import Path

import bpy
import pytest

from ism_addon.blender.render import read_settings
from ism_addon.choices import OccludedLight, OcclusionSampling
from ism_addon.settings import SSAO
from ism_addon.ui.presets import OCCLUSION_PROPERTIES, ISM_RENDER_PT_occlusion_presets
from tests.tools.new_file import open_empty_file

OURS = {"Default", "Contacts", "Rooms", "Creases_In_All_Light", "Report_2013"}

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """An empty scene, and an empty folder of user presets."""
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(tmp_path))
    return open_empty_file()


def preset_paths():
    folders = bpy.utils.preset_paths(ISM_RENDER_PT_occlusion_presets.preset_subdir)
    return {path.stem: path for folder in folders for path in Path(folder).glob("*.py")}


def choose(name):
    bpy.ops.script.execute_preset(
        filepath=str(preset_paths()[name]), menu_idname=ISM_RENDER_PT_occlusion_presets.__name__
    )


def chosen(scene):
    """The settings of ambient occlusion."""
    return read_settings.read(scene, "render").ssao


def change_all(scene):
    ssao = scene.ism.ssao
    ssao.sampling, ssao.light, ssao.unit, ssao.tint = "POINTS", "ALL", "PIXELS", (0.5, 0.25, 0.125)
    ssao.radius = ssao.radius_pixels = ssao.cone_angle = ssao.intensity = ssao.power = ssao.attenuation = 2.5
    ssao.thickness = 0.25


def test_each_begins_with_the_defaults(scene):
    assert set(preset_paths()) == OURS
    default = chosen(scene)
    for name in OURS:
        change_all(scene)
        assert all(getattr(chosen(scene), name) != getattr(SSAO(), name) for _, name in OCCLUSION_PROPERTIES)
        choose(name)
        assert (chosen(scene) == default) == (name == "Default")
        assert chosen(scene).attenuation == default.attenuation


def test_what_they_set(scene):
    choose("Report_2013")
    assert chosen(scene).sampling is OcclusionSampling.POINTS
    choose("Rooms")
    assert chosen(scene).sampling is OcclusionSampling.TRACED and chosen(scene).radius == 3.0
    choose("Creases_In_All_Light")
    assert chosen(scene).light is OccludedLight.ALL


def test_the_switch_and_the_quality_are_left_unchanged(scene):
    scene.ism.ssao.enabled, scene.ism.render.samples = False, 7
    for name in OURS:
        choose(name)
    assert (scene.ism.ssao.enabled, scene.ism.render.samples) == (False, 7)


def test_users_can_save_and_remove_their_own(scene, tmp_path):
    change_all(scene)
    own = chosen(scene)
    bpy.ops.render.ism_occlusion_preset_add(name="My own")
    assert preset_paths()["My_own"].is_relative_to(tmp_path)
    choose("Default")
    assert chosen(scene) != own
    choose("My_own")
    assert chosen(scene) == own
    bpy.ops.render.ism_occlusion_preset_add(name="My_own", remove_name=True)
    assert set(preset_paths()) == OURS


def test_they_print_no_errors_and_can_be_undone(scene, capfd):
    bpy.ops.ed.undo_push(message="before")
    for name in OURS:
        choose(name)
    choose("Contacts")
    assert bpy.context.scene.ism.ssao.radius == pytest.approx(0.1)
    bpy.ops.ed.undo()
    assert capfd.readouterr() == ("", "")
