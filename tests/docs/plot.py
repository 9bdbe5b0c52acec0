# SPDX-License-Identifier: GPL-3.0-or-later
"""Log–log plots as SVG, in a grid of panels. The same numbers give the same bytes, so that tests can compare."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

#: px. A panel's plot area, and the margins around it for numbers and titles.
WIDTH, HEIGHT = 230, 170
LEFT, RIGHT, TOP, BOTTOM = 62, 14, 26, 44
#: px. Height of the legend below all panels.
LEGEND = 30
#: On an axis; labels of more ticks would overlap.
MAX_TICKS = 6
COLORS = ("#ee6677", "#4477aa", "#66ccee", "#ccbb44", "#228833", "#aa3377", "#999999")

Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Panel:
    """One plot: curves by name, and the labels of its axes."""

    title: str
    x_label: str
    y_label: str
    curves: Mapping[str, Points]


@dataclass(frozen=True)
class Axis:
    """A logarithmic axis, `length` px long."""

    low: float
    high: float
    length: float

    def position(self, value: float) -> float:
        """Of a value, in px."""
        return self.length * math.log(value / self.low) / math.log(self.high / self.low)

    def ticks(self) -> list[float]:
        """1, 2 and 5 times powers of ten; only powers of ten if those are too many."""
        exponents = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        powers = [10.0**exponent for exponent in exponents]
        fine = [k * power for power in powers for k in (1, 2, 5)]
        visible, visible_powers = (
            [tick for tick in ticks if self.low <= tick <= self.high] for ticks in (fine, powers)
        )
        return visible if len(visible) <= MAX_TICKS else visible_powers


def axis(values: list[float], length: float) -> Axis:
    """An axis for all values, which are positive, with 15 % more at either end."""
    return Axis(min(values) / 1.15, max(values) * 1.15, length)


def tick_label(tick: float) -> str:
    """A number with a suffix: 20k, 1M."""
    for unit, letter in ((1e6, "M"), (1e3, "k")):
        if tick >= unit:
            return f"{tick / unit:g}{letter}"
    return f"{tick:g}"


def svg(panels: Sequence[Panel], columns: int) -> str:
    """All panels, each with its own axes, and one legend."""
    names = list(dict.fromkeys(name for panel in panels for name in panel.curves))
    colors = dict(zip(names, COLORS, strict=False))
    rows = -(-len(panels) // columns)
    width, height = LEFT + WIDTH + RIGHT, TOP + HEIGHT + BOTTOM
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width * columns} {height * rows + LEGEND}" '
        f'width="{width * columns}" font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for index, panel in enumerate(panels):
        x, y = width * (index % columns) + LEFT, height * (index // columns) + TOP
        lines += [f'<g transform="translate({x},{y})">', *panel_lines(panel, colors), "</g>"]
    step = width * columns / max(len(names), 1)
    for index, name in enumerate(names):
        x, y = step * index + 16, height * rows + 12
        lines.append(f'<path d="M{x:.0f} {y}h22" stroke="{colors[name]}" stroke-width="2"/>')
        lines.append(f'<text x="{x + 28:.0f}" y="{y + 4}">{escape(name)}</text>')
    return "\n".join([*lines, "</svg>", ""])


def panel_lines(panel: Panel, colors: Mapping[str, str]) -> Iterator[str]:
    """The SVG elements of one panel, whose plot area begins at 0, 0."""
    points = [(x, y) for curve in panel.curves.values() for x, y in curve]
    x_axis, y_axis = axis([x for x, _ in points], WIDTH), axis([y for _, y in points], HEIGHT)
    yield f'<text x="{WIDTH / 2:.0f}" y="-9" text-anchor="middle" font-weight="bold">{escape(panel.title)}</text>'
    for tick in x_axis.ticks():
        x = x_axis.position(tick)
        yield f'<path d="M{x:.1f} 0V{HEIGHT}" stroke="#ddd"/>'
        yield f'<text x="{x:.1f}" y="{HEIGHT + 15}" text-anchor="middle">{tick_label(tick)}</text>'
    for tick in y_axis.ticks():
        y = HEIGHT - y_axis.position(tick)
        yield f'<path d="M0 {y:.1f}H{WIDTH}" stroke="#ddd"/>'
        yield f'<text x="-5" y="{y + 4:.1f}" text-anchor="end">{tick_label(tick)}</text>'
    yield f'<rect width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>'
    yield f'<text x="{WIDTH / 2:.0f}" y="{HEIGHT + 31}" text-anchor="middle">{escape(panel.x_label)}</text>'
    transform = f"translate(-48,{HEIGHT / 2:.0f}) rotate(-90)"
    yield f'<text transform="{transform}" text-anchor="middle">{escape(panel.y_label)}</text>'
    for name, curve in panel.curves.items():
        points = [(x_axis.position(x), HEIGHT - y_axis.position(y)) for x, y in curve]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        yield f'<polyline points="{path}" fill="none" stroke="{colors[name]}" stroke-width="1.8"/>'
        for x, y in points:
            yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4" fill="{colors[name]}"/>'
