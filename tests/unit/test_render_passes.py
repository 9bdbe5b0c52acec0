# SPDX-License-Identifier: GPL-3.0-or-later
"""A row of the table makes a render pass: it is read back, written by the command line, and equals the reference."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon import render_passes, snapshot
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import COMBINED, OCCLUSION, RENDER_PASSES, RenderPass
from ism_addon.resources import BASE_COLOR, POSITION
from ism_addon.scene import Scene, View
from tests.pictures.test_cli import call as call
from tests.scenes.parts.tables import materials_of
from tests.scenes.small import sphere_in_corner, view
from tests.support import reference
from tests.support.jobs import wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality

#: Rows that the product's table lacks, for targets that exist.
ADDED = (
    RenderPass("Position", "use_pass_position", "XYZ", "VECTOR", POSITION),
    RenderPass("Diffuse Color", "use_pass_diffuse_color", "RGB", "COLOR", BASE_COLOR),
)
#: Fraction of the pixels that may lie on the other side of an edge.
EDGE = 0.01

SETTINGS = with_quality(SMALL_SETTINGS, samples=3)


def two_colors(width: int = 48, height: int = 32) -> tuple[Scene, View]:
    """A red sphere before walls of another colour, with background beside them, far from the world's origin.

    The pixel filter is 1.5 px wide.
    """
    scene, _ = sphere_in_corner()
    *walls, ball = scene.meshes
    ball = replace(ball, materials=np.ones(len(ball.triangles), np.uint32))
    materials = materials_of([(0.5, 0.6, 0.7), (0.8, 0.1, 0.2)])
    offset, matrices = np.array([60.0, -90.0, 0.0]), scene.instances.world_from_object.copy()
    matrices[:, :3, 3] += offset
    scene = replace(
        scene,
        meshes=(*walls, ball),
        instances=replace(scene.instances, world_from_object=matrices),
        materials=materials,
        lights=replace(scene.lights, position=scene.lights.position + offset),
    )
    camera = view(offset + (8.0, 7.0, 4.0), offset + (0.7, 0.7, 0.6), width, height)
    return scene, replace(camera, filter_width=1.5)


def expected(scene: Scene, view: View) -> dict[str, np.ndarray]:
    """(N,channels) of each pass except Combined, by rays through the pixels' centres."""
    surface = reference.surfaces(scene, view)
    exists = surface.exists[:, None]
    material = np.concatenate([scene.meshes[mesh].materials for mesh in scene.instances.mesh])[surface.triangle]
    return {
        "Depth": np.where(exists, surface.depth[:, None], 1e10),
        "Normal": np.where(exists, reference.shading_normals(scene, surface), 0.0),
        "Position": np.where(exists, surface.position, 0.0),
        "Diffuse Color": np.where(exists, scene.materials.base_color[material], 0.0),
    }


def compare(image: np.ndarray, truth: np.ndarray) -> None:
    """Check an image (H,W,channels) against the truth (N,channels), except at edges. The truth must not be constant."""
    assert image.dtype == np.float32
    difference = np.abs(image.reshape(-1, image.shape[-1]) - truth)
    assert (difference > 1e-3 * np.maximum(np.abs(truth), 1.0)).any(1).mean() <= EDGE
    assert len(np.unique(truth.round(3), axis=0)) > 2


@pytest.fixture
def rows(monkeypatch) -> tuple[RenderPass, ...]:
    """The table with rows added. No other code knows of them."""
    table = (*(each for each in RENDER_PASSES if each is not OCCLUSION), *ADDED)
    monkeypatch.setattr(render_passes, "RENDER_PASSES", table)
    return table


def test_every_row_is_read_back(device, rows):
    scene, view = two_colors()
    drawn = draw(device, scene, view, SETTINGS, last=0)
    images = drawn.renderer.images(rows)
    truth = expected(scene, view)
    assert {*images} == {COMBINED.name, *truth}
    for name in truth:
        compare(images[name], truth[name])


def test_a_job_has_the_requested_passes(worker, device):
    """The filtered picture is of all samples; unfiltered passes are of the first one."""
    scene, view = two_colors()
    job = worker.start(Request(scene, view, SETTINGS, (COMBINED, *ADDED)), "client")
    assert wait_for_end(job)
    assert [*job.picture().passes] == [COMBINED.name, *(each.name for each in ADDED)]
    one_sample, all_samples = Renderer(device), Renderer(device)
    first = draw(device, scene, view, SETTINGS, one_sample, last=0).renderer.images(ADDED)
    for each in ADDED:
        assert np.array_equal(job.picture().passes[each.name], first[each.name])
    assert np.array_equal(job.picture().color, draw(device, scene, view, SETTINGS, all_samples).color)
    assert not np.array_equal(all_samples.images(ADDED)["Position"], first["Position"])


def test_the_command_line_writes_every_row(call, tmp_path, device, rows):
    scene, view = two_colors()
    snapshot.save(tmp_path / "scene.npz", scene, view, SETTINGS)
    files = {each: tmp_path / f"{each.identifier}.npy" for each in rows}
    options = [option for each, file in files.items() for option in (f"--output-{each.identifier}", file)]
    assert call(tmp_path / "scene.npz", "-o", tmp_path / "out.png", *options) == (0, "", "")
    assert np.array_equal(np.load(files[COMBINED]), draw(device, scene, view, SETTINGS).color)
    for name, truth in expected(scene, view).items():
        compare(np.load(next(file for each, file in files.items() if each.name == name)), truth)


def test_a_pass_that_cannot_be_written_is_an_error(call, tmp_path):
    snapshot.save(tmp_path / "scene.npz", *two_colors(), SETTINGS)
    missing = tmp_path / "no folder" / "depth.npy"
    status, _, error = call(tmp_path / "scene.npz", "-o", tmp_path / "out.png", "--output-depth", missing)
    assert status == 1
    assert "no folder" in error
