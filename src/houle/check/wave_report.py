"""What `houle check` tells about waves: the wave, the maker, the sponges, and when the gauges can be believed."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from houle.analysis import AnalysisError, choose_window
from houle.boundary.makers import damping, left_over
from houle.boundary.sponge import sides
from houle.case.build import law_of_piston, source_of
from houle.case.messages import place
from houle.case.model import Case
from houle.case.tables.results import Reflection
from houle.case.tables.tank import Sponge
from houle.case.tables.waves import Piston, Source
from houle.check.section import Finding, Section
from houle.check.waves import reach
from houle.results.reflection import limits
from houle.waves import dispersion
from houle.waves.check import assess
from houle.waves.piston import Reading, reading_of
from houle.waves.wave import Wave

FEWEST, FEWEST_OF_A_SPECTRUM = 3, 20  # periods of a window
SETTLE = 2.0  # periods after the front


def wave_rows(case: Case) -> list[tuple[str, str]]:
    """(name, words) about the wave of the case and its maker; the numbers of `waves.check.assess`."""
    wave = case.wave
    if wave is None:
        return []
    assert case.waves is not None
    numbers = [text for level, text in assess(wave, max(case.domain.grid.spacing)) if level == "info"]
    names = ("theory", "size", "limits", "on the grid") if len(numbers) == 4 else ("theory", *[""] * (len(numbers) - 1))
    rows = [("wave", _wave(case)), *zip(names, numbers, strict=True), ("made by", _maker(case, wave))]
    return [rows[0], ("current", _current(case.waves.current, wave)), *rows[1:]] if case.waves.current else rows


def _current(speed: float, wave: Wave) -> str:
    """What the current does to a wave with a period."""
    own = wave.celerity - speed
    words = f"{speed:g} m/s; crests run at {own:.4g} m/s in the water, {wave.celerity:.4g} m/s seen from the bed"
    if wave.name.startswith("solitary"):
        return words
    still = 2 * pi / float(dispersion.wave_number(wave.omega, wave.depth, wave.gravity))
    relative = wave.length / own
    return f"{words}; period {relative:.4g} s in the water; length {wave.length / still:.3f} of that in still water"


def _wave(case: Case) -> str:
    waves = case.waves
    assert waves is not None
    sizes = (("height", waves.height, "m"), ("period", waves.period, "s"), ("depth", waves.depth, "m"))
    given = [f"{name} = {value:g} {unit}" for name, value, unit in sizes if value is not None]
    return ", ".join([str(waves.kind), *given, *([waves.file] if waves.file else [])])


def _maker(case: Case, wave: Wave) -> str:
    waves = case.waves
    assert waves is not None
    then = f"; full after {waves.ramp_time():.3g} s; the front runs at {wave.group_velocity:.3g} m/s"
    if isinstance(waves.maker, Source):
        width, (low, high) = source_of(waves, wave).width, reach(case, wave)
        side = {"both": "to both sides", "left": "to the left", "right": "to the right"}[waves.maker.side]
        at = f"source at x = {waves.maker.x:g} m, {width:.3g} m wide, acts from {low:.3g} to {high:.3g} m"
        return f"{at}; {side}{then}"
    if isinstance(waves.maker, Piston):
        return f"{_piston(case, wave)}{then}"
    start, end = waves.maker.x
    long = f"{(end - start) / wave.length:.2f} wavelengths"
    return f"relaxation zone, x {start:g} to {end:g} m, {long}; takes up what comes back{then}"


def _piston(case: Case, wave: Wave) -> str:
    """Stroke, height over stroke, where it moves, by which theory."""
    law, read, rest = law_of_piston(case, wave)
    low, high = law.reach
    compared = f"H/stroke = {wave.height / (high - low):.3g}, " if high - low > 1e-9 else ""
    told = (
        f"piston at x = {rest:g} m, stroke {high - low:.3g} m, {compared}moves from "
        f"{rest + low:.3g} to {rest + high:.3g} m; {law.theory}"
    )
    assert case.waves is not None and case.waves.piston is not None
    return f"{told}; absorbs, {_back(read, wave.period)}" if case.waves.piston.absorb else told


def _back(read: Reading, period: float) -> str:
    """Linear theory of what an absorbing wall sends back of some waves."""
    shares = [f"{100 * read.comes_back(2 * pi / t):.2g} % at T = {t:.3g} s" for t in (period / 2, period, 2 * period)]
    return f"sends back {', '.join(shares)}"


def absorber_rows(case: Case) -> list[tuple[str, str]]:
    """(name, words) of every absorbing wall."""
    wave, depth = case.wave, Section(case).depth()
    rows = []
    for i, table in enumerate(case.absorber):
        read = reading_of(wave, depth, case.fluid.gravity, table.period)
        rest = case.domain.grid.nearest_face(table.x)
        at = f"{table.side} end, at rest at x = {rest:g} m"
        rows.append((place(("absorber", i), case.__dict__), f"{at}; {_back(read, _tuned(read, wave, table.period))}"))
    return rows


def _tuned(read: Reading, wave: Wave | None, period: float | None) -> float:
    """The period to tell about [s]."""
    return period or (wave.period if wave is not None else 2 * pi / read.omega)


def sponge_rows(case: Case) -> list[tuple[str, str]]:
    """(name, words) of every sponge: where, how long, how strong, what comes back."""
    wave = case.wave
    speed = wave.group_velocity if wave is not None else sqrt(case.fluid.gravity * Section(case).depth())
    return [(place(("sponge", i), case.__dict__), _sponge(case, s, wave, speed)) for i, s in enumerate(case.sponge)]


def _sponge(case: Case, sponge: Sponge, wave: Wave | None, speed: float) -> str:
    axis, far = sides(sponge.box, case.domain.size, min(case.domain.grid.spacing) / 2)[0]
    long = sponge.box[1][axis] - sponge.box[0][axis]
    strength = sponge.strength or damping(speed, long)
    side = (("left", "right"), ("front", "back"))[axis][far]
    waves = f" ({long / wave.length:.2f} wavelengths)" if wave is not None else ""
    back = left_over(strength, speed, long)
    return f"{side} side, {long:.3g} m long{waves}, up to {strength:.3g} 1/s: {100 * back:.2g} % of the waves come back"


@dataclass(frozen=True)
class Flume:
    """What stands along x, seen from the maker to the right [m]."""

    maker: float
    gauges: list[float]
    structure: float | None  # first face of what stands in the water behind the maker
    left: float | None  # the wall that sends waves back behind the maker, None if they are taken up
    right: float | None  # the wall at the other end, None behind a sponge

    @classmethod
    def of(cls, case: Case, section: Section, wave: Wave) -> Flume:
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
    """When the gauges to the right of the maker read incident and reflected waves and nothing else, or why never.

    None without gauges, and for waves that pass once.
    """
    wave, waves = case.wave, case.waves
    if wave is None or waves is None or waves.kind in ("solitary", "focused", "series"):
        return None
    fewest, end = FEWEST if waves.kind == "regular" else FEWEST_OF_A_SPECTRUM, case.time.end
    if case.reflection is not None:
        return _measured(case, wave, case.reflection, fewest)
    flume = Flume.of(case, Section(case), wave)
    if not flume.gauges or (waves.source is not None and waves.source.side == "left"):
        return None
    face = flume.structure if flume.structure is not None else flume.right
    ramp = waves.ramp_time() / wave.period
    if face is None or face <= flume.gauges[0]:  # nothing in front of the gauges sends waves back
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
    return Finding("info", "gauges", f"can be taken apart from {window}")


def _measured(case: Case, wave: Wave, asked: Reflection, fewest: int) -> Finding | None:
    """The window of [reflection], as it is chosen at the end of the run."""
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
