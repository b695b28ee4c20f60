"""Flumes with waves for the shipped cases: overrides of a case file for another wave or another structure.

From left to right: relaxation zone of a wavelength and a half (it makes the waves and absorbs those that come back),
gauges, the structure, gauges, sponge of a wavelength and a half. The gauges stand so that a free second harmonic can be
told from the bound one for waves of 1 to 2 s in 0.25 m of water; there are many because the noise of the surface, some
hundredths of a cell and different at every gauge, is what limits the answer for waves lower than a cell.
"""

from __future__ import annotations

import math
from typing import Any

from houle.analysis import wave_number
from houle.waves import dispersion
from houle.waves.dispersion import GRAVITY
from houle.waves.theories import regular

GAUGES = (0.0, 0.1, 0.3, 0.4, 0.6, 0.7, 0.9, 1.0, 1.2, 1.3, 1.5, 1.6, 1.8)  # places in front, after the first [m]
BEHIND = (0.4, 0.5, 0.7, 0.8)  # places behind, after the back of the structure [m]
PER_LENGTH = 5  # gauges of an empty flume in a wavelength
GAP = 0.5  # distance between zone, gauges and structure [m]: evanescent modes have died out there
RAMP_SETTLE, PERIODS = 4.0, 5.0  # settling and length of the window, in periods: analysis.choose_window


def block(
    period: float,
    height: float,
    body: dict[str, Any],
    width: float = 1.5,
    *,
    wall: bool = False,
    slope: float = 0.0,
    echo: bool = False,
    depth: float = 0.25,
) -> dict[str, Any]:
    """A flume with a porous block over the full depth; body: its table without the shape; wall: one right behind it.

    slope  horizontal per vertical of the front: 0 is upright, 1 is 45 degrees. Half-way down the water the face stays
           where it is, so that the block holds as much water.
    echo   the run goes on until the waves that the zone sends back are steady, for a structure that reflects much
    """
    length, speed = _wave(period, depth)
    zone = _up(1.5 * length)
    first = zone + GAP
    front = _up(first + GAUGES[-1] + GAP + 0.5 * slope * depth)  # half-way down the water
    toe = front - 0.5 * slope * depth
    back = front + width
    away = [] if wall else [back + b for b in BEHIND]
    end = back if wall else _up(back + BEHIND[-1] + 0.4 + 1.5 * length)
    top = _top(depth, height)
    steady = (2 * back - zone - first) / speed + RAMP_SETTLE * period
    steady += 2 * (front - zone) / speed if echo else 0.0
    shape: dict[str, Any] = {"box": [[_round(front), 0.0], [_round(back), top]]}
    if slope:
        head = _round(toe + slope * top)
        shape = {"polygon": [[_round(toe), 0.0], [_round(back), 0.0], [_round(back), top], [head, top]]}
    names = [f"G{i}" for i in range(1, len(GAUGES) + 1)], [f"T{i}" for i in range(1, len(away) + 1)]
    places = [first + g for g in GAUGES] + away
    return {
        "domain.size": [_round(end), top],
        "waves": {"kind": "regular", "height": height, "period": period, "depth": depth, "zone": {"x": [0.0, zone]}},
        "porous": [{"name": "block", **shape, **body}],
        "gauge": [{"name": n, "x": _round(x)} for n, x in zip([*names[0], *names[1]], places, strict=True)],
        "sponge": [] if wall else [{"box": [[_round(end - 1.5 * length), 0.0], [_round(end), top]]}],
        "reflection": {
            "structure": [_round(front), _round(back)],
            "gauges": names[0],
            "behind": names[1],
            "twin": False,
        },
        "time.end": _up(steady + (PERIODS + 0.2) * period),
    }


def wall(period: float, height: float, depth: float = 0.25) -> dict[str, Any]:
    """A flume that ends at a solid upright wall."""
    flume = block(period, height, {}, width=0.0, wall=True, echo=True, depth=depth)
    return {**flume, "porous": [], "reflection": {**flume["reflection"], "structure": [flume["domain.size"][0]]}}


def linear(friction: float, period: float, porosity: float) -> dict[str, Any]:
    """A body with the linear drag f omega u of the pore velocity (Sollitt & Cross 1972), a = f omega / n, and S = 1."""
    a = friction * 2 * math.pi / period / porosity
    return {"porosity": porosity, "resistance": {"a": a, "b": 0.0}, "added_mass": 0.0}


def _wave(period: float, depth: float) -> tuple[float, float]:
    """Length [m] and group velocity [m/s] of a wave by linear theory."""
    k = float(wave_number(2 * math.pi / period, depth))
    return 2 * math.pi / k, float(dispersion.group_velocity(k, depth, GRAVITY))


def _round(x: float) -> float:
    return round(x, 4)


def _up(x: float) -> float:
    """The number rounded up to a tenth."""
    return round(math.ceil(10 * x - 1e-9) / 10, 1)


def empty(period: float, height: float, lengths: float = 5.0, depth: float = 0.25) -> dict[str, Any]:
    """An empty flume: relaxation zone, gauges over so many wavelengths, sponge."""
    wave = regular("auto", height, period, depth, GRAVITY, 0.0, 0.0)
    zone = _up(1.5 * wave.length)
    last = zone + GAP + lengths * wave.length
    end = _up(last + GAP + 1.5 * wave.length)
    top = _top(depth, height)
    every = wave.length / PER_LENGTH
    gauges = [
        {"name": f"G{i + 1}", "x": _round(zone + GAP + i * every)} for i in range(round(lengths * PER_LENGTH) + 1)
    ]
    return {
        "domain.size": [end, top],
        "waves": {"kind": "regular", "height": height, "period": period, "depth": depth, "zone": {"x": [0.0, zone]}},
        "gauge": gauges,
        "sponge": [{"box": [[_round(end - 1.5 * wave.length), 0.0], [end, top]]}],
        "time.end": _up((last - zone) / wave.group_velocity + (RAMP_SETTLE + PERIODS + 0.2) * period),
    }


def one_sided(period: float, height: float, lengths: float = 5.0, depth: float = 0.25) -> dict[str, Any]:
    """The flume of `empty` with an internal source that sends its waves to the right, and a sponge behind it."""
    wave = regular("auto", height, period, depth, GRAVITY, 0.0, 0.0)
    behind = _up(1.25 * wave.length)
    source = _round(behind + 0.8 * wave.length)  # acts over 0.75 wavelengths to each side
    flume = empty(period, height, lengths, depth)
    shift = _round(source + 1.25 * wave.length - flume["gauge"][0]["x"])
    end, top = _up(flume["domain.size"][0] + shift), flume["domain.size"][1]
    last = flume["gauge"][-1]["x"] + shift
    return {
        **flume,
        "domain.size": [end, top],
        "waves": {**flume["waves"], "zone": None, "source": {"x": source, "side": "right"}},
        "gauge": [{"name": gauge["name"], "x": _round(gauge["x"] + shift)} for gauge in flume["gauge"]],
        "sponge": [
            {"name": "behind", "box": [[0.0, 0.0], [behind, top]]},
            {"name": "end", "box": [[_round(end - 1.5 * wave.length), 0.0], [end, top]]},
        ],
        "time.end": _up((last - source) / wave.group_velocity + (RAMP_SETTLE + PERIODS + 0.2) * period),
    }


def two_sided(period: float, height: float, depth: float = 0.25) -> dict[str, Any]:
    """An internal source of the usual width in the middle of an empty flume, 1.2 wavelengths of gauges to each side."""
    wave = regular("auto", height, period, depth, GRAVITY, 0.0, 0.0)
    reach, stretch, sponge = 1.3 * wave.length, 1.2 * wave.length, 1.5 * wave.length
    middle = _up(sponge + stretch + reach)
    end, top = 2 * middle, _top(depth, height)
    steps = range(round(1.2 * PER_LENGTH) + 1)
    away = [reach + i * wave.length / PER_LENGTH for i in steps]
    turn = middle - 0.5 * sponge  # half-way into a sponge, from the source
    return {
        "domain.size": [end, top],
        "waves": {"kind": "regular", "height": height, "period": period, "depth": depth, "source": {"x": middle}},
        "gauge": [
            *({"name": f"R{i + 1}", "x": _round(middle + a)} for i, a in enumerate(away)),
            *({"name": f"L{i + 1}", "x": _round(middle - a)} for i, a in enumerate(away)),
        ],
        "sponge": [{"box": [[0.0, 0.0], [_round(sponge), top]]}, {"box": [[_round(end - sponge), 0.0], [end, top]]}],
        "time.end": _up((2 * turn - reach) / wave.group_velocity + (RAMP_SETTLE + PERIODS + 0.2) * period),
    }


def piston(
    period: float, height: float, *, wall: bool = False, lengths: float = 2.5, depth: float = 0.25
) -> dict[str, Any]:
    """A piston that absorbs, gauges over so many wavelengths, and a wall that absorbs; or a fixed one, `wall`."""
    wave = regular("auto", height, period, depth, GRAVITY, 0.0, 0.0)
    rest, first = 0.4, 0.4 + GAP
    last = first + lengths * wave.length
    end = _up(last + GAP)
    top = _top(depth, height)
    every = wave.length / (2 * PER_LENGTH)  # so near that waves of twice the frequency to both sides can be told apart
    travel = (2 * end - rest - first) / wave.group_velocity + RAMP_SETTLE * period
    return {
        "domain.size": [end if wall else round(end + 0.4, 4), top],
        "waves": {
            "kind": "regular", "height": height, "period": period, "depth": depth,
            "piston": {"x": rest, "absorb": True},
        },
        "gauge": [
            {"name": f"G{i + 1}", "x": _round(first + i * every)} for i in range(round((last - first) / every) + 1)
        ],
        "absorber": [] if wall else [{"x": end}],
        "time.end": _up(travel * (2.0 if wall else 1.0) + (PERIODS + 0.2) * period),
    }  # fmt: skip


def _top(depth: float, height: float) -> float:
    """Height of the tank [m], clear of the highest standing crest.

    With it, still water in 0.25 m of depth does not stand at the middle of a cell for the spacings of the cases (20, 10
    and 5 mm, fitted to this height).
    """
    return round(0.025 * math.ceil((depth + 1.6 * height + 0.06) / 0.025), 3)
