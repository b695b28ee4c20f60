"""Stands in for houle.flow.simulation: a tank that sloshes as one body, cheap, and sensitive to every bit of its state.

Its step size follows from the velocities, so that a step that is longer or shorter by a hair changes all that follows.
Environment of the tests that run it in a process of its own: FAKE_PAUSE = seconds of sleep per step, FAKE_FAIL = the
step that fails ("7" with SimulationError, "7!" with an error that nobody foresaw).
"""

from __future__ import annotations

import os
import time as clock
from typing import ClassVar

import numpy as np

from houle.errors import SimulationError
from houle.flow.particles import Particles
from houle.flow.snapshot import Snapshot

CASE = {
    "case": {"name": "tank"},
    "domain": {"size": [0.4, 0.2], "spacing": 0.02},
    "water": [{"box": [[0.0, 0.0], [0.2, 0.1]]}],
    "gauge": [{"x": 0.1}, {"x": 0.3}],
    "sensor": [{"at": [0.1, 0.05]}],
    "time": {"end": 0.5},
    "output": {"every": 0.1, "series_every": 0.007},
}


class Simulation:
    volume_drift = 0.0
    lag: ClassVar[dict[str, float]] = {"velocity": 0.5, "pressure": 1.0}

    def __init__(self, setup, threads=None):
        self.setup, self.grid = setup, setup.grid
        x, z = np.meshgrid(np.arange(0.005, 0.2, 0.01), np.arange(0.005, 0.1, 0.01))
        position = np.stack([x.ravel(), z.ravel()], axis=1)
        volume = np.full(len(position), self.grid.cell_volume / 4)
        self.particles = Particles(position, 0.1 + position.copy(), volume)
        self.time, self.steps, self.timings = 0.0, 0, {"sloshing": 0.0}
        self.step_size = 0.0
        self.fail = os.environ.get("FAKE_FAIL", "")

    def advance(self, stop):
        begin = clock.perf_counter()
        clock.sleep(float(os.environ.get("FAKE_PAUSE", "0")))
        if self.fail.startswith(str(self.steps + 1)):
            if self.fail.endswith("!"):
                raise ZeroDivisionError("nobody foresaw this")
            raise SimulationError(
                "the velocity is not finite", step=self.steps + 1, time=self.time, place=(0.07, 0.09),
                diagnosis="The tank was pushed over.",
            )  # fmt: skip
        p = self.particles
        dt = 0.2 * self.grid.spacing[0] / np.abs(p.velocity).max()
        if self.time + dt >= stop:
            dt, self.time = stop - self.time, stop
        else:
            self.time += dt
        self.step_size = dt
        p.velocity -= dt * 40.0 * (p.position - [0.1, 0.05])
        p.position += dt * p.velocity
        self.steps += 1
        self.timings["sloshing"] += clock.perf_counter() - begin

    def sample(self):
        p = self.particles
        return {
            "eta": np.array([p.position[:, 1].max(), np.nan]),
            "pressure": np.array([p.position.sum()]),
            "velocity": p.velocity[:1].copy(),
            "kinetic_energy": float(0.5 * np.sum(p.volume[:, None] * p.velocity**2)),
            "energy_forces": float(p.velocity.mean()),
        }

    def frame(self):
        g, p = self.grid, self.particles
        eta = np.where(g.axis_points(0) < 0.2, p.position[:, 1].max(), np.nan)
        ones = np.ones(len(p))
        return Snapshot(
            self.time, self.steps, p.position.copy(), p.velocity.copy(), p.volume.copy(), ones, ones,
            g.cells(), g.cells(), np.zeros((*g.shape, 2)), g.cells(1.0), eta,
        )  # fmt: skip

    def state(self):
        p = self.particles
        return {
            "flow/particles/position": p.position.copy(), "flow/particles/velocity": p.velocity.copy(),
            "flow/particles/volume": p.volume.copy(), "flow/time": np.float64(self.time), "steps": np.int64(self.steps),
        }  # fmt: skip

    def restore(self, state):
        names = ("position", "velocity", "volume")
        self.particles = Particles(*(state[f"flow/particles/{name}"].copy() for name in names))
        self.time, self.steps = float(state["flow/time"]), int(state["steps"])
