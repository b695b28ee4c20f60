"""Regular waves by name, or the theory that fits; what each theory is good for.   [ADD A THEORY HERE]

To add one, write a function (height, period, depth, gravity, phase, direction) -> Wave, and give it a line of REGULAR
and of PASSPORTS: the case file, `houle describe theories` and the tests find it there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from math import pi

from houle.waves import dispersion
from houle.waves.cnoidal import cnoidal
from houle.waves.fenton import NotConverged, fenton
from houle.waves.limits import miche, ursell, williams
from houle.waves.linear import airy
from houle.waves.stokes import second_harmonic, stokes
from houle.waves.wave import Wave, WaveError

REGULAR: dict[str, Callable[..., Wave]] = {
    "airy": airy,
    "stokes-2": partial(stokes, order=2),
    "stokes-3": partial(stokes, order=3),
    "stokes-4": partial(stokes, order=4),
    "stokes-5": partial(stokes, order=5),
    "fenton": fenton,
    "cnoidal": cnoidal,
}


@dataclass(frozen=True)
class Passport:
    """What it is, where it holds, where it comes from."""

    what: str
    range: str
    source: str


PASSPORTS: dict[str, Passport] = {
    "auto": Passport(
        "Airy where the second harmonic is below 1 % of the height, else the stream function, else (too long a wave "
        "for its series) cnoidal. The choice and its reason are printed by `houle check`.",
        "regular waves below breaking",
        "after the chart of Le Mehaute (1976); docs/waves.md",
    ),
    "airy": Passport("One cosine, linear.", "H so small that crests and troughs are alike", "Airy (1845)"),
    "stokes-2": Passport("Power series in kH/2, closed flume.", "Ursell number below 10", "Fenton (1985); raschii"),
    "stokes-3": Passport("The same to third order.", "Ursell number below 20", "Fenton (1985); raschii"),
    "stokes-4": Passport("The same to fourth order.", "Ursell number below 30", "Fenton (1985); raschii"),
    "stokes-5": Passport("The same to fifth order.", "Ursell number below 40", "Fenton (1985); raschii"),
    "fenton": Passport(
        "Stream function: Fourier series of the full equations, as many harmonics as matter, closed flume.",
        "regular waves up to 94 % of the highest for L/d below 50, 85 % at 90, 55 % at 180",
        "Rienecker & Fenton (1981); Fenton (1988)",
    ),
    "cnoidal": Passport(
        "Third order in H/h with elliptic functions, closed flume.",
        "L/d above 8, H/d below 0.4",
        "Fenton (1979, 1999)",
    ),
    "solitary-3": Passport("A single crest, third order.", "H/d below 0.3", "Grimshaw (1971); Fenton (1972, 1999)"),
    "solitary-5": Passport("A single crest, fifth order.", "H/d below 0.5", "Fenton (1999)"),
    "solitary": Passport("A single crest; theory solitary-5 unless told.", "H/d below 0.5", "see there"),
    "jonswap": Passport(
        "Random sea, linear, 200 components at seeded random frequencies and phases.",
        "Hm0/d below 0.4",
        "Hasselmann et al. (1973)",
    ),
    "pierson-moskowitz": Passport("The same, fully grown sea: gamma = 1.", "deep water", "Pierson & Moskowitz (1964)"),
    "tma": Passport("JONSWAP in finite depth.", "Hm0/d below 0.4", "Bouws et al. (1985)"),
    "focused": Passport(
        "NewWave: the likeliest shape of a high crest, at a given place and time; height is the crest above the level.",
        "linear",
        "Tromans, Anaturk & Hagemeijer (1991)",
    ),
    "series": Passport(
        "Elevations from a CSV file with columns t_s, eta_m, by linear dispersion; a ship's drawdown and its secondary "
        "waves.",
        "linear; long waves too",
        "Fourier components; docs/waves.md",
    ),
}

LOW = 0.6  # share of the highest wave below which a wave that has no Fourier series is too long, not too high
FLAT = 0.01  # second harmonic over height up to which a wave is linear


@lru_cache(maxsize=64)
def regular(
    theory: str,
    height: float,
    period: float,
    depth: float,
    gravity: float = dispersion.GRAVITY,
    phase: float = 0.0,
    direction: float = 0.0,
) -> Wave:
    """The regular wave of this theory ("auto" or a key of REGULAR): height crest to trough [m], period [s], depth [m].

    Crest at x = 0, t = 0 for phase = 0. Raises WaveError with the cure if the theory cannot give the wave.
    """
    if theory != "auto":
        return REGULAR[theory](height, period, depth, gravity, phase, direction)
    name, reason = choose(height, period, depth, gravity)
    try:
        return replace(REGULAR[name](height, period, depth, gravity, phase, direction), reason=reason)
    except NotConverged:
        length = _length(period, depth, gravity)
        if height > LOW * williams(length, depth):
            raise
        long = f"{length / depth:.0f} depths long and H/d = {height / depth:.2g}"
        reason = f"cnoidal: {long}, which the series of the stream function does not reach"
        return replace(cnoidal(height, period, depth, gravity, phase, direction), reason=reason)


def _length(period: float, depth: float, gravity: float) -> float:
    """Length of the linear wave [m]."""
    return 2 * pi / float(dispersion.wave_number(2 * pi / period, depth, gravity))


def choose(height: float, period: float, depth: float, gravity: float) -> tuple[str, str]:
    """Theory and the reason for it, one sentence. Raises WaveError for a wave that breaks."""
    length = _length(period, depth, gravity)
    highest = williams(1.1 * length, depth)  # steep waves are up to a tenth longer
    if height > highest:
        raise WaveError(
            f"waves.height = {height:g} m is above the highest wave of {period:g} s in {depth:g} m of water, "
            f"{highest:.3g} m (Williams 1981; Miche {miche(length, depth):.3g} m): it breaks; give a lower height"
        )
    number = ursell(height, length, depth)
    second = second_harmonic(height, length, depth)
    text = f"Ursell number {number:.3g}, H at {height / highest:.0%} of breaking"
    if second < FLAT and number < 40:
        return "airy", f"airy: the second harmonic would be {second:.1%} of the height, below {FLAT:.0%} ({text})"
    share = f"{second:.1%} of the height" if second < 0.5 else "higher than the first"
    return "fenton", f"fenton: the second harmonic would be {share}, airy ends at {FLAT:.0%} ({text})"
