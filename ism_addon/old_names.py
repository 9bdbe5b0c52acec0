# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of settings and of lights' fields in version 0.1.0. Files and presets saved by it keep their values."""

import re
from typing import Any

import numpy as np

#: Old and new names by section of settings; "" is for settings outside of sections.
SETTINGS: dict[str, dict[str, str]] = {
    "": {"skip": "shortcuts", "show": "debug_view"},
    "quality": {"light_points": "virtual_lights", "surface_points": "map_points"},
}

#: Values of the shadow's method. A .blend stores their index, which has not changed.
METHODS = {"FITTED": "RAY_TRACED", "CLASSIC": "SHADOW_MAPS"}

#: A line of a preset that sets a property.
QUALITY_LINE = re.compile(r"^(ism\.(?:render|viewport)\.)(\w+)(?= = )", re.M)
METHOD_LINE = re.compile(r"^(ism\.shadow\.method = ')(\w+)(?=')", re.M)

#: Values of the debug view, in the order of 0.1.0: a .blend stores their index. `irradiance` showed the light of shadow
#: maps, which now has the same target as for rays.
DEBUG_VIEWS = {
    "color": "sample_color",
    "triangle": "primitive",
    "depth": "depth",
    "position": "position",
    "normal": "normal",
    "albedo": "base_color",
    "around": "probe_prediction",
    "foreseen": "prediction_surface",
    "predicted": "direct_prediction",
    "correction": "direct_residual",
    "splats": "shadow_map_splats",
    "shadow_maps": "shadow_maps",
    "irradiance": "direct_prediction",
    "occlusion": "raw_occlusion",
    "occlusion_across": "half_blurred_occlusion",
    "smooth_occlusion": "ambient_occlusion",
    "color_correction": "sample_residual",
    "headroom": "sample_headroom",
}


def current(settings: Any) -> Any:
    """The settings of an old snapshot as JSON, with current names. JSON of another structure is returned unchanged."""
    if not isinstance(settings, dict):
        return settings
    converted = renamed(settings, "")
    if isinstance(view := converted.get("debug_view"), str):
        converted["debug_view"] = DEBUG_VIEWS.get(view, view)
    if isinstance(converted.get("quality"), dict):
        converted["quality"] = renamed(converted["quality"], "quality")
    shadow = converted.get("shadow")
    if isinstance(shadow, dict) and isinstance(method := shadow.get("method"), str):
        converted["shadow"] = shadow | {"method": METHODS.get(method, method)}
    return converted


def current_scene(scene: Any) -> Any:
    """The scene of an old snapshot as JSON, with current names of the lights' fields."""
    if not isinstance(scene, dict) or not isinstance(lights := scene.get("lights"), dict):
        return scene
    return scene | {"lights": {"emission" if name == "radiance" else name: value for name, value in lights.items()}}


def current_arrays(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The arrays of an old snapshot with current names. All of its lights are area lights; materials emit nothing.

    The world is even.
    """
    lights = "scene/lights/"
    converted = {name.replace(f"{lights}radiance", f"{lights}emission"): array for name, array in arrays.items()}
    if f"{lights}shape" in arrays:
        count = len(np.atleast_1d(arrays[f"{lights}shape"]))
        converted |= {
            f"{lights}blend": np.zeros(count, np.float32),
            f"{lights}radius": np.zeros(count),
            f"{lights}soft_falloff": np.zeros(count, bool),
            f"{lights}falloff_power": np.zeros(count, np.int32),
            f"{lights}falloff_smooth": np.zeros(count, np.float32),
            f"{lights}profile": np.full(count, -1, np.int32),
            f"{lights}profile_axes": np.zeros((count, 3, 3)),
            f"{lights}image": np.full(count, -1, np.int32),
            f"{lights}visible_camera": np.zeros(count, bool),
            f"{lights}shadow_softness": np.ones(count, np.float32),
        }
    instances, materials = "scene/instances/", "scene/materials/"
    if f"{instances}mesh" in arrays:
        count = len(np.atleast_1d(arrays[f"{instances}mesh"]))
        converted[f"{instances}visible_diffuse"] = np.ones(count, bool)
        converted |= {f"{instances}{name}": np.full(count, -1, np.int32) for name in ("receivers", "blockers")}
        converted[f"{instances}color"] = np.zeros((0, 4), np.float32)
        converted[f"{instances}pass_index"] = np.zeros(0, np.int32)
        converted[f"{instances}random"] = np.zeros(0, np.float32)
        converted[f"{instances}attributes"] = np.zeros((0, 0, 4), np.float32)
    if f"{materials}image" in arrays:
        count = len(np.atleast_1d(arrays[f"{materials}image"]))
        converted[f"{materials}emission"] = np.zeros((count, 3), np.float32)
        converted |= {f"{materials}{name}": np.full(count, -1, np.int32) for name in ("graph", "first_constant")}
        converted[f"{materials}constants"] = np.zeros((0, 4), np.float32)
        converted |= {
            f"{materials}{name}": np.zeros((0, 2), np.int32) for name in ("transparency", "transparency_constant")
        }
        converted |= {f"{materials}{name}": np.zeros(0, np.int32) for name in ("emission_graph", "emission_constant")}
    world = "scene/world/"
    if f"{world}radiance" in arrays:
        converted[f"{world}background"] = arrays[f"{world}radiance"]
        converted[f"{world}graph"], converted[f"{world}first_constant"] = (
            np.full(2, -1, np.int32),
            np.zeros(2, np.int32),
        )
        converted[f"{world}constants"] = np.zeros((0, 4), np.float32)
    for name in arrays:
        if (name.startswith("scene/meshes/")) and name.endswith("/positions"):
            converted[name.replace("/positions", "/attributes")] = np.zeros((0, 3, 0, 4), np.float32)
    return converted


def current_preset(script: str) -> str:
    """A preset's script with current names."""
    script = QUALITY_LINE.sub(lambda line: line[1] + SETTINGS["quality"].get(line[2], line[2]), script)
    return METHOD_LINE.sub(lambda line: line[1] + METHODS.get(line[2], line[2]), script)


def renamed(values: dict[str, Any], section: str) -> dict[str, Any]:
    """Values of a section with current names."""
    return {SETTINGS[section].get(name, name): value for name, value in values.items()}
