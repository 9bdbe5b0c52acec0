# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as SVG, log–log, in panels side by side. The same numbers give the same bytes, so that tests can compare."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

#: px. A panel's plot area, and the space around it for numbers and titles.
WIDTH, HEIGHT = 230, 170
LEFT, RIGHT, TOP, BOTTOM = 62, 14, 26, 44
#: px of the line of names below all panels.
LEGEND = 30
#: On an axis, more would lie on one another.
MOST_TICKS = 6
COLORS = ("#ee6677", "#4477aa", "#66ccee", "#ccbb44", "#228833", "#aa3377", "#999999")

Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Panel:
    """One plot: curves by name, and what its axes are."""

    title: str
    across: str
    up: str
    curves: Mapping[str, Points]


@dataclass(frozen=True)
class Axis:
    """A logarithmic axis of so many px."""

    low: float
    high: float
    length: float

    def at(self, value: float) -> float:
        return self.length * math.log(value / self.low) / math.log(self.high / self.low)

    def ticks(self) -> list[float]:
        """1, 2 and 5 times powers of ten; powers alone where these are many."""
        exponents = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        powers = [10.0**exponent for exponent in exponents]
        fine = [k * power for power in powers for k in (1, 2, 5)]
        within, of_powers = ([tick for tick in ticks if self.low <= tick <= self.high] for ticks in (fine, powers))
        return within if len(within) <= MOST_TICKS else of_powers


def axis(values: list[float], length: float) -> Axis:
    """Room for all values, which are positive, and a little more."""
    return Axis(min(values) / 1.15, max(values) * 1.15, length)


def number(tick: float) -> str:
    """20k, 1M"""
    for unit, letter in ((1e6, "M"), (1e3, "k")):
        if tick >= unit:
            return f"{tick / unit:g}{letter}"
    return f"{tick:g}"


def svg(panels: Sequence[Panel], columns: int) -> str:
    """All panels, each with axes of its own, and one legend."""
    names = list(dict.fromkeys(name for panel in panels for name in panel.curves))
    colors = dict(zip(names, COLORS, strict=False))
    rows = -(-len(panels) // columns)
    width, height = LEFT + WIDTH + RIGHT, TOP + HEIGHT + BOTTOM
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width * columns} {height * rows + LEGEND}" '
        f'width="{width * columns}" font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for number, panel in enumerate(panels):
        x, y = width * (number % columns) + LEFT, height * (number // columns) + TOP
        lines += [f'<g transform="translate({x},{y})">', *drawn(panel, colors), "</g>"]
    step = width * columns / max(len(names), 1)
    for number, name in enumerate(names):
        x, y = step * number + 16, height * rows + 12
        lines.append(f'<path d="M{x:.0f} {y}h22" stroke="{colors[name]}" stroke-width="2"/>')
        lines.append(f'<text x="{x + 28:.0f}" y="{y + 4}">{escape(name)}</text>')
    return "\n".join([*lines, "</svg>", ""])


def drawn(panel: Panel, colors: Mapping[str, str]) -> Iterator[str]:
    """One panel, its corner at 0, 0."""
    points = [(x, y) for curve in panel.curves.values() for x, y in curve]
    across, up = axis([x for x, _ in points], WIDTH), axis([y for _, y in points], HEIGHT)
    yield f'<text x="{WIDTH / 2:.0f}" y="-9" text-anchor="middle" font-weight="bold">{escape(panel.title)}</text>'
    for tick in across.ticks():
        x = across.at(tick)
        yield f'<path d="M{x:.1f} 0V{HEIGHT}" stroke="#ddd"/>'
        yield f'<text x="{x:.1f}" y="{HEIGHT + 15}" text-anchor="middle">{number(tick)}</text>'
    for tick in up.ticks():
        y = HEIGHT - up.at(tick)
        yield f'<path d="M0 {y:.1f}H{WIDTH}" stroke="#ddd"/>'
        yield f'<text x="-5" y="{y + 4:.1f}" text-anchor="end">{number(tick)}</text>'
    yield f'<rect width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>'
    yield f'<text x="{WIDTH / 2:.0f}" y="{HEIGHT + 31}" text-anchor="middle">{escape(panel.across)}</text>'
    upright = f"translate(-48,{HEIGHT / 2:.0f}) rotate(-90)"
    yield f'<text transform="{upright}" text-anchor="middle">{escape(panel.up)}</text>'
    for name, curve in panel.curves.items():
        path = " ".join(f"{across.at(x):.1f},{HEIGHT - up.at(y):.1f}" for x, y in curve)
        yield f'<polyline points="{path}" fill="none" stroke="{colors[name]}" stroke-width="1.8"/>'
        for x, y in curve:
            yield f'<circle cx="{across.at(x):.1f}" cy="{HEIGHT - up.at(y):.1f}" r="2.4" fill="{colors[name]}"/>'
