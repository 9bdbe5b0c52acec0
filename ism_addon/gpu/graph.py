# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame graph: executes passes, and keeps the contents of resources (compare O'Donnell 2017).

The recipe of a pass is the tuple of the identities of its inputs. While the recipe is unchanged, the pass is not
executed again. The identity of a resource is a number, the same for the same contents.
"""

import itertools
import time
from collections.abc import Iterable, Iterator
from operator import attrgetter
from typing import Any, TypeVar

from ..resource_types import Channel, Resource, Target
from ..scene import Change
from .frame import Frame, Input, Pass
from .gl import frame_uniforms
from .gl.context import Device
from .gl.errors import Cancelled
from .gl.render_targets import RenderTargets, size_of
from .profile import PassProfile, Profile

T = TypeVar("T")
Recipe = tuple[object, ...]


class Graph:
    """The frame graph of one renderer."""

    def __init__(self, device: Device):
        self.device = device
        self.targets = RenderTargets(device.gl)
        self.scene_records = device.scene_records()
        self.contents: dict[Resource[Any], Any] = {}
        self.passes: dict[type[Pass], Pass] = {}
        #: Recipe of each pass when it was last executed; () if it was skipped.
        self.recipes: dict[type[Pass], Recipe] = {}
        #: Identity of each resource.
        self.identities: dict[Resource[Any], int] = {}
        #: Of each output in the latest first picture: the identities of the inputs it depends on, and its identity.
        self.first_samples: dict[Resource[Any], tuple[Recipe, int]] = {}
        self.new_identities = itertools.count(1)

    def __getitem__(self, resource: Resource[T]) -> T:
        """The contents of a resource. Raises KeyError if no pass has made it."""
        contents: Any = None
        if isinstance(resource, Channel):
            contents = self.targets[resource.of]
        else:
            contents = self.targets[resource] if isinstance(resource, Target) else self.contents[resource]
        return contents

    def __setitem__(self, resource: Resource[T], content: T) -> None:
        self.contents[resource] = content

    def get(self, resource: Resource[T]) -> T | None:
        """The contents of a resource that is not a target, or None if no pass has made it."""
        contents: T | None = self.contents.get(resource)
        return contents

    def instance(self, pass_type: type[Pass]) -> Pass:
        """The pass of this class."""
        if pass_type not in self.passes:
            self.passes[pass_type] = pass_type(self.device)
        return self.passes[pass_type]

    def begin(self, pass_types: Iterable[type[Pass]]) -> None:
        """Begin an image that needs only these passes: free the outputs of all others."""
        pass_types = set(pass_types)
        needed = {output for pass_type in pass_types for output in pass_type.outputs}
        for pass_type in self.recipes.keys() - pass_types:
            del self.recipes[pass_type], self.passes[pass_type]
            self.drop(output for output in pass_type.outputs if output not in needed)
            for output in pass_type.outputs:
                self.first_samples.pop(output, None)
                self.identities.pop(output, None)

    def run(self, pass_types: Iterable[type[Pass]], frame: Frame, profile: Profile) -> Iterator[str]:
        """Execute passes; yields the name of each after it."""
        for pass_type in pass_types:
            self.step(pass_type, frame, profile)
            yield pass_type.__name__

    def step(self, pass_type: type[Pass], frame: Frame, profile: Profile) -> None:
        """Execute a pass, reuse its outputs, or skip it. Raises Cancelled."""
        frame.step = self.instance(pass_type)
        try:
            self._step(frame.step, frame, profile.rows[pass_type.__name__])
        finally:
            frame.step = None

    def _step(self, step: Pass, frame: Frame, row: PassProfile) -> None:
        pass_type, is_due = type(step), step.schedule.is_due(frame.sample)
        if not is_due and pass_type in self.recipes:
            needed = bool(self.recipes[pass_type])
            row.reused, row.skipped = row.reused + needed, row.skipped + (not needed)
            return
        needed = step.needed(frame)
        # Outputs of a first sample are kept: the next image may reuse them.
        due = is_due and (needed or frame.sample == 0)
        may_reuse = pass_type in self.recipes and (frame.settings.shortcuts or frame.sample > 0 or not needed)
        recipe = self.recipe(pass_type, frame) if needed and (due or not may_reuse) else ()
        if may_reuse and (not due or self.recipes[pass_type] == recipe):
            row.reused, row.skipped = row.reused + needed, row.skipped + (not needed)
            return
        start = time.perf_counter()
        if needed:
            self.prepare(pass_type, frame)
            # Another renderer may have bound its own uniforms since the last pass.
            frame.uniforms.bind_to_uniform_block(frame_uniforms.BINDING)
            try:
                step.execute(frame)
            except Cancelled:
                self.abandon()
                raise
            frame.submission.end_pass(row, start)
        else:
            self.drop(step.outputs)
        row.drawn, row.skipped = row.drawn + needed, row.skipped + (not needed)
        self.recipes[pass_type] = recipe
        for output, unrelated in step.unrelated.items():
            related = recipe
            if unrelated:
                related = tuple(value for index, value in enumerate(recipe) if index not in unrelated)
            self.identify(output, related, is_first=not frame.corrects)

    def prepare(self, pass_type: type[Pass], frame: Frame) -> None:
        """Allocate a pass's targets, and neutral textures for targets that it reads but that no pass has made."""
        for target in pass_type.sized_outputs:
            self.targets.allocate(target, size_of(target, *frame.size))
        for target in pass_type.read_targets + (pass_type.feedback_targets if frame.corrects else ()):
            self.targets.ensure(target)

    def recipe(self, pass_type: type[Pass], frame: Frame) -> Recipe:
        """The identities of all inputs of a pass: equal while its outputs are still valid."""
        if frame.sample > 0 and pass_type.differs_each_sample:
            return (object(),)  # each sample differs from all others; looking up all identities would take time
        size = frame.size if pass_type.sized_outputs else None
        return (*(self.identity(each, frame) for each in pass_type.inputs), size)

    def identity(self, each: Input, frame: Frame) -> object:
        """A value that identifies the contents of an input."""
        if isinstance(each, Change):
            return frame.states[each]
        if isinstance(each, Resource):
            return self.contents.get(each) if each.by_value else self.identities.get(each, 0)
        return attrgetter(each)(frame.settings)

    def identify(self, output: Resource[Any], recipe: Recipe, is_first: bool) -> None:
        """Give an output its identity. In a first picture, the same recipe gives the same identity."""
        if not is_first:
            self.identities[output] = next(self.new_identities)
            return
        if output not in self.first_samples or self.first_samples[output][0] != recipe:
            self.first_samples[output] = recipe, next(self.new_identities)
        self.identities[output] = self.first_samples[output][1]

    def drop(self, resources: Iterable[Resource[Any]]) -> None:
        """Free the contents of resources."""
        resources = list(resources)
        self.targets.release(each for each in resources if isinstance(each, Target))
        for each in resources:
            self.contents.pop(each, None)

    def abandon(self) -> None:
        """Invalidate all targets: one may be incomplete. Other outputs are stored last, so they are complete."""
        for pass_type in self.passes:
            targets = [output for output in pass_type.outputs if isinstance(output, Target)]
            if targets:
                self.recipes.pop(pass_type, None)
            for target in pass_type.outputs if targets else ():
                self.first_samples.pop(target, None)

    def release(self) -> None:
        """Free all contents."""
        self.targets.release()
        self.contents.clear()
