# SPDX-License-Identifier: GPL-3.0-or-later
"""Products on seamless paper under softboxes: metals, plastics, glazes, and lacquer under a coat."""

from pathlib import Path

from mathutils import Matrix

from tests.scenes import blend_file
from tests.scenes.atrium import SceneBuilder
from tests.scenes.blend_file import COOL, WARM, WHITE, AreaLight
from tests.scenes.lights.lamps import add_spot, set_world
from tests.scenes.objects import backdrop

from . import product_shapes as shapes
from .product_materials import MATERIALS

#: By name: shapes, x and y in m, and rotation in rad.
PRODUCTS = {
    "Bottle": (shapes.bottle(), -0.2, 0.1, 0.45),
    "Can": (shapes.can(), -0.095, 0.15, 0.0),
    "Vase": (shapes.vase(), 0.2, 0.16, 0.5),
    "Box": (shapes.lacquered_box(), 0.04, 0.12, -0.15),
    "Camera": (shapes.camera(), -0.05, 0.0, 0.25),
    "Cup": (shapes.cup(), -0.2, -0.05, -0.6),
    "Watch": (shapes.watch(), 0.1, -0.01, -0.35),
    "Duck": (shapes.duck(), 0.215, -0.01, 0.5),
    "Gold ring": (shapes.finger_ring("Gold"), 0.01, -0.12, 0.0),
    "Rose ring": (shapes.finger_ring("Rose gold"), 0.035, -0.105, 0.0),
    "Chrome ring": (shapes.finger_ring("Chrome"), -0.08, -0.12, 0.0),
}
LIGHTS = (
    (
        AreaLight("RECTANGLE", (-0.55, -0.65, 0.5), (0.0, 0.05, 0.08), 12.0, (0.7, 0.8), WHITE),
        AreaLight("RECTANGLE", (0.75, -0.2, 0.45), (0.0, 0.05, 0.08), 4.0, (0.35, 0.8), COOL),
        AreaLight("RECTANGLE", (0.0, 0.6, 0.55), (0.0, 0.0, 0.05), 4.0, (1.1, 0.12), WHITE),
    ),
    (
        AreaLight("RECTANGLE", (0.7, -0.45, 0.6), (0.0, 0.05, 0.08), 11.0, (0.7, 0.7), WHITE),
        AreaLight("RECTANGLE", (-0.8, 0.1, 0.5), (0.0, 0.05, 0.08), 5.0, (0.25, 0.9), WARM),
        AreaLight("RECTANGLE", (0.1, 0.6, 0.5), (0.0, 0.0, 0.05), 4.0, (1.2, 0.1), WHITE),
    ),
)
CAMERAS = (((0.03, -0.9, 0.31), (0.0, 0.05, 0.118), 48.0), ((-0.4, -0.72, 0.22), (0.01, 0.06, 0.1), 50.0))


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    blend_file.new_file()
    builder = SceneBuilder()
    used = {material for parts, *_ in PRODUCTS.values() for _, material in parts} | {"Seamless paper"}
    builder.materials.by_name |= {name: MATERIALS[name](name) for name in sorted(used)}
    builder.add("Backdrop", [(backdrop(), "Seamless paper")], [Matrix.Scale(0.14, 4)])
    for name, (parts, x, y, angle) in PRODUCTS.items():
        builder.add(name, parts, [Matrix.Translation((x, y, 0.0)) @ Matrix.Rotation(angle, 4, "Z")])
    blend_file.add_lights(LIGHTS[variant])
    add_spot((0.2, -0.5, 0.9), (0.12, 0.7, 0.3), 22.0, WARM, 0.02, 36.0, 0.8)
    set_world((0.01, 0.01, 0.012))
    blend_file.add_camera(*CAMERAS[variant])
    blend_file.save(path)
