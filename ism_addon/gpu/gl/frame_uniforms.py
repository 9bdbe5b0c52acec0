# SPDX-License-Identifier: GPL-3.0-or-later
"""Uniforms of the frame, shared by all passes: one uniform block, filled by numpy and read by GLSL."""

import numpy as np

from ...color import luminance
from ...scene import Scene, View
from ...spaces import view_from_anchor

#: Members in order. Their sizes are multiples of a vec4, so std140 needs no padding.
MEMBERS = {
    "clip_from_anchor": "mat4",
    "view_from_anchor": "mat4",
    "ray_origin": "vec4",  # at pixel coordinate (0, 0), anchor space
    "ray_origin_x": "vec4",  # difference from pixel to pixel
    "ray_origin_y": "vec4",
    "ray_direction": "vec4",  # at pixel (0, 0); its component along the view's axis is 1
    "ray_direction_x": "vec4",
    "ray_direction_y": "vec4",
    "luminance_weights": "vec4",  # of red, green and blue
    "picture_size": "vec4",  # width and height, px; textures may be larger, see driver_variants.py
    "scene_extent": "vec4",  # x: largest side of the box around the scene, m
    "anchor": "vec4",  # of anchor space, in world space
}
DTYPE = np.dtype([(name, "f4", (16 if type_ == "mat4" else 4,)) for name, type_ in MEMBERS.items()])
NAME = "Frame"
BINDING = 0

GLSL = (
    "layout(std140) uniform Frame {\n" + "".join(f"    {type_} {name};\n" for name, type_ in MEMBERS.items()) + "};\n"
)
GLSL += "ivec2 last_pixel() { return ivec2(picture_size.xy) - 1; }\n"


def rays(clip_from_view: np.ndarray, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions of the view rays, (3,3) each. Rows: at pixel (0,0), difference in x, difference in y.

    View space. Both are linear in the pixel's coordinate, for perspective (one origin) and for
    orthographic projections (one direction).
    """
    p = clip_from_view
    perspective = p[3, 2] != 0.0
    centre = p[:2, 2] if perspective else -p[:2, 3]
    across = np.zeros((3, 3))
    across[0, :2] = (centre - 1.0) / (p[0, 0], p[1, 1])
    across[1, 0] = 2.0 / (width * p[0, 0])
    across[2, 1] = 2.0 / (height * p[1, 1])
    along = np.zeros((3, 3))
    along[0, 2] = -1.0
    return (np.zeros((3, 3)), across + along) if perspective else (across, along)


def clip_from_anchor(view: View, anchor: np.ndarray) -> np.ndarray:
    """(4,4) float64."""
    return view.clip_from_view @ view_from_anchor(view.view_from_world, anchor)


def frame_block(scene: Scene, view: View, anchor: np.ndarray) -> np.ndarray:
    """One row of DTYPE."""
    from_anchor = view_from_anchor(view.view_from_world, anchor)
    origins, directions = rays(view.clip_from_view, view.width, view.height)
    to_anchor = from_anchor[:3, :3]  # rigid: row vectors times this are its inverse times column vectors
    origins = origins @ to_anchor
    origins[0] -= from_anchor[:3, :3].T @ from_anchor[:3, 3]
    directions = directions @ to_anchor
    block = np.zeros((), DTYPE)
    block["clip_from_anchor"] = clip_from_anchor(view, anchor).T.ravel()
    block["view_from_anchor"] = from_anchor.T.ravel()
    for name, rows in (("ray_origin", origins), ("ray_direction", directions)):
        for suffix, row in zip(("", "_x", "_y"), rows, strict=True):
            block[name + suffix][:3] = row
    block["luminance_weights"][:3] = luminance(scene.working_space)
    block["picture_size"][:2] = view.width, view.height
    block["scene_extent"][0] = scene.extent
    block["anchor"][:3] = anchor
    return block
