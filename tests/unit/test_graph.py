# SPDX-License-Identifier: GPL-3.0-or-later
"""The graph: passes exchange only resources that they declare, and are executed when their inputs have changed."""

import pytest

from ism_addon import resources
from ism_addon.gpu.estimators import DIRECT, OCCLUSION, SEEN_WORLD
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
    passes = *OCCLUSION.pass_types, *direct.pass_types, *SEEN_WORLD.pass_types
    return [*UPLOAD, *SURFACES, *SELECTION, *passes, *FILM, Resolve, EstimateError]


class Undeclared(Pass):
    """A pass that declares nothing. It executes the function `act`."""

    def execute(self, frame: Frame) -> None:
        self.act(frame)


class Declared(Undeclared):
    """The same with declared inputs, feedback and outputs."""

    inputs = (DEPTH, Change.SAMPLE)
    feedback = (MEAN_LUMINANCE,)
    outputs = outputs(TILES)


@pytest.fixture
def execute(device):
    """execute(pass_type, act, sample=0): what `act` returns for the frame that a pass of this class gets."""
    renderer, _ = first_frame(device, box_over_plane(24, 16)[0])
    drawn = draw(device, *box_over_plane(24, 16), renderer=renderer)

    def execute(pass_type: type[Pass], act, sample: int = 0) -> list:
        results = []
        frame = drawn.renderer.frame(*box_over_plane(24, 16), SMALL_SETTINGS, sample, Profile())
        renderer.graph.instance(pass_type).act = lambda own: results.append(act(own))
        renderer.graph.step(pass_type, frame, Profile())
        return results

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
def test_a_pass_can_neither_read_nor_write_undeclared_resources(execute, act):
    with pytest.raises(UndeclaredResourceError, match=r"Declared has not declared (normal|depth|mean_luminance)"):
        execute(Declared, act)


def test_a_pass_can_read_declared_resources(execute):
    (depth,) = execute(Declared, lambda frame: frame[DEPTH])
    assert depth.components == 1
    with pytest.raises(UndeclaredResourceError, match="Undeclared has not declared depth"):
        execute(Undeclared, lambda frame: frame[DEPTH])


def test_feedback_exists_from_the_second_sample_on(execute):
    with pytest.raises(UndeclaredResourceError, match="Declared reads mean_luminance before the first picture"):
        execute(Declared, lambda frame: frame[MEAN_LUMINANCE])
    assert len(execute(Declared, lambda frame: frame.get(MEAN_LUMINANCE), sample=1)) == 1


def test_a_uniform_that_no_source_declares_is_an_error(device):
    draw(device, *box_over_plane(24, 16))
    program = next(iter(device.programs.values()))
    with pytest.raises(UndeclaredUniformError, match="no source of the program declares the uniform nonsense"):
        bind(program, nonsense=1.0)


@pytest.mark.parametrize("direct", DIRECT.values(), ids=[method.label for method in DIRECT])
def test_each_resource_is_written_by_one_pass_before_others_read_it(direct):
    writers: dict[Resource, type[Pass]] = {ATLAS_BATCH: Pass}
    pass_types = plan(direct)
    for pass_type in pass_types:
        for each in pass_type.inputs:
            if isinstance(each, Resource) and each not in writers:
                all_outputs = {output for other in pass_types for output in other.outputs}
                assert each not in all_outputs, f"{pass_type.__name__} reads {each} before it is written: feedback"
        for output in pass_type.outputs:
            assert output not in writers, f"{pass_type.__name__} and {writers.get(output)} both write {output}"
            writers[output] = pass_type
    write_index = {}
    for index, pass_type in enumerate(pass_types):
        write_index |= dict.fromkeys(pass_type.outputs, index)
    for index, pass_type in enumerate(pass_types):
        name = pass_type.__name__
        for each in pass_type.feedback:
            assert each.lifetime is Lifetime.PICTURE, f"{each} is feedback of {name} and must live as long as a picture"
            assert write_index.get(each, len(pass_types)) > index, f"{each} is an input of {name}, not feedback"


def test_every_resource_is_written_and_read():
    written = {output for each in PASSES for output in each.outputs} | {ATLAS_BATCH}
    read = {item for each in PASSES for item in (*each.inputs, *each.feedback) if isinstance(item, Resource)}
    unread = {output for each in PASSES for output in each.outputs if output not in read}
    per_light = {"probe", "prediction", "ray_count", "irradiance_ratio"}
    assert {each.name for each in set(RESOURCES.values()) - written} == per_light
    assert read <= written
    #: Read by their own pass only, by the renderer, read back for the user, or read through a channel.
    assert {each.name for each in unread & set(RESOURCES.values())} == {
        *("tile_variance", "retest_candidates"),
        *("tile_min", "tile_max", "tile_normal_cone", "far_tile_min", "far_tile_max", "far_tile_normal_cone"),
        *("all_probes", "lights_used", "neighbour_mean", "signal_and_noise", "half_samples_image"),
        "doubling_difference",
        "emission_contrast",
        "subsample_emission",
        "baked_emission",
        *("filtered_once", "occlusion_image"),
    }


def test_a_resources_name_is_that_of_its_constant():
    names = {
        value: name for name, value in (vars(resources.world) | vars(resources)).items() if isinstance(value, Resource)
    }
    assert all(names[each] == each.name.upper() for each in RESOURCES.values())
    assert all(each.of in RESOURCES.values() for each in RESOURCES.values() if isinstance(each, Channel))


def test_a_picture_keeps_no_state_of_the_previous_one(device):
    """State that samples accumulate is reset: drawing another picture in between changes nothing."""
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


def test_targets_describe_their_texel_format():
    targets = [each for each in RESOURCES.values() if isinstance(each, Target)]
    formats = {target.format: (target.components, target.dtype) for target in targets}
    assert formats == {
        "r8": (1, "f1"),
        "rgba32ui": (4, "u4"),
        "r16f": (1, "f2"),
        "r32f": (1, "f4"),
        "rg16f": (2, "f2"),
        "rg32f": (2, "f4"),
        "r32ui": (1, "u4"),
        "rg32ui": (2, "u4"),
        "rg8": (2, "f1"),
        "rgba16f": (4, "f2"),
        "rgba32f": (4, "f4"),
        "depth32f": (1, "f4"),
    }
