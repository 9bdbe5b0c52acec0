# SPDX-License-Identifier: GPL-3.0-or-later
"""The GLSL functions of every light type agree: samples, their pdf, emitted radiance, and irradiance."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ism_addon.color import REC709, luminance
from ism_addon.gpu import lights
from ism_addon.gpu.culling.portal_geometry import Rectangle
from ism_addon.gpu.culling.portals import Portals
from ism_addon.gpu.emission.emitters import EmissiveMeshes
from ism_addon.gpu.environment.equirectangular import texel_directions
from ism_addon.gpu.environment.map_sun import MapSun
from ism_addon.gpu.environment.map_tables import MapTables
from ism_addon.gpu.gl import frame_uniforms
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.gl.render_targets import pixels
from ism_addon.gpu.gl.shader_compiler import FOLDER, bind, expand, head
from ism_addon.gpu.gl.shader_records import LIGHT_RECORDS
from ism_addon.gpu.lights.emissive_mesh import has_light_bvh
from ism_addon.gpu.lights.world.table import ENVIRONMENT, WORLD, MapLight, with_world
from ism_addon.gpu.passes.environment.bake_world import map_uniforms, rotation_uniform
from ism_addon.gpu.passes.light_selection.scene_portals import ScenePortals
from ism_addon.gpu.passes.upload.upload_lights import light_buffers
from ism_addon.scene import Lights, LightShape, World
from ism_addon.shading.vectors import euler_matrix
from tests.scenes.small import sphere, subdivided_box
from tests.support.emission import textured
from tests.support.small_scenes import light, make_scene, quad

from .bulb import BULB, Bulb

SIDE = 256
MAIN = """
uniform vec3 point, normal;
layout(location = 0) out vec4 of_sample;    // radiance, cosine, pdf; irradiance of the whole light
layout(location = 1) out vec4 of_direction; // pdf, emitted of that sample's direction; of a direction of the hemisphere
layout(location = 2) out vec2 hemisphere;   // pdf of this direction, cosine

void main() {
    vec2 uv = gl_FragCoord.xy / float(SIDE);
    Light light = fetch_Light(scene_records, lights);
    LightSample s = light_sample(light, point, normal, uv);
    of_sample = vec4(s.radiance, dot(normal, s.wi), s.pdf, light_irradiance(light, point, normal));
    of_direction = vec4(light_pdf(light, point, normal, s.wi), light_emitted(light, point, s.wi), 0.0, 0.0);
    vec3 x = normalize(cross(normal, abs(normal.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
    float cosine = uv.x, angle = 6.283185307179586 * uv.y, sine = sqrt(1.0 - cosine * cosine);
    vec3 wi = cosine * normal + sine * (cos(angle) * x + sin(angle) * cross(normal, x));
    of_direction.zw = vec2(light_pdf(light, point, normal, wi), light_emitted(light, point, wi));
    hemisphere = vec2(0.15915494309189535, cosine);
}
"""

#: Lights above the origin, by the name of their type: large, so that a grid of directions resolves their outlines.
EXAMPLES: dict[str, list[Lights]] = {
    "area": [
        light(shape, (0.3, -0.2, 1.0), (2.5, 0.4, 0.2), (0.3, -1.7, 0.1), spread=spread)
        for shape in (LightShape.RECTANGLE, LightShape.ELLIPSE)
        for spread in (np.pi, np.radians(100.0))
    ],
    "point": [
        light(LightShape.POINT, position, radius=radius, soft_falloff=soft)
        for position, radius in (((0.3, -0.2, 1.0), 0.6), ((0.3, -0.2, 1.0), 0.95), ((0.1, 0.0, 0.1), 0.3))
        for soft in (False, True)
    ]
    + [light(LightShape.POINT, (0.3, -0.2, 1.0))],
    "spot": [
        light(
            LightShape.SPOT,
            (0.3, -0.2, 1.0),
            (1.0, 0.0, 0.0),
            (0.0, -0.9805807 * height, 0.1961161 * height),
            radius=radius,
            soft_falloff=soft,
            spread=1.3,
            blend=blend,
        )
        for radius, soft, blend, height in (
            *((0.6, False, 0.5, 1.0), (0.6, True, 0.5, 1.0), (0.6, False, 0.02, 1.0), (0.6, False, 1.0, 0.8)),
            (0.0, False, 0.5, 0.6),
        )
    ],
    "sun": [
        light(LightShape.SUN, axis_u=(1.0, 0.0, 0.0), axis_v=axis_v, spread=spread)
        for axis_v in ((0.0, -1.0, 0.0), (0.0, -0.8, 0.6))
        for spread in (0.0, 1.2448, 2.2, np.pi)
    ],
    "emissive_mesh": [
        EmissiveMeshes().lights_of(make_scene([mesh], emission=(1.0, 1.0, 1.0)))
        for mesh in (
            quad((-0.9, -1.0, 1.1), (2.5, 0.4, 0.2), (0.3, 1.7, 0.1)),
            subdivided_box((-0.4, -0.9, 0.6), (0.9, 0.3, 1.4), 1),
            sphere((0.3, -0.2, 1.1), 0.6, 12, 6),
        )
    ]
    + [
        textured(mesh, np.random.default_rng(0).random((len(mesh.triangles), 3)) ** 2)
        for mesh in (subdivided_box((-0.4, -0.9, 0.6), (0.9, 0.3, 1.4), 1), sphere((0.3, -0.2, 1.1), 0.6, 12, 6))
    ],
    "world": [with_world(light().select(slice(0)), World.even(np.ones(3)))],
    "bulb": [light(BULB, (0.3, -0.2, 1.0))],
}
EXAMPLES["world through portals"] = EXAMPLES["world"]
#: A map that is bright in some directions, and a sun in it.
MAP = np.random.default_rng(0).random((32, 64, 3)).astype(np.float32) ** 6 + np.float32(0.02)
SUN_TEXELS = (slice(20, 24), slice(21, 26))  # around (1, 1, 1)


def a_map_sun(texels: tuple[slice, slice] = SUN_TEXELS) -> MapSun:
    """A sun of many directions, of which each texel has another radiance."""
    directions, solid_angles = (each.reshape(*MAP.shape[:2], -1)[texels] for each in texel_directions(*MAP.shape[:2]))
    radiance = np.random.default_rng(1).random(solid_angles.shape)
    vector = (radiance * solid_angles * directions).sum((0, 1))
    irradiance, of_texels = np.linalg.norm(vector), (radiance * solid_angles)[..., 0]
    first = texels[0].start, texels[1].start
    probability = (of_texels / of_texels.sum()).astype(np.float32)
    tables = (radiance[..., 0] / irradiance).astype(np.float32), probability
    return MapSun(vector / irradiance, np.ones(3), 0.5, first, *tables)


#: From directions of the world to those of the map.
ROTATION = euler_matrix(np.array([0.2, -0.1, 0.5]))
TURNED_SUN = replace(a_map_sun(), direction=a_map_sun().direction @ ROTATION)
WORLD_OF_MAP = with_world(
    light().select(slice(0)), World.even(np.ones(3)), MapLight(1.0, TURNED_SUN, np.ones((2, 2)), np.eye(3))
)
EXAMPLES["environment through portals"] = [WORLD_OF_MAP.select(slice(1, 2))]
EXAMPLES["map_sun"], EXAMPLES["environment"] = [WORLD_OF_MAP.select(slice(0, 1))], [WORLD_OF_MAP.select(slice(1, 2))]
#: Windows above and beside the origin, and one behind it.
PORTALS = Portals(
    (
        Rectangle(
            np.array([0.3, -0.2, 1.0]), np.array([[1.5, 0.4, 0.0], [0.32, -1.2, 0.0]]), np.array([0.0, 0.0, -1.0])
        ),
        Rectangle(np.array([1.0, 0.5, 0.6]), np.array([[0.0, 1.5, 0.0], [0.0, 0.0, 1.5]]), np.array([-1.0, 0.0, 0.0])),
        Rectangle(np.array([0.0, -1.0, 0.6]), np.array([[1.5, 0.0, 0.0], [0.0, 0.0, 1.5]]), np.array([0.0, -1.0, 0.0])),
    ),
    crossed=0.2,
    arriving=0.5,
    missed=0.1,
)
ORIGIN = np.zeros(3)
#: Normals of the receiver at the origin. All lights are above the horizon of the first.
NORMALS = np.array([[0.0, 0.0, 1.0], [0.8, 0.0, 0.6], [0.6, 0.7, -0.3872983]])
CASES = [(name, index, k) for name, own in EXAMPLES.items() for index in range(len(own)) for k in range(len(NORMALS))]


@pytest.fixture(scope="module")
def evaluate():
    """evaluate(light, normal): (SIDE²,10) of what MAIN writes, for the receiver at the origin."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lights, "LIGHT_TYPES", (*lights.LIGHT_TYPES, Bulb()))
        device = open_device()
        with device.gl as gl:
            programs = []
            for constants in (
                {"mesh_colors": 0},
                {"mesh_colors": 1},
                {"mesh_colors": 0, "portals": WORLD},
                {"mesh_colors": 0, "portals": ENVIRONMENT},
            ):
                begin = head(LIGHT_RECORDS, {"side": SIDE, **constants})
                source = begin + expand(FOLDER / "glsl/lights/light.glsl", [], constants) + MAIN
                vertex_shader = begin + (FOLDER / "glsl/full_screen.vert").read_text()
                programs.append(gl.program(vertex_shader, fragment_shader=source))
            map_tables = MapTables.of(MAP, luminance(REC709))
            block = np.zeros((), frame_uniforms.DTYPE)
            block["luminance_weights"][:3], block["scene_extent"] = luminance(REC709), 1.0
            uniforms = gl.buffer(block.tobytes())
            targets = [gl.texture((SIDE, SIDE), count, dtype="f4") for count in (4, 4, 2)]
            framebuffer = gl.framebuffer(targets)

            def run(
                of: Lights,
                normal: np.ndarray,
                through_portals: bool = False,
                sun: MapSun | None = None,
                portals: Portals = PORTALS,
                point: np.ndarray = ORIGIN,
            ) -> np.ndarray:
                shape = int(of.shape[0])
                mesh_colors = lights.mixed_variant(of)["mesh_colors"]
                program = programs[(2 if shape == WORLD else 3) if through_portals else mesh_colors]
                triangle, records = gl.vertex_array(program, []), device.scene_records()
                at_map = device, records, MAP, map_tables, sun or a_map_sun()
                buffers = light_buffers(records, of, np.zeros(3)) | map_uniforms(*at_map)
                buffers = buffers | rotation_uniform(ROTATION)
                if through_portals:
                    buffers = buffers | ScenePortals.upload(records, 0, shape, portals).uniforms
                used = {name: table for name, table in buffers.items() if name in program}
                gl.enable_only(moderngl.NOTHING)
                framebuffer.use()
                uniforms.bind_to_uniform_block(frame_uniforms.BINDING)
                program[frame_uniforms.NAME].binding = frame_uniforms.BINDING
                bind(program, **used, point=tuple(point), normal=tuple(normal))
                triangle.render(moderngl.TRIANGLES, vertices=3)
                return np.concatenate([pixels(target) for target in targets], 2).reshape(SIDE**2, -1).astype(float)

            yield run
        device.close()


@pytest.fixture(params=CASES, ids=[f"{name} {index}, normal {k}" for name, index, k in CASES])
def evaluated(request, evaluate):
    """The values of one case by name, and whether all light comes from one direction."""
    name, index, k = request.param
    columns = evaluate(EXAMPLES[name][index], NORMALS[k], "portals" in name).T
    radiance, cosine, pdf, irradiance, own_pdf, own_emitted, any_pdf, any_emitted, uniform, any_cosine = columns
    estimated = has_light_bvh(EXAMPLES[name][index])[0]  # by few nodes of a light BVH: not compared
    return {
        "arrives": (radiance > 0.0) & (cosine > 0.0),
        "radiance": radiance,
        "cosine": cosine,
        "pdf": pdf,
        "irradiance": (any_emitted * any_cosine / uniform).mean() if estimated else irradiance[0],
        "own": (own_pdf, own_emitted),
        "hemisphere": (any_pdf / uniform, any_emitted * any_cosine / uniform),
        "one direction": (pdf == 1.0).all(),
        "slack": 1e-3 if name == "spot" else 0.0,  # where a hard edge and the horizon cut a cap, W/m²
        "exact": lights.type_of(EXAMPLES[name][index], 0).is_exact(EXAMPLES[name][index], 0),
        "without a point": 0.15 if estimated else 0.0,  # fraction of samples that may lead to hidden triangles
    }


def test_every_light_type_has_an_example():
    assert {each.name for each in lights.LIGHT_TYPES} < set(EXAMPLES)


def test_samples_are_unbiased(evaluated):
    """Within 0.5 %, because an ellipse's spread is integrated at a few points only, and some spots with a radius."""
    estimates = np.where(evaluated["arrives"], evaluated["radiance"] * evaluated["cosine"] / evaluated["pdf"], 0.0)
    assert (evaluated["irradiance"] > 0.0) == evaluated["arrives"].any()
    assert estimates.mean() == pytest.approx(
        evaluated["irradiance"],
        rel=5e-3 if evaluated["exact"] else 0.03,
        abs=evaluated["slack"],
    )


@pytest.mark.parametrize("name", [name for name in EXAMPLES if "portals" in name])
def test_samples_through_portals_that_carry_light_have_a_density(evaluate, name):
    """Far from the origin, where the horizon cuts portals: rounding leaves some samples below it."""
    random = np.random.default_rng(2)
    for _ in range(40):
        point = random.uniform(-60.0, 60.0, 3)
        moved = [replace(each, centre=each.centre + point) for each in PORTALS.rectangles]
        inside = moved[0].centre - point + random.uniform(-0.4, 0.4, 2) @ moved[0].sides
        normal = np.cross(inside, random.normal(size=3))
        normal = normal / np.linalg.norm(normal)
        columns = evaluate(
            EXAMPLES[name][0], normal, True, portals=replace(PORTALS, rectangles=tuple(moved)), point=point
        )
        radiance, _, pdf = columns.T[:3]
        assert pdf[radiance > 0.0].min() > 1e-6


def test_the_pdf_of_a_sample_is_that_of_its_direction(evaluated):
    arrives, (pdf, emitted) = evaluated["arrives"], evaluated["own"]
    if evaluated["one direction"]:
        assert not pdf.any() and not emitted.any(), "a random ray has probability 0 of hitting it"
        return
    # Rounding puts a direction at the edge of a map's cell into the next one, once in ten thousand samples.
    assert np.isclose(pdf[arrives], evaluated["pdf"][arrives], rtol=2e-3, atol=0.0).mean() > 0.9999
    assert np.abs(emitted - evaluated["radiance"])[arrives].max(initial=0.0) <= 2e-3 * emitted.max()


def test_the_pdf_integrates_to_one_and_emitted_radiance_to_the_irradiance(evaluated):
    pdf, emitted = evaluated["hemisphere"]
    if not evaluated["one direction"]:
        # The pdf is unbounded where chords end.
        assert 0.97 - evaluated["without a point"] < pdf.mean() < 1.03
        rel = 0.01 if evaluated["exact"] else 0.03
        assert emitted.mean() == pytest.approx(evaluated["irradiance"], rel=rel, abs=evaluated["slack"])


@pytest.mark.parametrize("first", [0, 59])
def test_a_sun_at_the_edge_of_the_map_is_sampled_as_elsewhere(evaluate, first):
    """Texels at an edge are interpolated with those at the other one, where the sun has none."""
    sun = a_map_sun((slice(20, 24), slice(first, first + 5)))
    turned = replace(sun, direction=sun.direction @ ROTATION)
    of = with_world(
        light().select(slice(0)), World.even(np.ones(3)), MapLight(1.0, turned, np.ones((2, 2)), np.eye(3))
    ).select(slice(0, 1))
    radiance, cosine, pdf, irradiance, *_ = evaluate(of, NORMALS[0], sun=sun).T
    assert (radiance * cosine / pdf).mean() == pytest.approx(irradiance[0], rel=5e-3)


@pytest.mark.parametrize("shape", [LightShape.RECTANGLE, LightShape.ELLIPSE])
@pytest.mark.parametrize(("size", "bound"), [(1e-6, 1e-3), (1.0, 0.05), (100.0, 0.6)])
@pytest.mark.parametrize("offset", [0.0, 0.4])
def test_samples_of_an_area_estimate_the_same_from_any_distance(evaluate, shape, size, bound, offset):
    """Bounds of the relative standard deviation. Uniform samples in area have 10 for 100 m, and 0.15 for 1 m."""
    columns = evaluate(light(shape, (offset * size, 3.0, 3.0), (size, 0.0, 0.0), (0.0, -0.8 * size, 0.0)), NORMALS[0]).T
    estimates = columns[0] * np.maximum(columns[1], 0.0) / columns[2]
    assert estimates.mean() == pytest.approx(columns[3][0], rel=2e-3)
    assert estimates.std() < bound * estimates.mean()
