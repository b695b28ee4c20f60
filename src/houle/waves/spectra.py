"""Random seas and focused groups: a spectrum, its discretisation, seeded phases.

Spectra [m2/Hz], every one scaled so that the discrete components have the wanted Hm0 = 4 sqrt(m0) exactly:

    pierson-moskowitz   f^-5 exp(-5/4 (f/fp)^-4)                              Pierson & Moskowitz (1964)
    jonswap             the former times gamma^exp(-(f/fp - 1)^2 / 2 sigma^2), sigma = 0.07 below fp, 0.09 above
                                                                              Hasselmann et al. (1973)
    tma                 jonswap times tanh^2(kd)/(1 + 2kd/sinh 2kd), the depth function of Kitaigorodskii et al. (1975)
                                                                              Bouws et al. (1985), J. Geophys. Res. 90

The band 0.5 fp to 3.5 fp is cut into equal cells (the tail above holds 0.8 % of the energy of Pierson-Moskowitz); each
component carries the energy of its cell, at a frequency drawn at random within it. So no two differences of frequencies
are alike and the sea does not repeat, unlike with equal spacing, where it does after 1/df.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from houle.waves import dispersion
from houle.waves.current import wave_number
from houle.waves.linear import Linear
from houle.waves.wave import GAMMA, KINDS, Array, Components, Kind

BAND = (0.5, 3.5)  # frequencies of the components, in peak frequencies
COUNT = 200  # components
SUB = 32  # points of the spectrum in a cell
HIGHEST = 1.86  # highest wave of 1000 over Hm0 (Rayleigh); no crest is expected above 0.6 of it


def pierson_moskowitz(f: Array, peak: float) -> Array:
    """Spectrum of Pierson and Moskowitz at f [Hz], to a factor [1/Hz^5]."""
    return f**-5.0 * np.exp(-1.25 * (f / peak) ** -4.0)


def jonswap(f: Array, peak: float, gamma: float) -> Array:
    """JONSWAP spectrum at f [Hz], to a factor: that of Pierson and Moskowitz with its peak raised gamma times."""
    sigma = np.where(f <= peak, 0.07, 0.09)
    return pierson_moskowitz(f, peak) * gamma ** np.exp(-(((f / peak - 1) / sigma) ** 2) / 2)


def tma(f: Array, peak: float, gamma: float, depth: float, gravity: float) -> Array:
    """TMA spectrum at f [Hz], to a factor: JONSWAP in water of this depth [m]."""
    kd = dispersion.wave_number(2 * np.pi * f, depth, gravity) * depth
    x = np.minimum(2 * kd, 700.0)
    return jonswap(f, peak, gamma) * np.tanh(kd) ** 2 / (1 + x / np.sinh(x))


def shape(kind: str, f: Array, peak: float, gamma: float, depth: float, gravity: float) -> Array:
    """The spectrum of this name in the case file at f [Hz], to a factor."""
    if kind == "pierson-moskowitz":
        return pierson_moskowitz(f, peak)
    return tma(f, peak, gamma, depth, gravity) if kind == "tma" else jonswap(f, peak, gamma)


@dataclass(frozen=True)
class Cells:
    """Frequencies [Hz] and relative energy (sum 1) of the components."""

    f: Array
    energy: Array


def cells(
    kind: str, period: float, gamma: float, depth: float, gravity: float, count: int, draw: np.random.Generator
) -> Cells:
    """The components of a spectrum, one in each of `count` cells of the band; their frequencies are drawn first."""
    edges = np.linspace(*BAND, count + 1) / period
    width = edges[1] - edges[0]
    inside = edges[:-1, None] + (np.arange(SUB) + 0.5) / SUB * width
    energy = shape(kind, inside, 1 / period, gamma, depth, gravity).mean(-1)
    return Cells(edges[:-1] + draw.random(count) * width, energy / energy.sum())


def irregular(
    kind: str,
    height: float,
    period: float,
    depth: float,
    gravity: float,
    direction: float = 0.0,
    seed: int = 1,
    gamma: float = GAMMA,
    count: int = COUNT,
    current: float = 0.0,
) -> Linear:
    """A long-crested random sea of significant height Hm0 [m] and peak period [s].

    kind "jonswap", "pierson-moskowitz" or "tma". The same seed gives the same sea, bit for bit, on every machine
    (numpy's PCG64): frequencies first, then phases. Amplitudes are not random: every realisation has the wanted Hm0.
    """
    draw = np.random.Generator(np.random.PCG64(seed))
    c = cells(kind, period, gamma, depth, gravity, count, draw)
    amplitude = np.sqrt(2 * c.energy) * height / 4
    phase = draw.random(count) * 2 * np.pi
    omega = 2 * np.pi * c.f
    k = wave_number(omega, depth, gravity, current)
    parts = Components(amplitude, omega, k, phase, np.full(count, direction))
    return Linear.of(kind, height, period, depth, gravity, parts, 0.6 * HIGHEST * height, current)


def focused(
    height: float,
    period: float,
    depth: float,
    gravity: float,
    x: float,
    time: float,
    direction: float = 0.0,
    seed: int = 1,
    gamma: float = GAMMA,
    count: int = COUNT,
    current: float = 0.0,
) -> Linear:
    """NewWave: the most probable shape around a high crest of a JONSWAP sea, its autocorrelation.

    The crest stands `height` [m] ABOVE STILL WATER at x [m] and `time` [s]; amplitudes in proportion to the energy.
    Tromans, Anaturk & Hagemeijer (1991), Proc. 1st ISOPE. The seed only places the frequencies in their cells.
    """
    c = cells("jonswap", period, gamma, depth, gravity, count, np.random.Generator(np.random.PCG64(seed)))
    omega = 2 * np.pi * c.f
    k = wave_number(omega, depth, gravity, current)
    parts = Components(height * c.energy, omega, k, omega * time - k * x, np.full(count, direction))
    return Linear.of("focused", height, period, depth, gravity, parts, height, current)


KINDS.add(
    Kind(
        "jonswap",
        "Random sea, 200 components at seeded random frequencies and phases.",
        "Hm0/d below 0.4",
        "Hasselmann et al. (1973)",
        needs=("height", "period"),
        takes=("seed", "seeds", "gamma", "order"),
        place=2,
    )
)
KINDS.add(
    Kind(
        "pierson-moskowitz",
        "Random sea, fully grown: JONSWAP with gamma = 1.",
        "deep water",
        "Pierson & Moskowitz (1964)",
        needs=("height", "period"),
        takes=("seed", "seeds", "order"),
        place=3,
    )
)
KINDS.add(
    Kind(
        "tma",
        "Random sea: JONSWAP in finite depth.",
        "Hm0/d below 0.4",
        "Bouws et al. (1985)",
        needs=("height", "period"),
        takes=("seed", "seeds", "gamma", "order"),
        place=4,
    )
)
KINDS.add(
    Kind(
        "focused",
        "NewWave: the likeliest shape of a high crest, at a given place and time; height is the crest above the level.",
        "linear, or order = 2",
        "Tromans, Anaturk & Hagemeijer (1991)",
        needs=("height", "period", "focus"),
        takes=("seed", "gamma", "order"),
        place=5,
    )
)
