# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes meet only in resources that they have declared, and are executed when these are new."""

import pytest

from ism_addon import resources
from ism_addon.gpu.estimators import DIRECT, WORLD_LIGHT
from ism_addon.gpu.frame import Frame, Pass, Schedule, UndeclaredResourceError, outputs
from ism_addon.gpu.gl.shader_compiler import UndeclaredUniformError, bind
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import FILM, PASSES, SELECTION, SURFACES, UPLOAD, EstimateError, Resolve
from ism_addon.resource_types import Channel, Lifetime, Resource, Target
from ism_addon.resources import ATLAS_BATCH, DEPTH, MEAN_LUMINANCE, NORMAL, RESOURCES, TILES
from ism_addon.scene import Change
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, first_frame


def plan(direct) -> list[type[Pass]]:
    """All passes of a sample, in order."""
    return [*UPLOAD, *SURFACES, *SELECTION, *direct.pass_types, *WORLD_LIGHT.pass_types, *FILM, Resolve, EstimateError]


class Reads(Pass):
    """Declares nothing, and reads and makes what it is told to."""

    def execute(self, frame: Frame) -> None:
        self.act(frame)


class Told(Reads):
    """Declares what the test needs."""

    inputs = (DEPTH, Change.SAMPLE)
    feedback = (MEAN_LUMINANCE,)
    outputs = outputs(TILES)


@pytest.fixture
def execute(device):
    """execute(kind, act, sample=0): what `act` gives, with the frame that a pass of this class is handed."""
    renderer, _ = first_frame(device, box_over_plane(24, 16)[0])
    drawn = draw(device, *box_over_plane(24, 16), renderer=renderer)

    def execute(kind: type[Pass], act, sample: int = 0) -> list:
        found = []
        frame = drawn.renderer.frame(*box_over_plane(24, 16), SMALL_SETTINGS, sample, Profile())
        renderer.graph.instance(kind).act = lambda own: found.append(act(own))
        renderer.graph.step(kind, frame, Profile())
        return found

    return execute


@pytest.mark.parametrize(
    "act",
    [
        lambda frame: frame[NORMAL],
        lambda frame: frame.get(NORMAL),
        lambda frame: frame.read(NORMAL),
        lambda frame: frame.framebuffer(NORMAL),
        lambda frame: frame.framebuffer(DEPTH),
        lambda frame: frame.allocate(NORMAL, (1, 1)),
        lambda frame: frame.copy_target(DEPTH, NORMAL),
        lambda frame: frame.__setitem__(MEAN_LUMINANCE, 1.0),
    ],
)
def test_what_a_pass_has_not_declared_it_can_neither_read_nor_make(execute, act):
    with pytest.raises(UndeclaredResourceError, match=r"Told has not declared (normal|depth|mean_luminance)"):
        execute(Told, act)


def test_what_it_has_declared_it_can(execute):
    (depth,) = execute(Told, lambda frame: frame[DEPTH])
    assert depth.components == 1
    with pytest.raises(UndeclaredResourceError, match="Reads has not declared depth"):
        execute(Reads, lambda frame: frame[DEPTH])


def test_feedback_is_there_from_the_second_sample_on(execute):
    with pytest.raises(UndeclaredResourceError, match="Told reads mean_luminance before the first sample"):
        execute(Told, lambda frame: frame[MEAN_LUMINANCE])
    assert len(execute(Told, lambda frame: frame.get(MEAN_LUMINANCE), sample=1)) == 1


def test_a_uniform_that_no_source_declares_is_told(device):
    draw(device, *box_over_plane(24, 16))
    program = next(iter(device.programs.values()))
    with pytest.raises(UndeclaredUniformError, match="no source of the program declares the uniform nonsense"):
        bind(program, nonsense=1.0)


@pytest.mark.parametrize("direct", DIRECT.values(), ids=[method.label for method in DIRECT])
def test_each_resource_is_made_by_one_pass_before_others_read_it(direct):
    made: dict[Resource, type[Pass]] = {ATLAS_BATCH: Pass}
    kinds = plan(direct)
    for kind in kinds:
        for each in kind.inputs:
            if isinstance(each, Resource) and each not in made:
                own = {output for other in kinds for output in other.outputs}
                assert each not in own, f"{kind.__name__} reads {each} before it is made: that is feedback"
        for output in kind.outputs:
            assert output not in made, f"{kind.__name__} and {made.get(output)} both make {output}"
            made[output] = kind
    later = {}
    for index, kind in enumerate(kinds):
        later |= dict.fromkeys(kind.outputs, index)
    for index, kind in enumerate(kinds):
        for each in kind.feedback:
            assert each.lifetime is Lifetime.PICTURE, f"{each} is feedback of {kind.__name__}, so state of a picture"
            assert later.get(each, len(kinds)) > index, f"{each} is an input of {kind.__name__}, no feedback"


def test_every_resource_is_made_and_read():
    made = {output for kind in PASSES for output in kind.outputs} | {ATLAS_BATCH}
    read = {each for kind in PASSES for each in (*kind.inputs, *kind.feedback) if isinstance(each, Resource)}
    own = {output for kind in PASSES for output in kind.outputs if output not in read}
    of_one_light = {"probe", "prediction", "ray_count"}
    assert {each.name for each in set(RESOURCES.values()) - made} == of_one_light
    assert read <= made
    #: What only its own pass reads again, what is read back for the user, or through a channel.
    assert {each.name for each in own & set(RESOURCES.values())} == {
        *("visibility_depth", "tile_selection", "tile_variance", "culling_state", "retests", "retest_candidates"),
        *("tile_min", "tile_max", "tile_normal_cone", "far_tile_min", "far_tile_max", "far_tile_normal_cone"),
        *("all_probes", "lights_used", "neighbour_mean", "signal_and_noise", "half_samples_image"),
        "doubling_difference",
    }


def test_resources_are_called_what_the_code_calls_them():
    names = {value: name for name, value in vars(resources).items() if isinstance(value, Resource)}
    assert all(names[each] == each.name.upper() for each in RESOURCES.values())
    assert all(each.of in RESOURCES.values() for each in RESOURCES.values() if isinstance(each, Channel))


def test_a_picture_without_state_of_the_one_before(device):
    """What the samples of a picture build up begins anew: another picture in between changes nothing."""
    scene, view = box_over_plane(24, 16)
    settings = SMALL_SETTINGS
    first = draw(device, scene, view, settings)
    before = first.color
    draw(device, *box_over_plane(32, 16), settings, first.renderer)
    assert (draw(device, scene, view, settings, first.renderer).color == before).all()


@pytest.mark.parametrize(
    ("schedule", "samples"),
    [(Schedule.FIRST, [0]), (Schedule.DOUBLING, [0, 4, 8, 16, 32]), (Schedule.EVERY, list(range(33)))],
)
def test_schedules(schedule, samples):
    assert [sample for sample in range(33) if schedule.is_due(sample)] == samples


def test_targets_say_what_a_texel_is():
    targets = [each for each in RESOURCES.values() if isinstance(each, Target)]
    kinds = {target.format: (target.components, target.dtype) for target in targets}
    assert kinds == {
        "r16f": (1, "f2"),
        "r32f": (1, "f4"),
        "rg16f": (2, "f2"),
        "rg32f": (2, "f4"),
        "rg32ui": (2, "u4"),
        "rg8": (2, "f1"),
        "rgba32f": (4, "f4"),
        "depth32f": (1, "f4"),
    }
