# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimated error beside the true one, and blocks that have no more samples when it is small enough."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ism_addon.resources import TILE_SIZE
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support.small_scenes import MAPS, SMALL_SETTINGS, draw, with_quality

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
    """Pictures of very many samples, as soon as one was asked for."""
    return {}


@pytest.fixture
def truth(device, known):
    """A small scene's picture of very many samples, by its name."""

    def truth(name: str) -> np.ndarray:
        if name not in known:
            known[name] = draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=TRUTH)).color
        return known[name]

    return truth


def true_errors(color: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(H,W) of blocks, over the picture's mean brightness."""
    return np.sqrt(blocks(((color - truth)[..., :3] ** 2).mean(-1))) / truth[..., :3].mean()


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [4, 16, 64, 100])
def test_the_estimate_is_the_true_error(device, truth, name, samples):
    """Of the picture, and in the middle of its blocks, on either side of 1."""
    drawn = draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=samples))
    errors = true_errors(drawn.color, truth(name))
    assert LEAST < np.sqrt((errors**2).mean()) / drawn.renderer.error.image_error < MOST
    estimated = np.sqrt(drawn.renderer.error.variance / drawn.renderer.error.counts)
    noisy = errors > 0.3 * drawn.renderer.error.image_error
    assert LEAST < np.median(errors[noisy] / estimated[noisy]) < MOST


@pytest.mark.parametrize("name", SMALL)
def test_it_is_not_above_one_on_average(device, truth, name):
    """Of pictures of all numbers of samples."""
    ratios = []
    for samples in (4, 8, 16, 32, 64):
        drawn = draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=samples))
        errors = true_errors(drawn.color, truth(name))
        ratios.append(np.sqrt((errors**2).mean()) / drawn.renderer.error.image_error)
    assert 0.7 < np.exp(np.log(ratios).mean()) < 1.1


def test_the_noise_of_shadow_maps_and_of_occlusion_is_estimated_too(device):
    """Not what is wrong with them for ever: the truth here is their own."""
    settings, seen = replace(MAPS, ssao=SSAO()), small("sphere in corner")
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
def test_settled_blocks_are_as_good_as_asked(device, truth, name):
    threshold = 0.02
    drawn = draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=512, error_threshold=threshold))
    settled = drawn.renderer.error.converged
    assert settled.mean() > 0.9
    errors = true_errors(drawn.color, truth(name))[settled]
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


def test_blocks_beside_settled_ones_have_no_seams(device, truth):
    """A pixel at a block's border, whose filter reaches beyond it, is no worse than those inside."""
    name = "pillar field"
    drawn = draw(device, *small(name), with_quality(SMALL_SETTINGS, samples=512, error_threshold=0.02))
    off = ((drawn.color - truth(name))[..., :3] ** 2).mean(-1)
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


def test_less_error_takes_more_samples(device):
    taken = []
    for threshold in (0.1, 0.03, 0.01):
        settings = with_quality(SMALL_SETTINGS, samples=512, error_threshold=threshold)
        taken.append(draw(device, *small("pillar field"), settings).renderer.error.counts.sum())
    assert taken[0] < 0.7 * taken[1] < 0.49 * taken[2]
