# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes a picture needs: those in it, and those that can stand between what is in it and a light.

The others are not uploaded, and have no trees. A mesh that was needed once stays, as long as the scene has it.
"""

from dataclasses import dataclass

import numpy as np

from ....radiometry import plane_normals
from ....resources import RESIDENT_MESHES
from ....scene import Change, Lights, Mesh, Scene, bounding_boxes
from ...culling.frustum_culling import in_view
from ...culling.frustum_slices import BORDER, visible_slices
from ...culling.shaft_culling import meets_shaft
from ...frame import Frame, Pass, outputs
from ...gl.frame_uniforms import clip_from_anchor

#: What positions on the GPU may be off by, as a part of their coordinates.
POSITION_ROUNDING = 1e-6

#: Pairs of a box and a shaft that are looked at at a time: as many as processors keep close at hand.
PAIRS_AT_A_TIME = 1 << 14


@dataclass(frozen=True)
class ResidentMeshes:
    """Meshes of a scene that a picture of it has needed so far, by index, ascending."""

    meshes: tuple[Mesh, ...]  # all of the scene
    indices: tuple[int, ...]


class CullMeshes(Pass):
    """The meshes that are needed."""

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
            resident[mesh[self.chosen(frame, ~resident[mesh])]] = True
        frame[RESIDENT_MESHES] = ResidentMeshes(meshes, tuple(np.flatnonzero(resident).tolist()))

    @staticmethod
    def chosen(frame: Frame, others: np.ndarray) -> np.ndarray:
        """(I,) bool: the instances that the picture needs, of those whose mesh is not there yet, (I,) bool."""
        scene = frame.scene
        boxes = instance_boxes(scene, frame.anchor)
        seen = scene.instances.visible & boxes_in_view(frame, boxes)
        chosen, blockers = others & seen, np.flatnonzero(others & scene.instances.casts_shadow & ~seen)
        if frame.traces_shadows and len(blockers) and seen.any():
            parts = visible_slices(boxes[..., seen], frame.view, frame.anchor)
            chosen[blockers] = occluders(scene, frame.anchor, boxes, parts, blockers)
        return chosen


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


def occluders(scene: Scene, anchor: np.ndarray, boxes: np.ndarray, parts: np.ndarray, which: np.ndarray) -> np.ndarray:
    """(B,) bool: the instances, of those numbered (B,), in the way of a light to parts (2,3,K) of what is seen.

    Where to find out would take as long as to upload the mesh, it is taken to be.
    """
    ones, others, of_light = shadow_shafts(scene.lights, anchor, parts)
    mesh = scene.instances.mesh[which]
    triangles = np.array([len(mesh.triangles) for mesh in scene.meshes])
    found = np.bincount(mesh, minlength=len(triangles))[mesh] * len(of_light) > triangles[mesh]
    unsure = np.flatnonzero(~found)
    step = max(PAIRS_AT_A_TIME // max(len(of_light), 1), 1)
    for first in range(0, len(unsure), step):
        part = unsure[first : first + step]
        own = boxes[..., which[part]]
        may = may_occlude(scene.lights, anchor, own, scene.instances.groups[which[part]])
        found[part] = (may[:, of_light] & meets_shaft(own, ones, others)).any(1)
    return found


def shadow_shafts(lights: Lights, anchor: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From lights (2,3,S) to the parts (2,3,S) of the picture that they may shine on, and the lights' numbers (S,)."""
    centre, reach = (lights.position - anchor).T, (np.abs(lights.axis_u) + np.abs(lights.axis_v)).T / 2.0
    around = np.stack([centre - reach, centre + reach])
    shining = lights.casts_shadow & lights.radiance.any(1)
    light, part = np.nonzero(shining[:, None] & (max_height_above_light(lights, anchor, parts) > 0.0).T)
    return around[..., light], parts[..., part], light


def may_occlude(lights: Lights, anchor: np.ndarray, boxes: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """(B,L) bool: whether instances of these groups (B,) cast a light's shadows, and some of the box is ahead of it."""
    group = np.maximum(lights.blockers, 0).astype(np.uint32)
    linked = (lights.blockers < 0) | (groups[:, None] >> group & 1 == 1)
    return linked & (max_height_above_light(lights, anchor, boxes) > 0.0)


def max_height_above_light(lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
    """(N,L) m: how far before a light's plane boxes (2,3,N) reach."""
    normals = plane_normals(lights)
    middle, half = boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
    return middle.T @ normals.T - ((lights.position - anchor) * normals).sum(1) + half.T @ np.abs(normals).T
