# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays through the trees against every triangle, in float64; what is kept and what is uploaded."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.accel.blas import build_blas
from ism_addon.gpu.accel.bvh import GRID_EXTENT
from ism_addon.gpu.buffers.mesh_buffers import packed_corners
from ism_addon.parallel import MIN_PARALLEL_SIZE
from ism_addon.resources import BLAS, TLAS
from tests.scenes.small import subdivided_box
from tests.support import reference
from tests.support.rays import compare, occluded, rays, truth
from tests.support.small_scenes import draw, light, look, placed, quad, rubble, stage

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
TURN = np.array([[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


@pytest.mark.parametrize("count", [1, 2, 3, 5, 16, 17, 200, 1500])
def test_random_triangles(device, count):
    compare(device, stage([rubble(count, size=0.3 if count > 100 else 3.0)], light()), *rays(1500))


def test_more_triangles_than_one_thread_sorts(device):
    scene = stage([rubble(MIN_PARALLEL_SIZE + 100, size=0.02)], light())
    compare(device, scene, *rays(200, 1.2))


def test_deeper_than_eight_levels_of_four(device):
    """As deep as one word can tell what waits, and one deeper."""
    scene = stage([rubble(4**9 + 1, size=0.01)], light())
    compare(device, scene, *rays(60, 1.2))


def test_long_thin_triangles(device):
    """Blades a thousand times as long as wide, whose boxes are mostly empty."""
    random = np.random.default_rng(3)
    blades = [quad(random.uniform(-1, 1, 3), 1e-3 * random.normal(size=3), random.normal(size=3)) for _ in range(60)]
    starts, ends = rays(6000)
    ours = occluded(device, stage(blades, light()), starts, ends)
    expected, sure = truth(stage(blades, light()), starts, ends, 1e-3)
    assert expected.sum() > 20
    assert np.array_equal(ours[sure], expected[sure])


def test_a_triangle_in_two_texels_is_all_there():
    """Corners to the ends of the lattice, materials to the last bit."""
    random = np.random.default_rng(0)
    corners = random.integers(-GRID_EXTENT, GRID_EXTENT, (1000, 3, 3), np.int32, endpoint=True)
    corners[0], corners[1], corners[2] = -GRID_EXTENT, GRID_EXTENT, -1
    materials = random.integers(0, 1 << 28, 1000, np.uint32)
    materials[:2] = 0, (1 << 28) - 1
    words = packed_corners(list(np.ascontiguousarray(corners.reshape(-1, 9).T)), materials)
    lower = ((words & 127).astype(np.int64) << np.array([0, 7, 14, 21] * 2)).reshape(-1, 2, 4).sum(2)
    upper = words.view(np.int32) >> 7
    last = (lower[:, 0] ^ 1 << 27) - (1 << 27)  # a sign of 28 bits
    assert np.array_equal(np.column_stack([upper, last]).reshape(-1, 3, 3), corners)
    assert np.array_equal(lower[:, 1], materials)


MATRICES = {
    "turned": [TURN, 0.7 * TURN @ TURN],
    "mirrored": [np.diag([-1.0, 1.0, 1.0]), -TURN],
    "sheared": [SHEAR, SHEAR.T @ TURN],
    "stretched": [np.diag([1.0, 0.05, 2.0]), np.diag([3.0, 1.0, 0.3]) @ TURN],
    "flattened": [np.diag([1.0, 1.0, 0.0]), TURN @ np.diag([1.0, 0.0, 1.0])],
}


@pytest.mark.parametrize("kind", MATRICES)
def test_instances(device, kind):
    """Of two meshes, twice each, some through others."""
    one, two = MATRICES[kind]
    places = [placed(one, (-0.5, 0, 0)), placed(two, (0.8, 0.3, 0)), placed(), placed(two @ one, (0, 0, 0.4))]
    scene = stage([rubble(60), rubble(40, seed=1)], light(), places, [0, 1, 1, 0])
    compare(device, scene, *rays(1500, 2.0))


@pytest.mark.parametrize("scale", [1e-5, 1e-2, 1e3, 1e6])
def test_tiny_and_huge(device, scale):
    scene = stage([rubble(100)], light(), [placed(scale * TURN)])
    compare(device, scene, *(scale * ends for ends in rays(1000)))


def test_one_among_many_instances(device):
    """A thousand, which lie close to one another: the tree over them has ten levels."""
    random = np.random.default_rng(5)
    places = [placed(0.1 * TURN, offset) for offset in random.uniform(-1, 1, (1000, 3))]
    scene = stage([rubble(3)], light(), places, np.zeros(1000, int))
    compare(device, scene, *rays(500))


def test_far_from_the_worlds_origin(device):
    """Triangles about 1e4 m away from their mesh's origin, brought back by the matrix: none is lost."""
    mesh = rubble(100)
    far = replace(mesh, positions=mesh.positions + np.float32(1e4))
    compare(device, stage([far], light(), [placed(offset=(-1e4,) * 3)]), *rays(1000))


@pytest.mark.parametrize("axis", range(3))
def test_rays_along_axes(device, axis):
    """Not a component of them is anything but zero, in the world and in a turned instance; boxes have no thickness."""
    plates = [quad((-1, -1, z), (2, 0, 0), (0, 2, 0)) for z in (-0.4, 0.1, 0.5)]
    turns = [np.roll(np.eye(3), axis + 1, 0), np.diag([0.3, 0.3, 1.0])]
    scene = stage(plates, light(), [placed(turns[0]), placed(turns[0]), placed(turns[0] @ turns[1])])
    starts, _ = rays(600, 1.4)
    ends = starts.copy()
    ends[:, axis] = np.random.default_rng(1).uniform(-1.4, 1.4, 600)
    compare(device, scene, starts, ends)


@pytest.mark.parametrize("axis", range(3))
def test_rays_along_axes_through_the_lines_between_triangles(device, axis):
    """Where boxes begin and end, too, to the last bit: a closed wall has no gap."""
    wall = subdivided_box((-1, -1, -1), (1, 1, 1), 8)
    across = np.linspace(-0.75, 0.75, 7)
    starts = np.stack(np.meshgrid([2.0], across, across), -1).reshape(-1, 3)
    starts = np.roll(starts, axis, 1)
    ends = np.where(np.arange(3) == axis, 0.0, starts)
    scene = stage([wall], light())
    assert occluded(device, scene, starts, ends).all()
    assert not occluded(device, scene, starts, np.where(np.arange(3) == axis, 1.25, starts)).any()


def test_a_triangle_is_not_in_its_own_way(device):
    """Rays that start on triangles, a hair behind them: those miss their own, and no other."""
    places = [placed(TURN, (0.5, 0, 0)), placed(SHEAR), placed(-np.eye(3), (0, 0.5, 0))]
    scene = stage([rubble(40), rubble(30, seed=1)], light(), places, [1, 0, 1])
    triangles = reference.world_triangles(scene, np.ones(3, bool))
    first, rows = np.array([40, 0, 40]), np.array([1, 0, 2])  # of the meshes; of the instances, sorted by mesh
    counts = np.array([30, 40, 30])
    instance = np.repeat(np.arange(3), counts)
    orders = [build_blas(mesh).order for mesh in (scene.meshes[1], scene.meshes[0], scene.meshes[1])]
    number = np.concatenate([np.argsort(order) + first[k] for k, order in enumerate(orders)])
    _, ends = rays(len(triangles), 2.0)
    starts = triangles.mean(1)
    starts -= 1e-3 * (ends - starts)
    with_own = occluded(device, scene, starts, ends)
    ours = occluded(device, scene, starts, ends, np.column_stack([number, rows[instance]]))
    others = np.zeros(len(triangles), bool)
    sure = np.zeros(len(triangles), bool)
    for k in range(len(triangles)):
        rest = np.delete(triangles, k, 0)
        distance = reference.crossings(starts[k : k + 1], (ends - starts)[k : k + 1], rest)
        others[k] = (distance < 1.0).any()
        sure[k] = not (np.abs(distance - 1.0) < 1e-3).any()
    assert with_own.all()
    assert 0.1 < others.mean() < 0.9
    assert (ours[sure] == others[sure]).mean() > 0.98, "more than the rays along an edge"


def test_the_same_triangle_of_another_instance_is_in_the_way(device):
    plate = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    scene = stage([plate], light(), [placed(), placed(offset=(0, 0, 0.5))], [0, 0])
    start, end = np.array([[0.3, -0.2, -1e-4]]), np.array([[0.3, -0.2, 1.0]])
    assert occluded(device, scene, start, end, np.array([[0.0, 0.0]]))
    low = np.array([[0.3, -0.2, 0.2]])
    assert not occluded(device, scene, start, low, np.array([[0.0, 0.0]]))
    assert occluded(device, scene, start, low, np.array([[0.0, 1.0]]))


def test_what_casts_no_shadow_is_in_nobodys_way(device):
    scene = stage([rubble(80), rubble(80, seed=1)], light())
    ghost = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([False, True])))
    compare(device, ghost, *rays(1000))


def moved(scene):
    """The last instance elsewhere."""
    matrices = scene.instances.world_from_object.copy()
    matrices[-1, :3, 3] += 0.1
    return replace(scene, instances=replace(scene.instances, world_from_object=matrices))


def test_moving_an_instance_uploads_little_and_keeps_the_trees(device):
    scene, view = stage([rubble(5000), rubble(10, seed=1)], light()), look((3.0, -3.0, 2.0))
    first = draw(device, scene, view)
    trees, textures = first.renderer.graph[BLAS], first.renderer.graph[TLAS]
    second = draw(device, moved(scene), view, renderer=first.renderer)
    assert first.profile.counts["bytes_uploaded"] > 32 * 5000
    assert second.profile.counts["bytes_uploaded"] < 2000
    assert second.profile.rows["BuildBLAS"].drawn == 0
    assert second.renderer.graph[BLAS] is trees
    assert second.renderer.graph[TLAS]["blas_leaf_starts"] is textures["blas_leaf_starts"]
    assert second.renderer.graph[TLAS]["casters"] is not textures["casters"]


def test_a_mesh_that_did_not_change_keeps_its_tree(device):
    still, changing = rubble(500), rubble(300, seed=1)
    first = draw(device, stage([still, changing], light()), look((3.0, -3.0, 2.0)))
    before = first.renderer.graph[BLAS].trees
    draw(device, stage([rubble(300, seed=2), still], light()), look((3.0, -3.0, 2.0)), renderer=first.renderer)
    after = first.renderer.graph[BLAS].trees
    assert after[1] is before[0]
    assert after[0] is not before[1]


def test_instances_may_become_many(device):
    """After a picture of one."""
    view, mesh = look((3.0, -3.0, 2.0)), rubble(3)
    one = draw(device, stage([mesh], light()), view)
    random = np.random.default_rng(0)
    count = 4106
    places = [placed(0.05 * np.eye(3), offset) for offset in random.uniform(-1, 1, (count, 3))]
    many = stage([mesh], light(), places, np.zeros(count, int))
    fresh = draw(device, many, view).color
    assert np.array_equal(draw(device, many, view, renderer=one.renderer).color, fresh)
