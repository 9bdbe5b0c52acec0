# SPDX-License-Identifier: GPL-3.0-or-later
"""The render passes, a row each. The engine registers them, the view layer's panel offers them, the pipeline reads
their targets back, and renders and the command line write them: all of these loop over the table.
"""

from dataclasses import dataclass

from .resource_types import Target
from .resources import DEPTH, IMAGE, NORMAL


@dataclass(frozen=True)
class RenderPass:
    """An image that a render is made of besides, or the picture itself."""

    name: str  # Blender's, as the compositor and files have it
    switch: str  # the property of a ViewLayer that asks for it; "": it is always made
    channels: str  # a letter each, as files name them
    kind: str  # COLOR, VALUE or VECTOR
    resource: Target  # that it shows; gpu/read_back.py gives its values in world space
    filtered: bool = False  # over all samples, as the picture is; else it is of the first sample alone

    @property
    def identifier(self) -> str:
        """The name for command lines: diffuse-color."""
        return self.name.lower().replace(" ", "-")


COMBINED = RenderPass("Combined", "", "RGBA", "COLOR", IMAGE, filtered=True)

RENDER_PASSES = (
    COMBINED,
    RenderPass("Depth", "use_pass_z", "Z", "VALUE", DEPTH),  # m along the view's axis, 1e10 where nothing is
    RenderPass("Normal", "use_pass_normal", "XYZ", "VECTOR", NORMAL),
)


def asked_for(view_layer: object) -> tuple[RenderPass, ...]:
    """Those that a ViewLayer of Blender's has switched on."""
    return tuple(each for each in RENDER_PASSES if not each.switch or getattr(view_layer, each.switch))
