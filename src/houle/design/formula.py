"""A design formula says what it takes, where it holds and where it comes from; its answer says what lies outside.

A formula is a function of keyword arguments in SI units that returns an `Answer`. Each argument is annotated with an
`Input` or a `Choice`, which hold its meaning, its unit and the values that make sense at all; each number in the answer
is a `quantity` with its unit. The decorator `formula` checks what is given, adds source and range to the answer and the
inputs to the docstring, and puts a row into `FORMULAS`: `houle describe formulas`, the site and the tests read it.

    @formula("sainflou", "What it gives.", source="Sainflou (1928)", status="...", example={"depth": 8.0, ...})
    def sainflou(*, wave_height: Height, period: Period, depth: Depth) -> Standing: ...
"""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import Field, dataclass, field, fields, replace
from typing import Annotated, Any, ParamSpec, TypeVar, cast, get_args, get_origin, get_type_hints

from houle.design.errors import DesignError
from houle.registry import Choices

CURES = {
    "m": "lengths are in metres",
    "s": "times are in seconds",
    "rad": "angles are in radians (30 degrees are 0.524)",
    "Pa": "pressures are in pascals",
}
SUBJECTS = (
    "overtopping", "share", "nearest", "runup", "reflection", "transmission", "walls", "armour", "mound", "drag",
    "seepage", "ships",
)  # fmt: skip  # modules of formulas, in the order in which they are shown
RECALLED = "RECALLED from one source or from memory: verify before it is printed as a fact"


@dataclass(frozen=True)
class Input:
    """A number that a formula takes: what it is, its unit, and the values that make sense at all."""

    what: str
    unit: str
    above: float = -math.inf
    least: float = -math.inf
    below: float = math.inf
    most: float = math.inf

    @property
    def told(self) -> str:
        """The quantity in words."""
        return self.what

    @property
    def allowed(self) -> str:
        """The values in words: "above 0 and at most 1"."""
        bounds = {"above": self.above, "at least": self.least, "below": self.below, "at most": self.most}
        return " and ".join(f"{word} {bound:.4g}" for word, bound in bounds.items() if math.isfinite(bound))

    def check(self, name: str, value: Any) -> None:
        """Raises DesignError for what is no finite number, or does not make sense."""
        if isinstance(value, bool | str) or not _finite(value):
            raise DesignError(f"{name} = {value!r} is no number: {self.what} [{self.unit}]")
        if not (self.above < value < self.below and self.least <= value <= self.most):
            cure = "a fraction, not a percentage" if min(self.below, self.most) <= 1 else CURES.get(self.unit, "")
            said = f"{name} = {value:g} must be {self.allowed}: {self.what} [{self.unit}]"
            raise DesignError(f"{said}; {cure}" if cure else said)


@dataclass(frozen=True)
class Choice:
    """A name that a formula takes, one of `names`, or a switch where these are True and False."""

    what: str
    names: Iterable[Any]
    unit: str = ""

    @property
    def told(self) -> str:
        """The choice in words, with the names that it can be."""
        return f"{self.what}: {', '.join(map(repr, self.names))}"

    def check(self, name: str, value: Any) -> None:
        """Raises DesignError for a name that is not one of them."""
        if value not in tuple(self.names):
            raise DesignError(f"{name} = {value!r} is none of {', '.join(map(repr, self.names))}: {self.what}")


@dataclass(frozen=True)
class Limit:
    """The range of a dimensionless number in which a formula was measured: "xi", 1, inf."""

    ratio: str
    low: float = -math.inf
    high: float = math.inf

    def __str__(self) -> str:
        if self.low == -math.inf:
            return f"{self.ratio} up to {self.high:g}"
        if self.high == math.inf:
            return f"{self.ratio} from {self.low:g}"
        return f"{self.ratio} {self.low:g} to {self.high:g}"

    def outside(self, value: float) -> str:
        """A sentence about a value that lies outside; "" about one that does not."""
        if self.low <= value <= self.high:
            return ""
        bound = f"below {self.low:g}" if value < self.low else f"above {self.high:g}"
        return f"{self.ratio} = {value:.4g} is {bound}, where the range of the formula ends"


def quantity(what: str, unit: str) -> Any:
    """A field of an answer that is a number of the formula: what it is, and its unit."""
    return field(metadata={"what": what, "unit": unit})


def _quantities(members: Iterable[tuple[str, Any]]) -> Iterator[tuple[str, Field[Any]]]:
    """Those of the members of a class that are quantities."""
    return ((name, f) for name, f in members if isinstance(f, Field) and "unit" in f.metadata)


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The answer of a formula for one set of inputs, and how far it can be trusted.

    low, high  band of the first number, NaN where the source gives none; `band` says what it is
    ratios     dimensionless numbers of the case: those that the range is about, and what else decides
    branch     which of several equations was taken
    outside    a sentence for each number that lies outside the range in which the formula was measured
    formula    its name in `houle describe formulas`
    source     author, year, equation; it says RECALLED where these were not read
    range      in which the formula was measured
    scatter    how far measurements are from the formula
    verified   False where the formula is RECALLED, not compared with its source
    """

    low: float = math.nan
    high: float = math.nan
    band: str = ""
    ratios: Mapping[str, float] = field(default_factory=dict)
    branch: str = ""
    outside: tuple[str, ...] = ()
    formula: str = ""
    source: str = ""
    range: str = ""
    scatter: str = ""
    verified: bool = False

    def __init_subclass__(cls) -> None:
        """Ends the docstring of a kind of answer with the numbers that it holds."""
        numbers = (f"{name}  {f.metadata['what']} [{f.metadata['unit']}]" for name, f in _quantities(vars(cls).items()))
        cls.__doc__ = "\n\n".join([inspect.getdoc(cls) or "", "\n".join(numbers)])

    @classmethod
    def quantities(cls) -> dict[str, tuple[str, str]]:
        """The numbers of this kind of answer: name to (what it is, unit); the first is the `value`."""
        named = _quantities((f.name, f) for f in fields(cls))
        return {name: (f.metadata["what"], f.metadata["unit"]) for name, f in named}

    @property
    def value(self) -> float:
        """The number that the formula is about: the first of the quantities."""
        return float(getattr(self, next(iter(self.quantities()))))

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return next(iter(self.quantities().values()))[1]

    def __str__(self) -> str:
        first, *others = (
            f"{name} {getattr(self, name):.4g}{'' if unit == '-' else f' {unit}'}"
            for name, (_, unit) in self.quantities().items()
        )
        band = f" ({self.low:.4g} to {self.high:.4g})" if self.band else ""
        ratios = ", ".join(f"{name} {value:.4g}" for name, value in self.ratios.items())
        lines = (
            f"{self.formula}: {first}{band}",
            ", ".join(others),
            f"band: {self.band}" if self.band else "",
            "; ".join(text for text in (self.branch, ratios) if text),
            f"source: {self.source}" if self.source else "",
            f"scatter: {self.scatter}" if self.scatter else "",
            *(f"outside: {sentence}" for sentence in self.outside),
        )
        return "\n  ".join(line for line in lines if line)


@dataclass(frozen=True)
class Formula:
    """A row about a formula: the function and what is known of it.

    status    how the formula was checked; it begins with RECALLED where it was not compared with its source
    limits    ranges of the dimensionless numbers in its answers
    holds     where it holds, as far as no number says it
    scatter   how far it is from measurements
    example   inputs of an example, which lie inside the range
    equations  the formula in words and symbols
    """

    name: str
    function: Callable[..., Answer]
    what: str
    source: str
    status: str
    limits: tuple[Limit, ...]
    holds: str
    scatter: str
    example: dict[str, Any]
    equations: str

    @property
    def range(self) -> str:
        return "; ".join((*map(str, self.limits), *([self.holds] if self.holds else [])))

    @property
    def verified(self) -> bool:
        return not self.status.startswith("RECALLED")

    @property
    def cited(self) -> str:
        """The source as an answer gives it."""
        return self.source if self.verified else f"{self.source} ({RECALLED})"

    @property
    def subject(self) -> str:
        """The module in which it stands."""
        return self.function.__module__.rpartition(".")[2]

    @property
    def place(self) -> int:
        return SUBJECTS.index(self.subject) if self.subject in SUBJECTS else len(SUBJECTS)

    @property
    def call(self) -> str:
        """The function's name."""
        return str(getattr(self.function, "__name__", self.name))

    def said(self, given: Mapping[str, Any]) -> str:
        """Inputs as they are written in a call."""
        return ", ".join(f"{name}={value!r}" for name, value in given.items())

    @property
    def inputs(self) -> dict[str, Input | Choice]:
        """The inputs of the function, by the names of its arguments."""
        hints = get_type_hints(inspect.unwrap(self.function), include_extras=True)
        return {name: _told(hints[name]) for name in inspect.signature(self.function).parameters}

    @property
    def outputs(self) -> dict[str, tuple[str, str]]:
        """The numbers of the answer: name to (quantity in words, unit)."""
        kind: type[Answer] = get_type_hints(inspect.unwrap(self.function))["return"]
        return kind.quantities()

    def defaults(self) -> dict[str, Any]:
        """The inputs that may be left out."""
        given = inspect.signature(self.function).parameters.values()
        return {p.name: p.default for p in given if p.default is not inspect.Parameter.empty}

    def check(self, given: Mapping[str, Any]) -> None:
        """Raises DesignError for an input that makes no sense."""
        inputs, defaults = self.inputs, self.defaults()
        for name, value in given.items():
            if name in inputs and not (value is None and defaults.get(name, 0) is None):
                inputs[name].check(name, value)

    def outside(self, ratios: Mapping[str, float]) -> tuple[str, ...]:
        """A sentence for each of the numbers that lies outside the range."""
        told = (limit.outside(ratios[limit.ratio]) for limit in self.limits if limit.ratio in ratios)
        return tuple(sentence for sentence in told if sentence)


FORMULAS: Choices[Formula] = Choices("design formula", package="houle.design")

P = ParamSpec("P")
A = TypeVar("A", bound=Answer)


def formula(
    name: str,
    what: str,
    *,
    source: str,
    status: str,
    example: dict[str, Any],
    limits: tuple[Limit, ...] = (),
    holds: str = "",
    scatter: str = "",
) -> Callable[[Callable[P, A]], Callable[P, A]]:
    """Makes a function a formula of `FORMULAS`: its inputs are checked, its answer says source and range."""

    def made(function: Callable[P, A]) -> Callable[P, A]:
        @functools.wraps(function)
        def checked(*args: P.args, **given: P.kwargs) -> A:
            row.check(given)
            found = function(*args, **given)
            return replace(
                found, formula=name, source=row.cited, range=row.range, scatter=row.scatter,
                verified=row.verified, outside=(*row.outside(found.ratios), *found.outside),
            )  # fmt: skip

        told = inspect.getdoc(function) or ""
        row = Formula(
            name, cast("Callable[..., Answer]", checked), what, source, status, limits, holds, scatter, example, told
        )
        FORMULAS.add(row)
        checked.__doc__ = _documented(row)
        return checked

    return made


def _finite(value: Any) -> bool:
    try:
        return math.isfinite(value)
    except TypeError:
        return False


def _told(hint: Any) -> Input | Choice:
    """The Input or Choice in an annotation, also in one that allows None."""
    for part in (hint, *get_args(hint)):
        if get_origin(part) is Annotated:
            return next(told for told in get_args(part) if isinstance(told, Input | Choice))
    raise TypeError(f"{hint} holds no Input or Choice")


def _documented(row: Formula) -> str:
    """The docstring of a formula, with its inputs, range and source."""
    defaults = row.defaults()
    lines = []
    for name, given in row.inputs.items():
        unit = f" [{given.unit}]" if given.unit else ""
        left_out = f"; {defaults[name]!r} if not given" if defaults.get(name) is not None else ""
        left_out = "; may be left out" if name in defaults and defaults[name] is None else left_out
        lines.append(f"{name}  {given.told}{unit}{left_out}")
    ends = [f"Range: {row.range}." if row.range else "", f"Source: {row.source}. {row.status}.", row.scatter]
    return "\n\n".join([row.equations, "\n".join(lines), *(end for end in ends if end)])
