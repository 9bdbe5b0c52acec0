# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's atrium: a court of 24 × 8 m, open to the sky, with two storeys of galleries around it.

The arcades' axes are the rectangle |x| = 12, |y| = 4; the galleries behind them are 3.3 m deep. Materials are
Lambertian, so that Cycles without bounces renders the reference of the direct light.
"""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from tests.scenes.parts import architecture, cloth
from tests.scenes.parts.architecture import wall_over_arches
from tests.scenes.parts.materials import Materials
from tests.scenes.parts.meshes import mesh_of
from tests.scenes.parts.shapes import Shape, box, ring
from tests.scenes.parts.statue import statue_mesh
from tests.tools.new_file import open_empty_file

from .atrium_light import add_lights, set_up_camera

HALF_X, HALF_Y, DEPTH = 12.0, 4.0, 3.3  # m: arcade axes, depth of the galleries
FLOOR, SPRINGING, STOREY = 0.15, 2.95, 4.6  # m: gallery floor, springing of its arches, upper floor
UPPER_SPRINGING, TOP = 7.0, 9.1  # m
BAYS_LONG = np.arange(-10.5, 11.0, 3.0)  # m: middles of the bays along the long sides
BAYS_SHORT = np.array([-8.0, 0.0, 8.0]) / 3.0
SIDES = (  # distance of each side's arcade in m, its direction in rad, and its bays
    (HALF_Y, 0.0, BAYS_LONG),
    (HALF_Y, math.pi, BAYS_LONG),
    (HALF_X, 0.5 * math.pi, BAYS_SHORT),
    (HALF_X, -0.5 * math.pi, BAYS_SHORT),
)
CENTRE_Y = 0.3 + 0.5 * (DEPTH - 0.3)  # m: middle of a gallery, from its arcade's axis

THICKNESS = 0.6  # m, of the arcades

STATUE_X = 0.0  # m
CURTAINS = [(-7.5, 1), (-4.5, -1), (1.5, 1), (4.5, -1), (7.5, 1), (10.5, -1)]  # x in m, and the sign of y
BANNERS = [(-3.0, 1), (0.0, -1), (3.0, 1), (6.0, -1)]
SWAGS = [-4.0, 2.0, 7.5]

Parts = Sequence[tuple[Shape, str]]


def build(path: Path) -> None:
    """Build the atrium and save it as a .blend. It replaces the open file."""
    open_empty_file()
    builder = SceneBuilder()
    add_shell(builder)
    for distance, angle, bays in SIDES:
        add_side(builder, Matrix.Rotation(angle, 4, "Z") @ Matrix.Translation((0.0, distance, 0.0)), bays)
    add_corners(builder)
    furnish(builder)
    hang_cloths(builder)
    add_lights()
    set_up_camera()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


class SceneBuilder:
    """Adds objects to the open scene. Objects of one name share one mesh."""

    def __init__(self) -> None:
        self.materials = Materials()
        self.meshes: dict[str, bpy.types.Mesh] = {}

    def add(self, name: str, parts: Parts, matrices: Iterable[Matrix] = (Matrix(),)) -> None:
        """Add an object with a mesh of the parts for each world matrix."""
        if name not in self.meshes:
            self.meshes[name] = mesh_of(name, parts, self.materials)
        for matrix in matrices:
            instance = bpy.data.objects.new(name, self.meshes[name])
            instance.matrix_world = matrix
            bpy.context.scene.collection.objects.link(instance)


def add_shell(builder: SceneBuilder) -> None:
    """Floors, outer walls, cornices and roof: all that runs around the whole court."""
    out = DEPTH + 0.25
    floor = [(out, -0.1), (-0.6, -0.1), (-0.6, FLOOR - 0.02), (-0.58, FLOOR), (out, FLOOR), (out, -0.1)]
    ledge = [(-0.2, STOREY - 0.3), (-0.31, STOREY - 0.3), (-0.36, STOREY - 0.24), (-0.36, STOREY - 0.2)]
    ledge += [(-0.46, STOREY - 0.12), (-0.46, STOREY - 0.02), (-0.44, STOREY), (out, STOREY), (out, STOREY - 0.25)]
    ledge += [(-0.2, STOREY - 0.25), (-0.2, STOREY - 0.3)]
    crown = [(-0.2, TOP - 0.42), (-0.31, TOP - 0.42), (-0.35, TOP - 0.34), (-0.35, TOP - 0.24), (-0.52, TOP - 0.1)]
    crown += [(-0.6, TOP - 0.08), (-0.6, TOP + 0.06), (-0.57, TOP + 0.09), (out, TOP + 0.09), (out, TOP - 0.2)]
    crown += [(-0.2, TOP - 0.2), (-0.2, TOP - 0.42)]
    wall = [(DEPTH, -0.3), (DEPTH, TOP), (DEPTH + 0.4, TOP), (DEPTH + 0.4, -0.3), (DEPTH, -0.3)]
    builder.add("Court floor", [(box((-12.5, -4.5, -0.3), (12.5, 4.5, 0.0)), "Paving")])
    builder.add("Gallery floor", [(ring(floor, HALF_X, HALF_Y), "Limestone")])
    builder.add("Upper floor", [(ring(ledge, HALF_X, HALF_Y), "Limestone")])
    builder.add("Roof and cornice", [(ring(crown, HALF_X, HALF_Y), "Limestone")])
    builder.add("Outer walls", [(ring(wall, HALF_X, HALF_Y), "Stone blocks")])


def add_side(builder: SceneBuilder, frame: Matrix, bays: np.ndarray) -> None:
    """Both storeys of the galleries along one side. In its frame, x points along the arcade and y outwards."""
    bay = float(bays[1] - bays[0])
    length, half, radius = ("long", 12.3, 1.15) if bays is BAYS_LONG else ("short", 3.75, 0.98)
    for storey, springing, top in (("Ground", SPRINGING, STOREY - 0.1), ("Upper", UPPER_SPRINGING, TOP - 0.1)):
        wall = wall_over_arches(-half, half, bays, radius, (springing, top), THICKNESS)
        builder.add(f"{storey} arcade, {length}", [(wall, "Stone blocks")], [frame])
        arches = [frame @ Matrix.Translation((x, 0.0, springing)) for x in bays]
        builder.add(f"Archivolt, {length}", [(architecture.archivolt(radius, 0.24, THICKNESS), "Limestone")], arches)
    between = bays[:-1] + 0.5 * bay
    add_pillars(builder, frame, between)
    vault = architecture.groin_vault(0.5 * bay, 0.5 * DEPTH - 0.13, SPRINGING, 1.3)
    middles = [frame @ Matrix.Translation((x, CENTRE_Y, 0.0)) for x in bays]
    builder.add(f"Vault, {length}", [(vault, "Plaster")], middles)
    add_cross_ribs(builder, frame, [*between, bays[0] - 0.5 * bay, bays[-1] + 0.5 * bay])
    rail = architecture.balustrade(bay - 0.36, 8 if bays is BAYS_LONG else 7)
    builder.add(
        f"Balustrade, {length}", [(rail, "Limestone")], [frame @ Matrix.Translation((x, 0.0, STOREY)) for x in bays]
    )


def add_pillars(builder: SceneBuilder, frame: Matrix, positions: np.ndarray) -> None:
    """Pillars of both storeys at positions (m) along a side."""
    storeys = (
        ("Pillar", FLOOR, architecture.pillar(SPRINGING - FLOOR, 0.25, 0.74, flutes=16)),
        ("Upper pillar", STOREY, architecture.pillar(UPPER_SPRINGING - STOREY, 0.2, 0.74, flutes=0)),
    )
    for name, height, (shaft, ends) in storeys:
        matrices = [frame @ Matrix.Translation((x, 0.0, height)) for x in positions]
        builder.add(name, [(shaft, "Marble"), (ends, "Limestone")], matrices)


def add_cross_ribs(builder: SceneBuilder, frame: Matrix, positions: Sequence[float]) -> None:
    """Arches across the lower gallery, their pilasters, and the beams of the upper ceiling."""
    half = 0.5 * DEPTH
    rib = wall_over_arches(-half, half, [0.0], 1.27, (SPRINGING, STOREY - 0.15), thickness=0.4)
    pilaster = architecture.pier(SPRINGING - FLOOR, 0.22)
    beam = box((-0.13, -half, TOP - 0.5), (0.13, half, TOP - 0.1))
    quarter_turn = Matrix.Rotation(0.5 * math.pi, 4, "Z")
    across = [frame @ Matrix.Translation((x, CENTRE_Y, 0.0)) for x in positions]
    builder.add("Cross rib", [(rib, "Limestone")], [each @ quarter_turn for each in across])
    builder.add("Beam", [(beam, "Oak")], across)
    walls = [frame @ Matrix.Translation((x, DEPTH - 0.02, FLOOR)) for x in positions]
    builder.add("Pilaster", [(pilaster, "Limestone")], walls)


def add_corners(builder: SceneBuilder) -> None:
    """Square piers where the arcades meet, and vaults over the corners of the galleries."""
    lower = architecture.pier(SPRINGING - FLOOR, 0.36)
    upper = architecture.pier(UPPER_SPRINGING - STOREY, 0.36)
    middle = 0.5 * DEPTH
    vault = architecture.groin_vault(middle, middle, SPRINGING, 1.3)
    signs = [(x, y) for x in (-1, 1) for y in (-1, 1)]
    for name, height, pier in (("Corner pier", FLOOR, lower), ("Upper corner pier", STOREY, upper)):
        builder.add(
            name, [(pier, "Limestone")], [Matrix.Translation((x * HALF_X, y * HALF_Y, height)) for x, y in signs]
        )
    bays = [Matrix.Translation((x * (HALF_X + middle), y * (HALF_Y + middle), 0.0)) for x, y in signs]
    builder.add("Corner vault", [(vault, "Plaster")], bays)


def furnish(builder: SceneBuilder) -> None:
    """The statue on its plinth, and jars along the court."""
    profile = [(0.004, -0.02), (0.95, -0.02), (0.95, 0.14), (0.93, 0.16), (0.8, 0.16), (0.8, 0.3), (0.78, 0.32)]
    profile += [(0.64, 0.32), (0.62, 0.36), (0.57, 0.4), (0.55, 0.44), (0.55, 1.1), (0.58, 1.14), (0.65, 1.18)]
    profile += [(0.65, 1.26), (0.63, 1.28), (0.004, 1.28)]
    builder.add("Plinth", [(ring(profile, 0.0, 0.0), "Limestone")], [Matrix.Translation((STATUE_X, 0.0, 0.0))])
    mesh = statue_mesh()
    mesh.materials.append(builder.materials["Marble"])
    builder.meshes["Statue"] = mesh
    builder.add(
        "Statue", [], [Matrix.Translation((STATUE_X, 0.0, 1.27)) @ Matrix.Rotation(math.radians(-65.0), 4, "Z")]
    )
    feet = [(-6.0, 2.85), (-3.0, -2.85), (3.0, 2.85), (3.0, -2.85), (9.0, 2.85), (9.0, -2.85)]
    builder.add("Jar", [(architecture.urn(0.95), "Terracotta")], [Matrix.Translation((x, y, -0.005)) for x, y in feet])


def hang_cloths(builder: SceneBuilder) -> None:
    """Curtains in the lower arches, banners over the balustrades, swags across the court."""
    colors = ("Red damask", "Green damask", "Blue damask")
    for index, (x, side) in enumerate(CURTAINS):
        sheet = cloth.curtain(1.9, 2.6, 9, seed=index, gather=0.42)
        matrix = Matrix.Translation((x, side * HALF_Y, SPRINGING - 0.12))
        builder.add(f"Curtain {index + 1}", [(sheet, colors[index % 3])], [matrix])
    rod = box((-1.3, -0.025, -0.02), (1.3, 0.025, 0.03))
    rods = [Matrix.Translation((x, side * HALF_Y, SPRINGING - 0.12)) for x, side in CURTAINS]
    builder.add("Rod", [(rod, "Bronze")], rods)
    for index, (x, side) in enumerate(BANNERS):
        sheet = cloth.banner(1.2, 3.0, seed=20 + index)
        matrix = Matrix.Translation((x, side * (HALF_Y - 0.52), STOREY + 0.97))
        builder.add(f"Banner {index + 1}", [(sheet, "Red banner" if index % 2 else "Blue banner")], [matrix])
    for index, x in enumerate(SWAGS):
        sheet = cloth.swag(2.0 * HALF_Y - 0.62, 1.5, 1.0, seed=40 + index)
        builder.add(f"Swag {index + 1}", [(sheet, colors[(index + 2) % 3])], [Matrix.Translation((x, 0.0, TOP - 0.7))])
