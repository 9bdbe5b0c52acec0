# SPDX-License-Identifier: GPL-3.0-or-later
"""Quality presets: choosing, saving and removing them."""

from dataclasses import astuple
from pathlib import Path

import bpy
import pytest

from ism_addon import addon, settings
from ism_addon.blender.render import read_settings
from ism_addon.choices import OcclusionSampling
from ism_addon.settings import FINAL, VIEWPORT, Method
from ism_addon.settings.setting_fields import setting_fields
from ism_addon.ui.presets import PRESET_PROPERTIES, ISM_RENDER_PT_presets
from tests.tools.new_file import open_empty_file

OURS = {"Draft", "Default", "Final", "Report_2013"}


pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """An empty folder of user presets."""
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(tmp_path))


@pytest.fixture
def scene():
    return open_empty_file()


def preset_paths():
    """Paths of all presets, by name."""
    folders = bpy.utils.preset_paths(ISM_RENDER_PT_presets.preset_subdir)
    return {path.stem: path for folder in folders for path in Path(folder).glob("*.py")}


def choose(name):
    """Apply a preset."""
    bpy.ops.script.execute_preset(filepath=str(preset_paths()[name]), menu_idname="ISM_RENDER_PT_presets")


def current_values():
    """Values of all settings that presets set."""
    ism = bpy.context.scene.ism
    return {f"{group}.{name}": getattr(getattr(ism, group), name) for group, name in PRESET_PROPERTIES}


def change_all(scene):
    """Set everything that presets set to other values than the defaults."""
    scene.ism.shadow.method = "SHADOW_MAPS"
    scene.ism.ssao.sampling = "POINTS"
    scene.ism.viewport.resolution = "25"
    for group in (scene.ism.render, scene.ism.viewport):
        for member, _ in setting_fields(settings.Quality):
            setattr(group, member.name, getattr(group, member.name) + 3)


def test_our_presets_exist():
    assert set(preset_paths()) == OURS


def test_the_default_preset_has_the_default_settings(scene):
    before = current_values()
    change_all(scene)
    assert not {name for name, value in current_values().items() if value == before[name]}
    choose("Default")
    assert current_values() == before


@pytest.mark.parametrize(("name", "times", "resolution"), [("Draft", 0.25, "50"), ("Final", 4, "100")])
def test_draft_and_final_change_samples_and_resolution(scene, name, times, resolution):
    choose("Default")
    before = current_values()
    change_all(scene)
    choose(name)
    samples = {"render.samples": FINAL.samples * times, "viewport.samples": VIEWPORT.samples * times}
    assert current_values() == before | samples | {"viewport.resolution": resolution}


def test_the_report_of_2013(scene):
    change_all(scene)
    choose("Report_2013")
    render, viewport = (read_settings.read(scene, use) for use in ("render", "viewport"))
    assert render == viewport
    assert render.shadow.method is Method.SHADOW_MAPS
    assert render.ssao.sampling is OcclusionSampling.POINTS
    assert astuple(render.quality) == pytest.approx(astuple(settings.Quality(samples=1)))


def test_other_settings_are_left_unchanged(scene):
    scene.ism.ssao.radius, scene.ism.shadow.bias, scene.ism.debug_view = 3.0, 2.0, "normal"
    for name in OURS:
        choose(name)
    assert (scene.ism.ssao.radius, scene.ism.shadow.bias, scene.ism.debug_view) == (3.0, 2.0, "normal")


def test_users_can_save_and_remove_their_own(scene, tmp_path):
    change_all(scene)
    own_values = current_values()
    bpy.ops.render.ism_preset_add(name="My own")
    assert preset_paths()["My_own"].is_relative_to(tmp_path)
    choose("Default")
    assert current_values() != own_values
    choose("My_own")
    assert current_values() == own_values
    bpy.ops.render.ism_preset_add(name="My_own", remove_name=True)
    assert set(preset_paths()) == OURS


PRESET_OF_0_1_0 = """import bpy
ism = bpy.context.scene.ism

ism.shadow.method = 'CLASSIC'
ism.render.samples = 5
ism.render.light_points = 64
ism.viewport.surface_points = 4096
"""


def test_a_preset_of_version_0_1_0_keeps_its_values(scene, tmp_path, capfd):
    folder = tmp_path / "presets" / ISM_RENDER_PT_presets.preset_subdir
    folder.mkdir(parents=True)
    (folder / "Old.py").write_text(PRESET_OF_0_1_0)
    for _ in range(2):  # as 0.1.0 saved it, and as its first use has rewritten it
        choose("Default")
        choose("Old")
        values = current_values()
        assert values["shadow.method"] == "SHADOW_MAPS"
        assert (values["render.samples"], values["viewport.samples"]) == (5, VIEWPORT.samples)
        assert (values["render.virtual_lights"], values["viewport.map_points"]) == (64, 4096)
    assert capfd.readouterr() == ("", "")


def test_choosing_a_preset_can_be_undone(scene):
    scene.ism.render.samples = 9
    bpy.ops.ed.undo_push(message="before")
    choose("Final")
    assert bpy.context.scene.ism.render.samples == 4 * FINAL.samples
    bpy.ops.ed.undo()
    assert bpy.context.scene.ism.render.samples == 9


def test_our_presets_print_no_errors(scene, capfd):
    """Blender prints an error in a preset and continues."""
    for name in OURS:
        choose(name)
    assert capfd.readouterr() == ("", "")


def test_presets_are_gone_after_unregister():
    addon.unregister()
    try:
        assert not preset_paths()
    finally:
        addon.register()
