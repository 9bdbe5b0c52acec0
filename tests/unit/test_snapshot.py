# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots: saved and loaded bit for bit, and a clear error for files that are none or are damaged."""

import json
import math
import random
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon import snapshot
from ism_addon.scene import Image, Instances, LightImage, LightProfile, Lights, Mesh, NodeGraph, Scene, View, World
from ism_addon.settings import SSAO, DebugView, Method, Quality, Settings, Shadow
from ism_addon.shading.node_graph import Instruction
from tests.scenes.parts.tables import materials_of


def directions(generator, *shape):
    """Random vectors of unit length."""
    vectors = generator.normal(size=(*shape, 3))
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def a_mesh(generator, uvs=True):
    return Mesh(
        positions=generator.normal(size=(5, 3)).astype(np.float32),
        triangles=np.array([[0, 1, 2], [2, 3, 4]], np.uint32),
        normals=directions(generator, *((2, 3) if uvs else (5,))).astype(np.float32),
        uvs=generator.normal(size=(2 if uvs else 0, 3, 2)).astype(np.float32),
        materials=np.array([1, 0], np.uint32),
    )


def a_scene():
    generator = np.random.default_rng(7)
    return Scene(
        meshes=(a_mesh(generator), a_mesh(generator, uvs=False)),
        instances=Instances(
            mesh=np.array([1, 0, 1], np.int32),
            world_from_object=np.insert(generator.normal(size=(3, 3, 4)), 3, [0, 0, 0, 1], axis=1),
            visible=np.array([True, False, True]),
            casts_shadow=np.array([False, True, True]),
            groups=np.array([0, 5, 1], np.uint32),
            visible_diffuse=np.array([True, False, True]),
            receivers=np.array([-1, 3, 0], np.int32),
            blockers=np.array([31, -1, 2], np.int32),
        ),
        materials=materials_of(generator.random((2, 3)), [-1, 0], generator.random((2, 3))),
        images=(Image(generator.integers(0, 256, (3, 2, 4)).astype(np.uint8), repeat=False),),
        lights=Lights(
            shape=np.array([0, 1], np.int32),
            **{name: generator.normal(size=(2, 3)) for name in ("position", "axis_u", "axis_v")},
            normal=directions(generator, 2),
            emission=generator.random((2, 3), np.float32),
            spread=generator.random(2, np.float32),
            blend=np.array([0.0, 0.5], np.float32),
            radius=np.array([0.0, 2.0]),
            soft_falloff=np.array([True, False]),
            shadow_softness=np.array([0.5, 1.0], np.float32),
            falloff_power=np.array([0, 2], np.int32),
            falloff_smooth=np.array([0.5, 0.0], np.float32),
            profile=np.array([-1, 0], np.int32),
            profile_axes=generator.normal(size=(2, 3, 3)),
            image=np.array([0, -1], np.int32),
            visible_camera=np.array([True, False]),
            casts_shadow=np.array([True, False]),
            receivers=np.array([-1, 2], np.int32),
            blockers=np.array([0, -1], np.int32),
        ),
        world=World.even(np.array([0.1, 0.2, 0.3], np.float32)),
        light_profiles=(LightProfile(generator.random((145, 361), np.float32)),),
        light_images=(LightImage(generator.random((2, 3, 3), np.float32), repeat=False),),
        warnings=("Größe: ‘×’.",),
    )


VIEW = View(np.diag([0.1, 0.2, -0.3, 1.0]), np.eye(4)[[1, 0, 2, 3]], 640, 480, 1.25, True)
SHADOW = Shadow(method=Method.SHADOW_MAPS, bias=0.1 + 0.2)
SETTINGS = Settings(SHADOW, SSAO(enabled=False), Quality(samples=3), debug_view=DebugView.NORMAL)


def assert_same(a, b):
    """Equal in every field, arrays bit for bit."""
    assert type(a) is type(b)
    if is_dataclass(a):
        for member in fields(a):
            assert_same(getattr(a, member.name), getattr(b, member.name))
    elif isinstance(a, tuple):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            assert_same(one, other)
    elif isinstance(a, np.ndarray):
        assert (a.dtype, a.shape, a.tobytes()) == (b.dtype, b.shape, b.tobytes())
        assert not b.flags.writeable
    else:
        assert a == b


@pytest.fixture
def path(tmp_path):
    """A snapshot's file."""
    path = tmp_path / "scene.npz"
    snapshot.save(path, a_scene(), VIEW, SETTINGS)
    return path


def test_everything_is_loaded_bit_for_bit(path):
    assert_same(snapshot.load(path), (a_scene(), VIEW, SETTINGS))


def test_an_empty_scene_is_saved_and_loaded(tmp_path):
    scene = a_scene()
    nothing = Scene(
        meshes=(),
        instances=Instances(*(getattr(scene.instances, member.name)[:0] for member in fields(Instances))),
        materials=materials_of(np.zeros((0, 3))),
        images=(),
        lights=Lights(*(getattr(scene.lights, member.name)[:0] for member in fields(Lights))),
        world=scene.world,
    )
    snapshot.save(tmp_path / "nothing", nothing, VIEW, SETTINGS)
    assert_same(snapshot.load(tmp_path / "nothing"), (nothing, VIEW, SETTINGS))


def test_a_mesh_without_triangles_is_refused(tmp_path):
    empty = Mesh(*(getattr(a_scene().meshes[0], member.name)[:0] for member in fields(Mesh)))
    snapshot.save(tmp_path / "empty.npz", replace(a_scene(), meshes=(empty, empty)), VIEW, SETTINGS)
    with pytest.raises(snapshot.SnapshotError, match="scene/meshes/0 has no triangles"):
        snapshot.load(tmp_path / "empty.npz")


def test_graphs_that_read_more_attributes_of_instances_than_there_are_are_refused(tmp_path):
    graph, path = NodeGraph((Instruction("instance_attribute", (), 1),), ()), tmp_path / "attributes.npz"
    for count in (2, 1):
        attributes = np.zeros((a_scene().instances.row_count, count, 4), np.float32)
        instances = replace(a_scene().instances, attributes=attributes)
        snapshot.save(path, replace(a_scene(), instances=instances, graphs=(graph,)), VIEW, SETTINGS)
        if count == 2:
            snapshot.load(path)
    with pytest.raises(snapshot.SnapshotError, match="read attributes of instances that it has not"):
        snapshot.load(path)


@settings(deadline=None, derandomize=True)  # the machine may be busy
@given(st.floats(0.0, 16.0), st.integers(1, 65536))
def test_numbers_of_settings_come_back_exactly(tmp_path_factory, bias, samples):
    settings = Settings(Shadow(bias=bias), quality=Quality(samples=samples))
    path = tmp_path_factory.getbasetemp() / "numbers.npz"
    snapshot.save(path, a_scene(), VIEW, settings)
    assert snapshot.load(path)[2] == settings


def test_the_largest_angle_that_blender_stores_is_loaded(tmp_path):
    settings = Settings(ssao=SSAO(cone_angle=float(np.float32(math.pi))))
    assert settings.ssao.cone_angle > math.pi
    snapshot.save(tmp_path / "wide.npz", a_scene(), VIEW, settings)
    assert snapshot.load(tmp_path / "wide.npz")[2] == settings


def rewritten(path, arrays=None, values=None):
    """The file with some arrays and JSON values replaced; `values` has slash-separated names. None deletes an entry."""
    with np.load(path) as file:
        members = {name: file[name] for name in file.files}
    tree = json.loads(members["snapshot"].tobytes())
    for name, value in (values or {}).items():
        *parents, last = name.split("/")
        branch = tree
        for parent in parents:
            branch = branch[int(parent) if isinstance(branch, list) else parent]
        branch[last] = value
        if value is None:
            del branch[last]
    members["snapshot"] = np.frombuffer(json.dumps(tree).encode(), np.uint8)
    members.update(arrays or {})
    with open(path, "wb") as file:
        np.savez(file, **{name: array for name, array in members.items() if array is not None})
    return path


@pytest.mark.parametrize(
    ("name", "array", "sentence"),
    [
        ("view/clip_from_view", None, "has no view/clip_from_view"),
        ("scene/meshes/0/positions", np.zeros((5, 3)), "is float64 5 3 where float32 V 3 belongs"),
        ("scene/meshes/0/positions", np.zeros((5, 2), np.float32), "is float32 5 2 where"),
        ("scene/meshes/0/positions", np.full((5, 3), np.nan, np.float32), "not finite"),
        ("scene/meshes/0/materials", np.zeros(3, np.uint32), "is uint32 3 where uint32 T belongs"),
        ("scene/meshes/0/uvs", np.zeros((1, 3, 2), np.float32), "another length than its triangles"),
        ("scene/meshes/0/triangles", np.full((2, 3), 5, np.uint32), "leads outside 0 to 4"),
        ("scene/meshes/0/materials", np.full(2, 2, np.uint32), "leads outside 0 to 1"),
        ("scene/instances/mesh", np.array([0, 1, 2], np.int32), "leads outside 0 to 1"),
        ("scene/instances/mesh", np.array([0, 1, -1], np.int32), "leads outside 0 to 1"),
        ("scene/instances/attributes", np.zeros((2, 1, 4), np.float32), "another length than its instances"),
        ("scene/materials/image", np.array([-2, 0], np.int32), "leads outside -1 to 0"),
        ("scene/lights/shape", np.array([0, 5], np.int32), "leads outside 0 to 4"),
        ("scene/world/graph", np.array([7, -1], np.int32), "world/graph leads outside"),
        ("scene/images/0/texels", np.zeros((0, 2, 4), np.uint8), "has no texels"),
        ("scene/world/radiance", np.array([0, 0, np.inf], np.float32), "not finite"),
        ("scene/meshes/0/positions", np.full((5, 3), -2e9, np.float32), "holds numbers beyond 1e[+]09"),
        ("scene/lights/emission", np.full((2, 3), 2e15, np.float32), "holds numbers beyond 1e[+]15"),
        ("scene/lights/radius", np.array([0.0, -0.1]), "holds negative numbers"),
        ("scene/meshes/1/normals", np.zeros((5, 3), np.float32), "not of unit length"),
        ("scene/lights/normal", np.full((2, 3), 1.0), "not of unit length"),
        ("scene/instances/world_from_object", np.ones((3, 4, 4)), "does not place it"),
        ("scene/instances/world_from_object", np.stack([np.diag([1.0, 0.0, 1.0, 1.0])] * 3), "flattens a mesh"),
        ("scene/lights/axis_u", np.zeros((2, 3)), "have one without a size"),
        ("view/view_from_world", 2.0 * np.eye(4), "not rigid"),
        ("view/view_from_world", np.eye(4)[[3, 1, 2, 0]], "not rigid"),
        ("view/clip_from_view", np.eye(4), "neither a perspective nor an orthographic view"),
        ("view/clip_from_view", np.diag([0.0, 1.0, -1.0, 1.0]), "neither a perspective nor an orthographic"),
        ("view/clip_from_view", np.diag([1.0, 1.0, -1.0, 2.0]), "neither a perspective nor an orthographic"),
        ("scene/world/radiance", np.array([None] * 3, object), "is not a snapshot"),
    ],
)
def test_an_invalid_array_is_refused(path, name, array, sentence):
    with pytest.raises(snapshot.SnapshotError, match=sentence):
        snapshot.load(rewritten(path, arrays={name: array}))


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("version", 1, "of version 1; this one reads version 3"),
        ("version", None, "is not a snapshot"),
        ("scene", None, "has no scene"),
        ("scene/world", [], "has no scene/world"),
        ("scene/meshes", {}, "scene/meshes is not a list"),
        ("scene/meshes", [None] * 3, "has no scene/meshes/0"),
        ("scene/images/0/repeat", 1, "repeat is 1, which is no bool"),
        ("view/width", None, "has no view/width"),
        ("view/width", 0, "a picture of 0×480 pixels cannot be drawn"),
        ("view/width", 1.5, "which is no int"),
        ("view/filter_width", float("nan"), "which is no float"),
        ("settings/shadow/method", "SOFT", "method is 'SOFT', none of RAY_TRACED, SHADOW_MAPS"),
        ("settings/shadow/method", "shadow_maps", "method is 'shadow_maps', none of"),
        ("settings/shadow/method", ["SHADOW_MAPS"], "none of RAY_TRACED, SHADOW_MAPS"),
        ("settings/shadow/method", 1, "method is 1, none of"),
        ("settings/shadow/enabled", 1, "enabled is 1, which is no bool"),
        ("settings/quality/bounces", 3, "has bounces, unknown to this version"),
        ("scene/working_space", "Munsell", "scene cannot be used: colours in Munsell are not known"),
    ],
)
def test_an_invalid_value_is_refused(path, name, value, sentence):
    with pytest.raises(snapshot.SnapshotError, match=sentence):
        snapshot.load(rewritten(path, values={name: value}))


@pytest.mark.parametrize("name", ["bias", "method"])
def test_a_setting_that_an_older_file_lacks_has_its_default(path, name):
    settings = snapshot.load(rewritten(path, values={f"settings/shadow/{name}": None}))[2]
    default = getattr(Shadow(), name)
    assert settings == replace(SETTINGS, shadow=replace(SETTINGS.shadow, **{name: default}))
    assert type(getattr(settings.shadow, name)) is type(default)


@pytest.mark.parametrize("method", Method)
def test_an_enum_is_saved_by_its_name(path, method):
    snapshot.save(path, a_scene(), VIEW, Settings(Shadow(method=method)))
    with np.load(path) as file:
        assert json.loads(file["snapshot"].tobytes())["settings"]["shadow"]["method"] == method.value
    assert snapshot.load(path)[2].shadow.method is method


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"no archive", b"\x93NUMPY\x01\x00"])
def test_another_file_is_refused(tmp_path, content):
    (tmp_path / "other.npz").write_bytes(content)
    with pytest.raises(snapshot.SnapshotError, match=r"other\.npz is not a snapshot"):
        snapshot.load(tmp_path / "other.npz")


def test_a_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        snapshot.load(tmp_path / "none.npz")


def test_an_archive_that_unpacks_to_more_than_itself_is_refused(path):
    np.savez_compressed(path, snapshot=np.zeros(10_000_000, np.uint8))
    with pytest.raises(snapshot.SnapshotError, match="its arrays are larger than the file"):
        snapshot.load(path)


def test_a_damaged_file_is_refused_or_loaded(path):
    """400 files with a few bytes changed or cut off: no other error than SnapshotError is raised."""
    original, generator = path.read_bytes(), random.Random(1)
    refused = 0
    for _ in range(400):
        damaged = bytearray(original)
        for _ in range(generator.randint(1, 8)):
            damaged[generator.randrange(len(damaged))] = generator.randrange(256)
        path.write_bytes(damaged[: generator.choice([len(damaged), generator.randrange(len(damaged))])])
        try:
            snapshot.load(path)
        except snapshot.SnapshotError:
            refused += 1
    assert refused > 300
