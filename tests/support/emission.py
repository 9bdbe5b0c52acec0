# SPDX-License-Identifier: GPL-3.0-or-later
"""How the emission of lights depends on the direction, in float64, as in Cycles; and on the place, for meshes."""

from dataclasses import replace

import numpy as np

from ism_addon.gpu.emission.baked_emission import BakedEmission, key_of
from ism_addon.gpu.emission.emissive_lights import EmissiveLights
from ism_addon.gpu.emission.emitters import EmissiveMeshes
from ism_addon.gpu.emission.pieces import Pieces
from ism_addon.scene import Lights, Mesh, NodeGraph, Scene
from ism_addon.shading.node_graph import Instruction
from tests.support.small_scenes import make_scene

#: A graph of a constant radiance.
EVEN = NodeGraph((Instruction("closure_emission", (-1,)),), ("vec3",))


def spread_factor(spread: float, cosine: np.ndarray) -> np.ndarray:
    """Factor of a light's radiance at angles of `cosine` to its normal. It leaves the light's power unchanged."""
    half = max(spread, np.radians(1.0)) / 2.0
    if half > np.pi / 2.0 - 1e-4:
        return np.ones_like(cosine)
    tangent = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(cosine, 1e-20)
    return np.maximum(np.tan(half) - tangent, 0.0) / (np.tan(half) - half)


def spot_attenuation(directions: np.ndarray, lights: Lights, light: int) -> np.ndarray:
    """Factor of a spot's intensity in directions (…,3): a smoothstep of the cosine in the scaled space."""
    axes = [lights.axis_u[light], lights.axis_v[light], lights.normal[light]]
    local = np.stack([directions @ axis / (axis @ axis) for axis in axes], -1)
    edge = np.cos(lights.spread[light] / 2.0)
    x = (local[..., 2] / np.linalg.norm(local, axis=-1) - edge) / max((1.0 - edge) * lights.blend[light], 1e-9)
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def with_graph(scene: Scene, radiance=(1.0, 1.0, 1.0), graph: NodeGraph = EVEN, material: int = 0) -> Scene:
    """The scene, in which the emission of a material is a graph whose constant is the radiance."""
    graphs = np.full(len(scene.materials.graph), -1, np.int32)
    graphs[material] = len(scene.graphs)
    materials = replace(
        scene.materials,
        emission_graph=graphs,
        emission_constant=np.where(graphs >= 0, np.int32(len(scene.materials.constants)), np.int32(-1)),
        constants=np.concatenate([scene.materials.constants, np.array([[*radiance, 0.0]], np.float32)]),
    )
    return replace(scene, materials=materials, graphs=(*scene.graphs, graph))


def textured(mesh: Mesh, radiance: np.ndarray) -> EmissiveLights:
    """The light of a mesh whose triangles have this radiance (T,3)."""
    scene = with_graph(make_scene([mesh]))
    pieces = Pieces(np.arange(len(mesh.triangles)), np.asarray(radiance, float))
    return EmissiveMeshes().lights_of(scene, BakedEmission(key_of(scene), None, {0: pieces}))
