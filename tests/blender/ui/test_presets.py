# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of quality, as users choose, keep and remove them."""

from dataclasses import astuple
from pathlib import Path

import bpy
import pytest

from ism_addon import addon, settings
from ism_addon.blender.render import read_settings
from ism_addon.settings import FINAL, VIEWPORT, Method
from ism_addon.ui.presets import ABOUT, ISM_RENDER_PT_presets
from tests.tools.new_file import open_empty_file

OURS = {"Draft", "Default", "Final", "Report_2013"}


pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Of its own for what users keep."""
    monkeypatch.setenv("BLENDER_USER_SCRIPTS", str(tmp_path))


@pytest.fixture
def scene():
    return open_empty_file()


def found():
    """Paths of all presets, by name."""
    folders = bpy.utils.preset_paths(ISM_RENDER_PT_presets.preset_subdir)
    return {path.stem: path for folder in folders for path in Path(folder).glob("*.py")}


def choose(name):
    bpy.ops.script.execute_preset(filepath=str(found()[name]), menu_idname="ISM_RENDER_PT_presets")


def chosen():
    ism = bpy.context.scene.ism
    return {f"{group}.{name}": getattr(getattr(ism, group), name) for group, name in ABOUT}


def turn(scene):
    """All that a preset is about, away from its default."""
    scene.ism.shadow.method = "SHADOW_MAPS"
    scene.ism.viewport.resolution = "25"
    for group in (scene.ism.render, scene.ism.viewport):
        for member, _ in settings.setting_fields(settings.Quality):
            setattr(group, member.name, getattr(group, member.name) + 3)


def test_ours_are_there():
    assert set(found()) == OURS


def test_good_is_what_the_settings_are_by_themselves(scene):
    before = chosen()
    turn(scene)
    assert not {name for name, value in chosen().items() if value == before[name]}
    choose("Default")
    assert chosen() == before


@pytest.mark.parametrize(("name", "times", "resolution"), [("Draft", 0.25, "50"), ("Final", 4, "100")])
def test_a_preset_changes_what_it_says(scene, name, times, resolution):
    choose("Default")
    before = chosen()
    turn(scene)
    choose(name)
    samples = {"render.samples": FINAL.samples * times, "viewport.samples": VIEWPORT.samples * times}
    assert chosen() == before | samples | {"viewport.resolution": resolution}


def test_the_report_of_2013(scene):
    turn(scene)
    choose("Report_2013")
    render, viewport = (read_settings.read(scene, use) for use in ("render", "viewport"))
    assert render == viewport
    assert render.shadow.method is Method.SHADOW_MAPS
    assert astuple(render.quality) == pytest.approx(astuple(settings.Quality(samples=1)))


def test_the_look_is_left_alone(scene):
    scene.ism.ssao.radius, scene.ism.shadow.bias, scene.ism.debug_view = 3.0, 2.0, "normal"
    for name in OURS:
        choose(name)
    assert (scene.ism.ssao.radius, scene.ism.shadow.bias, scene.ism.debug_view) == (3.0, 2.0, "normal")


def test_users_keep_and_remove_their_own(scene, tmp_path):
    turn(scene)
    kept = chosen()
    bpy.ops.render.ism_preset_add(name="My own")
    assert found()["My_own"].is_relative_to(tmp_path)
    choose("Default")
    assert chosen() != kept
    choose("My_own")
    assert chosen() == kept
    bpy.ops.render.ism_preset_add(name="My_own", remove_name=True)
    assert set(found()) == OURS


OF_0_1_0 = """import bpy
ism = bpy.context.scene.ism

ism.shadow.method = 'CLASSIC'
ism.render.samples = 5
ism.render.light_points = 64
ism.viewport.surface_points = 4096
"""


def test_one_that_version_0_1_0_saved_keeps_its_values(scene, tmp_path, capfd):
    folder = tmp_path / "presets" / ISM_RENDER_PT_presets.preset_subdir
    folder.mkdir(parents=True)
    (folder / "Old.py").write_text(OF_0_1_0)
    for _ in range(2):  # as it was, and as it has been written anew
        choose("Default")
        choose("Old")
        found = chosen()
        assert found["shadow.method"] == "SHADOW_MAPS"
        assert (found["render.samples"], found["viewport.samples"]) == (5, VIEWPORT.samples)
        assert (found["render.virtual_lights"], found["viewport.map_points"]) == (64, 4096)
    assert capfd.readouterr() == ("", "")


def test_a_choice_can_be_undone(scene):
    scene.ism.render.samples = 9
    bpy.ops.ed.undo_push(message="before")
    choose("Final")
    assert bpy.context.scene.ism.render.samples == 4 * FINAL.samples
    bpy.ops.ed.undo()
    assert bpy.context.scene.ism.render.samples == 9


def test_nothing_goes_wrong_without_a_word(scene, capfd):
    """Blender prints what fails in a preset, and goes on."""
    for name in OURS:
        choose(name)
    assert capfd.readouterr() == ("", "")


def test_they_are_gone_after_unregister():
    addon.unregister()
    try:
        assert not found()
    finally:
        addon.register()
