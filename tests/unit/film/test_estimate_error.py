# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated error compared with the true one, and tiles that have no more samples once it is small enough."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.convergence import Convergence
from ism_addon.gpu.passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ism_addon.resources import TILE_SIZE
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality

SIZE = 64, 48

#: Samples of reference images: at least five times as many as of images that are compared with them.
TRUTH_SAMPLES = 512
#: True errors over estimated ones. If one edge is all that there is, samples along it are even, and it may be 1.5.
MIN_RATIO, MAX_RATIO = 0.6, 1.6


def tile_means(values: np.ndarray) -> np.ndarray:
    """(rows,columns): means over tiles of values (H,W)."""
    height, width = values.shape
    return values.reshape(height // TILE_SIZE, TILE_SIZE, width // TILE_SIZE, TILE_SIZE).mean((1, 3))


def small(name: str) -> tuple:
    """A small scene, and a view of it with Blender's filter."""
    scene, view = SMALL[name](*SIZE)
    return scene, replace(view, filter_width=1.5)


@pytest.fixture(scope="module")
def drawn_pictures() -> dict:
    """Pictures that have been drawn, each with its Convergence."""
    return {}


@pytest.fixture
def picture(device, drawn_pictures):
    """picture(name of a small scene, samples, error threshold): the picture, and its Convergence."""

    def picture(name: str, samples: int, error_threshold: float = 0.0) -> tuple[np.ndarray, Convergence]:
        key = name, samples, error_threshold
        if key not in drawn_pictures:
            settings = with_quality(SMALL_SETTINGS, samples=samples, error_threshold=error_threshold)
            drawn = draw(device, *small(name), settings)
            drawn_pictures[key] = drawn.color, drawn.renderer.error
            drawn.renderer.release()
        return drawn_pictures[key]

    return picture


@pytest.fixture
def truth(picture):
    """truth(name of a small scene): its picture of very many samples."""
    return lambda name: picture(name, TRUTH_SAMPLES)[0]


def true_errors(color: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(rows,columns) RMS errors of tiles, relative to the picture's mean."""
    return np.sqrt(tile_means(((color - truth)[..., :3] ** 2).mean(-1))) / truth[..., :3].mean()


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [4, 16, 64, 100])
def test_the_estimate_is_the_true_error(picture, truth, name, samples):
    """Of the picture, and the median of its noisy tiles. It may be too high or too low."""
    color, convergence = picture(name, samples)
    errors = true_errors(color, truth(name))
    assert MIN_RATIO < np.sqrt((errors**2).mean()) / convergence.image_error < MAX_RATIO
    estimated = np.sqrt(convergence.variance / convergence.counts)
    noisy = errors > 0.3 * convergence.image_error
    assert MIN_RATIO < np.median(errors[noisy] / estimated[noisy]) < MAX_RATIO


@pytest.mark.parametrize("name", SMALL)
def test_the_estimate_is_not_too_low_on_average(picture, truth, name):
    """True errors over estimated ones, averaged over numbers of samples."""
    ratios = []
    for samples in (4, 8, 16, 32, 64):
        color, convergence = picture(name, samples)
        ratios.append(np.sqrt((true_errors(color, truth(name)) ** 2).mean()) / convergence.image_error)
    assert 0.7 < np.exp(np.log(ratios).mean()) < 1.1


def test_the_noise_of_shadow_maps_and_of_occlusion_is_estimated_too(device):
    """Their bias is not estimated: the truth is an image by the same method."""
    settings, scene_and_view = replace(SMALL_SHADOW_MAPS, ssao=SSAO()), small("sphere in corner")
    drawn = draw(device, *scene_and_view, with_quality(settings, samples=16))
    errors = true_errors(drawn.color, draw(device, *scene_and_view, with_quality(settings, samples=128)).color)
    assert MIN_RATIO < np.sqrt((errors**2).mean()) / drawn.renderer.error.image_error < MAX_RATIO


@pytest.mark.parametrize(("samples", "resolves"), [(1, 1), (4, 3), (15, 3), (16, 3), (64, 5)])
def test_the_image_is_resolved_only_when_it_is_needed(device, samples, resolves):
    """After the first sample, and at least twice more: of 16 samples after 8 and 16, of 64 after 32 and 64 too."""
    drawn = draw(device, *small("box over plane"), with_quality(SMALL_SETTINGS, samples=samples))
    assert drawn.profile.rows["Resolve"].drawn == resolves
    assert np.isfinite(drawn.renderer.error.image_error) == (samples > 1)


@pytest.mark.parametrize("name", SMALL)
def test_converged_tiles_have_less_error_than_the_threshold(picture, truth, name):
    threshold = 0.02
    color, convergence = picture(name, 512, threshold)
    converged = convergence.converged
    assert converged.mean() > 0.9
    errors = true_errors(color, truth(name))[converged]
    assert np.median(errors) < threshold
    assert np.percentile(errors, 95.0) < 1.5 * threshold


def test_a_converged_tile_is_not_drawn_again_and_does_not_change(device):
    """Samples of the tiles beside it do not change it either."""
    settings = with_quality(SMALL_SETTINGS, samples=512, error_threshold=0.02)
    before = draw(device, *small("pillar field"), settings, last=31)
    converged = before.renderer.error.converged
    assert 0.1 < converged.mean() < 0.9
    after = draw(device, *small("pillar field"), settings, last=127)
    pixels = converged.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)
    for name in ("sum_color", "sum_residual", "sum_weights"):
        assert np.array_equal(before.target(name)[pixels], after.target(name)[pixels])
        assert not np.array_equal(before.target(name)[~pixels], after.target(name)[~pixels])
    assert after.renderer.error.counts[converged].max() <= 32 < after.renderer.error.counts[~converged].max()


def test_tiles_beside_converged_ones_have_no_seams(picture, truth):
    """A pixel at a tile's border, whose filter extends beyond it, has hardly more error than those inside."""
    name = "pillar field"
    color, _ = picture(name, 512, 0.02)
    squared_error = ((color - truth(name))[..., :3] ** 2).mean(-1)
    x, y = np.meshgrid(*(np.arange(size) % TILE_SIZE for size in SIZE))
    border = (x % (TILE_SIZE - 1) == 0) | (y % (TILE_SIZE - 1) == 0)
    assert np.sqrt(squared_error[border].mean() / squared_error[~border].mean()) < 1.3


@pytest.mark.parametrize("name", SMALL)
def test_no_tile_converges_early_and_none_without_a_threshold_or_shortcuts(device, name):
    coarse = with_quality(SMALL_SETTINGS, samples=512, error_threshold=1.0)
    assert not draw(device, *small(name), coarse, last=MIN_SAMPLES_TO_STOP - 2).renderer.error.converged.any()
    assert draw(device, *small(name), coarse, last=MIN_SAMPLES_TO_STOP - 1).renderer.error.converged.all()
    without_shortcuts = draw(device, *small(name), replace(coarse, shortcuts=False), last=MIN_SAMPLES_TO_STOP)
    assert not without_shortcuts.renderer.error.converged.any()
    assert not draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=64)).renderer.error.converged.any()


def test_less_error_takes_more_samples(picture):
    taken = [picture("pillar field", 512, threshold)[1].counts.sum() for threshold in (0.1, 0.04, 0.02)]
    assert taken[0] < 0.7 * taken[1] < 0.49 * taken[2]
