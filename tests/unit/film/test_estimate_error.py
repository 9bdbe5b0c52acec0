# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated error beside the true one, and blocks that have no more samples when it is small enough."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.convergence import Convergence
from ism_addon.gpu.passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ism_addon.resources import TILE_SIZE
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, with_quality

SIZE = 96, 64

#: Five times as many samples, at least, as the pictures that it is compared with.
TRUTH = 512
#: True errors over estimated ones. Where one edge is all that there is, places on it are even, and it may be 1.5.
LEAST, MOST = 0.6, 1.6


def blocks(values: np.ndarray) -> np.ndarray:
    """(H,W): means over blocks of pixels."""
    height, width = values.shape
    return values.reshape(height // TILE_SIZE, TILE_SIZE, width // TILE_SIZE, TILE_SIZE).mean((1, 3))


def small(name: str) -> tuple:
    """A small scene, and a view of it with Blender's filter."""
    scene, view = SMALL[name](*SIZE)
    return scene, replace(view, filter_width=1.5)


@pytest.fixture(scope="module")
def known() -> dict:
    """Pictures that have been drawn, with the convergence of each."""
    return {}


@pytest.fixture
def picture(device, known):
    """picture(name of a small scene, samples, error threshold): the picture, and its Convergence."""

    def picture(name: str, samples: int, error_threshold: float = 0.0) -> tuple[np.ndarray, Convergence]:
        key = name, samples, error_threshold
        if key not in known:
            settings = with_quality(SMALL_SETTINGS, samples=samples, error_threshold=error_threshold)
            drawn = draw(device, *small(name), settings)
            known[key] = drawn.color, drawn.renderer.error
            drawn.renderer.release()
        return known[key]

    return picture


@pytest.fixture
def truth(picture):
    """A small scene's picture of very many samples, by its name."""
    return lambda name: picture(name, TRUTH)[0]


def true_errors(color: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(H,W) of blocks, over the picture's mean brightness."""
    return np.sqrt(blocks(((color - truth)[..., :3] ** 2).mean(-1))) / truth[..., :3].mean()


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [4, 16, 64, 100])
def test_the_estimate_is_the_true_error(picture, truth, name, samples):
    """Of the picture, and in the middle of its blocks, on either side of 1."""
    color, convergence = picture(name, samples)
    errors = true_errors(color, truth(name))
    assert LEAST < np.sqrt((errors**2).mean()) / convergence.image_error < MOST
    estimated = np.sqrt(convergence.variance / convergence.counts)
    noisy = errors > 0.3 * convergence.image_error
    assert LEAST < np.median(errors[noisy] / estimated[noisy]) < MOST


@pytest.mark.parametrize("name", SMALL)
def test_it_is_not_above_one_on_average(picture, truth, name):
    """Of pictures of all numbers of samples."""
    ratios = []
    for samples in (4, 8, 16, 32, 64):
        color, convergence = picture(name, samples)
        ratios.append(np.sqrt((true_errors(color, truth(name)) ** 2).mean()) / convergence.image_error)
    assert 0.7 < np.exp(np.log(ratios).mean()) < 1.1


def test_the_noise_of_shadow_maps_and_of_occlusion_is_estimated_too(device):
    """Not what is wrong with them for ever: the truth here is their own."""
    settings, seen = replace(SMALL_SHADOW_MAPS, ssao=SSAO()), small("sphere in corner")
    drawn = draw(device, *seen, with_quality(settings, samples=16))
    errors = true_errors(drawn.color, draw(device, *seen, with_quality(settings, samples=128)).color)
    assert LEAST < np.sqrt((errors**2).mean()) / drawn.renderer.error.image_error < MOST


@pytest.mark.parametrize(("samples", "looks"), [(1, 1), (4, 3), (15, 3), (16, 3), (64, 5)])
def test_the_picture_is_put_together_only_to_be_looked_at(device, samples, looks):
    """After the first sample, and twice at least: for 16 samples after 8 and 16, for 64 after 32 and 64 too."""
    drawn = draw(device, *small("box over plane"), with_quality(SMALL_SETTINGS, samples=samples))
    assert drawn.profile.rows["Resolve"].drawn == looks
    assert np.isfinite(drawn.renderer.error.image_error) == (samples > 1)


@pytest.mark.parametrize("name", SMALL)
def test_settled_blocks_are_as_good_as_asked(picture, truth, name):
    threshold = 0.02
    color, convergence = picture(name, 512, threshold)
    settled = convergence.converged
    assert settled.mean() > 0.9
    errors = true_errors(color, truth(name))[settled]
    assert np.median(errors) < threshold
    assert np.percentile(errors, 95.0) < 1.5 * threshold


def test_a_settled_block_is_drawn_no_more_and_stays_as_it_is(device):
    """The samples of those beside it do not change it either."""
    settings = with_quality(SMALL_SETTINGS, samples=512, error_threshold=0.02)
    before = draw(device, *small("pillar field"), settings, last=31)
    settled = before.renderer.error.converged
    assert 0.1 < settled.mean() < 0.9
    after = draw(device, *small("pillar field"), settings, last=127)
    pixels = settled.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)
    for name in ("sum_color", "sum_residual", "sum_weights"):
        assert np.array_equal(before.target(name)[pixels], after.target(name)[pixels])
        assert not np.array_equal(before.target(name)[~pixels], after.target(name)[~pixels])
    assert after.renderer.error.counts[settled].max() <= 32 < after.renderer.error.counts[~settled].max()


def test_blocks_beside_settled_ones_have_no_seams(picture, truth):
    """A pixel at a block's border, whose filter reaches beyond it, is no worse than those inside."""
    name = "pillar field"
    color, _ = picture(name, 512, 0.02)
    off = ((color - truth(name))[..., :3] ** 2).mean(-1)
    x, y = np.meshgrid(*(np.arange(size) % TILE_SIZE for size in SIZE))
    border = (x % (TILE_SIZE - 1) == 0) | (y % (TILE_SIZE - 1) == 0)
    assert np.sqrt(off[border].mean() / off[~border].mean()) < 1.3


@pytest.mark.parametrize("name", SMALL)
def test_no_block_is_settled_early_and_none_without_a_threshold_or_skipping(device, name):
    coarse = with_quality(SMALL_SETTINGS, samples=512, error_threshold=1.0)
    assert not draw(device, *small(name), coarse, last=MIN_SAMPLES_TO_STOP - 2).renderer.error.converged.any()
    assert draw(device, *small(name), coarse, last=MIN_SAMPLES_TO_STOP - 1).renderer.error.converged.all()
    without = draw(device, *small(name), replace(coarse, shortcuts=False), last=MIN_SAMPLES_TO_STOP)
    assert not without.renderer.error.converged.any()
    assert not draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=64)).renderer.error.converged.any()


def test_less_error_takes_more_samples(picture):
    taken = [picture("pillar field", 512, threshold)[1].counts.sum() for threshold in (0.1, 0.04, 0.02)]
    assert taken[0] < 0.7 * taken[1] < 0.49 * taken[2]
