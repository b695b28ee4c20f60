"""The table [waves]: what may stand in it, what is said about the rest, and the wave that comes of it."""

import numpy as np
import pytest
from pydantic import ValidationError

from houle.case.tables.waves import Source, Waves, Zone
from houle.case.wave import make
from houle.registry import choices
from houle.waves.spectra import irregular

REGULAR_WAVE = {"kind": "regular", "height": 0.04, "period": 1.2, "depth": 0.25, "source": {"x": 2.0}}


def table(**keys):
    return Waves.model_validate({k: v for k, v in {**REGULAR_WAVE, **keys}.items() if v is not ...})


def complaints(**keys):
    with pytest.raises(ValidationError) as error:
        table(**keys)
    return "\n".join(
        ".".join(str(p) for p in e["loc"]) + ": " + e["msg"] + " " + e["type"] for e in error.value.errors()
    )


def test_a_regular_wave_has_its_crest_at_the_origin():
    waves = table()
    wave = make(waves)
    assert wave.name == "fenton" and wave.reason and wave.elevation(0.0, 0.0) == pytest.approx(wave.crest)
    assert isinstance(waves.maker, Source) and waves.maker.side == "both" and waves.place == 2.0
    assert waves.ramp_time() == pytest.approx(2.4) and table(ramp=0.0).ramp_time() == 0


def test_every_theory_and_kind_of_the_table_is_there():
    theories = ["airy", "stokes-2", "stokes-3", "stokes-4", "stokes-5", "fenton", "cnoidal", "solitary-3", "solitary-5"]
    kinds = ["regular", "solitary", "jonswap", "pierson-moskowitz", "tma", "focused", "series", "paddle", "ship"]
    assert list(choices("theory")) == ["auto", *theories]
    assert list(choices("waves")) == kinds
    assert all(name in complaints(theory="airey") for name in theories)
    assert all(name in complaints(kind="sine") for name in kinds)


def test_a_zone_starts_at_its_left_end_and_stands_alone():
    assert isinstance(table(source=..., zone={"x": [0.0, 1.5]}).maker, Zone)
    assert table(source=..., zone={"x": [0.0, 1.5]}).place == 0.0
    assert "source and zone are given together" in complaints(zone={"x": [0.0, 1.5]})
    assert "nothing makes the waves" in complaints(source=...)
    for places in ([1.0, 1.0], [3.0, 1.5]):
        assert "which must be larger" in complaints(source=..., zone={"x": places})


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"height": ...}, "height is missing"),
        ({"period": ...}, "period is missing: wave period"),
        ({"height": 4.0}, "height = 4 is above depth = 0.25 m"),
        ({"seed": 3}, 'seed does not belong to kind = "regular"'),
        ({"kind": "solitary"}, "a solitary wave has none"),
        ({"theory": "solitary-5"}, 'theory = "solitary-5" does not give kind = "regular"'),
        ({"kind": "solitary", "period": ..., "theory": "cnoidal"}, 'does not give kind = "solitary"'),
        ({"kind": "jonswap", "theory": "airy"}, "theory does not belong"),
        ({"kind": "pierson-moskowitz", "gamma": 3.3}, "gamma = 1"),
        ({"kind": "focused"}, "focus is missing"),
        ({"kind": "series", "period": ...}, "file is missing"),
        (
            {"kind": "series", "file": "a.csv"},
            'height does not belong to kind = "series": remove it, they are in the file',
        ),
        ({"kind": "swell"}, "literal_error"),
        ({"theory": "stokes"}, "literal_error"),
        ({"hight": 0.1}, "extra_forbidden"),
        ({"height": "0.04"}, "float_type"),
        ({"height": -0.04}, "greater_than"),
        ({"period": float("inf")}, "finite_number"),
        ({"direction": 90.0}, "less_than"),
        ({"source": {"x": 1.0, "side": "up"}}, "literal_error"),
        ({"source": {"x": 1.0, "beta": 3.0}}, "extra_forbidden"),
    ],
)
def test_what_is_wrong_in_the_table_is_said(keys, said):
    assert said in complaints(**keys)


def test_messages_start_with_the_key_as_in_case_files():
    """case_errors puts "waves." before a message that starts with a key, and nothing before ":"."""
    lines = complaints(height=..., seed=3, source=...).split("\n")
    text = lines[0].removeprefix(": Value error, ")
    assert text.startswith("height is missing") and lines[1].startswith("seed ") and lines[2].startswith(": nothing")


def test_solitary_wave_starts_before_the_maker_or_comes_to_its_focus():
    early = make(table(kind="solitary", period=...))
    assert early.elevation(2.0, 0.0) < 0.01 * 0.04
    assert early.elevation(2.0, np.linspace(0, 5, 500)).max() == pytest.approx(0.04, rel=1e-3)
    assert early.name == "solitary-5"
    assert make(table(kind="solitary", period=..., theory="solitary-3")).name == "solitary-3"
    aimed = make(table(kind="solitary", period=..., focus={"x": 6.0, "time": 3.0}))
    assert aimed.elevation(6.0, 3.0) == pytest.approx(0.04)


def test_focused_and_random_and_series(tmp_path):
    group = make(table(kind="focused", focus={"x": 6.0, "time": 10.0}, seed=4, gamma=2.0))
    assert group.elevation(6.0, 10.0) == pytest.approx(0.04)
    sea = make(table(kind="jonswap", seed=4, direction=20.0))
    again = make(table(kind="jonswap", seed=4, direction=20.0))
    assert sea.components().phase.tobytes() == again.components().phase.tobytes()
    direct = irregular("jonswap", 0.04, 1.2, 0.25, 9.81, seed=4).components()
    assert sea.components().phase.tobytes() == direct.phase.tobytes()
    peaked = make(table(kind="jonswap", seed=4, gamma=7.0)).components()
    assert peaked.amplitude.max() > 1.2 * direct.amplitude.max()
    assert sea.direction == pytest.approx(np.radians(20)) == pytest.approx(sea.components().direction[0])
    assert make(table(kind="tma", seed=4)).components().amplitude[150] != sea.components().amplitude[150]
    t = np.arange(0, 20, 0.1)
    eta = -0.02 * np.exp(-((t - 10) ** 2))
    rows = "".join(f"{a:.2f},{b:.6f}\n" for a, b in zip(t, eta, strict=True))
    (tmp_path / "ship.csv").write_text("t_s,eta_m\n" + rows)
    ship = make(table(kind="series", file="ship.csv", height=..., period=...), folder=tmp_path)
    assert ship.elevation(2.0, 10.0) == pytest.approx(-0.02, abs=1e-4)  # at the maker


def test_gravity_is_passed_on():
    waves = table(theory="airy")
    assert make(waves, 1.62).length < make(waves).length
    assert make(waves, 1.62).gravity == 1.62


def test_the_table_cannot_be_changed():
    with pytest.raises(ValidationError, match="frozen"):
        table().height = 1.0
