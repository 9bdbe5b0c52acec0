# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: renders a snapshot without Blender. python -m ism_addon.gpu scene.npz -o out.png"""

import argparse
import signal
import sys
from collections.abc import Callable
from dataclasses import Field, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import render_passes, snapshot
from ..atomic_files import atomic_write
from ..choices import Choice, DebugView
from ..render_passes import COMBINED, RenderPass
from ..scene import View
from ..setting_limits import beyond_limits, images_beyond_limits, view_beyond_limits
from ..settings import SECTIONS, Settings
from ..settings.setting_fields import Control, help_text, setting_fields
from .jobs.job import Job, Picture, Request
from .jobs.png import display_from_linear, write_png
from .jobs.render_thread import RenderThread
from .profile import table


def parser() -> argparse.ArgumentParser:
    """The command line: a flag for each setting, made from its label and meaning."""
    line = argparse.ArgumentParser(prog="python -m ism_addon.gpu", description="Render a snapshot of a scene.")
    line.add_argument("snapshot", type=Path, help="an .npz that the add-on or ism_addon.snapshot wrote")
    line.add_argument("-o", "--output", type=Path, default=Path("out.png"), help="the PNG to write (%(default)s)")
    for each in render_passes.RENDER_PASSES:
        line.add_argument(
            f"--output-{each.identifier}",
            dest=each.name,
            type=Path,
            metavar="FILE",
            help=f"an .npy to write the {each.name} pass to: float32, {each.channels}, bottom row first",
        )
    line.add_argument(
        "--size",
        type=size,
        metavar="WIDTHxHEIGHT",
        help="instead of the snapshot's own; the horizontal field of view stays",
    )
    line.add_argument(
        "--show",
        type=choice(DebugView),
        choices=list(DebugView),
        metavar="TARGET",
        help="a render target instead of the render: %(choices)s",
    )
    line.add_argument(
        "--shortcuts",
        action=argparse.BooleanOptionalAction,
        help="skip work that does not change the image; off, to measure what that saves",
    )
    line.add_argument("--profile", action="store_true", help="print statistics, with the time of each pass")
    for name, section in SECTIONS.items():
        group = line.add_argument_group(name)
        for member, control in setting_fields(section):
            add_flag(group, name, member, control)
    return line


def add_flag(group: Any, section: str, member: Field, control: Control) -> None:
    """--shadow-bias 1.0 for a number, --no-shadow-enabled for a switch, --shadow-method SHADOW_MAPS for a choice."""
    flag = "--" + (member.name if section == "quality" else f"{section}_{member.name}").replace("_", "-")
    options: dict = {"type": member.type}
    if member.type is bool:
        options = {"action": argparse.BooleanOptionalAction}
    elif isinstance(member.default, Choice):
        options = {"type": choice(type(member.default)), "choices": list(type(member.default))}
    elif isinstance(member.default, tuple):
        options = {"type": float, "nargs": len(member.default)}
    meaning = help_text(member, control).replace("%", "%%")
    group.add_argument(flag, dest=f"{section}.{member.name}", help=meaning, **options)


def choice(type_: type[Choice]) -> Callable[[str], Choice]:
    """A parser of one of these values, in capitals or not."""
    names = {each.upper(): each for each in type_}

    def choice(text: str) -> Choice:
        if text.upper() not in names:
            raise argparse.ArgumentTypeError(f"{text or 'nothing'} is none of {', '.join(type_)}")
        return names[text.upper()]

    return choice


def size(text: str) -> tuple[int, int]:
    """Width and height of 1280x720."""
    width, _, height = text.lower().partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise argparse.ArgumentTypeError(f"{text or 'nothing'} is not a size, such as 1280x720")
    return int(width), int(height)


def chosen(settings: Settings, options: argparse.Namespace) -> Settings:
    """The snapshot's settings with those of the command line."""
    for name in SECTIONS:
        given = {
            key.removeprefix(f"{name}."): tuple(value) if isinstance(value, list) else value
            for key, value in vars(options).items()
            if key.startswith(f"{name}.") and value is not None
        }
        settings = replace(settings, **{name: replace(getattr(settings, name), **given)})
    shortcuts = settings.shortcuts if options.shortcuts is None else options.shortcuts
    return replace(settings, debug_view=options.show or settings.debug_view, shortcuts=shortcuts)


def outputs(options: argparse.Namespace) -> dict[RenderPass, Path]:
    """Files of the render passes that are written, by pass."""
    files = {each: getattr(options, each.name) for each in render_passes.RENDER_PASSES}
    return {each: file for each, file in files.items() if file}


def resized(view: View, width: int, height: int) -> View:
    """The view at another size, with square pixels and the same horizontal field of view."""
    clip_from_view = view.clip_from_view.copy()
    clip_from_view[1] *= (width / height) / (view.width / view.height)
    return replace(view, clip_from_view=clip_from_view, width=width, height=height)


def draw(request: Request) -> tuple[Picture | None, Job]:
    """Render in a render thread, to the end."""
    thread = RenderThread()
    try:
        job = thread.start(request, "command line")
        while not job.finished:
            job.wait(1.0)
    finally:
        thread.stop()
    return job.picture(), job


def main() -> int:
    """Exit status: 0; 1 with a sentence on stderr if the render failed; after Ctrl+C that of shells."""
    try:
        return run(parser().parse_args())
    except KeyboardInterrupt:
        print("Interrupted.", file=sys.stderr)
        return 128 + signal.SIGINT


def run(options: argparse.Namespace) -> int:
    """Render and write the files: main's exit status."""
    try:
        scene, view, settings = snapshot.load(options.snapshot)
        view = resized(view, *options.size) if options.size else view
        request = Request(scene, view, chosen(settings, options), tuple({COMBINED: None} | outputs(options)))
    except (OSError, ValueError) as reason:
        print(reason, file=sys.stderr)
        return 1
    limited = *images_beyond_limits(scene.images), *view_beyond_limits(request.view), *beyond_limits(request.settings)
    for warning in (*scene.warnings, *limited):
        print(warning, file=sys.stderr)
    picture, job = draw(request)
    if picture is None:
        print(job.error, file=sys.stderr)
        return 1
    for warning in job.warnings:
        print(warning, file=sys.stderr)
    try:
        write_png(options.output, display_from_linear(picture.color))
        for each, path in outputs(options).items():
            with atomic_write(path) as file:
                np.save(file, picture.passes[each.name])
    except OSError as reason:
        print(reason, file=sys.stderr)
        return 1
    if options.profile:
        print(table(job.statistics))
    if job.error:  # the image has fewer samples
        print(job.error, file=sys.stderr)
    return int(bool(job.error))


if __name__ == "__main__":
    sys.exit(main())
