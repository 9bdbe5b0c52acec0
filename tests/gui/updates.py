# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the picture follows: after each act it is what a viewport shows that knows of nothing before it."""

from collections.abc import Callable, Generator

import numpy as np

from tests.gui import scene_setup
from tests.gui.screenshots import rmse
from tests.gui.session import Session, Steps

#: Display values by which pictures of the same may differ: screenshots are rounded, and sampling is repeatable.
SAME = 1.5 / 255
#: Enough to tell what is in the picture.
SAMPLES = 2

Act = Callable[[], object]
Picture = Generator[None, None, np.ndarray]


def settle(session: Session) -> Picture:
    """The picture of the scene before anything is done with it."""
    scene_setup.set_view(session.view, 5.0)
    session.without_overlays()
    session.scene.ism.viewport.samples = SAMPLES
    session.rendered()
    yield from session.until_idle()
    session.remember("Before")
    return session.pixels("0 before")


def changed(session: Session, name: str, act: Act, before: np.ndarray) -> Picture:
    """Act: the picture is another one than before, and right."""
    picture = yield from _done(session, name, act)
    assert rmse(picture, before) > SAME, f"{name}: the picture does not follow"
    yield from assert_current(session, name, picture)
    return picture


def assert_current(session: Session, name: str, picture: np.ndarray) -> Steps:
    """What is seen is what a viewport shows that is switched to Rendered only now."""
    session.space.shading.type = "SOLID"
    yield from session.main_loop()
    session.space.shading.type = "RENDERED"
    yield from session.until_idle()
    _compare(session, f"{name}, read anew", session.pixels(f"{name}, read anew"), picture)


def assert_unchanged(session: Session, name: str, act: Act, before: np.ndarray) -> Steps:
    """Act: the picture is the one from before, again or still."""
    picture = yield from _done(session, name, act)
    _compare(session, name, picture, before)


def _done(session: Session, name: str, act: Act) -> Picture:
    """The picture after an act, which is a step for undo."""
    with session.in_viewport():
        act()
    yield from session.until_idle()
    return session.pixels(name)


def _compare(session: Session, name: str, one: np.ndarray, other: np.ndarray) -> None:
    session.measured(f"{name}, RMSE", 255 * rmse(one, other), "/255", must=255 * SAME)
