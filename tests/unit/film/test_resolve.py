# SPDX-License-Identifier: GPL-3.0-or-later
"""The sums as one picture: what was predicted at first, and in the end all that corrects it."""

import numpy as np
import pytest

from ism_addon.gpu.passes.film.resolve import STRATIFICATION_EXPONENT
from ism_addon.resources import SUM_COLOR, SUM_HEADROOM, SUM_RESIDUAL, SUM_WEIGHTS, TILE_SAMPLE_COUNTS, TILE_SIZE
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality, write_texels

WIDTH, HEIGHT = 40, 24
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def resolved(
    device, means: np.ndarray, corrections: np.ndarray, squares: np.ndarray, count, doubt=1.0, sizes=None, headroom=None
) -> np.ndarray:
    """(H,W,3) of the mean prediction and correction of `count` samples (blocks or one), and their mean square (H,W).

    `doubt`, (H,W,1) or one: the luminance that is in doubt, and may be added unless `headroom` is less. `sizes` (H,W):
    the mean luminance of corrections without sign, if some have another one than their mean.
    """
    drawn = draw(device, *box_over_plane(WIDTH, HEIGHT), with_quality(SMALL_SETTINGS, samples=3))  # not resolved yet
    renderer = drawn.renderer
    blocks = np.broadcast_to(np.float32(count), (HEIGHT // TILE_SIZE, WIDTH // TILE_SIZE))
    samples = blocks.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[..., None]
    whole = np.concatenate([means * samples, samples], 2)
    parts = np.concatenate([corrections, squares[..., None]], 2) * (samples - 1.0)
    write_texels(renderer.graph[SUM_COLOR], whole.astype(np.float32))
    write_texels(renderer.graph[SUM_RESIDUAL], parts.astype(np.float32))
    corrected = samples - 1.0  # each counts for its own pixel alone
    sizes = np.abs(corrections @ LUMINANCE) if sizes is None else sizes
    weights = np.concatenate([samples, samples, sizes[..., None] * corrected, doubt * corrected], 2)
    write_texels(renderer.graph[SUM_WEIGHTS], weights.astype(np.float32))
    room = np.broadcast_to((doubt if headroom is None else headroom) * samples, (HEIGHT, WIDTH, 1))
    write_texels(renderer.graph[SUM_HEADROOM], room.astype(np.float32))
    write_texels(renderer.graph[TILE_SAMPLE_COUNTS], blocks)
    color = drawn.color  # resolved now, for the first time since two samples
    assert color[..., 3] == pytest.approx(1.0)
    return color[..., :3]


def random_picture(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((HEIGHT, WIDTH, 3))


def test_the_first_sample_shows_what_was_predicted_alone(device):
    means = random_picture()
    found = resolved(device, means, random_picture(1), np.ones((HEIGHT, WIDTH)), 1)
    assert found == pytest.approx(means, abs=1e-6)


@pytest.mark.parametrize("count", [2, 5, 300])
def test_a_correction_without_noise_is_believed_whole(device, count):
    """All samples found the same: the mean square is the square of the mean over their number."""
    means, corrections = 0.1 + random_picture(), 0.2 * random_picture(1) - 0.1
    found = resolved(device, means, corrections, np.zeros((HEIGHT, WIDTH)), count)
    assert found == pytest.approx(means + corrections, abs=1e-5)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_no_correction_is_larger_than_the_light_in_doubt(device, sign):
    means, corrections = np.ones((HEIGHT, WIDTH, 3)), np.full((HEIGHT, WIDTH, 3), 0.5 * sign)
    found = resolved(device, means, corrections, np.zeros((HEIGHT, WIDTH)), 5, doubt=0.2)
    assert found == pytest.approx(means + 0.2 * sign, abs=1e-5)


def test_no_correction_adds_light_that_nothing_sends(device):
    """Of what is in doubt, most had been predicted to arrive."""
    means, corrections = np.ones((HEIGHT, WIDTH, 3)), np.full((HEIGHT, WIDTH, 3), 0.5)
    found = resolved(device, means, corrections, np.zeros((HEIGHT, WIDTH)), 5, doubt=0.9, headroom=0.1)
    assert found == pytest.approx(means + 0.1, abs=1e-5)


def test_no_correction_takes_away_more_light_than_there_is(device):
    """What negative lights have made darker than black stays so."""
    means, corrections = 0.2 * random_picture() - 0.1, np.full((HEIGHT, WIDTH, 3), -0.5)
    found = resolved(device, means, corrections, np.zeros((HEIGHT, WIDTH)), 5)
    assert found == pytest.approx(means.clip(max=0.0), abs=1e-5)


def noisy(count: int, mean: float, deviation: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(H,W,3) and (H,W) twice: of `count` - 1 grey corrections, their mean, mean square and mean without sign."""
    found = np.random.default_rng(2).normal(mean, deviation, (count - 1, HEIGHT, WIDTH))
    return np.repeat(found.mean(0)[..., None], 3, 2), (found**2).mean(0), np.abs(found).mean(0)


def test_noise_about_nothing_is_hardly_believed(device):
    for count in (2, 4, 16):
        corrections, squares, sizes = noisy(count, 0.0)
        left = resolved(device, random_picture(), corrections, squares, count, sizes=sizes) - random_picture()
        shrinkage = 1.0 - count**-STRATIFICATION_EXPONENT
        assert np.sqrt((left**2).mean()) < (shrinkage + 0.15) * np.sqrt((corrections**2).mean())


def test_in_the_end_all_is_believed(device):
    """However small it is against the noise of a sample."""
    off = []
    for count in (4, 64, 4096):
        corrections, squares, sizes = noisy(count, 0.3)
        found = resolved(device, random_picture(), corrections, squares, count, sizes=sizes)
        left = found - random_picture() - corrections
        off.append(np.sqrt((left**2).mean()) / 0.3)
    assert off[1] < 0.5 * off[0]
    assert off[2] < 0.01


@pytest.mark.parametrize("count", [4, 64])
def test_a_single_ray_is_not_believed_however_many_samples_had_none(device, count):
    """One pixel in a hundred has one ray that says: all of it is wrong."""
    rare = (np.random.default_rng(4).random((HEIGHT, WIDTH)) < 0.01).astype(float)
    corrections = np.repeat(-rare[..., None], 3, 2)
    found = resolved(device, np.ones((HEIGHT, WIDTH, 3)), corrections, (count - 1) * rare, count)
    assert rare.any()
    assert found.min() > 0.9


def test_the_neighbours_mean_keeps_the_edges_of_textures(device):
    """A third too much of all that is in doubt, which changes from pixel to pixel; noise hides the difference."""
    means, doubt = random_picture(), 0.2 + random_picture(1)[..., :1]
    corrections = np.repeat(-0.3 * doubt, 3, 2)
    found = resolved(device, means, corrections, np.full((HEIGHT, WIDTH), 0.15), 5, doubt) - means
    assert np.median(np.abs(found / corrections - 1.0)) < 0.15  # where there are neighbours: most of the picture


def test_blocks_have_counts_of_their_own(device):
    counts = np.random.default_rng(3).integers(2, 60, (HEIGHT // TILE_SIZE, WIDTH // TILE_SIZE))
    means, corrections = random_picture(), random_picture(1)
    found = resolved(device, means, corrections, np.zeros((HEIGHT, WIDTH)), counts)
    assert found == pytest.approx(means + corrections, abs=1e-5)


@pytest.mark.parametrize("count", [2, 40])
def test_black_stays_black(device, count):
    nothing = np.zeros((HEIGHT, WIDTH, 3))
    assert not resolved(device, nothing, nothing, nothing[..., 0], count).any()
