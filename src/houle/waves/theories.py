"""Regular waves by the name of their theory, or by the theory that fits (theory = "auto")."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from math import pi

from houle.waves import dispersion
from houle.waves.cnoidal import cnoidal
from houle.waves.fenton import NotConverged
from houle.waves.limits import miche, ursell, williams
from houle.waves.stokes import second_harmonic
from houle.waves.wave import KINDS, THEORIES, Kind, Theory, Wave, WaveError

LOW = 0.6  # share of the highest wave: a lower wave for which no Fourier series is found is too long, not too high
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
    """The regular wave of this theory (one of `THEORIES`): height crest to trough [m], period [s], depth [m].

    Crest at x = 0, t = 0 for phase = 0. Raises WaveError with the cure if the theory cannot give the wave.
    """
    if (make := THEORIES[theory].make) is not None:
        return make(height, period, depth, gravity, phase, direction)
    name, reason = choose(height, period, depth, gravity)
    try:
        return replace(regular(name, height, period, depth, gravity, phase, direction), reason=reason)
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
    """The theory for a regular wave, "airy" or "fenton", and the reason. Raises WaveError for one that breaks."""
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


THEORIES.add(
    Theory(
        "auto",
        "Airy where the second harmonic is below 1 % of the height, else the stream function, else (too long a wave "
        "for its series) cnoidal. The choice and its reason are printed by `houle check`.",
        "regular waves below breaking",
        "after the chart of Le Mehaute (1976); docs/waves.md",
        None,
        place=0,
    )
)
KINDS.add(
    Kind(
        "regular",
        "Waves that are all alike, by one of the theories above.",
        "where its theory holds",
        "see there",
        needs=("height", "period"),
        takes=("theory",),
        place=0,
    )
)
