# SPDX-License-Identifier: GPL-3.0-or-later
"""Short runs of the benchmarks that no other test runs."""

import json
import subprocess
import sys

import bpy
import pytest

from tests.benchmark import draws, first_picture, image_memory
from tests.scenes.small import box_over_plane
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import with_quality
from tests.tools import memory
from tests.tools.project import ROOT

pytestmark = pytest.mark.any_release  # dev.py bench has the first bpy


def test_a_picture_of_a_growing_scene_is_measured():
    command = [sys.executable, "-m", "tests.benchmark.scale.point", "frames", "1"]
    result = json.loads(
        subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, timeout=120, check=True).stdout
    )
    assert result["triangles"] > 1000
    assert min(result["first sync s"], result["shadows ms"], result["a frame s"], result["peak bytes"]) > 0.0


def test_the_largest_draws_are_measured(device, monkeypatch):
    monkeypatch.setattr(draws, "MIN_RAYS", 0)
    (settings, _), (maps, _) = draws.IMAGES["ray-traced"], draws.IMAGES["shadow-mapped"]
    small = with_quality(maps, virtual_lights=4, map_size=32, map_points=512)
    for chosen, drawn in ((settings, "TraceShadows"), (small, "SplatMaps")):
        seconds = draws.seconds_of_largest_draws(device, *box_over_plane(48, 32), chosen, 2)
        assert {drawn, "GBuffer", "Accumulate"} <= set(seconds)
        assert all(len(times) == 2 and min(times) > 0.0 for times in seconds.values())


def test_renders_of_small_meshes_are_measured_beside_cycles(tmp_path):
    command = [sys.executable, "-m", "tests.benchmark.small_meshes", "--output", str(tmp_path)]
    subprocess.run([*command, "--meshes", "20", "--renders", "2"], cwd=ROOT, timeout=120, check=True)
    record = json.loads((tmp_path / "small_meshes.json").read_text())
    repetitions = record["rounds"]
    assert record["command"] == "python3 dev.py bench small_meshes --meshes 20 --renders 2"
    assert record["machine"]["opengl"]
    assert len(repetitions) == 2
    assert all(min(each["whole"], each["read"], each["BuildBLAS"], each["Cycles"]) > 0.0 for each in repetitions)


@pytest.mark.alone
@pytest.mark.skipif(not memory.resident(), reason="no /proc")
def test_large_images_take_little_more_memory_than_their_textures():
    """Their textures are in this process if the driver is software, and nowhere else then are all of their texels."""
    none, four = (image_memory.measure_in_processes(image_memory.Images(count, 4096)) for count in (0, 4))
    textures = 4 * 4096**2 * 4 * 4 / 3
    assert four["images decoded"] - four["file open"] > 4 * 4096**2 * 4
    assert four["peak"] - none["peak"] < 1.5 * textures


def test_a_slider_of_forty_nodes_compiles_nothing():
    into_blender(*box_over_plane(48, 32))
    material = next(each.active_material for each in bpy.data.objects if each.type == "MESH")
    material.node_tree.nodes.clear()
    shader, output = (
        material.node_tree.nodes.new(f"ShaderNode{name}") for name in ("BsdfPrincipled", "OutputMaterial")
    )
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    slider = first_picture.add_nodes(material, first_picture.NODES)
    viewport = first_picture.Viewport(out_of_blender()[1])
    (changes,) = first_picture.drag(viewport, {"nodes": slider}, 3).values()
    viewport.thread.stop()
    assert [each["programs"] for each in changes] == [0, 0, 0]
    assert all(each["seconds"] > each["read"] > 0.0 for each in changes)


def test_worlds_are_measured_beside_cycles(tmp_path):
    command = [sys.executable, "-m", "tests.benchmark.worlds", "--output", str(tmp_path), "--worlds", "even"]
    subprocess.run([*command, "--samples", "1", "--truth", "1", "--finest", "1"], check=True, cwd=ROOT)
    surfaces = json.loads((tmp_path / "worlds.json").read_text())["worlds"]["even"]
    assert (tmp_path / "worlds-even.png").exists()
    assert surfaces["plane"]["error"] < 1e-4 and surfaces["ball"]["error"] < 1e-3


def test_spheres_of_shaders_are_measured_beside_cycles(tmp_path):
    command = [sys.executable, "-m", "tests.benchmark.spheres", "--output", str(tmp_path), "--lights", "sun"]
    subprocess.run([*command, "--samples", "2", "--truth", "1", "--finest", "10"], cwd=ROOT, timeout=120, check=True)
    cases = json.loads((tmp_path / "spheres.json").read_text())["cases"]["sun"]
    assert (tmp_path / "spheres-sun-0-1.png").exists() and (tmp_path / "spheres-sun-1-10.png").exists()
    assert max(each["error"] for each in cases["Principled BSDF"].values()) < 0.05
    assert {len(by_roughness) for by_roughness in cases.values()} == {8}
    assert {each["truth"] for by_roughness in cases.values() for each in by_roughness.values()} == {1, 10}
