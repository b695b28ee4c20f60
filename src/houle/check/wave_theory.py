"""Checks of a wave by itself: is it inside the range of its theory, below breaking, and resolved by the grid?

The numbers go to `houle check`; doubts and refusals say the cure.
"""

from __future__ import annotations

from math import inf, pi, sqrt
from typing import Literal

import numpy as np

from houle.waves import dispersion
from houle.waves.cnoidal import Cnoidal
from houle.waves.limits import limits, ursell
from houle.waves.linear import Linear
from houle.waves.second_order import Kernel, SecondOrder
from houle.waves.stokes import URSELL, second_harmonic
from houle.waves.wave import Wave

Level = Literal["error", "warning", "info"]
Told = tuple[Level, str]  # level of a finding, and its text

CELLS_PER_LENGTH = (20.0, 50.0)  # cells in a wavelength: fewer are refused; fewer are warned of
CELLS_PER_HEIGHT = 0.2  # least without a warning: with it C_R, C_T of 36 blocks were within 0.02, heights within 0.5 %
MATTERS = 0.02  # share of the first harmonic: smaller harmonics do not matter
BENT = 0.03  # second harmonic over wave height from which on an airy wave is warned of
SPECTRA = ("jonswap", "pierson-moskowitz", "tma", "focused")  # kinds of waves that a spectrum gives
SECOND = 0.25  # bound second harmonic over the first from which on a sum of waves of second order is warned of
NEAR = 0.8  # share of the breaking limit from which on a wave is warned of


def assess(wave: Wave, spacing: float) -> list[Told]:
    """All that there is to say about a wave on a grid of this spacing [m]: its numbers as infos, then the findings."""
    return [*_numbers(wave, spacing), *_breaking(wave), *_theory(wave), *_resolution(wave, spacing)]


def bound(wave: Wave) -> str:
    """The bound waves of a sea or a group, and what first order makes of them, in words; "" for other waves.

    Records are told of at second order only: of many the linear waves are not known without it, nor a peak.
    """
    if not isinstance(wave, Linear) or not (wave.name in SPECTRA or isinstance(wave, SecondOrder)):
        return ""
    second = wave if isinstance(wave, SecondOrder) else SecondOrder.of_linear(wave, closed=True)
    sums, differences = second.sizes
    height = 4 * float(np.sqrt(np.sum(wave.parts.moving.amplitude**2) / 2))
    told = (
        f"Hm0 = {sums:.2g} m at the sums of frequencies ({sums / height:.1%}), {differences:.2g} m at the differences "
        f"({differences / height:.1%})"
    )
    if wave is second:
        return f"{told}; made with the waves"
    return f"{told}; order = 1 makes free waves as high with them, which run away from them; order = 2 does not"


def _solitary(wave: Wave) -> bool:
    return isinstance(wave, Cnoidal) and wave.ratio == inf


def _crest_to_trough(wave: Wave) -> float:
    """The wave height to compare with limits [m]; that of a focused group is twice its crest."""
    return 2 * wave.height if wave.name == "focused" else wave.height


def _numbers(wave: Wave, spacing: float) -> list[Told]:
    """Theory, dimensionless numbers, breaking limits and resolution of the wave, as infos."""
    h, d, dx = _crest_to_trough(wave), wave.depth, spacing
    many = isinstance(wave, Linear) and len(wave.parts.k) > 1
    lim = limits(h, wave.length, d)
    said: list[Told] = [("info", wave.reason or wave.name)]
    peak = " of the peak period" if many else ""
    if _solitary(wave):
        said.append(("info", f"H/d = {h / d:.3g}, {wave.length:.4g} m long, celerity {wave.celerity:.4g} m/s"))
        said.append(("info", f"highest wave {lim.mccowan:.4g} m (McCowan), {0.833 * d:.4g} m (Williams)"))
    else:
        said.append(
            (
                "info",
                f"wavelength{peak} {wave.length:.4g} m, celerity {wave.celerity:.4g} m/s, kh = {lim.kh:.3g}, "
                f"H/L = {lim.steepness:.3g}, Ursell number {lim.ursell:.3g}",
            )
        )
        said.append(
            (
                "info",
                f"highest wave {lim.miche:.4g} m (Miche), {lim.mccowan:.4g} m (McCowan), {lim.williams:.4g} m "
                f"(Williams); H = {h:.4g} m is {lim.share:.0%} of the lowest",
            )
        )
    said.append(("info", f"L/dx = {wave.length / dx:.3g}, H/dx = {h / dx:.3g}"))
    return said


def _breaking(wave: Wave) -> list[Told]:
    """The wave is below the highest possible one, and well below the breaking limit."""
    h, d = _crest_to_trough(wave), wave.depth
    lim = limits(h, 1e9 * d if _solitary(wave) else wave.length, d)
    regular = not isinstance(wave, Linear) or len(wave.parts.k) == 1
    if h > lim.williams:
        what = "the wave breaks" if regular else "waves of this height break"
        return [
            (
                "error",
                f"waves: H = {h:.4g} m is above the highest wave, {lim.williams:.4g} m for L = {wave.length:.4g} m and "
                f"d = {d:g} m: {what}; give a height below {lim.breaking:.3g} m or deeper water",
            )
        ]
    if h > NEAR * lim.breaking:
        return [
            (
                "warning",
                f"waves: H = {h:.4g} m is {lim.share:.0%} of the breaking limit {lim.breaking:.4g} m: crests may "
                f"break; below {NEAR * lim.breaking:.3g} m they should not",
            )
        ]
    return []


def _theory(wave: Wave) -> list[Told]:
    """The wave is inside the range of its theory."""
    lim = limits(wave.height, wave.length, wave.depth)
    said: list[Told] = []
    most = URSELL.get(wave.name)
    if most is not None and lim.ursell > most:
        said.append(
            (
                "error",
                f"waves: Ursell number {lim.ursell:.3g} is above {most:g}, where {wave.name} ends: its series has a "
                'false second crest; use theory = "fenton"',
            )
        )
    if wave.name == "airy" and (second := second_harmonic(wave.height, wave.length, wave.depth)) > BENT:
        said.append(
            (
                "warning",
                f"waves: the second harmonic of this wave is {second:.1%} of its height, above {BENT:.0%}: an airy "
                'wave starts without it and sends a free one after, which is slower; use theory = "auto"',
            )
        )
    if wave.name == "cnoidal":
        said += _cnoidal(wave)
    if _solitary(wave) and wave.height > 0.5 * wave.depth:
        said.append(
            (
                "warning",
                f"waves: H/d = {wave.height / wave.depth:.3g} is above 0.5: {wave.name} errs by "
                f"2 % of the depth and more; give a height below {0.5 * wave.depth:.3g} m",
            )
        )
    if isinstance(wave, SecondOrder):
        said += _second_order(wave)
    elif isinstance(wave, Linear) and len(wave.parts.k) > 1 and _crest_to_trough(wave) > 0.4 * wave.depth:
        said.append(
            (
                "warning",
                f"waves: H/d = {_crest_to_trough(wave) / wave.depth:.3g} is above 0.4: a sum of linear waves has no "
                f"bound harmonics there; heights below {0.4 * wave.depth:.3g} m are nearer to linear",
            )
        )
    return said


def _second_order(wave: SecondOrder) -> list[Told]:
    """The bound waves are small beside the waves that they are bound to: else the expansion has false crests.

    The bound harmonic of a wave of height Hm0 and the peak period is compared, k H (3 - s^2)/(8 s^3) with s = tanh k d:
    from a quarter of the wave on its troughs have a crest of their own.
    """
    omega = np.array([wave.peak])
    k = float(dispersion.wave_number(wave.peak, wave.depth, wave.gravity))
    height = _crest_to_trough(wave)
    level = float(Kernel.of(omega, omega, wave.depth, wave.gravity, 1).level[0]) * height / 2
    if level <= SECOND:
        return []
    return [
        (
            "warning",
            f"waves: kh = {k * wave.depth:.3g}, Ursell number {ursell(height, 2 * pi / k, wave.depth):.3g}: the "
            f"bound second harmonic of a wave of {height:.3g} m is {level:.0%} of it, above {SECOND:.0%}, where second "
            f"order ends: its troughs have crests; heights below {height * SECOND / level:.2g} m, or make the waves in "
            "deeper water",
        )
    ]


def _cnoidal(wave: Wave) -> list[Told]:
    """A cnoidal wave is long enough, and low enough for a theory of third order."""
    ratio, height = wave.length / wave.depth, wave.height / wave.depth
    if ratio < 8:
        text = f"waves: L/d = {ratio:.3g} is below 8, where cnoidal theory ends"
        return [("error", text + '; use theory = "fenton"')]
    if height > 0.4:
        text = f"waves: H/d = {height:.3g} is above 0.4: third-order theory errs by some {height**4:.0%} of the depth"
        return [("warning", text + '; use theory = "fenton"')]
    return []


def _resolution(wave: Wave, spacing: float) -> list[Told]:
    """The grid has enough cells in the length and the height of the wave, and of its harmonics or components."""
    h, said = _crest_to_trough(wave), list[Told]()
    least, good = CELLS_PER_LENGTH
    cells = wave.length / spacing
    if cells < least:
        said.append(
            (
                "error",
                f"waves: L/dx = {cells:.3g} is below {least:g}: the grid cannot carry L = {wave.length:.4g} m; "
                f"give domain.spacing below {wave.length / least:.3g} m",
            )
        )
    elif cells < good:
        said.append(
            (
                "warning",
                f"waves: L/dx = {cells:.3g} is below {good:g}: the wave will decay and lag; "
                f"give domain.spacing below {wave.length / good:.3g} m",
            )
        )
    if (cells := h / spacing) < CELLS_PER_HEIGHT * (1 - 1e-9):
        said.append(
            (
                "warning",
                f"waves: H/dx = {cells:.3g} is below {CELLS_PER_HEIGHT:g}: the levels at a gauge scatter by some "
                f"hundredths of a cell; give domain.spacing below {h / CELLS_PER_HEIGHT:.3g} m",
            )
        )
    said += _harmonics(wave, spacing)
    said += _short_components(wave, spacing)
    return said


def _harmonics(wave: Wave, spacing: float) -> list[Told]:
    """The grid carries the shortest harmonic of a regular wave that matters. Silent if it cannot carry the first."""
    parts = wave.components()
    if parts is None or len(parts.k) == 1 or isinstance(wave, Linear):
        return []
    share = np.abs(parts.amplitude / parts.amplitude[0])
    number = 1 + int(np.flatnonzero(share >= MATTERS).max())
    cells = wave.length / number / spacing
    if cells >= CELLS_PER_LENGTH[0] or wave.length / spacing < CELLS_PER_LENGTH[0]:
        return []
    good = wave.length / number / CELLS_PER_LENGTH[0]
    return [
        (
            "warning",
            f"waves: harmonic {number}, {share[number - 1]:.1%} of the first, has {cells:.3g} cells in its length, "
            f"{wave.length / number:.3g} m: below {CELLS_PER_LENGTH[0]:g} it decays; domain.spacing below {good:.3g} m",
        )
    ]


def _short_components(wave: Wave, spacing: float) -> list[Told]:
    """The grid carries all components of a sum of linear waves but a small share of their energy."""
    if not isinstance(wave, Linear) or len(wave.parts.k) == 1:
        return []
    shortest = CELLS_PER_LENGTH[0] * spacing
    energy = wave.parts.amplitude**2
    short = float(energy[wave.parts.k * shortest > 2 * pi].sum())
    lost, height = short / float(energy.sum()), 4 * sqrt(short / 2)
    if lost < 0.02 and height < 0.05 * wave.height:
        return []
    f = dispersion.frequency(2 * pi / shortest, wave.depth, wave.gravity) / (2 * pi)
    return [
        (
            "warning",
            f"waves: {lost:.1%} of the energy, Hm0 = {height:.2g} m, "
            f"is in waves shorter than {CELLS_PER_LENGTH[0]:g} dx = {shortest:.3g} m "
            f"(above {float(f):.3g} Hz), which the grid damps; a smaller domain.spacing keeps them",
        )
    ]
