# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots of version 0.1.0."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon import old_names, snapshot
from ism_addon.settings import DebugView

from .test_snapshot import SETTINGS, VIEW, a_scene, assert_same, rewritten
from .test_snapshot import path as path

#: Fields that version 0.1.0 did not have, with the values that its lights, instances and materials get.
NEW_FIELDS = {
    "lights": {
        "blend": np.zeros(2, np.float32),
        "radius": np.zeros(2),
        "soft_falloff": np.zeros(2, bool),
        "shadow_softness": np.ones(2, np.float32),
        "falloff_power": np.zeros(2, np.int32),
        "falloff_smooth": np.zeros(2, np.float32),
        "profile": np.full(2, -1, np.int32),
        "profile_axes": np.zeros((2, 3, 3)),
        "image": np.full(2, -1, np.int32),
        "visible_camera": np.zeros(2, bool),
    },
    "instances": {
        "visible_diffuse": np.ones(3, bool),
        "receivers": np.full(3, -1, np.int32),
        "blockers": np.full(3, -1, np.int32),
    },
    "materials": {"emission": np.zeros((2, 3), np.float32)},
    "world": {
        "background": a_scene().world.radiance,
        "graph": np.full(2, -1, np.int32),
        "first_constant": np.zeros(2, np.int32),
        "constants": np.zeros((0, 4), np.float32),
    },
}


def test_a_snapshot_of_version_0_1_0_keeps_its_settings_and_lights(path):
    missing = {f"scene/{record}/{name}": None for record, values in NEW_FIELDS.items() for name in values}
    missing["scene/lights/emission"] = None
    old = {"version": snapshot.PREVIOUS_VERSION, "settings/shadow/method": "CLASSIC"} | missing
    for section, names in old_names.SETTINGS.items():
        values = getattr(SETTINGS, section) if section else SETTINGS
        for name, new in names.items():
            below = "/".join(filter(None, ("settings", section)))
            old |= {f"{below}/{name}": getattr(values, new), f"{below}/{new}": None}
    scene = a_scene()
    arrays = missing | {"scene/lights/radiance": scene.lights.emission}
    scene = replace(
        scene, **{record: replace(getattr(scene, record), **values) for record, values in NEW_FIELDS.items()}
    )
    assert_same(snapshot.load(rewritten(path, arrays, old)), (scene, VIEW, SETTINGS))
    for name, current in old_names.DEBUG_VIEWS.items():
        loaded = snapshot.load(rewritten(path, values=old | {"settings/show": name}))
        assert_same(loaded, (scene, VIEW, replace(SETTINGS, debug_view=DebugView(current))))


@pytest.mark.parametrize("settings", [None, [], 1, {"quality": 3, "shadow": []}, {"shadow": {"method": {}}}])
def test_a_snapshot_of_version_0_1_0_without_its_settings_is_refused(path, settings):
    with pytest.raises(snapshot.SnapshotError):
        snapshot.load(rewritten(path, values={"version": snapshot.PREVIOUS_VERSION, "settings": settings}))
