# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of an image: how often each pass was executed, how long that took, and counts."""

import math
from collections import defaultdict
from dataclasses import asdict, dataclass, field

from ..scene import Scene

#: Counts of an image, in addition to the statistics of its passes.
COUNTS = (
    *("triangles_drawn", "pixels_drawn", "lights_used", "pairs_traced", "occlusion_rays", "retests"),
    *("virtual_lights", "map_points", "bytes_uploaded", "render_target_bytes"),
)


@dataclass
class PassProfile:
    """Statistics of a pass."""

    drawn: int = 0
    reused: int = 0
    skipped: int = 0
    ms: float = 0.0


@dataclass
class Profile:
    """Statistics of one image so far."""

    rows: defaultdict[str, PassProfile] = field(default_factory=lambda: defaultdict(PassProfile))
    counts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(COUNTS, 0))
    warnings: set[str] = field(default_factory=set)  # sentences about what could not be drawn

    def statistics(self, scene: Scene, samples: int, seconds: float, error: float, stopped_by: str) -> dict:
        """As plain values, for scripts. `error`: see convergence.py; `stopped_by`: see render_loop.py."""
        return {
            "passes": {name: asdict(row) for name, row in self.rows.items()},
            **self.counts,
            "triangles": scene.triangle_count,
            "samples": samples,
            "seconds": seconds,
            "error": error,
            "stopped_by": stopped_by,
        }


def table(statistics: dict) -> str:
    """Statistics as text: a line for each pass, and one of counts."""
    lines = [f"{'pass':<16}{'drawn':>7}{'reused':>8}{'skipped':>9}{'ms':>11}"]
    for name, row in statistics["passes"].items():
        lines.append(f"{name:<16}{row['drawn']:>7}{row['reused']:>8}{row['skipped']:>9}{row['ms']:>11.1f}")
    names = [name for name in ("samples", *COUNTS, "triangles") if statistics[name]]
    counted = (f"{statistics[name]:,} {name.replace('_', ' ')}" for name in names)
    end = f"{statistics['seconds']:.2f} s, stopped by {statistics['stopped_by']}"
    if math.isfinite(statistics["error"]):
        end += f", estimated error {100.0 * statistics['error']:.2f} % of the mean brightness"
    return "\n".join([*lines, " · ".join(counted), end])
