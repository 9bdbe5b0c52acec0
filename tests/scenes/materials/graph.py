# SPDX-License-Identifier: GPL-3.0-or-later
"""Node graphs of materials in few words: a Principled BSDF, and the nodes that feed it."""

from collections.abc import Mapping, Sequence
from typing import Any

import bpy
import numpy as np

from tests.scenes.parts.materials import packed_image

#: What an input is given: a number, components, or a node whose first output is meant.
Value = float | Sequence[float] | bpy.types.Node | bpy.types.NodeSocket
#: Values by the inputs' names, or by their indices where several have the same name.
Inputs = Mapping[str | int, Value]
Color = tuple[float, float, float]  # linear


class Graph:
    """A material that is being built."""

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree

    def add(self, kind: str, inputs: Inputs, **options: Any) -> bpy.types.Node:
        """Add a node of a type without the prefix ShaderNode."""
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in options.items():
            setattr(node, name, value)
        self.set_inputs(node, inputs)
        return node

    def set_inputs(self, node: bpy.types.Node, inputs: Inputs) -> None:
        """Link inputs of a node, or set their values."""
        for name, value in inputs.items():
            sockets = {each.name: each for each in reversed(node.inputs) if each.enabled}
            socket = node.inputs[name] if isinstance(name, int) else sockets[name]
            if isinstance(value, bpy.types.Node):
                value = next(each for each in value.outputs if each.enabled)
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            elif socket.type == "RGBA":
                socket.default_value = (*value, 1.0)
            else:
                socket.default_value = value

    def surface(self, base: Value, roughness: Value, **others: Value) -> bpy.types.Material:
        """Finish: the Principled BSDF's inputs. Of other inputs, give the names in lower case with underscores."""
        names = {socket.name.lower().replace(" ", "_"): socket.name for socket in self.principled.inputs}
        inputs = {names[name]: value for name, value in others.items()}
        self.set_inputs(self.principled, {"Base Color": base, "Roughness": roughness, **inputs})
        return self.material

    @property
    def principled(self) -> bpy.types.Node:
        """The node that new materials have."""
        return self.tree.nodes["Principled BSDF"]

    def coordinates(self, scale: float | Sequence[float] = 1.0, source: str = "UV") -> bpy.types.Node:
        """Texture coordinates times `scale`. Without it they are metres, of the surface for UV."""
        scales = (scale, scale, scale) if isinstance(scale, float) else scale
        return self.add("Mapping", {"Vector": self.add("TexCoord", {}).outputs[source], "Scale": scales})

    def solid(self, scale: float | Sequence[float] = 1.0) -> bpy.types.Node:
        """Coordinates in the object's space times `scale`, moved at random for each object, for grain and spots."""
        at = self.coordinates(scale, "Object")
        shift = self.add("VectorMath", {"Scale": 40.0}, operation="SCALE")
        self.set_inputs(shift, {"Vector": self.add("ObjectInfo", {}).outputs["Random"]})
        self.set_inputs(at, {"Location": shift})
        return at

    def image(self, pixels: np.ndarray, vector: Value, color_space: str = "sRGB") -> bpy.types.Node:
        """An image texture of pixels (H,W,3 or 4), bottom row first."""
        image = packed_image(self.material.name, pixels, color_space)
        return self.add("TexImage", {"Vector": vector}, image=image)

    def noise(self, vector: Value, scale: float, detail: float = 3.0, roughness: float = 0.5) -> bpy.types.Node:
        """Fractal noise, about .5."""
        return self.add("TexNoise", {"Vector": vector, "Scale": scale, "Detail": detail, "Roughness": roughness})

    def ramp(self, factor: Value, *stops: tuple[float, Color], interpolation: str = "LINEAR") -> bpy.types.Node:
        """A color ramp through two stops or more."""
        node = self.add("ValToRGB", {"Fac": factor})
        node.color_ramp.interpolation = interpolation
        elements = node.color_ramp.elements
        for _ in stops[2:]:
            elements.new(1.0)
        for element, (position, color) in zip(elements, stops, strict=True):
            element.position, element.color = position, (*color, 1.0)
        return node

    def mask(self, factor: Value, start: float, end: float) -> bpy.types.Node:
        """From 0 at `start` to 1 at `end`."""
        return self.add("MapRange", {"Value": factor, "From Min": start, "From Max": end})

    def mix(self, factor: Value, a: Value, b: Value, blend: str = "MIX") -> bpy.types.Node:
        """A mixture of two colors."""
        node = self.add("Mix", {}, data_type="RGBA", blend_type=blend)
        self.set_inputs(node, {"Factor": factor, "A": a, "B": b})
        return node

    def range(self, factor: Value, low: float, high: float) -> bpy.types.Node:
        """A number from 0 to 1 brought to another range."""
        return self.add("MapRange", {"Value": factor, "To Min": low, "To Max": high})

    def bump(self, height: Value, distance: float, strength: float = 1.0) -> bpy.types.Node:
        """The normal of a surface raised by a height from 0 to 1, times a distance in m."""
        return self.add("Bump", {"Height": height, "Distance": distance, "Strength": strength})

    def normal_map(self, height: np.ndarray, vector: Value, strength: float = 1.0) -> bpy.types.Node:
        """The normal of a map of a height (H,W), periodic, in units of a texel."""
        slopes = [0.5 * (np.roll(height, 1, axis) - np.roll(height, -1, axis)) for axis in (1, 0)]
        normals = np.stack([*slopes, np.ones_like(height)], axis=-1)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        image = self.image(0.5 + 0.5 * normals, vector, "Non-Color")
        return self.add("NormalMap", {"Color": image, "Strength": strength})


def plain(name: str, base: Color, roughness: float, **others: Value) -> bpy.types.Material:
    """A material without textures."""
    return Graph(name).surface(base, roughness, **others)
