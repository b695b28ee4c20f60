"""Shipped cases are complete and load, their comparisons read runs rightly, and the engine tells the truth."""

import re
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

import houle
from houle import analysis
from houle.case.model import load
from houle.case.reading import shipped
from houle.check.rules import check
from houle.errors import CaseError, SimulationError
from houle.running import runner
from houle.validation import Check, cases, coefficients, comparison, engine, measure, validate
from houle.validation.check import Variant
from houle.validation.exact import column_infiltration
from houle.validation.media import bed_top, medium

NAMED = {  # what the project promises
    "dam-break-rock-35",
    "dam-break-rock-25",
    "dam-break-beads",
    "martin-moyce",
    "hydrostatic-porous",
    "porous-column",
    "standing-wave",
    "spheric-2",
    "wave-flume",
    "piston-flume",
    "wave-block",
    "wave-slope",
    "solitary-wall",
    "solitary-submerged",
    "solitary-paddle",
    "breakwater",
    "beach",
    "bank-ship-wave",
}
RUNS = [(name, v.name, dict(v.overrides)) for name in cases() for v in comparison(name).variants]


def gauges(signal, time, length=1.0, count=10):
    """eta (gauge, time) of a surface 0.25 + signal(t) cos(pi x)."""
    x = (np.arange(count) + 0.5) * length / count
    eta = 0.25 + np.cos(np.pi * x / length)[:, None] * signal[None]
    return xr.DataArray(eta, dims=("gauge", "time"), coords={"gauge_x": ("gauge", x), "time": time})


def test_promised_cases_are_shipped_each_with_a_comparison():
    assert NAMED <= set(shipped()) == set(cases())


@pytest.mark.parametrize("name", cases())
def test_case_says_where_it_comes_from(name):
    folder = engine.FOLDER / name
    assert load(name).case.name == name
    assert len((folder / "README.md").read_text(encoding="utf-8")) > 200
    for data in folder.glob("data/*.csv"):
        head = data.read_text(encoding="utf-8").splitlines()[:8]
        comment = " ".join(line for line in head if line.startswith("#"))
        assert re.search(r"\b(19|20)\d\d\b", comment), "source"
        assert "error" in comment.lower(), "measurement error"


@pytest.mark.parametrize(("name", "variant", "overrides"), RUNS, ids=[f"{n}:{v}" for n, v, _ in RUNS])
def test_every_variant_passes_the_pre_flight(name, variant, overrides):
    case = load(name, overrides=overrides)
    assert not [finding for finding in check(case) if finding.level == "error"]


@pytest.mark.parametrize("name", cases())
def test_variants_have_different_names_and_one_is_quick(name):
    variants = comparison(name).variants
    assert len({v.name for v in variants}) == len(variants)
    assert any(v.quick for v in variants)


def test_check_compares_and_nothing_passes_that_is_not_a_number():
    assert Check("", 1.0, limit=1.0).passed and not Check("", 1.1, limit=1.0).passed
    assert Check("", 2.0, limit=1.0, kind="min").passed and not Check("", 0.9, limit=1.0, kind="min").passed
    assert Check("", 1.0, limit=(0.99, 1.01), kind="range").passed and not Check("", 1.02, limit=(0.99, 1.01)).passed
    assert Check("", 5.0, kind="report").passed
    assert not Check("", float("nan"), limit=1.0).passed and not Check("", float("inf"), kind="report").passed


def test_front_stops_at_the_first_gap_and_ignores_drops_ahead():
    x = np.array([0.5, 1.5, 2.5, 3.5, 4.5])
    eta = xr.DataArray(
        [[1.0, 0.6, 0.2, np.nan, 0.3], [np.nan] * 5, [1.0] * 5], dims=("time", "x"), coords={"x": x, "time": [0, 1, 2]}
    )
    assert measure.front_position(eta, 0.3) == pytest.approx([2.25, 0.0, 4.5])


def test_lowest_water_is_the_underside_of_the_lowest_particle():
    position, volume, porosity = np.array([[0.5, 0.9], [0.5, 0.30]]), np.array([0.02, 0.004]), np.array([1.0, 0.4])
    assert measure.lowest_water(position, volume, porosity, 0.1) == pytest.approx(0.25)


def test_water_left_of_counts_squares_cut_by_the_line_and_their_pores():
    frame = SimpleNamespace(
        position=np.array([[0.5, 0.1], [2.0, 0.1]]), volume=np.array([1.0, 0.5]), porosity=np.array([1.0, 0.5])
    )
    assert measure.water_left_of(np.array([0.0, 0.25, 1.0, 2.0, 3.0]), frame) == pytest.approx([0, 0.25, 1, 1.25, 1.5])


def test_order_of_the_dam_break_is_that_of_water_which_comes_to_its_place_with_the_spacing():
    """A slope of the water shifted by an error that falls fourfold: order 2, in depth and in place."""
    runs = {}
    for name, shift in {"dx-10-mm": 0.016, "": 0.004, "dx-2.5-mm": 0.001}.items():
        x = np.linspace(0.0, 0.892, 100_001)[1:-1]
        depth = 0.2 + 0.1 * np.cos(np.pi * (x + shift) / 0.892)
        frame = SimpleNamespace(
            position=np.stack([x, 0 * x], axis=1), volume=depth * (x[1] - x[0]), porosity=np.full(len(x), 1e6)
        )
        fields = SimpleNamespace(nearest=lambda t: 0, frame=lambda i, frame=frame: frame)
        runs[name] = SimpleNamespace(fields=fields)
    found = {c.name: c for c in comparison("dam-break-rock-35").across(runs)}
    orders = [c.value for name, c in found.items() if name.startswith("order")]
    assert len(orders) == 5 and orders == pytest.approx([2.0] * 5, abs=0.05)
    assert found["order of convergence, water depth"].kind == "min"
    del runs["dx-2.5-mm"]
    assert comparison("dam-break-rock-35").across(runs) == []


def test_fundamental_of_a_pure_wave_with_other_modes_and_a_level():
    time = np.linspace(0.0, 1.0, 11)
    wave = 0.02 * np.cos(3.0 * time)
    eta = gauges(wave, time)
    x = eta.gauge_x.values
    other = 0.01 * np.cos(2 * np.pi * x) + 0.005 * np.cos(5 * np.pi * x)
    assert measure.fundamental(eta + xr.DataArray(other, dims="gauge"), 1.0) == pytest.approx(wave, abs=1e-15)


def test_sliding_amplitude_follows_a_slow_decay():
    time = np.arange(0.0, 14.0, 0.01)
    centres, amplitude = measure.sliding_amplitude(time, np.exp(-0.02 * time) * np.cos(2 * np.pi / 1.4 * time), 1.4)
    assert amplitude == pytest.approx(np.exp(-0.02 * centres), rel=2e-3)


def test_mean_period_counts_zero_crossings():
    time = np.arange(0.0, 14.0, 0.01)
    assert measure.mean_period(time, np.cos(2 * np.pi / 1.3 * time + 0.4)) == pytest.approx(1.3, rel=1e-5)
    assert np.isnan(measure.mean_period(time, np.ones_like(time)))


def test_period_mean_takes_the_ripple_off_a_trend():
    time = np.arange(0.0, 10.0, 0.01)
    smooth = measure.period_mean(2.0 + 0.1 * time + np.cos(2 * np.pi * time), 100.0)
    assert smooth == pytest.approx(2.0 + 0.1 * (time[: len(smooth)] + 0.495))


def test_noise_is_what_lies_above_the_cut():
    time = np.arange(0.0, 2.0, 0.0025)
    slow = 100.0 * np.exp(-time) + 5.0 * np.cos(2 * np.pi * 2.0 * time)
    assert measure.noise(time, slow) < 0.05
    assert measure.noise(time, slow + 3.0 * np.cos(2 * np.pi * 60.0 * time)) == pytest.approx(3 / np.sqrt(2), rel=0.02)


def test_line_is_carried_on_to_the_face():
    x, t = np.array([1.0, 2.0, 4.0]), np.array([0.0, 1.0])
    assert measure.line_at(x, 3.0 + 2.0 * x[:, None] * (1 + t), 5.0) == pytest.approx(3.0 + 10.0 * (1 + t))


def test_observed_order_and_grid_convergence_index():
    spacings = [0.04, 0.02, 0.01]
    assert measure.observed_order(spacings, [3.0 * s**1.7 for s in spacings]) == pytest.approx(1.7)
    assert measure.grid_convergence_index(0.3, 2.0, 2.0) == pytest.approx(1.25 * 0.1)
    assert np.isnan(measure.grid_convergence_index(0.3, 2.0, -0.5))


def test_medium_of_a_case_has_the_coefficients_computed_by_hand():
    case = load("porous-column")
    found = medium(case.porous[0], case.fluid)
    by_hand = 500 * 2.21082 * 1e-6 / 0.0159**2, 2 * (1 + 7.5 / 128) * 4.33494 / 0.0159, 1 + 0.34 * 0.51 / 0.49
    assert (found.a, found.b, found.inertia) == pytest.approx(by_hand, rel=1e-5)
    slope = comparison("porous-column").variants[2]
    assert bed_top(load("porous-column", overrides=dict(slope.overrides)).porous[0]) == pytest.approx(0.45)


def standing_wave(decay=0.0005, stretch=1.0):
    """A run of standing-wave as it should be, or with a decay rate [1/s] or a wrong period."""
    case = load("standing-wave")
    time = np.arange(0.0, case.time.end + 1e-9, 0.01)
    wave = 0.02 * np.exp(-decay * time) * np.cos(2 * np.pi / (1.396157 * stretch) * time)
    ledger = {"kinetic_energy": 0.0, "potential_energy": 1.0, "volume": 0.25, "volume_drift": 0.0, "mean_level": 0.25}
    series = xr.Dataset({k: ("time", np.broadcast_to(v, time.shape)) for k, v in ledger.items()}, {"time": time})
    return SimpleNamespace(case=case, series=series.assign(eta=gauges(wave, time)))


@pytest.mark.parametrize(
    ("wrong", "missed"),
    [
        ({}, []),
        ({"decay": 0.01}, ["amplitude after 10 periods"]),
        ({"decay": -0.001}, ["amplitude after 10 periods", "amplitude, largest"]),
        ({"stretch": 1.004}, ["period error"]),
    ],
)
def test_standing_wave_comparison_sees_loss_growth_and_a_wrong_period(wrong, missed):
    checks = comparison("standing-wave").compare(standing_wave(**wrong))
    assert [c.name for c in checks if not c.passed] == missed


def test_column_comparison_sees_a_wrong_front(tmp_path):
    """Fed with the exact solution it finds no error; with the Darcy velocity taken for the pore velocity it does."""
    case = load("porous-column")
    time = np.arange(0.0, 1.0001, 0.005)
    depth, left, _ = column_infiltration(time, medium(case.porous[0], case.fluid), 0.2)
    errors = []
    for slow in (1.0, 0.49):
        layer = 0.2 - slow * (0.2 - left)
        series = xr.Dataset(
            {
                "eta": (("gauge", "time"), layer[None] + 0.45),
                "volume": ("time", np.full(time.size, 0.01)),
                "volume_drift": ("time", np.zeros(time.size)),
            },
            {"time": time},
        )
        last = np.array([[0.025, 0.45 - slow * depth[-1] + 0.00125]])
        frame = SimpleNamespace(position=last, volume=np.array([0.49 * 0.0025**2]), porosity=np.array([0.49]))
        fields = SimpleNamespace(times=[time[-1]], frame=lambda i, frame=frame: frame)
        run = SimpleNamespace(case=case, series=series, fields=fields, directory=tmp_path)
        errors.append([c.name for c in comparison("porous-column").compare(run) if not c.passed])
    assert not errors[0] and len(errors[1]) == 3


def broken_waves(factor=1.0, transient=0.0):
    """A run of `beach` with heights and levels of the record, and long before the end a transient [m]."""
    case, record = load("beach"), measure.read_points(engine.FOLDER / "beach" / "data" / "heights.csv")
    time = np.arange(0.0, case.time.end + 1e-9, 0.02)
    wave = 0.5 * factor * record["height_m"][:, None] * np.cos(2 * np.pi / case.waves.period * time)
    early = np.where(time < case.time.end - 10 * case.waves.period, transient, 0.0)
    eta = xr.DataArray(case.waves.depth + record["setup_m"][:, None] + wave + early, dims=("gauge", "time"))
    series = xr.Dataset({"eta": eta, "volume_drift": ("time", 0.0 * time)}, {"time": time})
    return SimpleNamespace(case=case, series=series)


@pytest.mark.parametrize("factor", [1.0, 1.1])
def test_beach_comparison_measures_breaking_and_set_up_as_the_record_does_over_the_last_periods(factor):
    found = {c.name: c.value for c in comparison("beach").compare(broken_waves(factor, transient=0.01))}
    assert found["largest height, from the toe"] == pytest.approx(8.22, abs=0.01)
    assert found["largest height"] == pytest.approx(103.6 * factor, abs=0.3)
    assert found["height behind breaking, off by"] == pytest.approx(100 * (factor - 1), abs=0.3)
    assert found["height up to 6.5 m from the toe, off by"] == pytest.approx(100 * (factor - 1), abs=0.3)
    assert found["set-up at the last gauge"] == pytest.approx(4.52, abs=0.2)


@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("porous-plug", {"domain.spacing": 0.01}),
        ("porous-startup", {"domain.spacing": 0.01}),
        ("porous-column-beads", {"domain.spacing": 0.01, "time.end": 0.5}),
    ],
)
def test_flow_through_pores_reaches_its_targets_on_a_coarse_grid(name, overrides, tmp_path):
    """The real solver against the exact solutions: flux, pressure jump, front."""
    run = houle.run(load(name, overrides=overrides), out=tmp_path / "run", threads=1)
    assert [f"{c.name} = {c.value:.3g}" for c in comparison(name).compare(run) if not c.passed] == []


def test_blind_case_runs_unattended_to_its_last_instant(tmp_path):
    run = houle.run(load("dam-break-rock-25", overrides={"domain.spacing": 0.02}), out=tmp_path / "run", threads=1)
    instants = comparison("dam-break-rock-25").compare(run)[0]
    assert run.summary["finished"] and instants.passed and instants.value == 12


def quiet():
    return Console(quiet=True)


def test_unknown_case_is_refused_before_anything_runs():
    with pytest.raises(CaseError, match="standing-wave"):
        validate(["standing-wave", "sitting-wave"], once=runner.once, console=quiet())


@pytest.mark.parametrize(("value", "status"), [(0.5, 0), (2.0, 1), (float("nan"), 1)])
def test_exit_status_follows_the_checks(monkeypatch, value, status):
    judged = engine.Comparison(lambda run: [Check("it", value, limit=1.0)], (Variant(),))
    monkeypatch.setattr(engine, "comparison", lambda name: judged)
    assert validate(["standing-wave"], once=lambda case, _: SimpleNamespace(case=case), console=quiet()) == status


def test_a_failed_run_is_a_line_of_the_table_and_the_others_go_on(monkeypatch, tmp_path):
    def once(case, out):
        if case.domain.spacing > 0.005:
            raise SimulationError("the pressure did not converge")
        return SimpleNamespace(case=case)

    judged = engine.Comparison(
        lambda run: [Check("spacing", run.case.domain.spacing, "m", 1.0)],
        (Variant("coarse", {"domain.spacing": 0.02}), Variant()),
    )
    monkeypatch.setattr(engine, "comparison", lambda name: judged)
    console = Console(record=True, width=160)
    assert validate(["porous-column"], once=once, out=tmp_path, console=console) == 1
    text = console.export_text()
    assert "did not converge" in text and "0.005 m" in text


def test_quick_leaves_out_what_is_not(monkeypatch):
    ran = []
    judged = engine.Comparison(lambda run: [], (Variant("slow", quick=False), Variant("fast")))
    monkeypatch.setattr(engine, "comparison", lambda name: judged)

    def once(case, out):
        ran.append(out.name)

    assert validate(["porous-column"], once=once, quick=True, console=quiet()) == 0
    assert ran == ["porous-column-fast"]


def test_variants_are_chosen_by_pattern_and_an_unknown_one_is_refused(monkeypatch):
    ran = []
    judged = engine.Comparison(lambda run: [], tuple(map(Variant, ("", "T-1-s", "T-2-s", "T-2-s-wall"))))
    monkeypatch.setattr(engine, "comparison", lambda name: judged)

    def once(case, out):
        ran.append(out.name)

    assert validate(["porous-column"], once=once, variants=["T-2-*", ""], console=quiet()) == 0
    assert ran == ["porous-column", "porous-column-T-2-s", "porous-column-T-2-s-wall"]
    with pytest.raises(CaseError, match=r"T-3-.*There are: T-1-s"):
        validate(["porous-column"], once=once, variants=["T-3-*"], console=quiet())


def test_what_is_finished_is_kept_what_was_cut_goes_on_and_the_table_is_a_file(monkeypatch, tmp_path):
    short = {"domain.spacing": 0.05, "time.end": 0.02, "output.every": 0.01}
    variants, once = (Variant("done", short), Variant("cut", short)), partial(runner.once, threads=1)
    judged = engine.Comparison(lambda run: [Check("steps", run.summary["steps"], limit=1e9)], variants)
    monkeypatch.setattr(engine, "comparison", lambda name: judged)
    houle.run(load("porous-startup", overrides=short), out=tmp_path / "porous-startup-cut", threads=1, until=0.005)
    assert validate(["porous-startup"], once=once, out=tmp_path, console=quiet()) == 0
    monkeypatch.setattr(runner, "run", None)  # nothing is begun again
    assert validate(["porous-startup"], once=once, out=tmp_path, console=quiet()) == 0
    lines = (tmp_path / "porous-startup.csv").read_text(encoding="utf-8").splitlines()
    assert [line.split(",")[0] for line in lines] == ["variant", "done", "cut"]
    assert "| cut | steps |" in (tmp_path / "porous-startup.md").read_text(encoding="utf-8")


def test_table_and_picture_of_coefficients_show_wall_and_open_blocks(tmp_path):
    time, x = np.arange(0.0, 15.0, 0.02), np.array([0.0, 0.3, 0.7, 1.2])
    k = float(analysis.wave_number(2 * np.pi / 1.5, 0.25))
    phase, back = 2 * np.pi / 1.5 * time, k * np.array([3.0, 3.3])
    eta = 2.5e-3 * (np.cos(k * x[:, None] - phase) + 0.2 * np.cos(k * x[:, None] + phase))
    behind = 0.75e-3 * np.cos(back[:, None] - phase)
    found = analysis.reflection(
        (time, np.append(x, back / k), np.concatenate([eta, behind])), depth=0.25, period=1.5, window=(3.0, 12.1),
        towards=1.0, gauges=[0, 1, 2, 3], behind=[4, 5],
    )  # fmt: skip
    rows = []
    for wall in (False, True):
        known = analysis.porous_block(2 * np.pi / 1.5, 0.25, 1.5, 0.85, 0.5, wall=wall)
        rows.append(coefficients.Row(f"wall-{wall}", wall, 0.85, 1.5, False, found, known))
    assert rows[0].off == pytest.approx({"C_R": 0.2 - 0.1565, "C_T": 0.3 - 0.2905}, abs=2e-4)
    assert set(rows[1].off) == {"C_R"}
    coefficients.write(tmp_path / "blocks", "Blocks", rows)
    table = (tmp_path / "blocks.csv").read_text(encoding="utf-8").splitlines()
    assert table[1].startswith("wall-False,1.5,0.85,0.5,open,5.00,0.200,") and table[2].endswith(",,,")
    assert (tmp_path / "blocks.png").stat().st_size > 10_000
