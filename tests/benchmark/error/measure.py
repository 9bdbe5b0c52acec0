# SPDX-License-Identifier: GPL-3.0-or-later
"""The race on one stage: in each round every engine takes its turn, so that a busy machine is as busy for each."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from .benchmark_scene import BenchmarkScene
from .curve import Point, medians
from .engines import Engine, Missing
from .metrics import errors, noise, resolution


@dataclass
class Result:
    """What came out on one stage; engines by name."""

    facts: dict[str, float]  # of the scene and of its truth
    starts: dict[str, dict[str, float]] = field(default_factory=dict)  # what is not counted
    missing: dict[str, str] = field(default_factory=dict)  # why an engine did not run
    rounds: dict[str, list[list[Point]]] = field(default_factory=dict)

    @property
    def curves(self) -> dict[str, list[Point]]:
        """Medians of the rounds."""
        return {name: medians(rounds) for name, rounds in self.rounds.items()}


def measure(stage: BenchmarkScene, engines: Sequence[Engine], rounds: int) -> Result:
    """Start all engines, then measure them in turns, each round beginning with another one."""
    result = Result(facts_of(stage))
    running = []
    for engine in engines:
        try:
            result.starts[engine.name] = engine.start()
        except Missing as reason:
            result.missing[engine.name] = str(reason)
        else:
            running.append(engine)
            result.rounds[engine.name] = []
    for round in range(rounds):
        first = round % len(running)
        for engine in running[first:] + running[:first]:
            print(f"{stage.name}, round {round + 1} of {rounds}: {engine.name}", flush=True)
            points = [
                Point(shot.samples, shot.seconds, errors(shot.picture, stage.halves)) for shot in engine.shots(round)
            ]
            result.rounds[engine.name].append(points)
    for engine in running:
        engine.close()
    return result


def facts_of(stage: BenchmarkScene) -> dict[str, float]:
    """Size of the scene, and how well its truth is known."""
    return {
        "triangles": stage.scene.triangle_count,
        "instances": len(stage.scene.instances.mesh),
        "lights": len(stage.scene.lights.shape),
        "mean of the truth": float(stage.halves.mean()),
        "noise of the truth": noise(stage.halves),
        "resolution of the error": resolution(stage.halves),
    }
