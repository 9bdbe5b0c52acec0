# SPDX-License-Identifier: GPL-3.0-or-later
"""Any picture is finite, never darker than black nor brighter than without shadows, and the same when drawn again."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from ism_addon import snapshot
from ism_addon.settings import SSAO, Method, Settings
from tests.scenes.small import mesh
from tests.stress.pictures.comparisons import relative_difference, unshadowed
from tests.stress.pictures.moves import Picture
from tests.stress.pictures.random_pictures import pictures
from tests.support import reference
from tests.support.small_scenes import draw

#: Pictures that were wrong once, as Hypothesis shrank them.
KEPT = sorted((Path(__file__).parent / "kept").glob("*.npz"))

#: How much brighter than without shadows, over the mean: rounding.
BRIGHTER = 1e-3

#: The same pictures each time, however long they take.
ANY = settings(derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))

#: Of so many pictures one is drawn again by a renderer that has drawn nothing else.
AFRESH = 8


def check(device, picture: Picture, renderer, afresh: bool) -> None:
    """All that holds of any picture."""
    scene, view, how = picture
    color = draw(device, scene, view, how, renderer).color
    assert color.shape == (view.height, view.width, 4)
    assert np.isfinite(color).all(), f"{(~np.isfinite(color)).sum()} values are not finite"
    assert color.min() >= 0.0, f"{color.min()} is darker than black"
    assert color[..., 3].max() <= 1.0 + 1e-5
    white = not np.ptp(scene.lights.radiance, axis=1).any()  # of light in doubt, only the brightness is known
    if how.shadow.method == Method.RAY_TRACED and not how.shortcuts and white:
        whole = draw(device, unshadowed(scene), view, how, renderer).color[..., :3]
        above = (color[..., :3] - whole).max()
        assert above <= BRIGHTER * max(whole.mean(), 1e-30), f"{above} brighter than without shadows"
    if afresh:
        again = draw(device, scene, view, how).color
        assert np.array_equal(again, color), "another renderer draws another picture"


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """Where the picture is written that was drawn last: the smallest that fails, in the end."""
    return tmp_path_factory.getbasetemp() / "failing.npz"


def test_random_pictures(device, failing, examples):
    """Drawn by one renderer, one after the other."""
    from ism_addon.gpu.renderer import Renderer

    renderer, numbers = Renderer(device), itertools.count()

    @settings(ANY, max_examples=examples)
    @given(pictures())
    def any_picture(picture: Picture) -> None:
        try:
            check(device, picture, renderer, next(numbers) % AFRESH == 0)
        except Exception as error:
            snapshot.save(failing, *picture)
            error.add_note(f"the picture is kept in {failing}")
            raise

    any_picture()


def against_rays(device, picture: Picture, renderer) -> float | None:
    """How far a picture is from rays to 289 points of each light; None where these give no truth.

    That is where 144 points, or a view that is moved by a hundredth of a pixel, give something else, or all is dark.
    """
    scene, view, how = picture
    scales = np.abs(np.linalg.det(scene.instances.world_from_object[scene.instances.visible, :3, :3]))
    if not len(scales) or scales.min() < 1e-6:
        return None
    meshes = tuple(mesh(each.positions, each.triangles) for each in scene.meshes)
    scene, view = replace(scene, meshes=meshes), replace(view, filter_width=0.01, transparent=False)
    plain = Settings(ssao=SSAO(enabled=False), quality=replace(how.quality, samples=64), shortcuts=how.shortcuts)
    moved = view.clip_from_view.copy()
    moved[:2] += 0.01 * 2.0 / np.array([[view.width], [view.height]]) * view.clip_from_view[3]  # of clip space
    few, beside, truth = (
        reference.picture(scene, each, side)[0].reshape(view.height, view.width, 3)
        for each, side in ((view, 12), (replace(view, clip_from_view=moved), 17), (view, 17))
    )
    if not truth.any() or max(relative_difference(few, truth), relative_difference(beside, truth)) > 0.01:
        return None
    return relative_difference(draw(device, scene, view, plain, renderer).color, truth)


def test_random_pictures_against_rays(device, within, examples):
    """Nine of ten are close: edges that pixels' centres lie on may fall to either side. Half as many as above."""
    from ism_addon.gpu.renderer import Renderer

    renderer, off = Renderer(device), []

    @settings(ANY, max_examples=examples // 2)
    @given(pictures())
    def any_picture(picture: Picture) -> None:
        if (found := against_rays(device, picture, renderer)) is not None:
            off.append(found)

    any_picture()
    assert len(off) > examples / 80
    within(float(np.quantile(off, 0.9)), 0.03)


@pytest.mark.parametrize("path", KEPT, ids=[path.stem for path in KEPT])
def test_pictures_that_were_wrong_once(device, path):
    check(device, snapshot.load(path), None, True)
    scene, view, how = snapshot.load(path)
    check(device, (scene, view, replace(how, shortcuts=False)), None, False)
