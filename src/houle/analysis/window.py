"""The window to measure in: the reflected wave is steady at every gauge, and no wave has come back a second time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from houle.analysis.errors import AnalysisError, positive
from houle.waves.dispersion import GRAVITY, group_velocity, wave_number

ENOUGH = 5  # periods of measurement; beyond these it is better to begin later than to measure longer


@dataclass(frozen=True)
class Window:
    """A window start <= t < end [s] of a whole number of `periods`; `reason` is a sentence on both ends."""

    start: float
    end: float
    periods: int
    reason: str

    def __str__(self) -> str:
        return f"{self.start:.4g} to {self.end:.4g} s ({self.periods} periods): {self.reason}"


def choose_window(
    omega: float,
    depth: float,
    *,
    maker: float,
    structure: float,
    gauges: Sequence[float],
    until: float,
    ramp: float = 2.0,
    settle: float = 2.0,
    rear: float | None = None,
    reflector: float | None = None,
    absorbing: bool = False,
    far_end: float | None = None,
    minimum: int = 3,
    gravity: float = GRAVITY,
) -> Window:
    """The longest window in which the gauges hold the incident wave and its first reflection, both steady, and no more.

    Fronts travel with the group velocity of omega [rad/s] from t = 0. Places are x [m] along the flume.
    maker      place of the maker                 structure  place of its first face
    gauges     places in front of the structure, behind it, or both
    until      end of the record [s]              ramp       periods over which the maker starts
    settle     periods to wait after the front: it is spread by dispersion and ends in a group
    rear       a wall in or behind the structure: the wave that goes there and back must be steady, too
    reflector  place that sends the reflected wave back: None is the paddle; or the end behind an internal source
    absorbing  true if nothing sends it back: an absorbing paddle, or a sponge behind the source. No absorber is
    perfect: if the record
               leaves ENOUGH periods after it, the window begins one more way to the structure and back later, when the
               few percent that come back are steady, too. Before, they change the incident wave but not yet the
               reflected one: C_R is wrong by their share times C_R squared.
    far_end    place that sends the transmitted wave back, None if it is absorbed
    minimum    fewest periods
    Raises AnalysisError, which says how much longer the flume or the record must be.
    """
    positive(omega=omega, depth=depth, gravity=gravity)
    period = 2 * np.pi / omega
    speed = float(group_velocity(wave_number(omega, depth, gravity), depth, gravity))
    along = 1.0 if structure > maker else -1.0
    at = along * (np.asarray(gauges, dtype=float) - maker)  # distances from the maker
    face = along * (structure - maker)
    if not (len(at) and face > 0 and at.min() >= 0):
        raise AnalysisError(
            f"gauges at {list(gauges)} m: they must be on the side of the structure ({structure:g} m) of the maker"
        )
    back = face if rear is None else along * (rear - maker)
    steady = (back + abs(back - at.min())) / speed if at.min() < face else at.max() / speed
    start = max(steady, at.max() / speed) + (ramp + settle) * period
    ends = [(until, "the record ends")]
    if not absorbing:
        turn = 0.0 if reflector is None else along * (reflector - maker)  # 0 or negative
        ends.append(((2 * face - 2 * turn + at.min()) / speed, "the wave re-reflected from the maker arrives"))
    if far_end is not None:
        away = along * (far_end - maker)
        ends.append(((2 * away - at.max()) / speed, "the transmitted wave comes back from the far end"))
    end, why = min(ends)
    further = ""
    echo = start + 2 * face / speed
    if absorbing and int(np.floor((end - echo) / period + 1e-9)) >= ENOUGH:
        start, further = echo, "and what little the maker sends back "
    periods = int(np.floor((end - start) / period + 1e-9))
    if periods < minimum:
        raise AnalysisError(_too_short(start, end, why, period, speed, minimum))
    reason = (
        f"the reflected wave {further}is steady at all gauges after {start:.3g} s (group velocity {speed:.3g} m/s, "
        f"{ramp:g} periods of ramp, {settle:g} to settle); {why} at {end:.3g} s"
    )
    return Window(start, start + periods * period, periods, reason)


def _too_short(start: float, end: float, why: str, period: float, speed: float, minimum: int) -> str:
    missing = start + minimum * period - end
    fact = (
        f"the gauges are steady at {start:.3g} s and {why} at {end:.3g} s, {minimum} periods of {period:.3g} s do "
        "not fit"
    )
    if why.startswith("the record"):
        return f"the record is too short: {fact}. Run {missing:.3g} s longer, or start with a shorter ramp"
    metres = 0.5 * missing * speed
    if why.startswith("the transmitted"):
        return (
            f"the flume is too short: {fact}. Move the far end {metres:.3g} m away, or absorb the wave there "
            "(far_end=None)"
        )
    return (
        f"the flume is too short: {fact}. Put {metres:.3g} m more between maker and structure, or absorb the wave at "
        "the maker (absorbing=True)"
    )
