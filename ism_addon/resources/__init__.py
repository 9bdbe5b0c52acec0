# SPDX-License-Identifier: GPL-3.0-or-later
"""Resources that passes exchange: render targets, buffers and tables, with their units.

A pass declares which of them it reads and which it makes, see gpu/frame.py. Types are static: `frame[NORMAL]` is a
texture and `frame[TILES]` an array. Distances are in metres, in anchor space (see spaces.py); light is in the scene's
working colour space.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..resource_types import Channel, Lifetime, Resource, Target
from . import world

if TYPE_CHECKING:
    from collections.abc import Mapping

    import moderngl
    import numpy as np

    from ..gpu.accel.blas_table import BLASBuffers, BLASTable
    from ..gpu.buffers.corner_buffers import AttributeBuffers, UVBuffers
    from ..gpu.buffers.instance_buffers import InstanceBuffers
    from ..gpu.buffers.material_buffers import MaterialBuffers
    from ..gpu.buffers.mesh_buffers import MeshBuffers
    from ..gpu.convergence import Convergence
    from ..gpu.culling.culling_state import CullingState
    from ..gpu.culling.light_influence import LightInfluence
    from ..gpu.culling.receiver_region import ReceiverRegion
    from ..gpu.emission.baked_emission import BakedEmission
    from ..gpu.gl.buffer_texture import BufferTexture, RecordTable
    from ..gpu.materials.point_graphs import ScenePointGraphs
    from ..gpu.passes.light_selection.cache_irradiance import CachedIrradiance
    from ..gpu.passes.light_selection.retests import Candidates, Retest
    from ..gpu.passes.shadow_maps.atlas import Batch
    from ..gpu.passes.shadow_maps.select_points import MapPoints
    from ..gpu.passes.surfaces.select_tiles import TileSelection
    from ..gpu.passes.upload.cull_meshes import ResidentMeshes
    from ..sampling.point_cloud import PointCloud

#: Pixels along each side of a tile. All pixels of a tile take part in the same samples.
TILE_SIZE = 8
#: Pixels between probe rays, in x and in y.
PROBE_SPACING = 2
#: Cells along each side of a tile: a fragment for each finds the graphs of its pixels. Software drivers shade eight or
#: sixteen fragments at once, so that one for each tile would leave most SIMD lanes idle.
GRAPH_CELLS = 4
#: Depth of the background, as in Cycles' depth pass. m
BACKGROUND_DEPTH = 1e10
#: Distance in a shadow map without an occluder. m
NO_OCCLUDER = 1e30

_SCENE, _PICTURE = Lifetime.SCENE, Lifetime.PICTURE


def _of_tiles(name: str, about: str, format: str = "rgba32f") -> Target:
    return Target(name, about, format=format, divisor=TILE_SIZE, strips=True)


def _packed(name: str, about: str) -> Target:
    return Target(name, about, format="rgba32ui", divisor=0)


# The scene on the GPU.
RESIDENT_MESHES: Resource[ResidentMeshes] = Resource("resident_meshes", "Meshes needed so far", _SCENE, by_value=True)
BLAS: Resource[BLASTable] = Resource("blas", "Bottom-level acceleration structures, one a resident mesh", _SCENE)
BLAS_BUFFERS: Resource[BLASBuffers] = Resource("blas_buffers", "The same on the GPU, concatenated", _SCENE)
TLAS: Resource[dict[str, Any]] = Resource("tlas", "BVH over instances: uniforms of trace/traversal.glsl", _SCENE)
MESH_BUFFERS: Resource[MeshBuffers] = Resource("mesh_buffers", "Vertices and triangles of resident meshes", _SCENE)
UV_BUFFERS: Resource[UVBuffers] = Resource("uv_buffers", "Texture coordinates of resident meshes", _SCENE)
ATTRIBUTE_BUFFERS: Resource[AttributeBuffers] = Resource("attribute_buffers", "What else graphs read of them", _SCENE)
INSTANCE_BUFFERS: Resource[InstanceBuffers] = Resource("instance_buffers", "Matrices and link groups", _SCENE)
POINT_GRAPHS: Resource[ScenePointGraphs] = Resource("point_graphs", "Graphs of transparency, of emission", _SCENE)
MATERIAL_BUFFERS: Resource[MaterialBuffers] = Resource("material_buffers", "Materials and images", _SCENE)
BAKED_EMISSION: Resource[BakedEmission] = Resource("baked_emission", "What meshes with graphs of it emit", _SCENE)
LIGHT_BUFFERS: Resource[Mapping[str, Any]] = Resource("light_buffers", "Tables of lights, of emitters", _SCENE)
SEEN_LIGHTS: Resource[RecordTable | None] = Resource("seen_lights", "Those that the camera sees, if any", _SCENE)

# Adaptive sampling: the tiles that take part in a sample.
TILES: Resource[np.ndarray] = Resource("tiles", "Rows of TILE: tiles that take part in this sample")
TILE_SELECTION: Resource[TileSelection] = Resource("tile_selection", "Probability and phase of each tile", _PICTURE)
SAMPLES_PER_TILE: Resource[np.ndarray] = Resource("samples_per_tile", "(rows,columns): of its pixels", _PICTURE)
TILE_PROBABILITIES = Target(
    "tile_probabilities", "That a tile takes part; the same, 0 if it converged", format="rg32f", divisor=TILE_SIZE
)
TILE_VARIANCE = _of_tiles("tile_variance", "Variance of luminance of a tile's samples; mean luminance", "rg32f")
MEAN_LUMINANCE: Resource[float] = Resource("mean_luminance", "Of all samples so far, W/(sr m²)", _PICTURE)

# What the camera sees.
VISIBILITY_BUFFER = Target(
    "visibility_buffer", "primitive in a finer grid, which several samples share", _PICTURE, format="rg32ui", divisor=0
)
VISIBILITY_DEPTH = Target("visibility_depth", "Depth buffer of visibility_buffer", format="depth32f", divisor=0)
TRANSMITTED_COLOR = Target(
    "transmitted_color", "Tint before it; in alpha, view z of the first surface", _PICTURE, format="rgba16f", divisor=0
)
DEPTH = Target(
    *("depth", "Distance along the view's axis, in metres: white from one on"),
    format="r32f",
    neutral=(BACKGROUND_DEPTH,),
    label="Depth",
)
TILE_GRAPHS = Target(
    "tile_graphs",
    "Bits of the graphs that pixels of a tile's cell have",
    format="r32ui",
    divisor=TILE_SIZE // GRAPH_CELLS,
)
POSITION = Target("position", "Of the nearest surface, in metres, as RGB; in alpha the packed normal", label="Position")
NORMAL = Target(
    "normal",
    "Of the nearest surface as RGB. Stored as octahedra: shading, geometric",
    format="rgba32ui",
    label="Normal",
)
PRIMITIVE = Channel(
    "primitive",
    "The nearest triangle, counted from 1, each in a colour of its own, and its instance",
    of=NORMAL,
    label="Triangles",
)
BASE_COLOR = Target("base_color", "Base color of the nearest surface; in alpha terminator_offset", label="Base Color")
# Of glossy surfaces, if there are any, see materials/gloss_packing.glsl.
GLOSS_REFLECTANCE = _packed("gloss_reflectance", "Reflectance at normal incidence, its rise")
GLOSS_RISE = _packed("gloss_rise", "Other changes of it, fraction that the lobe reflects")
LTC_ENTRIES = _packed("ltc_entries", "Of transforms that make a lobe a cosine: of it and of a coat")
COAT = _packed("coat", "A coat above that lobe, with its normal")
RARE_LOBES = _packed("rare_lobes", "Sheen, anisotropy and diffuse roughness")
TERMINATOR_OFFSET = Channel(
    "terminator_offset", "Height of shadow rays' origins above a triangle with smooth normals, in metres", of=BASE_COLOR
)

# Light selection.
TILE_MIN = _of_tiles("tile_min", "Low corner of the box around near surfaces; in alpha, whether there are any")
TILE_MAX = _of_tiles("tile_max", "High corner of that box")
TILE_NORMAL_CONE = _of_tiles("tile_normal_cone", "Axis of the cone of their normals; the cosine of its angle")
FAR_TILE_MIN = _of_tiles("far_tile_min", "tile_min of far surfaces")
FAR_TILE_MAX = _of_tiles("far_tile_max", "tile_max of far surfaces")
FAR_TILE_NORMAL_CONE = _of_tiles("far_tile_normal_cone", "tile_normal_cone of far surfaces")
CULLING_STATE: Resource[CullingState] = Resource("culling_state", "Bounds of surfaces, visibility of lights", _PICTURE)
LIGHT_INFLUENCE: Resource[dict[int, LightInfluence]] = Resource(
    "light_influence", "Of each light that contributes anywhere, bounds of its irradiance in each tile", _PICTURE
)
HIDDEN_LIGHTS: Resource[tuple[np.ndarray, np.ndarray]] = Resource(
    "hidden_lights", "Lights (H,) no ray has reached; (H,R,C) bounds over all, summed over coarse tiles", _PICTURE
)
CONTRIBUTING_LIGHTS: Resource[tuple[int, ...]] = Resource(
    "contributing_lights", "Indices, ascending", _PICTURE, by_value=True
)
RECEIVER_REGION: Resource[ReceiverRegion | None] = Resource(
    "receiver_region", "A sphere around the visible surfaces, if there is parallel light", _PICTURE, by_value=True
)
#: Pixels from one texel of the irradiance cache to the next, in x and in y; its largest ratio; a shader variant.
CACHE_SPACING, MAX_COARSE_RATIO = 4, 4.0
CACHE_CONSTANTS = {"cache_spacing": CACHE_SPACING, "max_coarse_ratio": MAX_COARSE_RATIO, "fine_cache": 2}
IRRADIANCE_RATIO = Target(
    "irradiance_ratio", "Of one light: unshadowed irradiance over its estimate", format="r16f", divisor=CACHE_SPACING
)
IRRADIANCE_CACHE: Resource[dict[int, CachedIrradiance]] = Resource(
    "irradiance_cache", "IRRADIANCE_RATIO textures by light, of those with a light BVH", _PICTURE
)
PROBE = Target("probe", "Of one light: unoccluded probe rays, and traced ones", format="rg8", divisor=PROBE_SPACING)
PROBES: Resource[dict[int, moderngl.Texture]] = Resource("probes", "PROBE textures by light", _PICTURE)
RETESTS: Resource[tuple[Retest, ...]] = Resource(
    "retests", "Rays of each sample since the last doubling to lights believed occluded", _PICTURE
)
RETEST_CANDIDATES: Resource[Candidates] = Resource(
    "retest_candidates", "Lights believed occluded, and the probabilities of their retests", _PICTURE
)
REDISCOVERED: Resource[dict[int, np.ndarray]] = Resource(
    "rediscovered", "By light, (rows,columns) bool: where retests before the last doubling were unoccluded", _PICTURE
)

# Direct light: prediction and residual. Both methods write direct_prediction.
PREDICTION = Target(
    "prediction",
    # Eight bits would quantise the visibility by up to 0.002, which stays visible until residuals of that size exceed
    # their noise.
    "Of one light: predicted visibility, and whether it is uncertain",
    format="rg16f",
    neutral=(1.0, 0.0),
)
PREDICTED_VISIBILITY: Resource[dict[int, moderngl.Texture]] = Resource(
    "predicted_visibility", "PREDICTION textures by light", _PICTURE
)
RAY_COUNT = Target("ray_count", "Of one light: unoccluded shadow rays so far, and traced ones", format="rg32f")
RAY_COUNTS: Resource[dict[int, moderngl.Texture]] = Resource("ray_counts", "RAY_COUNT textures by light", _PICTURE)
ALL_PROBES: Resource[dict[int, moderngl.Texture]] = Resource(
    "all_probes", "probes, and PROBE textures without rays for rediscovered lights", _PICTURE
)
TILE_VISIBILITY: Resource[dict[int, np.ndarray]] = Resource(
    "tile_visibility", "By light, (rows,columns,2) bool: any ray around a tile unoccluded; any occluded", _PICTURE
)
PROBE_PREDICTION = Target(
    "probe_prediction",
    "Visibility of one light, predicted from the probe rays around a pixel. Ray Traced only",
    format="rg16f",
    divisor=PROBE_SPACING,
    label="Probe Prediction",
)
PREDICTION_SURFACE = Target(
    "prediction_surface",
    "Positions for which visibility was predicted, with packed normals. Ray Traced only",
    _PICTURE,
    label="Prediction Positions",
)
PREDICTED_PIXEL = Target(
    "predicted_pixel", "Which pixel, of the 3×3 around, had the nearest surface in prediction_surface", format="r8"
)
DIRECT_PREDICTION = Target(
    "direct_prediction",
    "Predicted radiance of the lights towards the camera, W/(sr m²); in alpha, how much its luminance can rise",
    label="Predicted Direct Light",
)
DIRECT_RESIDUAL = Target(
    "direct_residual",
    "What shadow rays add to the prediction, or take away; in alpha the uncertain luminance. Ray Traced only",
    label="Direct Residual",
)
FAINT_LIGHTS: Resource[np.ndarray] = Resource("faint_lights", "Rows of FAINT_LIGHT: a tile and a light", _PICTURE)
LIGHTS_USED: Resource[frozenset[int]] = Resource("lights_used", "Lights that were drawn in any tile")

# Imperfect shadow maps.
POINT_CLOUD: Resource[PointCloud] = Resource("point_cloud", "Random points on all triangles that cast shadows", _SCENE)
LIGHT_IMPORTANCE: Resource[np.ndarray] = Resource("light_importance", "(L,): error of one virtual light", _SCENE)
VIRTUAL_LIGHT_COUNTS: Resource[dict[int, int]] = Resource("virtual_light_counts", "By light")
VIRTUAL_LIGHT_RANGES: Resource[BufferTexture] = Resource("virtual_light_ranges", "Rows of VIRTUAL_LIGHT_RANGE")
VIRTUAL_LIGHTS: Resource[BufferTexture] = Resource("virtual_lights", "Rows of VIRTUAL_LIGHT")
SHADOW_MAP_VIEWS: Resource[np.ndarray] = Resource("shadow_map_views", "Rows of SHADOW_MAP_VIEW")
MAP_POINTS: Resource[MapPoints] = Resource("map_points", "The points of each light's shadow maps", _SCENE)
ATLAS_BATCH: Resource[Batch] = Resource("atlas_batch", "The virtual lights whose maps are in the atlas", by_value=True)
SHADOW_MAP_SPLATS = Target(
    "shadow_map_splats",
    "The shadow maps as drawn from points, with holes. Imperfect Shadow Maps only",
    format="r32f",
    divisor=0,
    neutral=(NO_OCCLUDER,),
    label="Splats",
)
SHADOW_MAPS = Target(
    "shadow_maps",
    "The shadow maps with filled holes: distance in metres, and coverage. Imperfect Shadow Maps only",
    format="rg32f",
    divisor=0,
    neutral=(NO_OCCLUDER, 0.0),
    label="Shadow Maps",
)

# Emission that the camera sees, W/(sr m²).
SAMPLE_EMISSION = Target("sample_emission", "Emission of surfaces and lights, as the camera sees it", label="Emission")
EMISSION_CONTRAST = _of_tiles("emission_contrast", "Luminance of its differences around a tile's pixels", "r32f")
EMISSION_EDGES: Resource[np.ndarray] = Resource("emission_edges", "(rows,columns): maxima of that so far", _PICTURE)
SUBSAMPLE_EMISSION = Target("subsample_emission", "sample_emission at another position, with a border", divisor=0)
FILTERED_EMISSION = Target("filtered_emission", "Sums around edges, weighted by the pixel filter; in alpha the weights")

# A sample, and the sums of all samples.
SAMPLE_COLOR = Target("sample_color", "The render itself; alpha premultiplied", label="Render")
SAMPLE_RESIDUAL = Target(
    "sample_residual",
    "What shadow rays add to the render, or take away; in alpha the uncertain luminance. Ray Traced only",
    label="Residual",
)
SAMPLE_HEADROOM = Target(
    "sample_headroom",
    "The most by which uncertain light can still brighten the render. Ray Traced only",
    format="r32f",
    label="Maximum Increase",
)
DEBUG_IMAGE = Target("debug_image", "The debug view, stretched to the image's size")
SUM_COLOR = Target("sum_color", "Weighted sums of sample_color", _PICTURE)
SUM_RESIDUAL = Target("sum_residual", "Of sample_residual; in alpha, squares of their weighted norms", _PICTURE)
SUM_WEIGHTS = Target(
    "sum_weights", "Of squared luminances, samples, norms of residuals, uncertain luminances", _PICTURE
)
SUM_HEADROOM = Target("sum_headroom", "Of sample_headroom", _PICTURE, format="r32f")
NEIGHBOUR_MEAN = Target("neighbour_mean", "Mean residual of a pixel's neighbourhood")
SIGNAL_AND_NOISE = Target(
    "signal_and_noise", "Square and noise of a pixel's difference from neighbour_mean; of neighbour_mean, likewise"
)
IMAGE = Target("image", "The render of all samples so far, alpha premultiplied")
HALF_SAMPLES_IMAGE = Target("half_samples_image", "The image at half as many samples", _PICTURE)
DOUBLING_DIFFERENCE = _of_tiles(
    "doubling_difference", "Mean square of a tile's difference from half_samples_image; mean luminance", "rg32f"
)
CONVERGENCE: Resource[Convergence] = Resource("convergence", "Error of each tile, and which have converged", _PICTURE)

#: Resources by name.
RESOURCES: dict[str, Resource[Any]] = {
    x.name: x for x in (*globals().values(), *vars(world).values()) if isinstance(x, Resource)
}

#: Targets and channels that are debug views; the render is first.
DEBUG_VIEWS = [SAMPLE_COLOR] + [
    each for each in RESOURCES.values() if getattr(each, "label", "") and each is not SAMPLE_COLOR
]
