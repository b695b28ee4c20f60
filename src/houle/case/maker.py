"""What makes the waves of [waves]: the law of its piston, the source inside the water."""

from __future__ import annotations

from houle.boundary.internal_source import Source, source_width
from houle.case.model import Case
from houle.case.tables.waves import Waves
from houle.waves.piston import Law, Reading, law_of, reading_of
from houle.waves.wave import Wave


def law_of_piston(case: Case, wave: Wave) -> tuple[Law, Reading, float]:
    """How the piston of a case moves, what it reads, and where it stands at rest [m]. Raises CaseError."""
    waves = case.waves
    assert waves is not None and waves.piston is not None
    rest = case.domain.grid.nearest_face(waves.piston.x)
    read = reading_of(wave, wave.depth, wave.gravity)
    return law_of(wave, rest, read, waves.ramp_time(), regular=waves.kind == "regular"), read, rest


def source_of(table: Waves, wave: Wave) -> Source:
    """The source of [waves], its width known."""
    given = table.source
    assert given is not None
    return Source(given.x, source_width(given.width, table.kind, wave), given.form, given.side)
