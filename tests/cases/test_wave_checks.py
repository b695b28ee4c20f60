"""Pre-flight of waves and sponges: each doubt is found, with both numbers; a good flume is left in peace."""

import pytest
from matplotlib.image import imread

from houle.case.model import load
from houle.check import gauges, report, rules
from houle.errors import CaseError
from houle.output.section import draw, stretch

WAVE = {"kind": "regular", "height": 0.04, "period": 1.2, "depth": 0.25}  # L = 1.667 m
SPONGE = {"box": [[7.5, 0.0], [10.0, 0.4]]}
ZONE = {"zone": {"x": [0.0, 2.5]}}
SOURCE = {"source": {"x": 4.0, "width": 0.8, "form": "linear"}}
LEFT = {"box": [[0.0, 0.0], [2.5, 0.4]]}


def flume(waves=None, size=(10.0, 0.4), **tables):
    base = {
        "case": {"name": "flume"},
        "domain": {"size": list(size), "spacing": 0.01},
        "water": [{"below": 0.25}],
        "sponge": [SPONGE],
        "time": {"end": 20.0},
    }
    return load({**base, "waves": WAVE | (ZONE if waves is None else waves), **tables})


def block(x0=5.0, x1=6.0):
    return {"box": [[x0, 0.0], [x1, 0.4]], "porosity": 0.45, "resistance": {"a": 1.0, "b": 50.0}}


def found(case):
    """(level, key, text) of every finding that is no info."""
    return [(f.level, f.key, str(f)) for f in rules.check(case) if f.level != "info"]


GOOD = {
    "zone": flume(porous=[block()], gauge=[{"x": 3.0}]),
    "source": flume(SOURCE, sponge=[SPONGE, LEFT], porous=[block(5.5, 6.5)], gauge=[{"x": 5.0}]),
    "one side": flume({"source": {"x": 1.0, "width": 0.8, "form": "linear", "side": "right"}}),
    "a bed under everything": flume(water=[{"below": 0.3}], solid=[{"box": [[0.0, 0.0], [10.0, 0.05]]}]),
    "a beach in a sponge": flume(solid=[{"polygon": [[8.0, 0.0], [10.0, 0.0], [10.0, 0.3]]}]),
    "spectrum": flume({"kind": "jonswap", **ZONE}),
    "solitary": flume({"kind": "solitary", "period": None, "zone": {"x": [0.0, 6.0]}}, sponge=[]),
    "3D": flume(  # 5 m sin(19.48 degrees) = L
        {"source": {"x": 4.0, "width": 0.8, "form": "linear"}, "direction": 19.48},
        sponge=[{"box": [[7.5, 0.0, 0.0], [10.0, 5.0, 0.4]]}, {"box": [[0.0, 0.0, 0.0], [2.5, 5.0, 0.4]]}],
        domain={"size": [10.0, 5.0, 0.4], "spacing": 0.04, "walls": {"y": "periodic"}},
        water=[{"below": 0.25}],
    ),
}


@pytest.mark.parametrize("good", GOOD)
def test_a_good_flume_is_left_in_peace(good):
    coarse = ("waves", "domain.spacing") if good == "3D" else ()
    assert [f for f in found(GOOD[good]) if f[1] not in coarse] == []


# level, key and the words of the one finding
DOUBTS = {
    "it breaks": (flume({"height": 0.24, **ZONE}), "error", "waves.height", ["0.24", "breaks", "lower height"]),
    "false crest": (
        flume({"theory": "stokes-2", "period": 2.0, **ZONE}, sponge=[]), "error", "waves", ["Ursell", "fenton"]),
    "too coarse": (
        flume(domain={"size": [10.0, 0.4], "spacing": 0.1}, sponge=[]), "error", "waves", ["L/dx = 16.7", "0.0833"]),
    "another depth": (
        flume({"depth": 0.3, **SOURCE}, sponge=[SPONGE, LEFT]), "error", "waves.depth",
        ["= 0.3 m", "0.25 m deep", "x = 3.4 to 4.6 m", "depth = 0.25"]),
    "depth over a step": (
        flume(solid=[{"box": [[1.0, 0.0], [3.0, 0.1]]}]), "error", "waves.depth", ["0.15 m deep at x", "[[solid]]"]),
    "maker on land": (
        flume(solid=[{"box": [[0.0, 0.0], [3.0, 0.4]]}]), "error", "waves.depth", ["there is no water"]),
    "source outside": (flume({"source": {"x": 12.0}}), "error", "waves.source.x", ["= 12", "0 < x < 10 m"]),
    "source in cm": (flume({"source": {"x": 400.0}}), "error", "waves.source.x", ["cm given"]),
    "source at the wall": (
        flume({"source": {"x": 0.3, "width": 0.8, "form": "linear", "side": "right"}}), "error", "waves.source.x",
        ["0.6 m to each side", "wall at 0 m", "x = 0.6"]),
    "narrow source of steep waves": (
        flume({"source": {"x": 4.0, "width": 0.5}}), "error", "waves.source", ["leave width out", 'form = "linear"']),
    "source sends to the wall": (flume(SOURCE), "warning", "waves.source.side", ["[[sponge]]", "3.4 m", '"right"']),
    "source in a sponge": (
        flume({"source": SOURCE["source"] | {"x": 8.5}}, sponge=[SPONGE, LEFT]), "error", "sponge.sponge-1", ["damps"]),
    "source beside a sponge": (
        flume({"source": SOURCE["source"] | {"x": 2.9}}, sponge=[SPONGE, LEFT]), "warning", "sponge.sponge-2",
        ["x = 0 to 2.5 m", "2.3 to 3.5 m", "lower"]),
    "solitary from a source": (
        flume({"kind": "solitary", "period": None, **SOURCE}, sponge=[]), "error", "waves.source", ["waves.zone"]),
    "source in stones": (
        flume(SOURCE, sponge=[SPONGE, LEFT], porous=[block(4.5, 5.5)]), "error", "porous.porous-1",
        ["x 4.5 to 4.6 m", "clear water"]),
    "zone in stones": (flume(porous=[block(2.0, 3.0)]), "error", "porous.porous-1", ["x 2 to 2.5 m"]),
    "zone away from the wall": (
        flume({"zone": {"x": [1.0, 3.5]}}), "error", "waves.zone.x", ["left wall", "x = [0, 3.5]"]),
    "zone over everything": (
        flume({"zone": {"x": [0.0, 12.0]}}, sponge=[]), "error", "waves.zone.x", ["outside the domain"]),
    "short zone": (flume({"zone": {"x": [0.0, 1.7]}}), "warning", "waves.zone.x", ["1.02", "1.67 m", "[0, 2.5]"]),
    "shorter zone": (flume({"zone": {"x": [0.0, 0.7]}}), "error", "waves.zone.x", ["0.42"]),
    "zone into a sponge": (
        flume(sponge=[{"box": [[2.0, 0.0], [10.0, 0.4]]}]), "error", "sponge.sponge-1", ["x = 2 m", "2.5 m"]),
    "zone without a wall": (
        flume(domain={"size": [10.0, 0.4], "spacing": 0.01, "walls": {"x": "periodic"}}, sponge=[]),
        "error", "waves.zone", ["periodic"]),
    "oblique from a zone": (
        flume({"direction": 20.0, **ZONE}, (10.0, 0.4, 0.4), sponge=[]), "error", "waves.direction", ["waves.source"]),
    "oblique, does not come round": (
        flume({"source": {"x": 4.0, "width": 0.8, "form": "linear"}, "direction": 30.0}, sponge=[],
              domain={"size": [10.0, 5.0, 0.4], "spacing": 0.04, "walls": {"y": "periodic"}}),
        "error", "waves.direction", ["1.50 waves", "19.5 or 41.8 degrees"]),
    "oblique between walls": (
        flume({"source": {"x": 4.0, "width": 0.8, "form": "linear"}, "direction": 30.0}, sponge=[],
              domain={"size": [10.0, 5.0, 0.4], "spacing": 0.04}),
        "warning", "waves.direction", ['y = "periodic"']),
    "lid": (flume(size=(10.0, 0.26), sponge=[]), "error", "domain.size", ["crests rise", "hit the lid", "height 0.3"]),
    "lid over a standing wave": (
        flume(size=(10.0, 0.29), sponge=[]), "warning", "domain.size", ["sent back whole", "height 0.3"]),
    "gauge in the zone": (flume(gauge=[{"x": 2.0}]), "warning", "gauge.G1.x", ["waves.zone", "not complete"]),
    "gauge in a sponge": (flume(gauge=[{"x": 8.0}]), "warning", "gauge.G1.x", ["sponge.sponge-1", "damped"]),
    "no record": (flume({"kind": "series", "height": None, "period": None, "file": "no.csv", **ZONE}),
        "error", "waves.file", ["no.csv", "cannot be read"]),
    "sponge inside": (
        flume(sponge=[{"box": [[5.0, 0.0], [8.0, 0.4]]}]), "error", "sponge.sponge-1.box",
        ["touches no side", "x = 10"]),
    "sponge everywhere": (
        flume({"source": {"x": 5.0, "side": "right"}}, sponge=[{"box": [[0.0, 0.0], [10.0, 0.4]]}]),
        "error", "sponge.sponge-1.box", ["from side to side"]),
    "sponge outside": (
        flume(sponge=[{"box": [[8.0, 0.0], [11.0, 0.4]]}]), "error", "sponge.sponge-1.box", ["x = 11", "0 <= x <= 10"]),
    "sponge in a corner": (
        flume(size=(10.0, 5.0, 0.4), domain={"size": [10.0, 5.0, 0.4], "spacing": 0.02},
              sponge=[{"box": [[7.0, 3.0, 0.0], [10.0, 5.0, 0.4]]}]),
        "error", "sponge.sponge-1.box", ["two sides"]),
    "sponge at no wall": (
        flume({"source": {"x": 3.0, "width": 0.8, "form": "linear", "side": "right"}},
              domain={"size": [10.0, 0.4], "spacing": 0.01, "walls": {"x": "periodic"}}),
        "error", "sponge.sponge-1.box", ["no wall"]),
    "short sponge": (
        flume(sponge=[{"box": [[9.0, 0.0], [10.0, 0.4]]}]), "warning", "sponge.sponge-1.box",
        ["0.60", "some 16 %", "2.5 m are good"]),
    "low sponge": (
        flume(sponge=[{"box": [[7.5, 0.0], [10.0, 0.2]]}]), "warning", "sponge.sponge-1.box", ["0.2 m", "undamped"]),
    "dry sponge": (
        flume(solid=[{"box": [[7.0, 0.0], [10.0, 0.4]]}]), "error", "sponge.sponge-1", ["holds no water"]),
    "sponge in stones": (flume(porous=[block(7.0, 8.0)]), "error", "porous.porous-1", ["sponge.sponge-1", "7.5 to 8"]),
}  # fmt: skip


@pytest.mark.parametrize("doubt", DOUBTS)
def test_doubts_quote_the_numbers_and_the_cure(doubt):
    case, level, key, words = DOUBTS[doubt]
    told = [text for f_level, f_key, text in found(case) if (f_level, f_key) == (level, key)]
    assert len(told) == 1, found(case)
    assert all(word in told[0] for word in words), told[0]
    if level == "error":
        with pytest.raises(CaseError):
            rules.require(case)


def test_the_window_is_that_of_the_analysis():
    case = flume(porous=[block()], gauge=[{"x": 3.0}, {"x": 3.4}])
    good = gauges.steady(case)
    assert good is not None and good.level == "info" and "waves can be separated from" in good.text
    short = gauges.steady(load(case, {"time.end": 8.0}))
    assert short is not None and (short.level, short.key) == ("warning", "time.end") and "s longer" in short.text
    source = SOURCE["source"] | {"x": 2.0, "side": "right"}
    closed = flume({"source": source}, gauge=[{"x": 3.0}], porous=[block(3.5, 4.5)])
    there_and_back = gauges.steady(closed)
    assert there_and_back is not None and there_and_back.key == "domain.size" and "[[sponge]]" in there_and_back.text


def test_an_empty_flume_wants_the_front_to_pass_the_last_gauge():
    case = flume(gauge=[{"x": 3.0}, {"x": 7.0}])
    wave = case.wave
    start = (7.0 - 2.5) / wave.group_velocity + 4 * 1.2  # two periods of ramp, two to settle
    for end, level in ((start + 3.05 * 1.2, "info"), (start + 2.9 * 1.2, "warning")):
        told = gauges.steady(load(case, {"time.end": float(end)}))
        assert told is not None and told.level == level
    assert gauges.steady(flume()) is None, "no gauges"
    assert gauges.steady(GOOD["solitary"]) is None, "it passes once"


def test_the_report_names_wave_maker_and_sponge():
    rows = dict(report.wave_rows(GOOD["source"]))
    assert "height = 0.04 m" in rows["wave"] and "kh = 0.942" in rows["size"]
    assert "acts from 3.4 to 4.6 m" in rows["made by"] and "full after 2.4 s" in rows["made by"]
    assert "1.50 wavelengths" in dict(report.wave_rows(GOOD["zone"]))["made by"]
    (_, words), (name, left) = report.sponge_rows(GOOD["source"])
    assert name == "sponge.sponge-2" and left.startswith("left side, 2.5 m long (1.50 wavelengths)")
    assert words.startswith("right") and ": 0.3 % of the waves come back" in words
    weak = report.sponge_rows(flume(sponge=[SPONGE | {"strength": 1.0}]))[0][1]
    assert "up to 1 1/s" in weak and "47.4 %" in weak  # exp(-2.5 / (3 * 1.10)) is 46.9 %


def test_long_sections_are_enlarged_by_a_round_number():
    assert [stretch(ratio) for ratio in (2.0, 5.5, 25.0, 50.0, 2000.0)] == [1.0, 1.0, 5.0, 10.0, 400.0]
    assert all(ratio / stretch(ratio) <= 5.5 * (1 + 1e-9) for ratio in (17.5, 60.0, 2e3))


@pytest.mark.parametrize("good", ["zone", "source", "3D"])
def test_the_picture_shows_what_acts_on_the_water(good, tmp_path):
    """More grey lines of makers and sponges, or of a source, than without them."""
    bare = GOOD[good].model_copy(update={"waves": None, "sponge": ()})
    dark = [
        (imread(draw(case, tmp_path / "section.png"))[..., :3].mean(axis=-1) < 0.8).sum() for case in (GOOD[good], bare)
    ]
    assert dark[0] > dark[1] + 2000


GROUP = {"kind": "focused", "period": 1.2, "height": 0.03, "depth": 0.25}
CREST = {"kind": "solitary", "height": 0.05, "depth": 0.25}
RIGHT = {"source": {"x": 4.0, "side": "right"}}
TO_THE_LEFT = {"source": {"x": 6.0, "side": "left"}}
ALL = {"zone": ZONE, "piston": {"piston": {"x": 1.0}}, "right": RIGHT, "left": TO_THE_LEFT}


def focused(wave, maker, x, time, end=20.0):
    tables = {
        "case": {"name": "flume"},
        "domain": {"size": [10.0, 0.4], "spacing": 0.02},
        "water": [{"below": 0.25}],
        "time": {"end": end},
    }
    return load({**tables, "waves": {**wave, **ALL[maker], "focus": {"x": x, "time": time}}})


def of_focus(case):
    return [(f.key, f.text) for f in rules.check(case) if f.key.startswith("waves.focus")]


@pytest.mark.parametrize(
    ("wave", "maker", "x", "earliest"),
    [
        (CREST, "zone", 7.0, 5.2),  # 7 m and acosh(10) / sqrt(3H/4d^3) = 1.93 m of its front, at 1.71 m/s
        (CREST, "piston", 7.0, 4.65),
        (GROUP, "piston", 4.0, 7.1),  # 3 m at 0.51 m/s, that of waves of 0.75 s, and a period
        (GROUP, "right", 7.0, 7.1),
        (GROUP, "left", 3.0, 7.1),
        (GROUP, "zone", 4.25, 7.1),  # from the middle of the zone
    ],
)
def test_a_focus_that_the_maker_cannot_reach_is_refused_with_the_earliest_time_that_can(wave, maker, x, earliest):
    for time in (0.5, 0.9 * earliest):
        ((key, text),) = of_focus(focused(wave, maker, x, time))
        assert key == "waves.focus.time" and "pass the maker" in text
    told = float(text.rpartition("time = ")[2].split()[0])
    assert told == pytest.approx(earliest, rel=0.06)
    assert of_focus(focused(wave, maker, x, told)) == []


def test_a_wave_that_the_run_does_not_wait_for_leaves_the_piston_at_rest():
    """Its front has not left the maker when the run ends: no stroke to compare the height with."""
    case = focused({**CREST, "depth": 0.25, "height": 0.04}, "piston", 7.0, 20.0)
    assert "H/stroke" not in dict(report.wave_rows(case))["made by"]


@pytest.mark.parametrize("maker", ALL)
def test_a_focus_outside_the_tank_or_the_run_or_behind_the_maker_is_refused(maker):
    inside = 2.0 if maker == "left" else 7.0
    assert "after the end of the run" in of_focus(focused(GROUP, maker, inside, 15.0, end=10.0))[0][1]
    for x in (12.0, -3.0):
        assert "outside the domain" in of_focus(focused(GROUP, maker, x, 15.0))[0][1]
    if maker != "zone":
        behind = {"piston": 0.5, "right": 2.0, "left": 8.0}[maker]
        assert "behind the maker" in of_focus(focused(GROUP, maker, behind, 15.0))[0][1]


def test_what_a_source_sends_to_the_left_comes_together_where_it_is_asked_for():
    case = focused(GROUP, "left", 3.0, 12.0)
    wave = case.wave  # the wave of -x
    assert wave.elevation(-3.0, 12.0) == pytest.approx(0.03, rel=1e-9)


@pytest.mark.parametrize("kind", ["solid", "porous"])
def test_few_cells_over_the_crest_of_a_bar_are_told(kind):
    def bar(top, spacing):
        body = {"polygon": [[4.0, 0.0], [5.0, top], [5.5, top], [6.5, 0.0]]}
        body |= {"porosity": 0.4, "resistance": {"a": 1.0, "b": 50.0}} if kind == "porous" else {}
        case = flume(domain={"size": [10.0, 0.4], "spacing": spacing}, **{kind: [body]})
        return [text for level, key, text in found(case) if key == f"{kind}.{kind}-1" and level == "warning"]

    (told,) = bar(0.15, 0.02)
    assert "0.1 m of water over its crest, 5.0 cells" in told and "domain.spacing = 0.01" in told
    assert "third harmonics 0.25 m long, 12 cells" in told  # T/3 = 0.4 s: 9.81 / (2 pi) 0.4^2 = 0.250 m if deep
    assert bar(0.15, 0.01) == [], "ten"
    assert bar(0.35, 0.02) == [], "it stands out of the water"
