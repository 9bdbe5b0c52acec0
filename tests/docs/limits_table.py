# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of numbers in docs/limits.md, made from the constants that set them."""

from ism_addon.gpu.buffers.mesh_buffers import MAX_TRIANGLES
from ism_addon.scene import MAX_LINK_GROUPS
from ism_addon.scene.limits import MAX_DISTANCE, MAX_EMISSION
from ism_addon.setting_limits import MAX_TEXTURE_LINES, TEXTURE_WIDTH, WIDEST_FILTER

ROWS = {
    "triangles of meshes that a picture needs, instances not counted": f"{MAX_TRIANGLES:,}, "
    "or a third of the driver's `GL_MAX_TEXTURE_BUFFER_SIZE` if that is less",
    "groups of objects that lights are linked to": f"{MAX_LINK_GROUPS}",
    "distance from the world's origin": f"{MAX_DISTANCE:,.0f} m",
    "emission of a light or a material": f"{MAX_EMISSION:g} W/(sr m²), W/sr or W/m²",
    "texels of all images at their size": f"{TEXTURE_WIDTH * MAX_TEXTURE_LINES:,}",
    "width of the pixel filter": f"{WIDEST_FILTER:g} px",
}


def table() -> str:
    return "\n".join(["| what | at most |", "|---|---|", *(f"| {what} | {limit} |" for what, limit in ROWS.items())])
