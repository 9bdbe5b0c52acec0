# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow rays through the trees against every triangle, in float64; what is kept and what is uploaded."""

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from ism_addon.gpu import mesh_tree as mesh_trees
from ism_addon.gpu.geometry import packed_corners
from ism_addon.gpu.layout import CASTER, WIDTH, upload_array
from ism_addon.gpu.mesh_tree import FEW, mesh_tree
from ism_addon.gpu.passes.trees import InstanceTree, MeshTrees
from ism_addon.gpu.passes.upload import Meshes, Place
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.program import FOLDER, bind, expand, head
from ism_addon.gpu.renderer import Renderer
from ism_addon.gpu.tree import LARGE, REACH

from . import reference
from .scenes.small import grid_triangles, mesh, subdivided_box
from .studio import SMALL_SETTINGS, draw, light, look, placed, quad, rubble, stage

SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
TURN = np.array([[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])

ASK = """
uniform sampler2D starts;
uniform sampler2D ends;
uniform sampler2D owners;
out float told;
void main() {
    ivec2 at = ivec2(gl_VertexID % WIDTH, gl_VertexID / WIDTH);
    vec2 own = texelFetch(owners, at, 0).xy;
    vec3 from = texelFetch(starts, at, 0).xyz, to = texelFetch(ends, at, 0).xyz;
    told = occluded(from, to, int(own.x), int(own.y), -1) ? 1.0 : 0.0;
}
"""


def occluded(device, scene, starts: np.ndarray, ends: np.ndarray, owners: np.ndarray | None = None) -> np.ndarray:
    """(N,) bool: whether the shader finds anything between starts and ends (N,3) but their own triangle, row (N,2)."""
    renderer, view = Renderer(device), look(np.abs(starts).max() * np.array([1.0, -1.0, 1.0]))
    frame = renderer.frame(scene, view, SMALL_SETTINGS, 0, Profile())
    for kind in (MeshTrees, Meshes, Place, InstanceTree):
        renderer.run(kind, frame, Profile())
    owners = np.full((len(starts), 2), -5.0) if owners is None else owners
    shader = "\n".join([head((CASTER,), {}), expand(FOLDER / "lib" / "occluded.glsl", []), ASK])
    program = device.gl.program(vertex_shader=shader, varyings=["told"])
    rays = {"starts": starts - frame.anchor, "ends": ends - frame.anchor, "owners": owners}
    textures = {name: upload_array(device.gl, rows.astype(np.float32), "f4") for name, rows in rays.items()}
    bind(program, **textures, **frame.tables["casters"])
    device.gl.simple_framebuffer((1, 1)).use()
    buffer = device.gl.buffer(reserve=4 * len(starts))
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=len(starts))
    return np.frombuffer(buffer.read(), "f4") > 0.5


def truth(scene, starts: np.ndarray, ends: np.ndarray, doubt: float = 1e-4) -> tuple[np.ndarray, np.ndarray]:
    """(N,) whether any triangle is in the way, and whether that is so by more than rounding: off edges and ends."""
    triangles = reference.world_triangles(scene, scene.instances.casts_shadow)
    found, sure = np.zeros(len(starts), bool), np.zeros(len(starts), bool)
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    for row, (start, end) in enumerate(zip(starts, ends, strict=True)):
        p = np.cross(end - start, v)
        q = np.cross(start - a, u)
        with np.errstate(all="ignore"):
            scale = 1.0 / (u * p).sum(1)
            s, t = ((start - a) * p).sum(1) * scale, (q @ (end - start)) * scale
            at = (v * q).sum(1) * scale
            margin = np.minimum.reduce([s, t, 1.0 - s - t, at, 1.0 - at])
        margin = np.nan_to_num(margin, nan=-1.0)
        found[row] = margin.max() > 0.0
        sure[row] = margin.max() > doubt or margin.max() < -doubt
    return found, sure


def compare(device, scene, starts: np.ndarray, ends: np.ndarray, unsure: float = 0.02) -> None:
    """All rays but those that pass too close to an edge; some are free and some are not."""
    ours = occluded(device, scene, starts, ends)
    expected, sure = truth(scene, starts, ends)
    assert (~sure).mean() <= unsure
    assert 0.01 < expected[sure].mean() < 0.99, "these rays ask nothing"
    wrong = np.flatnonzero(sure & (ours != expected))
    assert not len(wrong), (len(wrong), starts[wrong[0]], ends[wrong[0]], ours[wrong[0]])


def rays(count: int, reach: float = 1.5, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Starts and ends (N,3) anywhere."""
    random = np.random.default_rng(seed)
    return tuple(random.uniform(-reach, reach, (2, count, 3)))


@pytest.mark.parametrize("count", [1, 2, 3, 5, 16, 17, 200, 1500])
def test_random_triangles(device, count):
    compare(device, stage([rubble(count, size=0.3 if count > 100 else 3.0)], light()), *rays(1500))


def test_more_triangles_than_one_thread_sorts(device):
    scene = stage([rubble(LARGE + 100, size=0.02)], light())
    compare(device, scene, *rays(200, 1.2))


def bumps(side: int, order: np.ndarray | None = None):
    """A sheet of 2 side² triangles, row after row, or in another order (side²,) of its quads."""
    line = np.linspace(-1.0, 1.0, side + 1)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.stack([x, y, 0.2 * np.sin(7.0 * x) * np.sin(5.0 * y)], -1).reshape(-1, 3)
    triangles = grid_triangles(side + 1, side + 1).reshape(-1, 2, 3)
    return mesh(points, (triangles if order is None else triangles[order]).reshape(-1, 3))


#: Quads along a sheet's side, so that it is none of the few.
MANY = 261


def test_a_large_mesh_whose_neighbours_lie_together_stays_in_its_order(device):
    sheet = bumps(MANY)
    tree = mesh_tree(sheet)
    assert len(sheet.triangles) > FEW
    assert tree.order is None
    assert tree.per_leaf * len(np.unique(tree.starts)) >= len(sheet.triangles)
    compare(device, stage([sheet, rubble(50, seed=1)], light()), *rays(150))


def test_a_large_mesh_in_no_order_is_sorted(device):
    shuffled = bumps(MANY, np.random.default_rng(0).permutation(MANY**2))
    tree = mesh_tree(shuffled)
    assert np.array_equal(np.sort(tree.order), np.arange(len(shuffled.triangles)))
    compare(device, stage([shuffled], light()), *rays(100))


def test_runs_of_runs_are_taken_together(device, monkeypatch):
    """As with ten million triangles: what is sorted is few, and rays find the same."""
    monkeypatch.setattr(mesh_trees, "MANY", 64)
    sheet = bumps(MANY)
    scene, (starts, ends) = stage([sheet], light()), rays(200)
    grouped, tree = occluded(device, scene, starts, ends), MeshTrees.kept[sheet]
    neighbours = np.diff(tree.starts.astype(int)) == tree.per_leaf
    assert neighbours.sum() > 0.7 * len(np.unique(tree.starts)), "runs of four runs"
    monkeypatch.undo()
    MeshTrees.kept.clear()
    assert np.array_equal(occluded(device, scene, starts, ends), grouped)
    neighbours = np.diff(MeshTrees.kept[sheet].starts.astype(int)) == tree.per_leaf
    assert neighbours.sum() < 0.7 * len(np.unique(tree.starts))


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
    corners = random.integers(-REACH, REACH, (1000, 3, 3), np.int32, endpoint=True)
    corners[0], corners[1], corners[2] = -REACH, REACH, -1
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
    orders = [mesh_tree(mesh).order for mesh in (scene.meshes[1], scene.meshes[0], scene.meshes[1])]
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
    trees, textures = first.renderer.tables["mesh_trees"], first.renderer.tables["casters"]
    second = draw(device, moved(scene), view, renderer=first.renderer)
    assert first.profile.counts["bytes_uploaded"] > 32 * 5000
    assert second.profile.counts["bytes_uploaded"] < 2000
    assert second.profile.rows["MeshTrees"].drawn == 0
    assert second.renderer.tables["mesh_trees"] is trees
    assert second.renderer.tables["casters"]["tree_starts"] is textures["tree_starts"]
    assert second.renderer.tables["casters"]["casters"] is not textures["casters"]


def test_a_mesh_that_did_not_change_keeps_its_tree(device):
    still, changing = rubble(500), rubble(300, seed=1)
    first = draw(device, stage([still, changing], light()), look((3.0, -3.0, 2.0)))
    before = first.renderer.tables["mesh_trees"].trees
    draw(device, stage([rubble(300, seed=2), still], light()), look((3.0, -3.0, 2.0)), renderer=first.renderer)
    after = first.renderer.tables["mesh_trees"].trees
    assert after[1] is before[0]
    assert after[0] is not before[1]


def test_instances_may_outgrow_the_room_before_the_meshes(device):
    """More of them than one line of the texture holds, after a picture of one."""
    view, mesh = look((3.0, -3.0, 2.0)), rubble(3)
    one = draw(device, stage([mesh], light()), view)
    random = np.random.default_rng(0)
    count = WIDTH + 10
    places = [placed(0.05 * np.eye(3), offset) for offset in random.uniform(-1, 1, (count, 3))]
    many = stage([mesh], light(), places, np.zeros(count, int))
    fresh = draw(device, many, view).color
    assert np.array_equal(draw(device, many, view, renderer=one.renderer).color, fresh)
