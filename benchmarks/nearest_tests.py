"""How well the nearest laboratory tests predict overtopping, beside EurOtop: the numbers of docs/design.md.

    python benchmarks/nearest_tests.py [--rows 100]

Every test of the table is predicted by the geometric mean of the tests nearest to it, itself left out; then without all
tests up to so many rows away in the database, which are mostly series of the same laboratory. For each kind and number
of neighbours: the share of predictions within a factor of two of the measured discharge, their geometric bias, and how
often the measured one lies between the least and the most of the neighbours. Tests with the same numbers are compared
with each other: nothing that knows only these can predict better. "with the formula": the neighbours' ratio
of measured to EurOtop, times EurOtop for the test. Of mounds EurOtop is given by both rules for the roughness.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

from houle.design.nearest import NEEDED, cloud, others

RULES = {"mound": ("eurotop-2018", "taw-2002")}


def within(error: NDArray[np.float64]) -> str:
    """Share of the logarithmic errors within a factor of two, and their bias."""
    return f"{np.mean(np.abs(error) <= np.log(2)):5.0%}  {np.exp(error.mean()):4.2f}"


def measure(kind: str, rows: int) -> None:
    """Prints the lines of a kind."""
    tests, measured = cloud(kind).tests, np.log(cloud(kind).q_star)
    ratios = {}  # of measured to formula
    for rule in RULES.get(kind, ("eurotop-2018",)):
        ratios[rule] = np.log([test.q / test.by_formula(rule).q for test in tests])
        print(f"{kind:6} {len(tests):4} tests, {rule:20} {within(-ratios[rule])}")
    first, second = cloud(kind).twins()
    print(f"{kind:6} {len(first):4} pairs with the same numbers {within(measured[first] - measured[second])}")
    for apart in (0, rows):
        for count in (1, 3, 5, 10):
            nearest = others(kind, count, apart)
            found = measured[nearest]
            held = (found.min(axis=1) <= measured) & (measured <= found.max(axis=1))
            text = f"{within(found.mean(axis=1) - measured)}  {held.mean():5.0%}"
            carried = "  ".join(within(ratio[nearest].mean(axis=1) - ratio) for ratio in ratios.values())
            print(
                f"{kind:6} {count:4} nearest, {f'beyond {apart} rows' if apart else 'all others':16} {text}  {carried}"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=100)
    rows = parser.parse_args().rows
    print(f"{'':36} within 2, bias, held; with the formula: within 2, bias")
    for kind in NEEDED:
        measure(kind, rows)


if __name__ == "__main__":
    main()
