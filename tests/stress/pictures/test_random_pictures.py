# SPDX-License-Identifier: GPL-3.0-or-later
"""Random pictures: finite, not negative, not brighter than without shadows, reproducible, and close to a reference."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from ism_addon import snapshot
from ism_addon.settings import SSAO, Method, Settings, Shadow
from tests.scenes.small import mesh
from tests.stress.pictures.comparisons import relative_difference, without_shadows
from tests.stress.pictures.moves import Picture
from tests.stress.pictures.random_pictures import pictures
from tests.support import reference
from tests.support.small_scenes import draw

#: Pictures that failed once, as Hypothesis shrank them.
REGRESSIONS = sorted((Path(__file__).parent / "kept").glob("*.npz"))

#: How much brighter than without shadows a pixel may be, relative to the mean: room for rounding.
MAX_BRIGHTER = 1e-3

#: The same pictures in each run, without a deadline.
ANY = settings(derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))

#: One in so many pictures is drawn again by a new renderer.
AFRESH = 8


def check(device, picture: Picture, renderer, is_redrawn: bool) -> None:
    """Assert what holds for any picture; if `is_redrawn`, also that a new renderer draws the same."""
    scene, view, picture_settings = picture
    color = draw(device, scene, view, picture_settings, renderer).color
    assert color.shape == (view.height, view.width, 4)
    assert np.isfinite(color).all(), f"{(~np.isfinite(color)).sum()} values are not finite"
    assert color.min() >= 0.0, f"{color.min()} is darker than black"
    assert color[..., 3].max() <= 1.0 + 1e-5
    # Of light whose visibility is uncertain, only the luminance is bounded.
    is_white = not np.ptp(scene.lights.emission, axis=1).any()
    if picture_settings.shadow.method == Method.RAY_TRACED and not picture_settings.shortcuts and is_white:
        unshadowed = draw(device, without_shadows(scene), view, picture_settings, renderer).color[..., :3]
        excess = (color[..., :3] - unshadowed).max()
        assert excess <= MAX_BRIGHTER * max(unshadowed.mean(), 1e-30), f"{excess} brighter than without shadows"
    if is_redrawn:
        again = draw(device, scene, view, picture_settings).color
        assert np.array_equal(again, color), "another renderer draws another picture"


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """Where the last picture that failed is saved; Hypothesis ends with the smallest one."""
    return tmp_path_factory.getbasetemp() / "failing.npz"


def test_random_pictures(device, failing, examples):
    """One renderer draws all of them, one after the other."""
    from ism_addon.gpu.renderer import Renderer

    renderer, numbers = Renderer(device), itertools.count()

    # Hypothesis derives its seed from this function's source: any change of it draws other pictures.
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
    """Relative difference from a reference with rays to 289 points of each light; None where that is unreliable.

    It is unreliable where it is black, or changes with 144 points or if the view moves by a hundredth of a pixel.
    """
    scene, view, picture_settings = picture
    scales = np.abs(np.linalg.det(scene.instances.world_from_object[scene.instances.visible, :3, :3]))
    if not len(scales) or scales.min() < 1e-6:
        return None
    meshes = tuple(mesh(each.positions, each.triangles) for each in scene.meshes)
    ones, no = np.ones(len(scene.lights.shape), np.float32), np.zeros(len(scene.lights.shape), np.bool_)
    # The reference shows no lights, whose shadows see their sizes, and whose nodes do nothing.
    lights = replace(scene.lights, shadow_softness=ones, visible_camera=no, falloff_power=no.astype(np.int32))
    lights = replace(lights, falloff_smooth=0.0 * ones, profile=no.astype(np.int32) - 1, image=no.astype(np.int32) - 1)
    scene = replace(scene, meshes=meshes, lights=lights)
    view = replace(view, filter_width=0.01, transparent=False)
    plain_settings = Settings(
        shadow=Shadow(world=False),
        ssao=SSAO(enabled=False),
        quality=replace(picture_settings.quality, samples=64),
        shortcuts=picture_settings.shortcuts,
    )
    moved_clip = view.clip_from_view.copy()
    moved_clip[:2] += 0.01 * 2.0 / np.array([[view.width], [view.height]]) * view.clip_from_view[3]  # of clip space
    coarse, moved, truth = (
        reference.picture(scene, each, side)[0].reshape(view.height, view.width, 3)
        for each, side in ((view, 12), (replace(view, clip_from_view=moved_clip), 17), (view, 17))
    )
    if not truth.any() or max(relative_difference(coarse, truth), relative_difference(moved, truth)) > 0.01:
        return None
    return relative_difference(draw(device, scene, view, plain_settings, renderer).color, truth)


def test_random_pictures_against_rays(device, assert_within, examples):
    """Nine in ten are close: an edge through pixel centres may fall to either side. Half as many as above are drawn."""
    from ism_addon.gpu.renderer import Renderer

    renderer, off = Renderer(device), []

    # Hypothesis derives its seed from this function's source: any change of it draws other pictures.
    @settings(ANY, max_examples=examples // 2)
    @given(pictures())
    def any_picture(picture: Picture) -> None:
        if (found := against_rays(device, picture, renderer)) is not None:
            off.append(found)

    any_picture()
    assert len(off) > examples / 80
    assert_within(float(np.quantile(off, 0.9)), 0.03)


@pytest.mark.parametrize("path", REGRESSIONS, ids=[path.stem for path in REGRESSIONS])
def test_pictures_that_failed_once(device, path):
    check(device, snapshot.load(path), None, True)
    scene, view, picture_settings = snapshot.load(path)
    check(device, (scene, view, replace(picture_settings, shortcuts=False)), None, False)
