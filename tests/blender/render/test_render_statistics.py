# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of renders, as the panel shows them."""

import bpy
import pytest

from ism_addon.blender import engine
from ism_addon.blender.render import render_statistics
from ism_addon.ui import statistics
from tests.tools.new_file import open_factory_file

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture(autouse=True)
def cleared_statistics():
    """Clears the statistics of earlier pictures."""
    render_statistics._kept.clear()


@pytest.fixture
def render_with():
    """render_with(method): renders the factory scene under an area light."""

    def render(method):
        scene = open_factory_file()
        scene.objects["Light"].data.type = "AREA"
        scene.render.engine = "ISM"
        scene.render.resolution_x, scene.render.resolution_y = 24, 16
        scene.ism.shadow.method = method
        quality = scene.ism.render
        quality.samples, quality.virtual_lights, quality.map_size, quality.map_points = 2, 2, 16, 256
        bpy.ops.render.render()

    return render


def test_there_are_no_statistics_before_the_first_picture():
    assert statistics.latest() == ("", {})


def test_a_final_render_has_statistics(render_with):
    render_with("RAY_TRACED")
    use, shown_statistics = statistics.latest()
    assert use == "render"
    assert use in statistics.USES
    assert shown_statistics == engine.statistics()
    rows = {name: numbers for name, *numbers in statistics.passes(shown_statistics)}
    assert len(statistics.COLUMNS) == 1 + len(rows["TraceShadows"])
    assert rows["GBuffer"][:3] == ["2", "0", "0"]
    assert rows["TraceShadows"][:3] == ["3", "0", "0"], "the first sample without rays, then with them"
    assert rows["UploadUVs"][:3] == ["0", "0", "2"]
    assert "SplatMaps" not in rows, "passes of the other method are not shown"
    assert float(rows["TraceShadows"][3]) > 0.0


@pytest.mark.parametrize(("method", "has_virtual_lights"), [("RAY_TRACED", False), ("SHADOW_MAPS", True)])
def test_counts_are_those_of_the_method(render_with, method, has_virtual_lights):
    render_with(method)
    shown = dict(statistics.counts(statistics.latest()[1]))
    assert shown["Samples"] == "2"
    assert (shown["Triangles"], shown["Triangles Drawn"]) == ("12", "24")
    assert shown["Time"].endswith(" s")
    assert shown["Stopped By"] == "Samples"
    assert 0.0 < float(shown["Estimated Error"].removesuffix(" %")) < 100.0
    assert ("Virtual Point Lights" in shown) == ("Points per Map" in shown) == has_virtual_lights
    assert all(float(shown[name].removesuffix(" MB")) >= 0.0 for name in ("Uploaded", "Render Target Memory"))


def test_the_newest_picture_is_the_latest():
    first, second = {"samples": 1}, {"samples": 2}
    render_statistics.store("render", first)
    render_statistics.store("viewport", second)
    render_statistics.store("viewport", {})
    assert render_statistics.latest() == ("viewport", second)
    render_statistics.store("render", first)
    assert render_statistics.latest() == ("render", first)
    render_statistics.latest()[1]["samples"] = 7
    assert render_statistics.for_use("render") == first
