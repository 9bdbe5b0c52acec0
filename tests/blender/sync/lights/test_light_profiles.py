# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with IES Texture nodes, compared with Cycles."""

import bpy
import numpy as np
import pytest

from tests.blender.sync.lights.test_light_nodes import draw, node_tree
from tests.scenes.cycles import direct_light

#: Angles of the downlight below. Before 5.0, Cycles has a seam beside azimuth 0, as wide as the step.
BEAM = {"polar": np.arange(0.0, 181.0, 5.0), "azimuths": np.arange(0.0, 361.0, 2.5)}


def beam(polar: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Candela at these angles, degrees: of a downlight that is wider along one axis, and brighter on one side."""
    width = 25.0 + 12.0 * np.cos(np.radians(2.0 * azimuth))
    side = np.sin(np.radians(polar)) * np.sin(np.radians(azimuth))
    return 1000.0 * np.exp(-((polar / width) ** 2)) * (1.0 + 0.4 * side) + 3.0


def file_of(polar: np.ndarray, azimuths: np.ndarray, candela: np.ndarray, kind: int = 1, tilt: str = "NONE") -> str:
    """An IES file: candela (H,V)."""
    header = f"IESNA:LM-63-2002\n[TEST] a lamp\nTILT={tilt}\n"
    header += f"1 1000 1.5 {len(polar)} {len(azimuths)} {kind} 2 0.1 0.1 0\n0.8 1 60\n"
    return header + "\n".join(" ".join(f"{x:.5g}" for x in row) for row in (polar, azimuths, *candela))


def beam_file(polar=BEAM["polar"], azimuths=BEAM["azimuths"], **format_) -> str:
    return file_of(polar, azimuths, beam(polar, azimuths[:, None]), **format_)


@pytest.fixture
def ies_texture(light_object):
    """A point light's IES Texture node, without a file."""
    light_object.data = bpy.data.lights.new("lamp", "POINT")
    light_object.data.energy, light_object.data.shadow_soft_size = 5.0, 0.0
    bpy.context.scene.cycles.light_sampling_threshold = 0.0  # else samples of dark pixels are noisy
    tree = node_tree(light_object.data)
    node = tree.nodes.new("ShaderNodeTexIES")
    tree.links.new(node.outputs["Fac"], tree.nodes["Emission"].inputs["Strength"])
    return node


def set_text(node: bpy.types.ShaderNodeTexIES, text: str) -> None:
    node.ies = bpy.data.texts.new("lamp.ies")
    node.ies.from_string(text)


def assert_like_cycles(device, bound: float, samples: int = 1, samples_of_cycles: int = 16) -> None:
    """The mean difference is below this fraction of the mean."""
    ours, theirs = draw(device, samples), direct_light(samples_of_cycles)[..., :3]
    assert theirs.mean() > 0.001
    assert np.abs(ours - theirs).mean() < bound * theirs.mean()


PLACES = {
    "above": {},
    "tilted": {"rotation_euler": (0.5, 0.3, 0.8)},
    "sideways": {"rotation_euler": (1.3, 0.0, 0.4), "location": (-3.0, 1.0, 1.0)},
    "scaled": {"rotation_euler": (0.2, 0.1, 0.3), "scale": (1.0, 2.0, 0.7)},
    "mirrored": {"rotation_euler": (0.5, 0.3, 0.8), "scale": (-1.0, 1.0, 1.0)},
}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("kind", ["POINT", "SPOT", "AREA", "SUN"])
def test_lights_shine_as_in_cycles(device, ies_texture, light_object, read_scene, kind, place):
    set_text(ies_texture, beam_file())
    light_object.data.type = kind
    light_object.data.energy = 0.05 if kind == "SUN" else 5.0
    if kind == "SPOT":
        light_object.data.spot_size, light_object.data.spot_blend = 2.5, 0.3
    for name, value in PLACES[place].items():
        setattr(light_object, name, value)
    scene = read_scene()
    assert not [each for each in scene.warnings if "IES" in each]
    assert len(scene.light_profiles) == (kind != "SUN")
    if kind == "AREA":  # its profile is the mean of a few points, until rays correct it
        light_object.data.size = 0.5
        assert_like_cycles(device, 0.04 if place in ("scaled", "sideways") else 0.02, 64, 256)
    else:
        assert_like_cycles(device, 0.01 if place == "sideways" else 0.005)


@pytest.mark.parametrize(("radius", "soft", "bound"), [(0.2, True, 0.01), (0.6, True, 0.025), (0.6, False, 0.025)])
def test_a_light_with_a_radius(device, ies_texture, light_object, radius, soft, bound):
    """Its profile is the mean of a few points, until rays correct it."""
    set_text(ies_texture, beam_file())
    light_object.data.shadow_soft_size, light_object.data.use_soft_falloff = radius, soft
    assert_like_cycles(device, bound, 128, 512)


def half(azimuths: np.ndarray) -> np.ndarray:
    """Candela (H,V) at the first half's azimuths."""
    return 1000.0 * np.exp(-((BEAM["polar"] / (20.0 + 0.2 * azimuths[:, None])) ** 2))


def part(end: float) -> str:
    """A file of azimuths up to this one."""
    azimuths = np.arange(0.0, end + 1.0, 2.5)
    return file_of(BEAM["polar"], azimuths, half(azimuths))


FILES = {
    "one azimuth": beam_file(azimuths=np.zeros(1)),
    "a quadrant": part(90.0),
    "a half": part(180.0),
    "a half from the side": file_of(BEAM["polar"], np.arange(90.0, 271.0, 2.5), half(np.arange(0.0, 181.0, 2.5))),
    "without the last azimuth": beam_file(azimuths=np.arange(0.0, 359.0, 2.5)),
    "downwards only": beam_file(polar=np.arange(0.0, 91.0, 2.5)),
    "upwards only": beam_file(polar=np.arange(90.0, 181.0, 2.5)),
    "uneven angles": beam_file(polar=np.array([0.0, 1.0, 3.0, 8.0, 20.0, 45.0, 90.0, 180.0])),
    "with tilt": beam_file(tilt="INCLUDE\n1\n3\n0 45 90\n1 0.9 0.8"),
    "commas": beam_file().replace(" 22.5 ", ",22.5,"),
    "type B": file_of(
        np.arange(-90.0, 91.0, 15.0),
        np.arange(-90.0, 91.0, 15.0),
        np.add.outer(np.arange(13.0), 300.0 * np.arange(13.0)),
        kind=2,
    ),
    "a half of type B": file_of(
        np.arange(0.0, 91.0, 15.0),
        np.arange(0.0, 91.0, 15.0),
        np.add.outer(900.0 - 100.0 * np.arange(7.0), 50.0 * np.arange(7.0)),
        kind=2,
    ),
}


#: What Cycles read otherwise before 5.0.
FILES_SINCE_5 = {"one azimuth", "type B", "a half of type B"}


@pytest.mark.parametrize("name", [name for name in FILES if bpy.app.version >= (5, 0) or name not in FILES_SINCE_5])
def test_files_are_read_as_in_cycles(device, ies_texture, light_object, read_scene, name):
    set_text(ies_texture, FILES[name])
    light_object.rotation_euler = (2.5, 0.3, 0.8) if name == "upwards only" else (0.3, 0.2, 0.5)
    if "type B" in name:
        light_object.rotation_euler = (1.3, 0.2, 0.5)
    assert read_scene().warnings == ()
    # Profiles have a value for each half degree: this much of the light is where files have none.
    assert_like_cycles(device, 0.01 if "only" in name or "type B" in name else 0.005)


def test_strength_and_falloff_multiply_it(device, ies_texture, light_object, read_scene):
    set_text(ies_texture, beam_file())
    tree = light_object.data.node_tree
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    ies_texture.inputs["Strength"].default_value = 0.5
    tree.links.new(ies_texture.outputs["Fac"], falloff.inputs["Strength"])
    tree.links.new(falloff.outputs["Linear"], tree.nodes["Emission"].inputs["Strength"])
    assert read_scene().warnings == ()
    assert_like_cycles(device, 0.002)


def test_a_file_on_disk(device, ies_texture, light_object, read_scene, tmp_path):
    ies_texture.mode, ies_texture.filepath = "EXTERNAL", str(tmp_path / "lamp.ies")
    assert "cannot be read" in read_scene().warnings[0]
    (tmp_path / "lamp.ies").write_text(beam_file())
    assert read_scene().warnings == ()
    assert_like_cycles(device, 0.002)


def test_lights_share_a_profile(ies_texture, light_object, add, read_scene):
    set_text(ies_texture, beam_file())
    add("Other", light_object.data)
    plain = add("Plain", bpy.data.lights.new("plain", "POINT"))
    plain.data.energy = 10.0
    one, other = read_scene(), read_scene()
    assert sorted(one.lights.profile.tolist()) == [-1, 0, 0]
    assert one.light_profiles[0] is other.light_profiles[0]


BROKEN = {
    "nothing": "",
    "no tilt": "IESNA:LM-63-2002\n1 2 3",
    "the end": beam_file()[:1000],
    "a word": beam_file().replace("67.5", "x", 1),
    "type A": beam_file(kind=3),
    "no angles": file_of(np.zeros(0), np.zeros(0), np.zeros((0, 0))),
    "not a number": beam_file().replace("1003", "nan"),
    "beyond measure": beam_file().replace("1003", "1e308"),
    "falling angles": beam_file(polar=np.array([0.0, 90.0, 45.0, 180.0])),
    "huge counts": beam_file().replace(" 37 145 ", " 1e300 1e300 "),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_cannot_be_read_is_said(ies_texture, read_scene, name):
    set_text(ies_texture, BROKEN[name])
    scene = read_scene()
    sentence = "Lights whose IES file cannot be read shine evenly, a hundred times as strong: 'Lamp'."
    assert scene.warnings == (sentence,)
    assert scene.light_profiles == ()


def test_a_file_that_cannot_be_read_is_as_bright_as_in_cycles(device, ies_texture):
    set_text(ies_texture, "no file")
    assert_like_cycles(device, 0.002)


def test_a_vector_is_said(ies_texture, read_scene):
    set_text(ies_texture, beam_file())
    tree = ies_texture.id_data
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Normal"], ies_texture.inputs["Vector"])
    assert read_scene().warnings == ("Lights whose IES Texture has a vector shine as if it had none: 'Lamp'.",)
