# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes a picture needs: visible ones, those that may cast a shadow on visible surfaces, and textured lights.

The others are not uploaded and get no BVH. A mesh that was needed once stays resident as long as the scene has it.
"""

from dataclasses import dataclass

import numpy as np

from ....resources import RESIDENT_MESHES
from ....scene import Change, Lights, Mesh, Scene, bounding_boxes
from ...culling.frustum_culling import in_view
from ...culling.frustum_slices import BORDER, visible_slices
from ...culling.shaft_culling import meets_shaft
from ...emission.baked_emission import instances_with_graphs
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.frame_uniforms import clip_from_anchor
from ...lights import by_type
from ...occlusion import may_trace_occlusion

#: Relative rounding error of positions on the GPU.
POSITION_ROUNDING = 1e-6

#: Pairs of a box and a shaft that are tested at a time: few enough for the processor's cache.
PAIRS_AT_A_TIME = 1 << 14


@dataclass(frozen=True)
class ResidentMeshes:
    """The meshes of a scene that its pictures have needed so far."""

    meshes: tuple[Mesh, ...]  # all of the scene
    indices: tuple[int, ...]  # of the needed ones, ascending


class CullMeshes(Pass):
    """Find the meshes that this picture needs, and keep those that an earlier one did."""

    schedule = Schedule.FIRST
    inputs = (
        *(Change.MESHES, Change.INSTANCES, Change.LIGHTS, Change.GLOSS, Change.VIEW),
        *("shadow.enabled", "shadow.method", "shortcuts"),
        *("ssao.sampling", "ssao.enabled", "occlusion_pass"),
    )
    outputs = outputs(RESIDENT_MESHES)

    def execute(self, frame: Frame) -> None:
        meshes, mesh, previous = frame.scene.meshes, frame.scene.instances.mesh, frame.get(RESIDENT_MESHES)
        resident = np.zeros(len(meshes), bool)
        if previous is not None and previous.meshes is meshes:
            resident[list(previous.indices)] = True
        resident[mesh[instances_with_graphs(frame.scene)]] = True
        if not frame.settings.shortcuts:
            resident[mesh] = True
        elif not resident[mesh].all():
            resident[mesh[self.needed_instances(frame, ~resident[mesh])]] = True
        frame[RESIDENT_MESHES] = ResidentMeshes(meshes, tuple(np.flatnonzero(resident).tolist()))

    @staticmethod
    def needed_instances(frame: Frame, candidates: np.ndarray) -> np.ndarray:
        """(I,) bool: which of the candidates, (I,) bool, the picture needs."""
        scene = frame.scene
        boxes = instance_boxes(scene, frame.anchor)
        visible = scene.instances.visible & boxes_in_view(frame, boxes)
        needed, casters = candidates & visible, np.flatnonzero(candidates & scene.instances.casts_shadow & ~visible)
        if may_trace_occlusion(frame.settings) or scene.traces_graphs:  # by all that is anywhere
            needed[casters] = True
        elif frame.traces_shadows and len(casters) and visible.any():
            slices = visible_slices(boxes[..., visible], frame.view, frame.anchor)
            needed[casters] = are_occluders(scene, frame.anchor, boxes, slices, casters)
        return needed


def instance_boxes(scene: Scene, anchor: np.ndarray) -> np.ndarray:
    """(2,3,I) float64: lowest and highest corners of the bounding boxes of all instances, in anchor space."""
    instances, corners = scene.instances, bounding_boxes(scene.meshes)
    low, high = corners[instances.mesh].swapaxes(0, 1)
    linear, offsets = instances.world_from_object[:, :3, :3], instances.world_from_object[:, :3, 3]
    middle = np.einsum("nij,nj->in", linear, (low + high) / 2.0) + (offsets - anchor).T
    half = np.einsum("nij,nj->in", np.abs(linear), (high - low) / 2.0)
    half += POSITION_ROUNDING * (np.abs(middle) + half)
    return np.stack([middle - half, middle + half])


def boxes_in_view(frame: Frame, boxes: np.ndarray) -> np.ndarray:
    """(I,) bool: which of the boxes (2,3,I) may be in the picture."""
    view, middle, half = frame.view, boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
    clip = np.repeat(clip_from_anchor(view, frame.anchor)[None], boxes.shape[2], 0)
    clip[..., 3] += np.einsum("nij,jn->ni", clip[..., :3], middle)
    return in_view(half.T, clip, 2.0 * BORDER / min(view.width, view.height))


def are_occluders(
    scene: Scene, anchor: np.ndarray, boxes: np.ndarray, slices: np.ndarray, instances: np.ndarray
) -> np.ndarray:
    """(B,) bool: which of these instances (B,) may occlude a light as seen from the visible slices (2,3,K).

    Instances whose test would take longer than the upload of their mesh are not tested: they count as occluders.
    """
    light_boxes, slice_boxes, light = shadow_shafts(scene.lights, anchor, slices)
    mesh = scene.instances.mesh[instances]
    triangles = np.array([len(mesh.triangles) for mesh in scene.meshes])
    occluders = np.bincount(mesh, minlength=len(triangles))[mesh] * len(light) > triangles[mesh]
    untested = np.flatnonzero(~occluders)
    step = max(PAIRS_AT_A_TIME // max(len(light), 1), 1)
    for first in range(0, len(untested), step):
        batch = untested[first : first + step]
        batch_boxes = boxes[..., instances[batch]]
        may = may_occlude(scene.lights, anchor, batch_boxes, scene.instances.groups[instances[batch]])
        occluders[batch] = (may[:, light] & meets_shaft(batch_boxes, light_boxes, slice_boxes)).any(1)
    return occluders


def shadow_shafts(lights: Lights, anchor: np.ndarray, slices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shafts from lights to slices that they may light: boxes of both, (2,3,S) each, and the lights (S,)."""
    ends = np.zeros((2, 3, len(lights.shape), slices.shape[2]))
    for light_type, rows, type_lights in by_type(lights):
        ends[:, :, rows] = light_type.shadow_ends(type_lights, anchor, slices)
    casts_shadow = lights.casts_shadow & lights.emission.any(1)
    light, slice_ = np.nonzero(casts_shadow[:, None] & (heights(lights, anchor, slices) > 0.0).T)
    return ends[:, :, light, slice_], slices[..., slice_], light


def may_occlude(lights: Lights, anchor: np.ndarray, boxes: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """(B,L) bool: whether instances of link groups (B,) cast a light's shadows, and extend in front of it."""
    group = np.maximum(lights.blockers, 0).astype(np.uint32)
    linked = (lights.blockers < 0) | (groups[:, None] >> group & 1 == 1)
    return linked & (heights(lights, anchor, boxes) > 0.0)


def heights(lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """(N,L) m: see LightType.heights."""
    result = np.zeros((boxes.shape[2], len(lights.shape)))
    for light_type, rows, type_lights in by_type(lights):
        result[:, rows] = light_type.heights(type_lights, anchor, boxes)
    return result
