# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays through the BVH against all triangles in float64, and which of it is reused and uploaded."""

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
from tests.support.rays import assert_agree, occluded, random_rays, reference_occlusion
from tests.support.small_scenes import draw, light, look_at, make_scene, quad, random_triangles, transform

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
ROTATION = np.array([[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


@pytest.mark.parametrize("count", [1, 2, 3, 5, 16, 17, 200, 1500])
def test_random_triangles(device, count):
    assert_agree(
        device, make_scene([random_triangles(count, size=0.3 if count > 100 else 3.0)], light()), *random_rays(1500)
    )


def test_enough_triangles_for_parallel_sorting(device):
    scene = make_scene([random_triangles(MIN_PARALLEL_SIZE + 100, size=0.02)], light())
    assert_agree(device, scene, *random_rays(200, 1.2))


def test_deeper_than_eight_levels_of_four(device):
    """One level deeper than one word of the traversal state can hold."""
    scene = make_scene([random_triangles(4**9 + 1, size=0.01)], light())
    assert_agree(device, scene, *random_rays(60, 1.2))


def test_long_thin_triangles(device):
    """Triangles a thousand times as long as wide, whose bounding boxes are mostly empty."""
    random = np.random.default_rng(3)
    blades = [quad(random.uniform(-1, 1, 3), 1e-3 * random.normal(size=3), random.normal(size=3)) for _ in range(60)]
    starts, ends = random_rays(6000)
    ours = occluded(device, make_scene(blades, light()), starts, ends)
    expected, certain = reference_occlusion(make_scene(blades, light()), starts, ends, 1e-3)
    assert expected.sum() > 20
    assert np.array_equal(ours[certain], expected[certain])


def test_a_triangle_is_packed_into_two_texels_without_loss():
    """Corners up to the ends of the quantization grid, and all bits of material indices."""
    random = np.random.default_rng(0)
    corners = random.integers(-GRID_EXTENT, GRID_EXTENT, (1000, 3, 3), np.int32, endpoint=True)
    corners[0], corners[1], corners[2] = -GRID_EXTENT, GRID_EXTENT, -1
    materials = random.integers(0, 1 << 28, 1000, np.uint32)
    materials[:2] = 0, (1 << 28) - 1
    words = packed_corners(list(np.ascontiguousarray(corners.reshape(-1, 9).T)), materials)
    lower = ((words & 127).astype(np.int64) << np.array([0, 7, 14, 21] * 2)).reshape(-1, 2, 4).sum(2)
    upper = words.view(np.int32) >> 7
    last = (lower[:, 0] ^ 1 << 27) - (1 << 27)  # sign-extended from 28 bits
    assert np.array_equal(np.column_stack([upper, last]).reshape(-1, 3, 3), corners)
    assert np.array_equal(lower[:, 1], materials)


MATRICES = {
    "turned": [ROTATION, 0.7 * ROTATION @ ROTATION],
    "mirrored": [np.diag([-1.0, 1.0, 1.0]), -ROTATION],
    "sheared": [SHEAR, SHEAR.T @ ROTATION],
    "stretched": [np.diag([1.0, 0.05, 2.0]), np.diag([3.0, 1.0, 0.3]) @ ROTATION],
    "flattened": [np.diag([1.0, 1.0, 0.0]), ROTATION @ np.diag([1.0, 0.0, 1.0])],
}


@pytest.mark.parametrize("transformation", MATRICES)
def test_instances(device, transformation):
    """Two instances each of two meshes, some of which intersect."""
    one, two = MATRICES[transformation]
    matrices = [
        transform(one, (-0.5, 0, 0)),
        transform(two, (0.8, 0.3, 0)),
        transform(),
        transform(two @ one, (0, 0, 0.4)),
    ]
    scene = make_scene([random_triangles(60), random_triangles(40, seed=1)], light(), matrices, [0, 1, 1, 0])
    assert_agree(device, scene, *random_rays(1500, 2.0))


@pytest.mark.parametrize("scale", [1e-5, 1e-2, 1e3, 1e6])
def test_tiny_and_huge_scenes(device, scale):
    scene = make_scene([random_triangles(100)], light(), [transform(scale * ROTATION)])
    assert_agree(device, scene, *(scale * ends for ends in random_rays(1000)))


def test_many_instances(device):
    """A thousand close to one another: the TLAS has ten levels."""
    random = np.random.default_rng(5)
    matrices = [transform(0.1 * ROTATION, offset) for offset in random.uniform(-1, 1, (1000, 3))]
    scene = make_scene([random_triangles(3)], light(), matrices, np.zeros(1000, int))
    assert_agree(device, scene, *random_rays(500))


def test_far_from_the_worlds_origin(device):
    """Triangles about 1e4 m away from their mesh's origin, moved back by the instance's matrix."""
    mesh = random_triangles(100)
    far = replace(mesh, positions=mesh.positions + np.float32(1e4))
    assert_agree(device, make_scene([far], light(), [transform(offset=(-1e4,) * 3)]), *random_rays(1000))


@pytest.mark.parametrize("axis", range(3))
def test_rays_along_axes(device, axis):
    """Two components are zero, in world space and in a rotated instance; the plates' boxes have no thickness."""
    plates = [quad((-1, -1, z), (2, 0, 0), (0, 2, 0)) for z in (-0.4, 0.1, 0.5)]
    rotation, scale = np.roll(np.eye(3), axis + 1, 0), np.diag([0.3, 0.3, 1.0])
    scene = make_scene(plates, light(), [transform(rotation), transform(rotation), transform(rotation @ scale)])
    starts, _ = random_rays(600, 1.4)
    ends = starts.copy()
    ends[:, axis] = np.random.default_rng(1).uniform(-1.4, 1.4, 600)
    assert_agree(device, scene, starts, ends)


@pytest.mark.parametrize("axis", range(3))
def test_rays_along_axes_through_edges_between_triangles(device, axis):
    """These are also the exact bounds of boxes. A closed wall has no gap."""
    wall = subdivided_box((-1, -1, -1), (1, 1, 1), 8)
    across = np.linspace(-0.75, 0.75, 7)
    starts = np.stack(np.meshgrid([2.0], across, across), -1).reshape(-1, 3)
    starts = np.roll(starts, axis, 1)
    ends = np.where(np.arange(3) == axis, 0.0, starts)
    scene = make_scene([wall], light())
    assert occluded(device, scene, starts, ends).all()
    assert not occluded(device, scene, starts, np.where(np.arange(3) == axis, 1.25, starts)).any()


def test_a_triangle_does_not_occlude_its_own_rays(device):
    """Rays that start slightly behind a triangle ignore that triangle and no other."""
    matrices = [transform(ROTATION, (0.5, 0, 0)), transform(SHEAR), transform(-np.eye(3), (0, 0.5, 0))]
    scene = make_scene([random_triangles(40), random_triangles(30, seed=1)], light(), matrices, [1, 0, 1])
    triangles = reference.world_triangles(scene, np.ones(3, bool))
    first, rows = np.array([40, 0, 40]), np.array([1, 0, 2])  # first triangle by mesh; row of instances sorted by mesh
    counts = np.array([30, 40, 30])
    instance = np.repeat(np.arange(3), counts)
    orders = [build_blas(mesh).order for mesh in (scene.meshes[1], scene.meshes[0], scene.meshes[1])]
    index = np.concatenate([np.argsort(order) + first[k] for k, order in enumerate(orders)])
    _, ends = random_rays(len(triangles), 2.0)
    starts = triangles.mean(1)
    starts -= 1e-3 * (ends - starts)
    with_own = occluded(device, scene, starts, ends)
    ours = occluded(device, scene, starts, ends, np.column_stack([index, rows[instance]]))
    others = np.zeros(len(triangles), bool)
    certain = np.zeros(len(triangles), bool)
    for k in range(len(triangles)):
        rest = np.delete(triangles, k, 0)
        distance = reference.intersections(starts[k : k + 1], (ends - starts)[k : k + 1], rest)
        others[k] = (distance < 1.0).any()
        certain[k] = not (np.abs(distance - 1.0) < 1e-3).any()
    assert with_own.all()
    assert 0.1 < others.mean() < 0.9
    assert (ours[certain] == others[certain]).mean() > 0.98, "more differ than the few rays through an edge"


def test_the_same_triangle_of_another_instance_occludes(device):
    plate = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    scene = make_scene([plate], light(), [transform(), transform(offset=(0, 0, 0.5))], [0, 0])
    start, end = np.array([[0.3, -0.2, -1e-4]]), np.array([[0.3, -0.2, 1.0]])
    assert occluded(device, scene, start, end, np.array([[0.0, 0.0]]))
    low = np.array([[0.3, -0.2, 0.2]])
    assert not occluded(device, scene, start, low, np.array([[0.0, 0.0]]))
    assert occluded(device, scene, start, low, np.array([[0.0, 1.0]]))


def test_instances_that_cast_no_shadow_occlude_nothing(device):
    scene = make_scene([random_triangles(80), random_triangles(80, seed=1)], light())
    one_casts = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([False, True])))
    assert_agree(device, one_casts, *random_rays(1000))


def moved(scene):
    """The scene with the last instance moved by 0.1 m along each axis."""
    matrices = scene.instances.world_from_object.copy()
    matrices[-1, :3, 3] += 0.1
    return replace(scene, instances=replace(scene.instances, world_from_object=matrices))


def test_moving_an_instance_uploads_little_and_keeps_the_blas(device):
    scene, view = make_scene([random_triangles(5000), random_triangles(10, seed=1)], light()), look_at((3.0, -3.0, 2.0))
    first = draw(device, scene, view)
    blas, tlas = first.renderer.graph[BLAS], first.renderer.graph[TLAS]
    second = draw(device, moved(scene), view, renderer=first.renderer)
    assert first.profile.counts["bytes_uploaded"] > 32 * 5000
    assert second.profile.counts["bytes_uploaded"] < 2000
    assert second.profile.rows["BuildBLAS"].drawn == 0
    assert second.renderer.graph[BLAS] is blas
    assert second.renderer.graph[TLAS]["blas_nodes"] is tlas["blas_nodes"]
    assert second.profile.rows["BuildTLAS"].drawn == 1


def test_an_unchanged_mesh_keeps_its_blas(device):
    still, changing = random_triangles(500), random_triangles(300, seed=1)
    first = draw(device, make_scene([still, changing], light()), look_at((3.0, -3.0, 2.0)))
    before = first.renderer.graph[BLAS].blases
    draw(
        device,
        make_scene([random_triangles(300, seed=2), still], light()),
        look_at((3.0, -3.0, 2.0)),
        renderer=first.renderer,
    )
    after = first.renderer.graph[BLAS].blases
    assert after[1] is before[0]
    assert after[0] is not before[1]


def test_a_picture_of_many_instances_after_one_of_one(device):
    """The renderer's buffers grow; the picture is that of a new renderer."""
    view, mesh = look_at((3.0, -3.0, 2.0)), random_triangles(3)
    one = draw(device, make_scene([mesh], light()), view)
    random = np.random.default_rng(0)
    count = 4106
    matrices = [transform(0.05 * np.eye(3), offset) for offset in random.uniform(-1, 1, (count, 3))]
    many = make_scene([mesh], light(), matrices, np.zeros(count, int))
    expected = draw(device, many, view).color
    assert np.array_equal(draw(device, many, view, renderer=one.renderer).color, expected)
