# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a scene, scenes and settings without lights, shadows or occlusion, and the passes that an edit repeats."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ism_addon.scene import Lights, Scene, View, World
from ism_addon.settings import Method, Settings

Edit = Callable[[Scene, View], tuple[Scene, View]]
Removal = Callable[[Scene, Settings], tuple[Scene, Settings]]


def nothing_changed(scene: Scene, view: View) -> tuple[Scene, View]:
    return scene, view


def view_turned(scene: Scene, view: View) -> tuple[Scene, View]:
    """Rotated by a tenth of a radian about the vertical."""
    cosine, sine = np.cos(0.1), np.sin(0.1)
    rotation = np.eye(4)
    rotation[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return scene, replace(view, view_from_world=view.view_from_world @ rotation)


def light_moved(scene: Scene, view: View) -> tuple[Scene, View]:
    return replace(scene, lights=replace(scene.lights, position=scene.lights.position + 0.1)), view


def colour_changed(scene: Scene, view: View) -> tuple[Scene, View]:
    materials = replace(scene.materials, base_color=scene.materials.base_color * np.float32([0.9, 0.2, 0.2]))
    return replace(scene, materials=materials), view


def object_moved(scene: Scene, view: View) -> tuple[Scene, View]:
    """The last instance, moved upwards."""
    matrices = scene.instances.world_from_object.copy()
    matrices[-1, 2, 3] += 0.2
    return replace(scene, instances=replace(scene.instances, world_from_object=matrices)), view


EDITS: tuple[Edit, ...] = (nothing_changed, view_turned, light_moved, colour_changed, object_moved)

VISIBLE_SURFACES = {"VisibilityBuffer", "GBuffer"}
OCCLUSION = {"AmbientOcclusion", "BlurOcclusion"}
FILM = {"Shade", "Accumulate", "EstimateError", "Resolve"}
RAY_TRACED_LIGHT = {"CullLights", "PredictVisibility", "SelectFaintLights", "TraceShadows"}
SHADOW_MAPPED_LIGHT = {"SplatMaps", "FillHoles", "GatherLight"}

#: Passes that are drawn in every sample.
EACH_SAMPLE = {
    Method.RAY_TRACED: {"SelectTiles"} | VISIBLE_SURFACES | RAY_TRACED_LIGHT | OCCLUSION | FILM,
    Method.SHADOW_MAPS: {"SelectTiles", "CullLights", "PlaceVirtualLights"}
    | VISIBLE_SURFACES
    | SHADOW_MAPPED_LIGHT
    | OCCLUSION
    | FILM,
}


#: Passes that an edit repeats, of those whose results serve all samples.
SHARED = {
    Method.RAY_TRACED: {
        nothing_changed: set(),
        view_turned: {"CullMeshes", "ProbeVisibility"},
        light_moved: {"CullMeshes", "UploadLights", "ProbeVisibility"},
        colour_changed: {"UploadMaterials"},
        object_moved: {"CullMeshes", "UploadInstances", "BuildTLAS", "ProbeVisibility"},
    },
    Method.SHADOW_MAPS: {
        nothing_changed: set(),
        view_turned: {"CullMeshes"},
        light_moved: {"CullMeshes", "UploadLights", "WeighLights", "SelectPoints"},
        colour_changed: {"UploadMaterials"},
        object_moved: {"CullMeshes", "UploadInstances", "SamplePoints", "WeighLights", "SelectPoints"},
    },
}

#: Passes that an edit repeats in a first sample, where only a first sample was drawn before it.
FIRST = {
    Method.RAY_TRACED: {
        nothing_changed: set(),
        view_turned: {"SelectTiles"} | VISIBLE_SURFACES | RAY_TRACED_LIGHT | OCCLUSION | FILM,
        light_moved: RAY_TRACED_LIGHT | FILM,
        colour_changed: {"GBuffer", "TraceShadows"} | FILM,  # radiance reflected to the camera depends on the colour
        object_moved: VISIBLE_SURFACES | RAY_TRACED_LIGHT | OCCLUSION | FILM,
    },
    Method.SHADOW_MAPS: {
        nothing_changed: set(),
        view_turned: {"SelectTiles", "CullLights", "GatherLight"} | VISIBLE_SURFACES | OCCLUSION | FILM,
        light_moved: {"CullLights", "PlaceVirtualLights"} | SHADOW_MAPPED_LIGHT | FILM,
        colour_changed: {"GBuffer", "GatherLight"} | FILM,
        object_moved: {"CullLights", "PlaceVirtualLights"} | VISIBLE_SURFACES | SHADOW_MAPPED_LIGHT | OCCLUSION | FILM,
    },
}


def with_ssao(settings: Settings, **changes: object) -> Settings:
    return replace(settings, ssao=replace(settings.ssao, **changes))


def unlit(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    none = Lights(**{name: value[:0].copy() for name, value in vars(scene.lights).items()})
    return replace(scene, lights=none), settings


def without_casters(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    none = np.zeros_like(scene.instances.casts_shadow)
    return replace(scene, instances=replace(scene.instances, casts_shadow=none)), settings


def unshadowed(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros_like(scene.lights.casts_shadow))), settings


def shadows_off(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return scene, replace(settings, shadow=replace(settings.shadow, enabled=False))


def occlusion_off(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return scene, with_ssao(settings, enabled=False)


def no_intensity(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return scene, with_ssao(settings, intensity=0.0)


def no_radius(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return scene, with_ssao(settings, radius=0.0)


def tiny_radius(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return scene, with_ssao(settings, radius=1e-3)


def black_world(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    return replace(scene, world=World.even(np.zeros(3, np.float32))), settings


WITHOUT_LIGHT: tuple[Removal, ...] = (unlit,)
WITHOUT_SHADOWS: tuple[Removal, ...] = (without_casters, unshadowed, shadows_off)
WITHOUT_OCCLUSION: tuple[Removal, ...] = (occlusion_off, no_intensity, no_radius, tiny_radius, black_world)
