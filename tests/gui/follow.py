# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the picture follows: after each act it is what a viewport shows that knows of nothing before it."""

from collections.abc import Callable, Generator

import numpy as np

from tests.gui import scenery
from tests.gui.sight import rmse
from tests.gui.stage import Stage, Steps

#: Display values by which pictures of the same may differ: screenshots are rounded, and sampling is repeatable.
SAME = 1.5 / 255
#: Enough to tell what is in the picture.
SAMPLES = 2

Act = Callable[[], object]
Picture = Generator[None, None, np.ndarray]


def settle(stage: Stage) -> Picture:
    """The picture of the scene before anything is done with it."""
    scenery.look(stage.view, 5.0)
    stage.bare()
    stage.scene.ism.viewport.samples = SAMPLES
    stage.rendered()
    yield from stage.rested()
    stage.remember("Before")
    return stage.pixels("0 before")


def changed(stage: Stage, name: str, act: Act, before: np.ndarray) -> Picture:
    """Act: the picture is another one than before, and right."""
    picture = yield from _done(stage, name, act)
    assert rmse(picture, before) > SAME, f"{name}: the picture does not follow"
    yield from right(stage, name, picture)
    return picture


def right(stage: Stage, name: str, picture: np.ndarray) -> Steps:
    """What is seen is what a viewport shows that is switched to Rendered only now."""
    stage.space.shading.type = "SOLID"
    yield from stage.turns()
    stage.space.shading.type = "RENDERED"
    yield from stage.rested()
    _compare(stage, f"{name}, read anew", stage.pixels(f"{name}, read anew"), picture)


def same(stage: Stage, name: str, act: Act, before: np.ndarray) -> Steps:
    """Act: the picture is the one from before, again or still."""
    picture = yield from _done(stage, name, act)
    _compare(stage, name, picture, before)


def _done(stage: Stage, name: str, act: Act) -> Picture:
    """The picture after an act, which is a step for undo."""
    with stage.in_viewport():
        act()
    yield from stage.rested()
    return stage.pixels(name)


def _compare(stage: Stage, name: str, one: np.ndarray, other: np.ndarray) -> None:
    stage.measured(f"{name}, RMSE", 255 * rmse(one, other), "/255", must=255 * SAME)
