# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures all engines on one scene, in rounds: each engine runs once a round, so that other load affects all alike."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from .benchmark_scene import BenchmarkScene
from .curve import Point, medians
from .engines import Engine, Missing
from .metrics import errors, noise, resolution


@dataclass
class Result:
    """The results of one scene. Engines are by name."""

    facts: dict[str, float]  # about the scene and its reference
    uncounted: dict[str, dict[str, float]] = field(default_factory=dict)  # times and memory that do not count
    missing: dict[str, str] = field(default_factory=dict)  # why an engine did not run
    rounds: dict[str, list[list[Point]]] = field(default_factory=dict)

    @property
    def curves(self) -> dict[str, list[Point]]:
        """Medians over the rounds, by engine."""
        return {name: medians(rounds) for name, rounds in self.rounds.items()}


def measure(benchmark_scene: BenchmarkScene, engines: Sequence[Engine], rounds: int) -> Result:
    """Start all engines, then measure them in rounds. Each round begins with another engine."""
    result = Result(scene_facts(benchmark_scene))
    running = []
    for engine in engines:
        try:
            result.uncounted[engine.name] = engine.start()
        except Missing as reason:
            result.missing[engine.name] = str(reason)
        else:
            running.append(engine)
            result.rounds[engine.name] = []
    for round in range(rounds):
        first = round % len(running)
        for engine in running[first:] + running[:first]:
            print(f"{benchmark_scene.name}, round {round + 1} of {rounds}: {engine.name}", flush=True)
            points = [
                Point(render.samples, render.seconds, errors(render.picture, benchmark_scene.halves))
                for render in engine.renders(round)
            ]
            result.rounds[engine.name].append(points)
    for engine in running:
        engine.close()
    return result


def scene_facts(benchmark_scene: BenchmarkScene) -> dict[str, float]:
    """The size of the scene, and the noise of its reference."""
    return {
        "triangles": benchmark_scene.scene.triangle_count,
        "instances": len(benchmark_scene.scene.instances.mesh),
        "lights": len(benchmark_scene.scene.lights.shape),
        "mean of the truth": float(benchmark_scene.halves.mean()),
        "noise of the truth": noise(benchmark_scene.halves),
        "resolution of the error": resolution(benchmark_scene.halves),
    }
