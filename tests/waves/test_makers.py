"""The source pushes with the gradient of a potential: no curl, in whatever direction and to whichever side."""

import numpy as np
import pytest

from houle.boundary.internal_source import FiniteSource, InternalSource, make_source
from houle.case.acting import source_of
from houle.case.tables.waves import Waves
from houle.case.wave import make
from houle.grid import Grid
from houle.waves.wave import WaveError


def make_maker(table, wave, grid):
    """The force of a source, as a run makes it."""
    return make_source(source_of(table, wave), table.kind, wave, grid, table.ramp_time(), table.current)


TABLE = {"kind": "regular", "height": 0.02, "period": 1.2, "depth": 0.25}


@pytest.mark.parametrize("side", ["both", "left", "right"])
@pytest.mark.parametrize(
    ("wave", "kind"), [({}, FiniteSource), ({"theory": "airy"}, InternalSource), ({"kind": "jonswap"}, InternalSource)]
)
def test_the_push_of_an_oblique_wave_has_no_curl(side, wave, kind):
    def worst(n):
        grid = Grid((n, n, 2), (4.0 / n, 1.0 / n, 0.1), (False, True, False))
        table = Waves.model_validate(
            TABLE | wave | {"direction": 30.0, "ramp": 0.0, "source": {"x": 2.0, "width": 1.0, "side": side}}
        )
        maker = make_maker(table, make(table), grid)
        assert isinstance(maker, kind)
        force = grid.faces()
        maker.push(0.37, force)
        fx, fy = force[0][1:-1, :, 0], force[1][:, :, 0]
        along_y = np.diff(fx, axis=1) / grid.spacing[1]
        along_x = np.diff(fy[:, 1 : fx.shape[1]], axis=0) / grid.spacing[0]
        return np.abs(along_y - along_x).max() / np.abs(along_y).max()

    coarse, fine = worst(80), worst(160)
    assert fine < 5e-3 and coarse / fine == pytest.approx(4.0, rel=0.1)  # second order in the spacing


def test_a_source_does_not_take_what_is_no_oscillation(tmp_path):
    grid = Grid((80, 4), (0.05, 0.05), (False, False))
    time = np.arange(0.0, 40.0, 0.1)
    rows = [f"{t:.1f},{-0.02 * np.exp(-(((t - 20.0) / 5.0) ** 2)):.6f}\n" for t in time]
    (tmp_path / "ship.csv").write_text("t_s,eta_m\n" + "".join(rows))  # drawdown: its mean is not 0
    source = {"depth": 0.25, "source": {"x": 2.0, "width": 1.0}}
    for table, words in (
        ({"kind": "series", "file": "ship.csv", **source}, "mean of the record"),
        ({"kind": "solitary", "height": 0.05, **source}, "no sum of cosines"),
    ):
        waves = Waves.model_validate(table)
        with pytest.raises(WaveError, match=words):
            make_maker(waves, make(waves, folder=tmp_path), grid)


def test_waves_along_x_are_not_pushed_along_y():
    grid = Grid((80, 4, 2), (0.05, 0.05, 0.1), (False, True, False))
    table = Waves.model_validate(TABLE | {"ramp": 0.0, "source": {"x": 2.0, "width": 1.0}})
    force = grid.faces()
    make_maker(table, make(table), grid).push(0.37, force)
    assert np.abs(force[0]).max() > 0 and not force[1].any() and not force[2].any()
