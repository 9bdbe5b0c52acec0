# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader's unshadowed irradiance, for the tests of light types."""

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.gl.shader_compiler import FOLDER, bind, expand, head
from ism_addon.gpu.gl.shader_records import LIGHT_RECORDS
from ism_addon.gpu.passes.upload.upload_lights import light_buffers
from ism_addon.scene import Lights

RECEIVERS = 8
MAIN = """
uniform samplerBuffer points, normals;
out vec4 result;
void main() {
    int at = int(gl_FragCoord.x);
    vec3 point = texelFetch(points, at).xyz, normal = texelFetch(normals, at).xyz;
    result = vec4(light_irradiance(fetch_Light(scene_records, lights), point, normal));
}
"""


@pytest.fixture(scope="module")
def shader(opened_device):
    """shader(lights, points (N,3), normals (N,3)): (N,) irradiance by the first light, of radiance 1; N ≤ RECEIVERS."""
    with opened_device.gl as gl:
        begin = head(LIGHT_RECORDS, {})
        program = gl.program(
            begin + (FOLDER / "glsl/full_screen.vert").read_text(),
            fragment_shader=begin + expand(FOLDER / "glsl/lights/light.glsl", [], {}) + MAIN,
        )
        triangle = gl.vertex_array(program, [])
        target = gl.texture((RECEIVERS, 1), 4, dtype="f4")
        frame = gl.framebuffer([target])

    def run(lights: Lights, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        count = len(points)
        padded = (np.pad(rows, ((0, 0), (0, 1))).astype("f4") for rows in (points, normals))
        with opened_device.gl as gl:
            points, normals = map(opened_device.buffer_from, padded)
            buffers = light_buffers(opened_device.scene_records(), lights, np.zeros(3))
            gl.enable_only(moderngl.NOTHING)
            frame.use()
            bind(program, points=points, normals=normals, **buffers)
            triangle.render(moderngl.TRIANGLES, vertices=3)
            irradiances = np.frombuffer(target.read(), "f4").reshape(-1, 4)[:count, 0].astype(float)
        assert np.isfinite(irradiances).all() and (irradiances >= 0.0).all()
        return irradiances

    return run
