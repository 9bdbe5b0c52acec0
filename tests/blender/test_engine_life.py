# SPDX-License-Identifier: GPL-3.0-or-later
"""Registering and unregistering the add-on, and the exit of a Python process that has registered it."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from ism_addon import addon
from ism_addon.ui import compatible_panels, developer, panels, shading, statistics

ROOT = Path(__file__).parents[2]


def python(script, **environment):
    """Run a script in a fresh interpreter, from the checkout."""
    everything = {**os.environ, **environment}
    command = [sys.executable, "-c", script]
    return subprocess.run(command, cwd=ROOT, env=everything, capture_output=True, text=True, timeout=60)


def shown_panels():
    """Names of the panels, other than our own, that are shown for this engine."""
    others = [panel for panel in bpy.types.Panel.__subclasses__() if not panel.__module__.startswith("ism_addon.")]
    return {panel.__name__ for panel in others if "ISM" in getattr(panel, "COMPAT_ENGINES", ())}


def test_can_be_registered_repeatedly():
    for _ in range(3):
        addon.register()
        assert hasattr(bpy.types.Scene, "ism")
        bpy.context.scene.render.engine = "ISM"
        addon.unregister()
        assert not hasattr(bpy.types.Scene, "ism")
        with pytest.raises(TypeError):
            bpy.context.scene.render.engine = "ISM"


def test_registration_can_be_repeated_after_a_failure(monkeypatch):
    """Each class in turn is the first that Blender refuses."""
    handlers, remaining = list(bpy.app.handlers.load_pre), 0
    register_class = bpy.utils.register_class

    def refused(cls):
        nonlocal remaining
        if not remaining:
            raise ValueError("refused")
        remaining -= 1
        register_class(cls)

    monkeypatch.setattr(bpy.utils, "register_class", refused)
    for accepted in range(1000):
        remaining = accepted
        try:
            addon.register()
        except ValueError as error:
            assert str(error) == "refused"
            assert shown_panels() == set()
            assert not hasattr(bpy.types.Scene, "ism")
            assert list(bpy.app.handlers.load_pre) == handlers
        else:
            break
    addon.unregister()
    assert accepted > 20


def test_unregistering_restores_blender():
    handlers = list(bpy.app.handlers.load_pre)
    addon.register()
    assert len(shown_panels()) > 100
    addon.unregister()
    assert shown_panels() == set()
    assert list(bpy.app.handlers.load_pre) == handlers
    assert not any(panel.is_registered for panel in panels.CLASSES)


def test_panels_show_in_this_engine_only(registered):
    shown = [
        *(panels.ISM_RENDER_PT_sampling, panels.ISM_RENDER_PT_shadow, panels.ISM_RENDER_PT_ssao),
        *(developer.ISM_RENDER_PT_developer, statistics.ISM_RENDER_PT_statistics),
    ]
    bpy.context.scene.render.engine = "ISM"
    assert all(panel.poll(bpy.context) for panel in shown)
    bpy.context.scene.render.engine = "CYCLES"
    assert not any(panel.poll(bpy.context) for panel in shown)


@pytest.mark.parametrize(("engine", "shading_type"), [("ISM", "RENDERED"), ("ISM", "SOLID"), ("CYCLES", "RENDERED")])
def test_the_shading_popover_has_ours_in_rendered_shading_only(registered, engine, shading_type):
    bpy.context.scene.render.engine = engine
    area = next(area for area in bpy.context.window.screen.areas if area.type == "VIEW_3D")
    area.spaces.active.shading.type = shading_type
    with bpy.context.temp_override(area=area):
        expected = (engine, shading_type) == ("ISM", "RENDERED")
        assert shading.ISM_VIEW3D_PT_shading.poll(bpy.context) == expected


def test_light_panel_shows_for_lights(registered):
    bpy.context.scene.render.engine = "ISM"
    light = bpy.data.lights.new("Lamp", "AREA")
    with bpy.context.temp_override(light=light):
        assert panels.ISM_LIGHT_PT_light.poll(bpy.context)


@pytest.mark.parametrize(
    "name",
    [
        "RENDER_PT_format",
        "RENDER_PT_output",
        "RENDER_PT_color_management",
        "DATA_PT_lens",
        "DATA_PT_camera",
        "DATA_PT_context_light",
        "EEVEE_MATERIAL_PT_context_material",
        "EEVEE_MATERIAL_PT_surface",
        "EEVEE_WORLD_PT_surface",
        "MATERIAL_PT_preview",
        "OBJECT_PT_visibility",
        "VIEWLAYER_PT_layer",
        "TEXTURE_PT_image",
    ],
)
def test_blenders_own_panels_are_shown(registered, name):
    assert name in shown_panels()


def test_panels_of_features_that_are_not_drawn_are_hidden(registered):
    assert not shown_panels() & (compatible_panels.EXCLUDED | {"DATA_PT_EEVEE_light", "VIEWLAYER_PT_freestyle"})


def test_register_needs_no_opengl():
    result = python(
        "import bpy, sys\n"
        "from ism_addon import addon\n"
        "addon.register()\n"
        "assert 'moderngl' not in sys.modules and 'glcontext' not in sys.modules\n"
    )
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("last", ["", "addon.unregister()", "bpy.ops.wm.read_factory_settings(use_empty=True)"])
def test_python_ends_cleanly(last):
    result = python(f"import bpy\nfrom ism_addon import addon\naddon.register()\n{last}\nprint('end')")
    assert result.returncode == 0
    assert result.stderr == python("import bpy").stderr  # Blender itself may print warnings about this machine


@pytest.mark.parametrize("last", ["", "bpy.ops.wm.read_factory_settings(use_empty=True); bpy.context.scene.camera"])
def test_python_ends_cleanly_after_a_render(last):
    result = python(
        "import bpy\n"
        "from ism_addon import addon\n"
        "addon.register()\n"
        "render = bpy.context.scene.render\n"
        "render.engine, render.resolution_x, render.resolution_y = 'ISM', 16, 16\n"
        "bpy.context.scene.ism.render.samples = 1\n"
        "bpy.ops.render.render()\n"
        "import threading; assert any(thread.name == 'ISM renderer' for thread in threading.enumerate())\n"
        f"{last}\n"
        f"{'assert threading.active_count() == 1' if last else ''}\n"
    )
    assert result.returncode == 0, result.stderr


def test_unknown_errors_are_not_swallowed():
    """A bug of ours must raise in scripts and print a traceback, not silently render a black picture."""
    result = python(
        "import bpy\n"
        "from ism_addon import addon\n"
        "from ism_addon.blender.sync import camera\n"
        "addon.register()\n"
        "camera.final_view = None\n"
        "bpy.context.scene.render.engine = 'ISM'\n"
        "bpy.ops.render.render()\n"
    )
    assert result.returncode == 1
    assert "RuntimeError: Error: The picture could not be made" in result.stderr
    assert "TypeError" in result.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="hides the drivers in a way that is specific to Linux")
@pytest.mark.parametrize(
    ("before", "environment", "sentence"),
    [
        ("", {"__EGL_VENDOR_LIBRARY_FILENAMES": "/none"}, "OpenGL 4.1 could not be opened"),
        ("import sys; sys.modules['moderngl'] = None\n", {}, "moderngl, which comes with the extension, could not be"),
    ],
    ids=["no driver", "no moderngl"],
)
def test_a_missing_driver_or_package_is_reported_in_one_sentence(before, environment, sentence):
    """The engine is registered nevertheless."""
    result = python(
        f"{before}"
        "import bpy\n"
        "from ism_addon import addon\n"
        "addon.register()\n"
        "bpy.context.scene.render.engine = 'ISM'\n"
        "try:\n"
        "    bpy.ops.render.render()\n"
        "except RuntimeError as error:\n"
        "    print('SAID', str(error).strip())\n",
        **environment,
    )
    assert result.returncode == 0, result.stderr
    (message,) = [line for line in result.stdout.splitlines() if line.startswith("SAID")]
    assert message.startswith(f"SAID Error: {sentence}")
    assert "Traceback" not in result.stderr
