"""The time window in which gauges read steady waves: the incident and the reflected ones, and no others."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from houle.analysis import AnalysisError, choose_window
from houle.case.acting import reach
from houle.case.model import Case
from houle.case.section import CrossSection
from houle.case.tables.results import Reflection
from houle.case.tables.waves import PASSING, Source
from houle.check.finding import Finding
from houle.results.reflection import limits
from houle.waves.wave import Wave

FEWEST, FEWEST_OF_A_SPECTRUM = 3, 20  # least periods in a window, for regular waves and for a spectrum
SETTLE = 2.0  # periods from the arrival of the full wave until it is steady


@dataclass(frozen=True)
class DrawnFlume:
    """Places along the flume, as it is drawn, that waves meet on their way from the maker to the right, x [m].

    maker      right end of the interval in which the maker acts
    gauges     gauges to the right of that
    structure  first face of a porous body or solid to the right of it, None without
    left       wall that reflects waves which come back to the maker, None if they are absorbed
    right      wall at the right end, None if a sponge or an absorber stands there
    """

    maker: float
    gauges: list[float]
    structure: float | None
    left: float | None
    right: float | None

    @classmethod
    def of(cls, case: Case, section: CrossSection, wave: Wave) -> DrawnFlume:
        assert case.waves is not None
        source = isinstance(case.waves.maker, Source)
        maker = reach(case, wave)[1] if not source else case.waves.place
        near, size = case.domain.spacing, case.domain.size[0]
        piston, left = case.waves.piston, 0.0
        quiet = not source or any(s.box[0][0] <= near for s in case.sponge)
        if piston is not None:
            quiet, left = piston.absorb, piston.x
        quiet = quiet or any(a.side == "left" for a in case.absorber)
        taken = any(s.box[1][0] >= size - near for s in case.sponge) or any(a.side == "right" for a in case.absorber)
        faces = [float(b.shape.bounds[0][0]) for b in (*section.porous, *section.solid)]
        faces = [x for x in faces if maker < x < size]
        gauges = sorted(g.x for g in case.gauge if g.x >= maker)
        return cls(maker, gauges, min(faces, default=None), None if quiet else left, None if taken else size)


def steady(case: Case) -> Finding | None:
    """The window in which gauges right of the maker read incident and reflected waves alone, or why there is none.

    None without gauges, and for waves that pass only once.
    """
    wave, waves = case.wave, case.waves
    if wave is None or waves is None or waves.kind in PASSING:
        return None
    fewest, end = FEWEST if waves.kind == "regular" else FEWEST_OF_A_SPECTRUM, case.time.end
    if case.reflection is not None:
        return _measured(case, wave, case.reflection, fewest)
    flume = DrawnFlume.of(case, CrossSection(case), wave)
    if not flume.gauges or (waves.source is not None and waves.source.side == "left"):
        return None
    face = flume.structure if flume.structure is not None else flume.right
    ramp = waves.ramp_time() / wave.period
    if face is None or face <= flume.gauges[0]:  # nothing beyond the gauges reflects waves
        start = (flume.gauges[-1] - flume.maker) / wave.group_velocity + (ramp + SETTLE) * wave.period
        if (periods := int((end - start) / wave.period + 1e-9)) >= fewest:
            return Finding("info", "gauges", f"see steady waves from {start:.3g} s on, {periods} periods")
        text = (
            f"= {end:g} s is too short: the waves are steady at all gauges from {start:.3g} s on, {fewest} periods of "
        )
        return Finding(
            "warning", "time.end", text + f"{wave.period:.3g} s are needed: {start + fewest * wave.period:.3g}"
        )
    try:
        window = choose_window(
            2 * pi / wave.period, wave.depth, maker=flume.maker, structure=face, gauges=flume.gauges, until=end,
            ramp=ramp, settle=SETTLE, rear=flume.right, reflector=flume.left, absorbing=flume.left is None,
            minimum=fewest, gravity=wave.gravity,
        )  # fmt: skip
    except AnalysisError as error:
        return _no_window(error)
    return Finding("info", "gauges", f": incident and reflected waves can be separated from {window}")


def _measured(case: Case, wave: Wave, asked: Reflection, fewest: int) -> Finding | None:
    """The window of [reflection]: the one that the end of the run will choose, or a warning about the one given."""
    end = case.time.end
    if asked.window is not None:
        low, high = asked.window
        if min(high, end) - low >= 2 * wave.period:
            return None
        text = f"= [{low:g}, {high:g}] s holds less than 2 periods of {wave.period:.3g} s before time.end = {end:g} s"
        return Finding("warning", "reflection.window", text)
    places = {gauge.name: gauge.x for gauge in case.gauge}
    gauges = [places[name] for name in (*asked.gauges, *asked.behind)]
    try:
        window = choose_window(
            2 * pi / wave.period, wave.depth, gauges=gauges, until=end, minimum=fewest, gravity=wave.gravity,
            **limits(case, wave),
        )  # fmt: skip
    except AnalysisError as error:
        return _no_window(error)
    return Finding("info", "reflection", f"is measured from {window}")


def _no_window(error: AnalysisError) -> Finding:
    key = "time.end" if str(error).startswith("the record") else "domain.size"
    cure = "with a [[sponge]] behind the source, or a piston that absorbs"
    return Finding("warning", key, f": {str(error).replace('(absorbing=True)', cure)}")
