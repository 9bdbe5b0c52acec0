# SPDX-License-Identifier: GPL-3.0-or-later
"""Which passes are executed, and what each resource holds.

A pass has a recipe: its inputs, each by what stands for what it holds. As long as that is what it was, the pass is not
executed again. Resources are compared by numbers: what holds the same has the same number. Compare the frame graph of
O'Donnell 2017, whose passes declare likewise what they read and make.
"""

import itertools
import time
from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from ..resource_types import Channel, Resource, Target
from ..scene import Change
from ..settings import Settings
from .frame import Frame, Input, Pass
from .gl import frame_uniforms
from .gl.context import Device
from .gl.errors import Cancelled
from .gl.render_targets import RenderTargets, size_of
from .profile import Profile

T = TypeVar("T")
Recipe = dict[Any, object]


class Graph:
    """Of one renderer."""

    def __init__(self, device: Device):
        self.device = device
        self.targets = RenderTargets(device.gl)
        self.held: dict[Resource[Any], Any] = {}
        self.passes: dict[type[Pass], Pass] = {}
        #: Of each pass, when it was last executed or left out.
        self.recipes: dict[type[Pass], Recipe] = {}
        #: Of resources: the same number where they hold the same.
        self.numbers: dict[Resource[Any], int] = {}
        #: Of each output, for the newest first sample that it was made for: its part of the recipe, and its number.
        self.first_samples: dict[Resource[Any], tuple[Recipe, int]] = {}
        self.fresh = itertools.count(1)

    def __getitem__(self, resource: Resource[T]) -> T:
        """What a resource holds. Raises KeyError where no pass has made it."""
        held: Any = None
        if isinstance(resource, Channel):
            held = self.targets[resource.of]
        else:
            held = self.targets[resource] if isinstance(resource, Target) else self.held[resource]
        return held

    def __setitem__(self, resource: Resource[T], content: T) -> None:
        self.held[resource] = content

    def get(self, resource: Resource[T]) -> T | None:
        """The same of what is no target, or None where no pass has made it."""
        held: T | None = self.held.get(resource)
        return held

    def instance(self, kind: type[Pass]) -> Pass:
        """The pass of this class."""
        if kind not in self.passes:
            self.passes[kind] = kind(self.device)
        return self.passes[kind]

    def begin(self, kinds: Iterable[type[Pass]]) -> None:
        """A picture begins that these passes may be executed for: free what others have made."""
        kinds = set(kinds)
        made = {output for kind in kinds for output in kind.outputs}
        for kind in self.recipes.keys() - kinds:
            del self.recipes[kind], self.passes[kind]
            self.drop(output for output in kind.outputs if output not in made)
            for output in kind.outputs:
                self.first_samples.pop(output, None)
                self.numbers.pop(output, None)

    def run(self, kinds: Iterable[type[Pass]], frame: Frame, profile: Profile) -> Iterator[str]:
        """Execute those that are due and have new inputs; yields the name of each when it has been submitted."""
        for kind in kinds:
            self.step(kind, frame, profile)
            yield kind.__name__

    def step(self, kind: type[Pass], frame: Frame, profile: Profile) -> None:
        """Execute a pass, reuse what it made, or leave it out. Raises Cancelled."""
        step, row = self.instance(kind), profile.rows[kind.__name__]
        own = frame.for_pass(step)
        needed = step.needed(own)
        recipe = self.recipe(kind, frame) if needed else {}
        # What a first sample left is kept: the next picture may use it again.
        due = kind.schedule.is_due(frame.sample) and (needed or frame.sample == 0)
        may_reuse = frame.settings.shortcuts or frame.sample > 0 or not needed
        if may_reuse and kind in self.recipes and (not due or self.recipes[kind] == recipe):
            row.reused, row.skipped = row.reused + needed, row.skipped + (not needed)
            return
        start = time.perf_counter()
        if needed:
            self.prepare(kind, frame)
            # Another renderer may have drawn since the last pass.
            frame.uniforms.bind_to_uniform_block(frame_uniforms.BINDING)
            try:
                step.execute(own)
            except Cancelled:
                self.abandon()
                raise
            frame.submission.end_pass(row, start)
        else:
            self.drop(kind.outputs)
        row.drawn, row.skipped = row.drawn + needed, row.skipped + (not needed)
        self.recipes[kind] = recipe
        for output, exclusive in kind.outputs.items():
            others = {each for inputs in kind.outputs.values() for each in inputs} - set(exclusive)
            self.identify(output, {key: value for key, value in recipe.items() if key not in others}, frame.sample)

    def prepare(self, kind: type[Pass], frame: Frame) -> None:
        """Allocate a pass's targets, and let neutral texels stand for those that it reads and no pass has made."""
        for output in kind.outputs:
            if isinstance(output, Target) and output.divisor:
                self.targets.allocate(output, size_of(output, *frame.size))
        for resource in (*kind.inputs, *(kind.feedback if frame.sample > 0 else ())):
            target = resource.of if isinstance(resource, Channel) else resource
            if isinstance(target, Target):
                self.targets.ensure(target)

    def recipe(self, kind: type[Pass], frame: Frame) -> Recipe:
        """All that a pass depends on: equal as long as what it made last still holds."""
        sized = any(isinstance(output, Target) and output.divisor for output in kind.outputs)
        return {each: self.identity(each, frame) for each in kind.inputs} | ({"size": frame.size} if sized else {})

    def identity(self, each: Input, frame: Frame) -> object:
        """What stands for what an input holds."""
        if isinstance(each, Change):
            return frame.value_of(each)
        if isinstance(each, Resource):
            return self.held.get(each) if each.by_value else self.numbers.get(each, 0)
        return setting(frame.settings, each)

    def identify(self, output: Resource[Any], recipe: Recipe, sample: int) -> None:
        """Number what a pass has made. What a first sample makes depends on the recipe alone."""
        if sample > 0:
            self.numbers[output] = next(self.fresh)
            return
        if self.first_samples.get(output, (None, 0))[0] != recipe:
            self.first_samples[output] = recipe, next(self.fresh)
        self.numbers[output] = self.first_samples[output][1]

    def drop(self, resources: Iterable[Resource[Any]]) -> None:
        """Free what resources hold."""
        resources = list(resources)
        self.targets.release(each for each in resources if isinstance(each, Target))
        for each in resources:
            self.held.pop(each, None)

    def abandon(self) -> None:
        """Keep no targets: one may be half drawn, or half added to. Passes make all else as the last that they do."""
        for kind in self.passes:
            targets = [output for output in kind.outputs if isinstance(output, Target)]
            if targets:
                self.recipes.pop(kind, None)
            for target in kind.outputs if targets else ():
                self.first_samples.pop(target, None)

    def release(self) -> None:
        """Free all."""
        self.targets.release()
        self.held.clear()


def setting(settings: Settings, path: str) -> object:
    """The setting, or section of settings, that a path such as "shadow.bias" names."""
    value: object = settings
    for name in path.split("."):
        value = getattr(value, name)
    return value
