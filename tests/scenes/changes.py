# SPDX-License-Identifier: GPL-3.0-or-later
"""What may change between two pictures, and what may be missing in one; and what an edit has drawn again."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ism_addon.scene import Lights, Scene, View
from ism_addon.settings import Method, Settings

Edit = Callable[[Scene, View], tuple[Scene, View]]
Lack = Callable[[Scene, Settings], tuple[Scene, Settings]]


def nothing_changed(scene: Scene, view: View) -> tuple[Scene, View]:
    return scene, view


def view_turned(scene: Scene, view: View) -> tuple[Scene, View]:
    """By a tenth of a radian about the vertical."""
    cosine, sine = np.cos(0.1), np.sin(0.1)
    turned = np.eye(4)
    turned[:2, :2] = [[cosine, -sine], [sine, cosine]]
    return scene, replace(view, view_from_world=view.view_from_world @ turned)


def light_moved(scene: Scene, view: View) -> tuple[Scene, View]:
    return replace(scene, lights=replace(scene.lights, position=scene.lights.position + 0.1)), view


def colour_changed(scene: Scene, view: View) -> tuple[Scene, View]:
    materials = replace(scene.materials, base_color=scene.materials.base_color * np.float32([0.9, 0.2, 0.2]))
    return replace(scene, materials=materials), view


def object_moved(scene: Scene, view: View) -> tuple[Scene, View]:
    """The last instance, upwards."""
    matrices = scene.instances.world_from_object.copy()
    matrices[-1, 2, 3] += 0.2
    return replace(scene, instances=replace(scene.instances, world_from_object=matrices)), view


EDITS: tuple[Edit, ...] = (nothing_changed, view_turned, light_moved, colour_changed, object_moved)

SEEN = {"VisibilityBuffer", "GBuffer"}
OCCLUSION = {"AmbientOcclusion", "BlurOcclusion"}
PICTURE = {"Shade", "Accumulate", "EstimateError", "Resolve"}
BY_RAYS = {"CullLights", "PredictVisibility", "SelectFaintLights", "TraceShadows"}
BY_MAPS = {"SplatMaps", "FillHoles", "GatherLight"}

#: Other ones, or nothing new, in each sample.
EACH_SAMPLE = {
    Method.RAY_TRACED: {"SelectTiles"} | SEEN | BY_RAYS | OCCLUSION | PICTURE,
    Method.SHADOW_MAPS: {"SelectTiles", "CullLights", "PlaceVirtualLights"} | SEEN | BY_MAPS | OCCLUSION | PICTURE,
}


#: What an edit has drawn again, of that which samples share;
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

#: and of a first sample, where all that was drawn is that of another first sample.
FIRST = {
    Method.RAY_TRACED: {
        nothing_changed: set(),
        view_turned: {"SelectTiles"} | SEEN | BY_RAYS | OCCLUSION | PICTURE,
        light_moved: BY_RAYS | PICTURE,
        colour_changed: {"GBuffer", "TraceShadows"} | PICTURE,  # radiance, as it is towards the camera
        object_moved: SEEN | BY_RAYS | OCCLUSION | PICTURE,
    },
    Method.SHADOW_MAPS: {
        nothing_changed: set(),
        view_turned: {"SelectTiles", "CullLights", "GatherLight"} | SEEN | OCCLUSION | PICTURE,
        light_moved: {"CullLights", "PlaceVirtualLights"} | BY_MAPS | PICTURE,
        colour_changed: {"GBuffer", "GatherLight"} | PICTURE,
        object_moved: {"CullLights", "PlaceVirtualLights"} | SEEN | BY_MAPS | OCCLUSION | PICTURE,
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
    return replace(scene, world=replace(scene.world, radiance=np.zeros(3, np.float32))), settings


WITHOUT_LIGHT: tuple[Lack, ...] = (unlit,)
WITHOUT_SHADOWS: tuple[Lack, ...] = (without_casters, unshadowed, shadows_off)
WITHOUT_OCCLUSION: tuple[Lack, ...] = (occlusion_off, no_intensity, no_radius, tiny_radius, black_world)
