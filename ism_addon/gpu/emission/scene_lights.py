# SPDX-License-Identifier: GPL-3.0-or-later
"""All lights of a scene: its lamps, its world and its emissive meshes."""

from dataclasses import replace

from ...scene import Lights, Scene, World
from ..lights.world.table import MapLight, with_world
from .baked_emission import BakedEmission
from .emitters import EmissiveMeshes


class SceneLights:
    """Makes scenes with all of their lights. These are kept until something that they depend on changes."""

    def __init__(self) -> None:
        self.emissive_meshes = EmissiveMeshes()
        #: Lights, a world, whether it casts shadows and the light of its map, and the lights of both.
        self.world_lit: tuple[Lights, World, bool, MapLight | None, Lights] | None = None
        #: The arguments of `lit`, and its result.
        self.latest: tuple[Scene, bool, MapLight | None, BakedEmission | None, Scene] | None = None

    def lit(self, scene: Scene, world_shadows: bool, of_map: MapLight | None, baked: BakedEmission | None) -> Scene:
        """The scene with the lights of its emissive meshes and of its world.

        `world_shadows`: whether the world's light has shadows; `of_map`: see with_world.
        """
        if self.latest is None or self.latest[:4] != (scene, world_shadows, of_map, baked):
            of_world = self.lamps_and_world(scene, world_shadows, of_map)
            with_lamps = scene if of_world is scene.lights else replace(scene, lights=of_world)
            lights = self.emissive_meshes.lights_of(with_lamps, baked)
            result = scene if lights is scene.lights else replace(scene, lights=lights)
            self.latest = scene, world_shadows, of_map, baked, result
        return self.latest[4]

    def lamps_and_world(self, scene: Scene, world_shadows: bool, of_map: MapLight | None) -> Lights:
        """The scene's lights and the world: the same object while all are unchanged."""
        if not scene.world.radiance.any():
            return scene.lights
        key = scene.lights, scene.world, world_shadows, of_map
        if self.world_lit is None or self.world_lit[:4] != key:
            self.world_lit = *key, with_world(scene.lights, scene.world, of_map, world_shadows)
        return self.world_lit[4]
