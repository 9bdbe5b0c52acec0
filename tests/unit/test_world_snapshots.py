# SPDX-License-Identifier: GPL-3.0-or-later
"""Snapshots of worlds whose radiance a graph gives."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon import snapshot
from ism_addon.scene import World
from ism_addon.shading.builder import Builder, Value

from .test_snapshot import SETTINGS, VIEW, a_scene


@pytest.mark.parametrize(("image", "first"), [(0.0, 0), (1.0, 0), (0.5, 0), (0.0, 1), (0.0, -1)])
def test_the_graph_of_a_world_has_its_constants(tmp_path, image, first):
    path, builder = tmp_path / "graph.npz", Builder()
    direction = builder.call("world_direction")
    texel = builder.call("image_equirectangular", Value("image", constant=image), direction, parameter=0)
    graph, constants = builder.finish([builder.call("closure_emission", builder.call("color_of", texel))])
    world = replace(World.even(np.ones(3)), graph=np.int32([0, -1]), first_constant=np.int32([first, 0]))
    scene = replace(a_scene(), graphs=(graph,), world=replace(world, constants=constants))
    snapshot.save(path, replace(scene, images=scene.images[:1]), VIEW, SETTINGS)
    if (image, first) in ((0.0, 0), (0.0, -1)):
        snapshot.load(path)
    else:
        with pytest.raises(snapshot.SnapshotError, match=r"scene/world/(first_constant leads|constants name)"):
            snapshot.load(path)
