# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of render passes, used by the engine, the view layer's panel, reading back, final renders and the command
line.
"""

from dataclasses import dataclass

from .resource_types import Target
from .resources import DEPTH, IMAGE, NORMAL
from .resources.world import OCCLUSION_IMAGE


@dataclass(frozen=True)
class RenderPass:
    """A render pass."""

    name: str  # Blender's name, in the compositor and in files
    switch: str  # the property of a ViewLayer that enables it; "": it is always rendered
    channels: str  # a letter for each, as in files
    kind: str  # COLOR, VALUE or VECTOR
    resource: Target  # its source; gpu/read_back.py converts it to world space
    filtered: bool = False  # the filtered mean of all samples; else of the first sample

    @property
    def identifier(self) -> str:
        """The name for command lines: diffuse-color."""
        return self.name.lower().replace(" ", "-")


COMBINED = RenderPass("Combined", "", "RGBA", "COLOR", IMAGE, filtered=True)
#: What ambient occlusion leaves of white light.
OCCLUSION = RenderPass("AO", "use_pass_ambient_occlusion", "RGB", "COLOR", OCCLUSION_IMAGE, filtered=True)

RENDER_PASSES = (
    COMBINED,
    RenderPass("Depth", "use_pass_z", "Z", "VALUE", DEPTH),  # m along the view's axis; background: 1e10
    RenderPass("Normal", "use_pass_normal", "XYZ", "VECTOR", NORMAL),
    OCCLUSION,
)


def enabled(view_layer: object) -> tuple[RenderPass, ...]:
    """The passes that are enabled in a bpy.types.ViewLayer."""
    return tuple(each for each in RENDER_PASSES if not each.switch or getattr(view_layer, each.switch))
