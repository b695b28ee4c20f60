"""Energy budget of the waves: work of the maker = sponges + drag + viscosity + stored + lost in numbers.

It is made for runs with [waves], from their series, as mean powers over the last periods. Potential energy is that of
the levels of the columns (`potential_energy` of such runs). The remainder is the loss in numbers. It is compared with
the energy that the waves hold: the loss per wavelength is the share lost in L / c_g, while the energy goes a
wavelength.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from houle.case.tables.waves import PASSING, Waves
from houle.results.reflection import wave_of

if TYPE_CHECKING:
    from houle.case.model import Case
    from houle.results.run import Run
    from houle.waves.wave import Wave

PERIODS = 5  # periods at the end of the run over which means are taken
FEWEST = 2  # periods with which there is a budget
SETTLE = 2.0  # periods after the ramp before the budget begins
GIVEN = ("source_work", "open_work", "energy_exchange")
TAKEN = ("sponge_work", "drag_work", "viscous_work", "friction_work")


def record(run: Run) -> dict[str, Any]:
    """The entry "wave_energy" of run.json; {} without periodic waves, or when the run is too short for them."""
    window = None if run.case.waves is None else _window(run.case, float(run.series.time[-1]))
    if window is None:
        return {}
    wave, (start, end) = wave_of(run.case), window
    row = run.series.interp(time=[start, end])
    mean = {name: float(np.diff(row[name])[0]) / (end - start) for name in (*GIVEN, *TAKEN) if name in row}
    energy = run.series.kinetic_energy + run.series.potential_energy
    stored = float(np.diff(energy.interp(time=[start, end]))[0]) / (end - start)
    lost = sum(mean.get(name, 0.0) for name in GIVEN) - sum(mean.get(name, 0.0) for name in TAKEN) - stored
    held = float(energy.sel(time=slice(start, end)).mean() - energy[0])
    entry = {"unit": "W/m" if run.case.dimension == 2 else "W", "start": start, "end": end, **mean, "stored": stored}
    entry |= {"periods": round((end - start) / wave.period), "lost": lost, "held": held}
    return {"wave_energy": {**entry, "lost_per_wavelength": _per_wavelength(lost, held, wave)}}


def _window(case: Case, end: float) -> tuple[float, float] | None:
    """The last whole periods [s] after the ramp."""
    waves: Waves | None = case.waves
    if waves is None or waves.kind in PASSING:
        return None
    period = wave_of(case).period
    periods = min(PERIODS, int((end - waves.ramp_time() - SETTLE * period) / period + 1e-9))
    return (end - periods * period, end) if periods >= FEWEST else None


def _per_wavelength(lost: float, held: float, wave: Wave) -> float:
    return lost * wave.length / wave.group_velocity / held if held > 0 else float("nan")
