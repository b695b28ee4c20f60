"""Answers of [[armour]]: the largest loads on its stones (`houle.results.armour`), and the damage by formula.

They are indicators of stability: no stone moves in a run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import cos, sin, sqrt
from typing import TYPE_CHECKING, Any

from houle.design.armour import armour_damage_van_der_meer, armour_damage_van_gent
from houle.errors import CaseError
from houle.results.answers.formulas import beside
from houle.results.answers.given import Given, Question, with_formulas, worst
from houle.results.answers.outline import OutlineError, outline_of
from houle.results.answers.table import Answer, Beside, not_answered

if TYPE_CHECKING:
    from houle.results.answers.structure import Outline, Sea

INDICATOR = "an indicator: no stone moves in the run"
LIFTS = "cos(beta): lifts a stone"
ALONG = "sin(beta): a phreatic line along the slope"
STORM = 3000.0  # waves for which damage is usually told
ON_SOLID, ON_POROUS, ALONE = 0.1, 0.5, 0.6  # notional permeability P
Entry = Mapping[str, Any]


def questions(given: Given, runs: Sequence[Sequence[Entry]]) -> Iterator[Question]:
    """Two questions for each armour, from its entry in run.json of each run: loads on its stones, damage by formula."""
    for entries in zip(*runs, strict=True):
        name = f"armour {entries[0]['armour']}"
        yield name, partial(worst, given, [partial(_loads, given, entry) for entry in entries])
        if given.sea is not None and "problem" not in entries[0]:
            yield f"{name}, damage level S", partial(_damage, given, entries[0])


def _loads(given: Given, entry: Entry) -> Iterator[Answer]:
    """The rows of the loads. Raises CaseError where nothing could be said of them."""
    if "problem" in entry:
        raise CaseError(entry["problem"])
    force, down = entry["force_over_weight"], entry["gradient_down"]
    about = f"stones of D_n50 {entry['size']:.3g} m, n {entry['porosity']:g}, Delta {entry['buoyant']:.3g}"
    lifts, along = Beside(LIFTS, cos(force["slope"])), Beside(ALONG, sin(down["slope"]))
    row = partial(_row, given, entry)
    yield row("force out over submerged weight", force, "-", "armour force", lifts).noted(INDICATOR, about)
    yield row("run-down gradient", down, "-", "armour gradient", along)
    yield row("largest speed over the stones", entry["speed"], "m/s", "armour speed")
    yield row("largest pore velocity", entry["pore_velocity"], "m/s", "armour speed")


def _row(given: Given, entry: Entry, what: str, largest: Entry, unit: str, group: str, *limit: Beside) -> Answer:
    """The row of the stone on which a load is largest, with place, time and duration, and what is held against it."""
    x, z = largest["x"], largest["z"]
    height = f"z = {z:.4g} m" if given.sea is None else f"{z - given.sea.level:+.3g} m from still water"
    place = f"at x = {x:.4g} m, {height}, {largest['time']:.4g} s, above half of it for {largest['lasts']:.2g} s"
    tenth = largest["tenth"]
    highest = "" if tenth is None else f"mean of the highest tenth of the waves there {tenth:.3g}"
    method = f"largest of {entry['stones']} stones, {given.when(entry['place'])}"
    name = f"armour {entry['armour']}, {what}"
    return Answer(name, largest["value"], unit, method=method, formulas=limit, group=group).noted(place, highest)


def _damage(given: Given, entry: Entry) -> Iterator[Answer]:
    """The row of the damage, which a run does not tell, with the formulas for it."""
    name, sea = f"armour {entry['armour']}, damage level S", given.sea
    assert sea is not None
    row = replace(not_answered(name, "no stone moves in a run, see the formulas", "-"), group="damage")
    found = with_formulas(row, sea, lambda: list(_formulas(given, entry, sea)))
    if not found.formulas:
        yield found
        return
    waves = given.waves(entry["place"])
    yield found.noted(
        f"of the {waves:.0f} waves of the run, of {STORM:.0f} {sqrt(STORM / waves):.3g} times as much",
        f"section: {outline_of(given.case, sea, entry['crest']).words}",
        f"sea: {sea.words}",
    )


def _formulas(given: Given, entry: Entry, sea: Sea) -> Iterator[Beside]:
    """Damage by Van der Meer and by Van Gent, Smale & Kuiper. Raises DesignError, OutlineError."""
    outline = outline_of(given.case, sea, entry["crest"])
    if outline.kind != "mound":
        raise OutlineError(f"the section is a {outline.kind}: the formulas are for a slope of rock")
    keys: dict[str, Any] = {
        "wave_height": sea.height, "cot_slope": outline.cot_slope, "D_n50": entry["size"],
        "waves": given.waves(entry["place"]), "buoyant_density": entry["buoyant"],
    }  # fmt: skip
    P, core = _permeability(given, entry, outline), _core(given, entry, outline)
    meer = armour_damage_van_der_meer(mean_period=sea.mean, permeability=P, **keys)
    yield beside(meer, f"Van der Meer, P {P:g}")
    yield beside(armour_damage_van_gent(core_to_armour=core, **keys), f"Van Gent, core/armour {core:.2g}")


def _permeability(given: Given, entry: Entry, outline: Outline) -> float:
    """Notional permeability P: that of the case, or by what is under the armour."""
    table = next(row for row in given.case.armour if row.name == entry["armour"])
    if table.permeability is not None:
        return table.permeability
    if not outline.permeable:
        return ON_SOLID
    return ON_POROUS if len(given.case.porous) > 1 else ALONE


def _core(given: Given, entry: Entry, outline: Outline) -> float:
    """Grain of the finest porous body over that of the armour, 0 if a solid is under it."""
    if not outline.permeable:
        return 0.0
    table = next(row for row in given.case.armour if row.name == entry["armour"])
    grains = {row.name: row.grain_diameter for row in given.case.porous if row.grain_diameter is not None}
    own = grains.get(table.body)
    return 1.0 if own is None else min(grains.values()) / own
