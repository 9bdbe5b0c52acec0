# SPDX-License-Identifier: GPL-3.0-or-later
"""A field of the scene declares its array once: reading, checking, saving and loading all follow from that."""

from dataclasses import dataclass, fields

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.scene import Image, Instances, Lights, Materials, Mesh, Scene, View, World
from ism_addon.scene.arrays import array, array_specs, index
from tests.unit.test_snapshot import SETTINGS, VIEW, a_scene, assert_same, rewritten


@pytest.mark.parametrize("record", [Mesh, Instances, Materials, Image, Lights, World, View])
def test_every_array_has_a_declaration(record):
    arrays = {member.name for member in fields(record) if member.type is np.ndarray}
    assert set(array_specs(record)) == arrays


@dataclass(frozen=True, eq=False)
class Beams(Lights):
    """Lights with two more fields."""

    width: np.ndarray = array("float32 L 2", "m", max_abs=5.0)
    cover: np.ndarray = index("int32 L", into="images", first=-1)


@dataclass(frozen=True, eq=False)
class BeamScene(Scene):
    """A scene with such lights."""

    lights: Beams


@pytest.mark.parametrize(
    ("arrays", "sentence"),
    [
        ({}, None),
        ({"width": None}, "has no scene/lights/width"),
        ({"width": np.ones((2, 2))}, "lights/width is float64 2 2 where float32 L 2 belongs"),
        ({"width": np.ones((3, 2), np.float32)}, "lights/width is float32 3 2 where float32 L 2 belongs"),
        ({"width": np.full((2, 2), 6.0, np.float32)}, "lights/width holds numbers beyond 5"),
        ({"cover": np.array([0, 1], np.int32)}, "lights/cover leads outside -1 to 0"),
    ],
)
def test_a_new_field_is_one_line(tmp_path, monkeypatch, arrays, sentence):
    """Its array is made from a list, saved, checked and loaded by the field's declaration alone."""
    monkeypatch.setattr(snapshot, "Scene", BeamScene)
    scene, path = a_scene(), tmp_path / "stage.npz"
    columns = {member.name: getattr(scene.lights, member.name).tolist() for member in fields(Lights)}
    beams = Beams.of(**columns, width=[(1, 2), (3, 4)], cover=[-1, 0])
    members = {member.name: getattr(scene, member.name) for member in fields(Scene)} | {"lights": beams}
    snapshot.save(path, BeamScene(**members), VIEW, SETTINGS)
    rewritten(path, arrays={f"scene/lights/{name}": array for name, array in arrays.items()})
    if sentence is None:
        assert_same(snapshot.load(path), (BeamScene(**members), VIEW, SETTINGS))
    else:
        with pytest.raises(snapshot.SnapshotError, match=sentence):
            snapshot.load(path)


def test_rows_are_converted_to_a_record():
    scene = a_scene()
    rows = [
        {member.name: getattr(scene.lights, member.name)[k].tolist() for member in fields(Lights)} for k in range(2)
    ]
    assert_same(Lights.of_rows(rows), scene.lights)
    nothing = Lights.of_rows([])
    assert_same(nothing, Lights(*(getattr(scene.lights, member.name)[:0] for member in fields(Lights))))
