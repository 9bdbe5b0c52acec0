# SPDX-License-Identifier: GPL-3.0-or-later
"""The sums resolved to an image: the mean prediction, and the mean residual, which is shrunk if it is noisy."""

import numpy as np
import pytest

from ism_addon.gpu.passes.film.resolve import STRATIFICATION_EXPONENT
from ism_addon.resources import SUM_COLOR, SUM_HEADROOM, SUM_RESIDUAL, SUM_WEIGHTS, TILE_SIZE
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality, write_texels

WIDTH, HEIGHT = 40, 24
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def resolved(
    device,
    means: np.ndarray,
    residuals: np.ndarray,
    squares: np.ndarray,
    count,
    uncertain=1.0,
    magnitudes=None,
    headroom=None,
) -> np.ndarray:
    """(H,W,3) from the mean prediction and residual of `count` samples, and the residuals' mean square (H,W).

    `count`: of each tile, or one number. `uncertain`, (H,W,1) or one number: the uncertain luminance, which residuals
    may remove, and add unless `headroom` is less. `magnitudes` (H,W): the mean absolute luminance of residuals, if it
    is not that of their mean.
    """
    drawn = draw(device, *box_over_plane(WIDTH, HEIGHT), with_quality(SMALL_SETTINGS, samples=3))  # not resolved yet
    renderer = drawn.renderer
    counts = np.broadcast_to(np.float32(count), (HEIGHT // TILE_SIZE, WIDTH // TILE_SIZE))
    samples = counts.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[..., None]
    color_sums = np.concatenate([means * samples, samples], 2)
    residual_sums = np.concatenate([residuals, squares[..., None]], 2) * samples
    write_texels(renderer.graph[SUM_COLOR], color_sums.astype(np.float32))
    write_texels(renderer.graph[SUM_RESIDUAL], residual_sums.astype(np.float32))
    magnitudes = np.abs(residuals @ LUMINANCE) if magnitudes is None else magnitudes
    weights = np.concatenate([samples, samples, magnitudes[..., None] * samples, uncertain * samples], 2)
    write_texels(renderer.graph[SUM_WEIGHTS], weights.astype(np.float32))
    headroom_sums = np.broadcast_to((uncertain if headroom is None else headroom) * samples, (HEIGHT, WIDTH, 1))
    write_texels(renderer.graph[SUM_HEADROOM], headroom_sums.astype(np.float32))
    color = drawn.color  # resolved now, for the first time in two samples
    assert color[..., 3] == pytest.approx(1.0)
    return color[..., :3]


def random_image(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).random((HEIGHT, WIDTH, 3))


@pytest.mark.parametrize("count", [2, 5, 300])
def test_a_residual_without_noise_is_not_shrunk(device, count):
    """A mean square of 0 means no noise."""
    means, residuals = 0.1 + random_image(), 0.2 * random_image(1) - 0.1
    image = resolved(device, means, residuals, np.zeros((HEIGHT, WIDTH)), count)
    assert image == pytest.approx(means + residuals, abs=1e-5)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_no_residual_is_larger_than_the_uncertain_light(device, sign):
    means, residuals = np.ones((HEIGHT, WIDTH, 3)), np.full((HEIGHT, WIDTH, 3), 0.5 * sign)
    image = resolved(device, means, residuals, np.zeros((HEIGHT, WIDTH)), 5, uncertain=0.2)
    assert image == pytest.approx(means + 0.2 * sign, abs=1e-5)


def test_no_residual_adds_more_light_than_the_headroom(device):
    """Most of the uncertain light is already part of the prediction."""
    means, residuals = np.ones((HEIGHT, WIDTH, 3)), np.full((HEIGHT, WIDTH, 3), 0.5)
    image = resolved(device, means, residuals, np.zeros((HEIGHT, WIDTH)), 5, uncertain=0.9, headroom=0.1)
    assert image == pytest.approx(means + 0.1, abs=1e-5)


def test_no_residual_removes_more_light_than_there_is(device):
    """Predictions below 0, by negative lights, stay the same."""
    means, residuals = 0.2 * random_image() - 0.1, np.full((HEIGHT, WIDTH, 3), -0.5)
    image = resolved(device, means, residuals, np.zeros((HEIGHT, WIDTH)), 5)
    assert image == pytest.approx(means.clip(max=0.0), abs=1e-5)


def noisy_residuals(count: int, mean: float, deviation: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(H,W,3) and (H,W) twice: mean, mean square and mean absolute value of `count` grey residuals."""
    residuals = np.random.default_rng(2).normal(mean, deviation, (count, HEIGHT, WIDTH))
    return np.repeat(residuals.mean(0)[..., None], 3, 2), (residuals**2).mean(0), np.abs(residuals).mean(0)


def test_noise_around_zero_is_shrunk(device):
    for count in (2, 4, 16):
        residuals, squares, magnitudes = noisy_residuals(count, 0.0)
        left = resolved(device, random_image(), residuals, squares, count, magnitudes=magnitudes) - random_image()
        shrinkage = 1.0 - count**-STRATIFICATION_EXPONENT
        assert np.sqrt((left**2).mean()) < (shrinkage + 0.15) * np.sqrt((residuals**2).mean())


def test_with_many_samples_residuals_are_not_shrunk(device):
    """However small they are compared with the noise of a sample."""
    errors = []
    for count in (4, 64, 4096):
        residuals, squares, magnitudes = noisy_residuals(count, 0.3)
        image = resolved(device, random_image(), residuals, squares, count, magnitudes=magnitudes)
        left = image - random_image() - residuals
        errors.append(np.sqrt((left**2).mean()) / 0.3)
    assert errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.01


@pytest.mark.parametrize("count", [4, 64])
def test_the_residual_of_a_single_ray_is_shrunk_however_many_samples_traced_none(device, count):
    """In one pixel in a hundred, a single ray has a residual that removes all light."""
    rare = (np.random.default_rng(4).random((HEIGHT, WIDTH)) < 0.01).astype(float)
    residuals = np.repeat(-rare[..., None], 3, 2)
    image = resolved(device, np.ones((HEIGHT, WIDTH, 3)), residuals, count * rare, count)
    assert rare.any()
    assert image.min() > 0.9


def test_the_neighbours_mean_keeps_the_edges_of_textures(device):
    """The prediction is too high by 0.3 of the uncertain light, which varies by pixel. Noise hides the differences."""
    means, uncertain = random_image(), 0.2 + random_image(1)[..., :1]
    residuals = np.repeat(-0.3 * uncertain, 3, 2)
    change = resolved(device, means, residuals, np.full((HEIGHT, WIDTH), 0.15), 5, uncertain) - means
    assert np.median(np.abs(change / residuals - 1.0)) < 0.15  # where there are neighbours: in most of the picture


def test_each_tile_has_its_own_sample_count(device):
    counts = np.random.default_rng(3).integers(2, 60, (HEIGHT // TILE_SIZE, WIDTH // TILE_SIZE))
    means, residuals = random_image(), random_image(1)
    image = resolved(device, means, residuals, np.zeros((HEIGHT, WIDTH)), counts)
    assert image == pytest.approx(means + residuals, abs=1e-5)


@pytest.mark.parametrize("count", [2, 40])
def test_black_stays_black(device, count):
    black = np.zeros((HEIGHT, WIDTH, 3))
    assert not resolved(device, black, black, black[..., 0], count).any()
