"""Where a particle meets one medium only, sampling it takes no sums over faces and cells, and gives the same."""

import numpy as np
import pytest
import shapely

from houle import _core
from houle.grid import Grid
from houle.medium.medium import Medium
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box, Polygon

ROCK = {"porosity": 0.45, "a": 300.0, "inertia": 1.4}
PLANE = Grid((40, 30), (0.1, 0.1), (False, False))
WRAPPED = Grid((40, 30), (0.1, 0.1), (True, False))
SPACE = Grid((24, 5, 22), (0.1, 0.1, 0.1), (False, True, False))
SLOPE = Polygon(shapely.Polygon([(1.0, 0.0), (4.0, 0.0), (4.0, 3.0)]), 2)
WALL = Box((2.6, 0.0), (2.9, 1.0))


@pytest.mark.parametrize(
    ("grid", "bodies", "solids"),
    [
        (PLANE, [PorousBody("rock", Box((2.0, 0.0), (4.0, 3.0)), **ROCK)], []),
        (PLANE, [PorousBody("rock", SLOPE, **ROCK)], [WALL]),
        (WRAPPED, [PorousBody("rock", Box((2.03, 0.0), (4.0, 1.47)), **ROCK)], [WALL]),
        (PLANE, [PorousBody("all", Box((0.0, 0.0), (4.0, 3.0)), **ROCK)], [WALL]),
        (SPACE, [PorousBody("rock", Box((1.2, 0.13, 0.0), (2.4, 0.41, 1.0)), **ROCK)], []),
    ],
)
def test_one_medium_is_sampled_as_several(grid, bodies, solids):
    medium = Medium.build(grid, bodies, solids)
    x = np.random.default_rng(1).uniform(size=(20_000, grid.dimension)) * grid.size
    volume = np.full(len(x), 0.3)

    def sample(uniform):
        bulk, inertia = np.zeros(len(x)), np.zeros(x.shape, np.float32)
        fields = [(medium.kind, uniform), (medium.kind, uniform), medium.listed("particle_porosity")]
        table = (medium.material, medium.materials)
        _core.sample_medium(grid.core, *table, *fields, x, volume, bulk, inertia, medium.interfaces)
        return bulk, inertia

    uniform = medium.kinds["uniform"]
    cells = uniform[medium.kind]
    assert 0.1 < np.mean(cells > 0.0) < 1.0
    assert set(np.unique(cells)) <= {0.0, 1.0, 1.4 / 0.45}
    for short, long in zip(sample(uniform), sample(np.zeros_like(uniform)), strict=True):
        assert short == pytest.approx(long, rel=1e-7 if long.dtype == np.float32 else 1e-14)
