# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's atrium, built by script: a court of 24 × 8 m under an open roof, two storeys of galleries around it.

The arcades' axes are the rectangle |x| = 12, |y| = 4; the galleries behind them are 3.3 m deep. Materials are
Lambertian, so Cycles without bounces is the truth of the direct light.
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
BAYS_LONG = np.arange(-10.5, 11.0, 3.0)  # m: middles of the bays
BAYS_SHORT = np.array([-8.0, 0.0, 8.0]) / 3.0
SIDES = (  # distance and direction of each side's arcade, and its bays
    (HALF_Y, 0.0, BAYS_LONG),
    (HALF_Y, math.pi, BAYS_LONG),
    (HALF_X, 0.5 * math.pi, BAYS_SHORT),
    (HALF_X, -0.5 * math.pi, BAYS_SHORT),
)
CENTRE_Y = 0.3 + 0.5 * (DEPTH - 0.3)  # m: middle of a gallery, from its arcade's axis

THICKNESS = 0.6  # m, of the arcades

STATUE_X = 0.0  # m
CURTAINS = [(-7.5, 1), (-4.5, -1), (1.5, 1), (4.5, -1), (7.5, 1), (10.5, -1)]  # x in m, and which side
BANNERS = [(-3.0, 1), (0.0, -1), (3.0, 1), (6.0, -1)]
SWAGS = [-4.0, 2.0, 7.5]

Parts = Sequence[tuple[Shape, str]]


def build(path: Path) -> None:
    """Write the atrium to a .blend; what was open is replaced."""
    open_empty_file()
    mason = SceneBuilder()
    shell(mason)
    for middle, turn, bays in SIDES:
        side(mason, Matrix.Rotation(turn, 4, "Z") @ Matrix.Translation((0.0, middle, 0.0)), bays)
    corners(mason)
    furnish(mason)
    hang(mason)
    add_lights()
    set_up_camera()
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


class SceneBuilder:
    """Sets parts into the open scene; parts of one name share one mesh."""

    def __init__(self) -> None:
        self.materials = Materials()
        self.meshes: dict[str, bpy.types.Mesh] = {}

    def set(self, name: str, parts: Parts, places: Iterable[Matrix] = (Matrix(),)) -> None:
        """Stand the parts wherever a place says."""
        if name not in self.meshes:
            self.meshes[name] = mesh_of(name, parts, self.materials)
        for place in places:
            part = bpy.data.objects.new(name, self.meshes[name])
            part.matrix_world = place
            bpy.context.scene.collection.objects.link(part)


def shell(mason: SceneBuilder) -> None:
    """What goes around the whole court: floors, outer walls, cornices, roof."""
    out = DEPTH + 0.25
    steps = [(out, -0.1), (-0.6, -0.1), (-0.6, FLOOR - 0.02), (-0.58, FLOOR), (out, FLOOR), (out, -0.1)]
    ledge = [(-0.2, STOREY - 0.3), (-0.31, STOREY - 0.3), (-0.36, STOREY - 0.24), (-0.36, STOREY - 0.2)]
    ledge += [(-0.46, STOREY - 0.12), (-0.46, STOREY - 0.02), (-0.44, STOREY), (out, STOREY), (out, STOREY - 0.25)]
    ledge += [(-0.2, STOREY - 0.25), (-0.2, STOREY - 0.3)]
    crown = [(-0.2, TOP - 0.42), (-0.31, TOP - 0.42), (-0.35, TOP - 0.34), (-0.35, TOP - 0.24), (-0.52, TOP - 0.1)]
    crown += [(-0.6, TOP - 0.08), (-0.6, TOP + 0.06), (-0.57, TOP + 0.09), (out, TOP + 0.09), (out, TOP - 0.2)]
    crown += [(-0.2, TOP - 0.2), (-0.2, TOP - 0.42)]
    wall = [(DEPTH, -0.3), (DEPTH, TOP), (DEPTH + 0.4, TOP), (DEPTH + 0.4, -0.3), (DEPTH, -0.3)]
    mason.set("Court floor", [(box((-12.5, -4.5, -0.3), (12.5, 4.5, 0.0)), "Paving")])
    mason.set("Gallery floor", [(ring(steps, HALF_X, HALF_Y), "Limestone")])
    mason.set("Upper floor", [(ring(ledge, HALF_X, HALF_Y), "Limestone")])
    mason.set("Roof and cornice", [(ring(crown, HALF_X, HALF_Y), "Limestone")])
    mason.set("Outer walls", [(ring(wall, HALF_X, HALF_Y), "Stone blocks")])


def side(mason: SceneBuilder, frame: Matrix, bays: np.ndarray) -> None:
    """Both storeys of the galleries along one side; in its frame, x runs along the arcade and y outwards."""
    bay = float(bays[1] - bays[0])
    kind, half, radius = ("long", 12.3, 1.15) if bays is BAYS_LONG else ("short", 3.75, 0.98)
    for storey, springing, top in (("Ground", SPRINGING, STOREY - 0.1), ("Upper", UPPER_SPRINGING, TOP - 0.1)):
        wall = wall_over_arches(-half, half, bays, radius, (springing, top), THICKNESS)
        mason.set(f"{storey} arcade, {kind}", [(wall, "Stone blocks")], [frame])
        arches = [frame @ Matrix.Translation((x, 0.0, springing)) for x in bays]
        mason.set(f"Archivolt, {kind}", [(architecture.archivolt(radius, 0.24, THICKNESS), "Limestone")], arches)
    between = bays[:-1] + 0.5 * bay
    stand(mason, frame, between)
    vault = architecture.groin_vault(0.5 * bay, 0.5 * DEPTH - 0.13, SPRINGING, 1.3)
    middles = [frame @ Matrix.Translation((x, CENTRE_Y, 0.0)) for x in bays]
    mason.set(f"Vault, {kind}", [(vault, "Plaster")], middles)
    cross_ribs(mason, frame, [*between, bays[0] - 0.5 * bay, bays[-1] + 0.5 * bay])
    rail = architecture.balustrade(bay - 0.36, 8 if bays is BAYS_LONG else 7)
    mason.set(
        f"Balustrade, {kind}", [(rail, "Limestone")], [frame @ Matrix.Translation((x, 0.0, STOREY)) for x in bays]
    )


def stand(mason: SceneBuilder, frame: Matrix, spots: np.ndarray) -> None:
    """Pillars of both storeys at spots along a side."""
    storeys = (
        ("Pillar", FLOOR, architecture.pillar(SPRINGING - FLOOR, 0.25, 0.74, flutes=16)),
        ("Upper pillar", STOREY, architecture.pillar(UPPER_SPRINGING - STOREY, 0.2, 0.74, flutes=0)),
    )
    for name, height, (shaft, ends) in storeys:
        places = [frame @ Matrix.Translation((x, 0.0, height)) for x in spots]
        mason.set(name, [(shaft, "Marble"), (ends, "Limestone")], places)


def cross_ribs(mason: SceneBuilder, frame: Matrix, spots: Sequence[float]) -> None:
    """Arches across the lower gallery, their pilasters, and the beams of the upper ceiling."""
    half = 0.5 * DEPTH
    rib = wall_over_arches(-half, half, [0.0], 1.27, (SPRINGING, STOREY - 0.15), thickness=0.4)
    pilaster = architecture.pier(SPRINGING - FLOOR, 0.22)
    beam = box((-0.13, -half, TOP - 0.5), (0.13, half, TOP - 0.1))
    across = [frame @ Matrix.Translation((x, CENTRE_Y, 0.0)) for x in spots]
    mason.set("Cross rib", [(rib, "Limestone")], [place @ Matrix.Rotation(0.5 * math.pi, 4, "Z") for place in across])
    mason.set("Beam", [(beam, "Oak")], across)
    walls = [frame @ Matrix.Translation((x, DEPTH - 0.02, FLOOR)) for x in spots]
    mason.set("Pilaster", [(pilaster, "Limestone")], walls)


def corners(mason: SceneBuilder) -> None:
    """Square piers where the arcades meet, and the vaults of the galleries' corners."""
    lower = architecture.pier(SPRINGING - FLOOR, 0.36)
    upper = architecture.pier(UPPER_SPRINGING - STOREY, 0.36)
    middle = 0.5 * DEPTH
    vault = architecture.groin_vault(middle, middle, SPRINGING, 1.3)
    signs = [(x, y) for x in (-1, 1) for y in (-1, 1)]
    for name, height, pier in (("Corner pier", FLOOR, lower), ("Upper corner pier", STOREY, upper)):
        mason.set(name, [(pier, "Limestone")], [Matrix.Translation((x * HALF_X, y * HALF_Y, height)) for x, y in signs])
    bays = [Matrix.Translation((x * (HALF_X + middle), y * (HALF_Y + middle), 0.0)) for x, y in signs]
    mason.set("Corner vault", [(vault, "Plaster")], bays)


def furnish(mason: SceneBuilder) -> None:
    """The statue on its plinth, and jars along the court."""
    profile = [(0.004, -0.02), (0.95, -0.02), (0.95, 0.14), (0.93, 0.16), (0.8, 0.16), (0.8, 0.3), (0.78, 0.32)]
    profile += [(0.64, 0.32), (0.62, 0.36), (0.57, 0.4), (0.55, 0.44), (0.55, 1.1), (0.58, 1.14), (0.65, 1.18)]
    profile += [(0.65, 1.26), (0.63, 1.28), (0.004, 1.28)]
    mason.set("Plinth", [(ring(profile, 0.0, 0.0), "Limestone")], [Matrix.Translation((STATUE_X, 0.0, 0.0))])
    mesh = statue_mesh()
    mesh.materials.append(mason.materials["Marble"])
    mason.meshes["Statue"] = mesh
    mason.set("Statue", [], [Matrix.Translation((STATUE_X, 0.0, 1.27)) @ Matrix.Rotation(math.radians(-65.0), 4, "Z")])
    spots = [(-6.0, 2.85), (-3.0, -2.85), (3.0, 2.85), (3.0, -2.85), (9.0, 2.85), (9.0, -2.85)]
    mason.set("Jar", [(architecture.urn(0.95), "Terracotta")], [Matrix.Translation((x, y, -0.005)) for x, y in spots])


def hang(mason: SceneBuilder) -> None:
    """Curtains in the lower arches, banners from the upper floor, swags from side to side."""
    colors = ("Red damask", "Green damask", "Blue damask")
    for number, (x, way) in enumerate(CURTAINS):
        sheet = cloth.curtain(1.9, 2.6, 9, seed=number, gather=0.42)
        place = Matrix.Translation((x, way * HALF_Y, SPRINGING - 0.12))
        mason.set(f"Curtain {number + 1}", [(sheet, colors[number % 3])], [place])
    rod = box((-1.3, -0.025, -0.02), (1.3, 0.025, 0.03))
    spots = [Matrix.Translation((x, way * HALF_Y, SPRINGING - 0.12)) for x, way in CURTAINS]
    mason.set("Rod", [(rod, "Bronze")], spots)
    for number, (x, way) in enumerate(BANNERS):
        sheet = cloth.banner(1.2, 3.0, seed=20 + number)
        place = Matrix.Translation((x, way * (HALF_Y - 0.52), STOREY + 0.97))
        mason.set(f"Banner {number + 1}", [(sheet, "Red banner" if number % 2 else "Blue banner")], [place])
    for number, x in enumerate(SWAGS):
        sheet = cloth.swag(2.0 * HALF_Y - 0.62, 1.5, 1.0, seed=40 + number)
        mason.set(f"Swag {number + 1}", [(sheet, colors[(number + 2) % 3])], [Matrix.Translation((x, 0.0, TOP - 0.7))])
