# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes a picture needs: those in it, and those that may occlude a light from what is in it.

The others are not uploaded, and have no BVH. A mesh that was needed once stays resident as long as the scene has it.
"""

from dataclasses import dataclass

import numpy as np

from ....resources import RESIDENT_MESHES
from ....scene import Change, Lights, Mesh, Scene, bounding_boxes
from ...culling.frustum_culling import in_view
from ...culling.frustum_slices import BORDER, visible_slices
from ...culling.shaft_culling import meets_shaft
from ...frame import Frame, Pass, outputs
from ...gl.frame_uniforms import clip_from_anchor
from ...lights import by_type

#: Relative rounding error of positions on the GPU.
POSITION_ROUNDING = 1e-6

#: Pairs of a box and a shaft that are tested at a time, so that they stay in the processor's cache.
PAIRS_AT_A_TIME = 1 << 14


@dataclass(frozen=True)
class ResidentMeshes:
    """Meshes of a scene that a picture of it has needed so far, by index, ascending."""

    meshes: tuple[Mesh, ...]  # all of the scene
    indices: tuple[int, ...]


class CullMeshes(Pass):
    """Find the meshes that this picture needs, and keep those that an earlier one did."""

    inputs = (
        *(Change.MESHES, Change.INSTANCES, Change.LIGHTS, Change.VIEW),
        *("shadow.enabled", "shadow.method", "shortcuts"),
    )
    outputs = outputs(RESIDENT_MESHES)

    def execute(self, frame: Frame) -> None:
        meshes, mesh, before = frame.scene.meshes, frame.scene.instances.mesh, frame.get(RESIDENT_MESHES)
        resident = np.zeros(len(meshes), bool)
        if before is not None and before.meshes is meshes:
            resident[list(before.indices)] = True
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
        seen = scene.instances.visible & boxes_in_view(frame, boxes)
        needed, unseen = candidates & seen, np.flatnonzero(candidates & scene.instances.casts_shadow & ~seen)
        if frame.traces_shadows and len(unseen) and seen.any():
            slices = visible_slices(boxes[..., seen], frame.view, frame.anchor)
            needed[unseen] = are_occluders(scene, frame.anchor, boxes, slices, unseen)
        return needed


def instance_boxes(scene: Scene, anchor: np.ndarray) -> np.ndarray:
    """(2,3,I) float64, anchor space: lowest and highest corners of all instances."""
    instances, corners = scene.instances, bounding_boxes(scene.meshes)
    low, high = corners[instances.mesh].swapaxes(0, 1)
    linear, offsets = instances.world_from_object[:, :3, :3], instances.world_from_object[:, :3, 3]
    middle = np.einsum("nij,nj->in", linear, (low + high) / 2.0) + (offsets - anchor).T
    half = np.einsum("nij,nj->in", np.abs(linear), (high - low) / 2.0)
    half += POSITION_ROUNDING * (np.abs(middle) + half)
    return np.stack([middle - half, middle + half])


def boxes_in_view(frame: Frame, boxes: np.ndarray) -> np.ndarray:
    """(I,) bool: which of them (2,3,I) may be in the picture."""
    view, middle, half = frame.view, boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
    clip = np.repeat(clip_from_anchor(view, frame.anchor)[None], boxes.shape[2], 0)
    clip[..., 3] += np.einsum("nij,jn->ni", clip[..., :3], middle)
    return in_view(half.T, clip, 2.0 * BORDER / min(view.width, view.height))


def are_occluders(
    scene: Scene, anchor: np.ndarray, boxes: np.ndarray, slices: np.ndarray, instances: np.ndarray
) -> np.ndarray:
    """(B,) bool: which of these instances (B,) may occlude a light from visible slices (2,3,K).

    Where the test would take as long as to upload the mesh, it is taken to be an occluder.
    """
    light_boxes, slice_boxes, light = shadow_shafts(scene.lights, anchor, slices)
    mesh = scene.instances.mesh[instances]
    triangles = np.array([len(mesh.triangles) for mesh in scene.meshes])
    found = np.bincount(mesh, minlength=len(triangles))[mesh] * len(light) > triangles[mesh]
    untested = np.flatnonzero(~found)
    step = max(PAIRS_AT_A_TIME // max(len(light), 1), 1)
    for first in range(0, len(untested), step):
        batch = untested[first : first + step]
        own = boxes[..., instances[batch]]
        may = may_occlude(scene.lights, anchor, own, scene.instances.groups[instances[batch]])
        found[batch] = (may[:, light] & meets_shaft(own, light_boxes, slice_boxes)).any(1)
    return found


def shadow_shafts(lights: Lights, anchor: np.ndarray, slices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shafts from boxes of lights (2,3,S) to the slices (2,3,S) that they may light, and the lights (S,)."""
    ends = np.zeros((2, 3, len(lights.shape)))
    for light_type, rows, own in by_type(lights):
        ends[..., rows] = light_type.shadow_ends(own, anchor)
    shining = lights.casts_shadow & lights.radiance.any(1)
    light, which = np.nonzero(shining[:, None] & (heights(lights, anchor, slices) > 0.0).T)
    return ends[..., light], slices[..., which], light


def may_occlude(lights: Lights, anchor: np.ndarray, boxes: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """(B,L) bool: if instances of link groups (B,) cast a light's shadows, and their boxes reach in front of it."""
    group = np.maximum(lights.blockers, 0).astype(np.uint32)
    linked = (lights.blockers < 0) | (groups[:, None] >> group & 1 == 1)
    return linked & (heights(lights, anchor, boxes) > 0.0)


def heights(lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """(N,L) m: see LightType.heights."""
    found = np.zeros((boxes.shape[2], len(lights.shape)))
    for light_type, rows, own in by_type(lights):
        found[:, rows] = light_type.heights(own, anchor, boxes)
    return found
