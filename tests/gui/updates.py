# SPDX-License-Identifier: GPL-3.0-or-later
"""Assertions that the viewport is up to date: after each edit, it shows what it shows after a switch to Rendered."""

from collections.abc import Callable, Generator

import numpy as np

from tests.gui import scene_setup
from tests.gui.screenshots import rmse
from tests.gui.session import Session, Steps

#: RMSE of display values between pictures of the same scene: screenshots are rounded, and sampling is repeatable.
MAX_RMSE = 1.5 / 255
#: Enough to tell pictures of different scenes apart.
SAMPLES = 2

Action = Callable[[], object]
Picture = Generator[None, None, np.ndarray]


def first_picture(session: Session) -> Picture:
    """Show the scene, with an undo step before the first edit: its picture."""
    scene_setup.set_view(session.view, 5.0)
    session.hide_overlays()
    session.scene.ism.viewport.samples = SAMPLES
    session.show_rendered()
    yield from session.until_idle()
    session.push_undo("Before")
    return session.pixels("0 before")


def assert_changed(session: Session, name: str, action: Action, before: np.ndarray) -> Picture:
    """After the action, the picture differs from that before, and is up to date: the new picture."""
    picture = yield from _picture_after(session, name, action)
    assert rmse(picture, before) > MAX_RMSE, f"{name}: the picture has not changed"
    yield from assert_current(session, name, picture)
    return picture


def assert_current(session: Session, name: str, picture: np.ndarray) -> Steps:
    """The picture equals what the viewport shows after it has been switched from Solid to Rendered."""
    session.space.shading.type = "SOLID"
    yield from session.main_loop()
    session.space.shading.type = "RENDERED"
    yield from session.until_idle()
    _compare(session, f"{name}, read anew", session.pixels(f"{name}, read anew"), picture)


def assert_unchanged(session: Session, name: str, action: Action, before: np.ndarray) -> Steps:
    """After the action, the picture equals `before`."""
    picture = yield from _picture_after(session, name, action)
    _compare(session, name, picture, before)


def _picture_after(session: Session, name: str, action: Action) -> Picture:
    with session.in_viewport():
        action()
    yield from session.until_idle()
    return session.pixels(name)


def _compare(session: Session, name: str, one: np.ndarray, other: np.ndarray) -> None:
    session.record(f"{name}, RMSE", 255 * rmse(one, other), "/255", must=255 * MAX_RMSE)
