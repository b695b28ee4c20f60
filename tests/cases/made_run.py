"""A made-up run for the tests of what a run writes: case, grid, frames and samples by number."""

import dataclasses

import numpy as np

from houle.case.build import instruments
from houle.case.model import load
from houle.flow.snapshot import Snapshot
from houle.grid import Grid
from houle.output import Outputs, about

SINGLE = 2e-7  # relative rounding of float32, in which fields are stored


def made_case(dimension=2, **tables):
    """A tank with a porous block, gauges and a sensor; tables replace its own."""
    flat = dimension == 2
    block = {"name": "block", "porosity": 0.5, "resistance": {"a": 1.0, "b": 1.0}}
    block["box"] = [[0.3, 0.0], [0.6, 0.2]] if flat else [[0.3, 0.0, 0.0], [0.6, 0.2, 0.2]]
    across = {} if flat else {"y": 0.1}
    return load(
        {
            "case": {"name": "slosh", "title": "Sloshing tank"},
            "domain": {"size": [0.9, 0.3] if flat else [0.9, 0.3, 0.3], "spacing": 0.03},
            "water": [{"below": 0.15}],
            "porous": [block],
            "gauge": [{"name": "G1", "x": 0.2, **across}, {"name": "G2", "x": 0.8, **across}],
            "sensor": [{"name": "P1", "at": [0.45, 0.05] if flat else [0.45, 0.1, 0.05]}],
            "time": {"end": 1.0},
            **tables,
        }
    )


def made_outputs(folder, case, grid):
    """The writers of a run of a made case."""
    return Outputs(folder, grid, [kind.stations for kind in instruments(case)], about(case.identity))


def made_grid(dimension=2):
    return Grid.fit((0.9, 0.3) if dimension == 2 else (0.9, 0.3, 0.3), 0.03)


def made_frame(grid, index):
    """Snapshot number `index`, 0.1 s apart, of a sloshing tank; the number of particles changes from frame to frame."""
    d, t = grid.dimension, 0.1 * index
    level = 0.15 + 0.05 * np.cos(np.pi * grid.points()[..., 0, 0] / 0.9) * np.cos(6 * t)
    rng = np.random.default_rng(index)
    position = rng.uniform(0, grid.size, (2000 + 150 * (index % 3) + 4 * index, d))
    position = position[position[:, -1] < 0.15 + 0.05 * np.cos(np.pi * position[:, 0] / 0.9) * np.cos(6 * t)]
    count = len(position)
    eta = np.where(np.arange(grid.shape[0]) == 2, np.nan, level.T).T
    return Snapshot(
        time=t,
        step=7 * index,
        position=position,
        velocity=rng.normal(size=(count, d)),
        volume=np.full(count, 1e-4),
        porosity=np.where(position[:, 0] > 0.5, 0.5, 1.0),
        pressure=9810 * position[:, -1],
        cell_pressure=rng.uniform(0, 1e3, grid.shape),
        cell_fill=rng.uniform(0, 1, grid.shape),
        cell_velocity=rng.normal(size=(*grid.shape, d)),
        cell_porosity=np.full(grid.shape, 0.7),
        eta=eta,
    )


def made_sample(dimension, index):
    """Row number `index`, 0.025 s apart; the second gauge is dry at first."""
    return {
        "eta": np.array([0.1 + 0.01 * index, np.nan if index < 3 else 0.2]),
        "pressure": np.array([100.0 * index]),
        "velocity": np.full((1, dimension), 0.1 * index),
        "volume": np.asarray(0.13),
        "volume_drift": np.asarray(1e-15 * index),
        "kinetic_energy": np.asarray(5.0 * index),
        "potential_energy": np.asarray(90.0 - index),
        "pressure_iterations": np.asarray(11.0),
    }


def write(outputs, grid, frames, rows):
    """Frames and rows by number, in the order of time as a run hands them over."""
    for index in frames:
        outputs.append_frame(made_frame(grid, index))
    for index in rows:
        outputs.append_series(0.025 * index, made_sample(grid.dimension, index))


def assert_same_frame(got, wanted):
    for field in dataclasses.fields(Snapshot):
        a, b = np.asarray(getattr(got, field.name)), np.asarray(getattr(wanted, field.name))
        assert a.shape == b.shape, field.name
        np.testing.assert_allclose(a, b, rtol=SINGLE, atol=0, err_msg=field.name)
