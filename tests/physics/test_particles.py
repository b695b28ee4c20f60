"""A quantity that each particle carries is declared once: here, and a run sorts, remeshes, exchanges and saves it."""

from __future__ import annotations

import numpy as np
import pytest
from situations import DAM_BREAK, run, simulation

from houle.flow.particles import Column, Particles
from houle.flow.transfer import Fmpm

SALT = Column("salt", "water")
COLOUR = Column("colour", "water", (4,), 0.5)  # wider than a vector
RIVER = {
    "case": {"name": "river"},
    "domain": {"size": [0.8, 0.24], "spacing": 0.02},
    "water": [{"below": 0.151, "velocity": [0.3, 0.0]}],
    "open": [{"side": "left", "velocity": 0.3}, {"side": "right", "level": 0.151}],
    "time": {"end": 10.0},
}


@pytest.fixture
def salted(monkeypatch):
    """Makes simulations whose particles carry salt and colour; at the start as the height of the water is."""
    monkeypatch.setattr(Fmpm, "columns", lambda self, dimension: (SALT, COLOUR))

    def make(case, **overrides):
        sim = simulation(case, **overrides)
        p = sim.particles
        p["salt"][...] = 1.0 + p.position[:, 0]
        p["colour"][...] = p["salt"][:, None] * [1.0, 2.0, 3.0, 4.0]
        return sim

    return make


def amount(sim, name="salt"):
    """Volume times value, summed over the particles."""
    return sim.particles.volume @ sim.particles[name]


def test_it_stays_with_its_particle_where_particles_are_only_sorted(salted):
    """Without remeshing each particle keeps its own, however the particles are ordered."""
    sim = salted(DAM_BREAK, numerics__remesh="none")
    before = np.sort(sim.particles["salt"] + 1j * sim.particles.volume)
    run(sim, 20)
    p = sim.particles
    assert np.array_equal(np.sort(p["salt"] + 1j * p.volume), before)
    assert np.array_equal(p["colour"][:, 3], 4.0 * p["salt"])


def test_remeshing_conserves_its_amount_and_keeps_what_is_constant(salted):
    """To round-off, and every component as the first."""
    sim = salted(DAM_BREAK)
    sim.particles["colour"][:, 3] = 7.0
    salt, count = amount(sim), 0
    for _ in range(30):
        run(sim, 1)
        count += sim.step.remeshing.count == 0
    assert count > 2
    assert amount(sim) == pytest.approx(salt, rel=1e-13)
    np.testing.assert_allclose(sim.particles["colour"][:, 1], 2.0 * sim.particles["salt"], rtol=1e-12)
    np.testing.assert_allclose(sim.particles["colour"][:, 3], 7.0, rtol=1e-12)


def test_open_sides_let_in_what_is_new_and_take_out_what_is_there(salted):
    """Water without salt washes a channel: what is left and what went out add up to what there was."""
    sim = salted(RIVER)
    sim.particles["salt"][...], sim.particles["colour"][...] = 1.0, 0.5
    before = amount(sim)
    run(sim, 10_000, until=1.0)
    ledger, p = sim.ledger, sim.particles
    assert ledger.inflow > 0.25 * ledger.volume0
    assert amount(sim) + ledger.outflow == pytest.approx(before, rel=1e-12)  # only the first water has gone so far
    assert np.abs(p["salt"][p.position[:, 0] < 0.1]).max() < 1e-3  # between the two waters M4' overshoots
    np.testing.assert_allclose(p["salt"][p.position[:, 0] > 0.7], 1.0, atol=1e-3)
    np.testing.assert_allclose(p["colour"], 0.5, rtol=1e-12)


@pytest.mark.parametrize("case", [DAM_BREAK, RIVER])
def test_it_is_saved_and_a_run_that_goes_on_has_the_same_to_the_last_bit(salted, case):
    whole = run(salted(case), 11)
    state = {key: np.array(value) for key, value in whole.state().items()}
    again = salted(case)
    again.restore(state)
    run(whole, 9), run(again, 9)
    for name in ("salt", "colour"):
        assert again.particles[name].tobytes() == whole.particles[name].tobytes()


def test_it_stays_when_the_flow_gets_more_rows_of_cells(salted):
    """Water that shoots up a wall: the flow is built anew on a higher grid, of the same particles."""
    case = {**DAM_BREAK, "domain": {"size": [0.4, 0.9], "spacing": 0.02}, "water": [{"box": [[0.0, 0.0], [0.2, 0.3]]}]}
    sim = salted({**case, "porous": [], "fluid": {"gravity": 30.0}})
    salt, rows = amount(sim), sim.flow.grid.shape[-1]
    while sim.flow.grid.shape[-1] == rows:
        run(sim, 1)
        assert sim.time < 1.0
    assert amount(sim) == pytest.approx(salt, rel=1e-13)


@pytest.mark.parametrize("case", [DAM_BREAK, RIVER])
def test_what_is_read_from_the_medium_is_known_at_every_particle(salted, case):
    """After steps with remeshing and exchange: bulk volume V/n and inertia where there are pores, no others."""
    p = run(salted(case), 12).particles
    assert sorted(p.of_kind("place")) == (["bulk", "inertia"] if "porous" in case else [])
    assert all(np.isfinite(p[name]).all() and len(p[name]) == len(p) for name in p.declared)


# ---- the columns themselves ------------------------------------------------------------------------------------------


def some(count=6):
    """Particles with a column of each kind, numbered."""
    x = np.arange(2.0 * count).reshape(count, 2)
    p = Particles(x, -x, np.arange(1.0, count + 1.0))
    p.declare(SALT, Column("slope", "grid", (2, 2)), Column("pores", "place", new=np.nan, dtype=np.float32))
    for name in p.declared:
        p[name][...] = np.arange(count).reshape(count, *(1,) * (p[name].ndim - 1))
    return p


def test_select_takes_all_columns_along():
    for chosen in ([False, True] * 3, [5, 0, 3]):
        part = some().select(np.array(chosen))
        numbers = np.arange(6)[chosen]
        assert np.array_equal(part.volume, 1.0 + numbers)
        for name in part.declared:
            assert np.array_equal(part[name].reshape(len(part), -1)[:, 0], numbers)


def test_what_is_appended_has_what_it_is_given_or_what_is_new():
    more = some().append(np.zeros((2, 2)), np.zeros((2, 2)), np.ones(2), salt=np.array([8.0, 9.0]))
    assert np.array_equal(more["salt"], [0, 1, 2, 3, 4, 5, 8, 9])
    assert not more["slope"][6:].any() and np.isnan(more["pores"][6:]).all() and more["pores"].dtype == np.float32


def test_water_that_joins_mixes_what_belongs_to_the_water():
    p = some()
    p.join(np.array([2]), np.array([[10.0, 10.0]]), np.zeros((1, 2)), np.array([3.0]), salt=np.array([4.0]))
    assert p.volume[2] == 6.0 and p["salt"][2] == 3.0 and p["slope"][2, 0, 0] == 2.0
    assert np.array_equal(p.position[2], [7.0, 7.5])


def test_a_name_is_given_once():
    p = some()
    p.declare(SALT)
    assert p["salt"].any()  # the same declaration a second time changes nothing
    for other in (Column("salt", "grid"), Column("volume", "water")):
        with pytest.raises(ValueError, match="another column"):
            p.declare(other)
