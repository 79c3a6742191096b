"""Whether the stated bounds of sizes hold as often as they say, by family of arms and by number of points.

`python -m benchmarks.coverage` takes a minute or two; `--full` takes 1,000 arms of three seeds at 2 thousand, 131
thousand and 2 million points, which takes hours. `--family "waist and 2R" --arms 20 --points 2048` looks at a part.
"""

from __future__ import annotations

import argparse
import os
import time
import warnings
from dataclasses import dataclass, field

import numpy as np
from workspace import spare_sizes
from workspace.known_sizes import FAMILIES, Known, general_arm, known_arm

from benchmarks import machine
from robokin.workspace.extremes import extent
from robokin.workspace.measure import measure
from robokin.workspace.membership import finitely_many
from robokin.workspace.space import space_of

POINTS = (2048, 131072, 2097152)

SHORT = {2048: 1.0, 131072: 0.06, 2097152: 0.0}
"""Which part of the arms a short run looks at with so many points, of those whose size is an estimate."""

EXACT = 1e-9
"""A bound of this part of the size was not drawn at random: more seeds or points would say the same."""


@dataclass
class Tally:
    """What is counted of a family at a number of points."""

    outside: int = 0
    runs: int = 0
    bounds: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)
    seconds: float = 0.0
    examples: list[str] = field(default_factory=list)


GENERAL, TIMES = "any three joints", 16
"""Arms of no known size: it is what TIMES as many points say."""

ALL = [*FAMILIES, *spare_sizes.FAMILIES, GENERAL]


def general(number: int, points: int) -> Known:
    """An arm of three joints in any directions, and its size from so many points and another seed."""
    robot = general_arm(number)
    found, _ = measure(space_of(robot), None, points, 99, 1)
    return Known(robot, found.value, found.error / found.value)


def known_of(family: str, number: int, points: int) -> Known:
    """An arm of any family, and its size."""
    if family == GENERAL:
        return general(number, TIMES * points)
    if family in spare_sizes.FAMILIES:
        return Known(*spare_sizes.spare_arm(family, number), spare_sizes.FAMILIES[family])
    return known_arm(family, number)


def measured(family: str, arms: int, points: int, seeds: int) -> Tally:
    """The sizes of arms of a family against what is known of them."""
    tally, start = Tally(), time.process_time()
    for number in range(arms):
        known = known_of(family, number, points)
        space = space_of(known.robot)
        bounds = None if finitely_many(space) else extent(space)
        for seed in range(seeds):
            found, _ = measure(space, bounds, points, seed, 1)
            off = abs(found.value - known.size)
            tally.runs += 1
            tally.bounds.append(found.error / known.size)
            tally.ratios.append(off / (found.error + known.part * known.size))
            if tally.ratios[-1] > 1.0:
                tally.outside += 1
                tally.examples.append(f"{family}, arm {number}, {points} points, seed {seed}: {tally.ratios[-1]:.2f}")
    tally.seconds = time.process_time() - start
    return tally


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--full", action="store_true", help="1,000 arms at every number of points")
    parser.add_argument("--family", action="append", choices=ALL, help="one family; repeatable")
    parser.add_argument("--arms", type=int, default=None, help="arms of each family")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--points", default=None, help="numbers of points, separated by commas")
    asked = parser.parse_args()
    warnings.simplefilter("error")
    full = asked.full or os.environ.get("FULL", "") not in ("", "0")
    families = asked.family or ALL
    points = [int(part) for part in asked.points.split(",")] if asked.points else POINTS
    arms = asked.arms or (1000 // len(families) + 1 if full else 24)
    print(f"{machine.describe()}\n")
    print(f"  {'':<18}{'points':>9}{'runs':>7}{'outside':>9}{'median bound':>14}{'worst error':>13}{'s':>7}")
    examples, totals = [], {count: [0, 0] for count in points}
    for family in families:
        for count in points:
            # What needs no chance is as quick with any number of points.
            sharp = count == min(points) or max(measured(family, 1, min(points), 1).bounds) < EXACT
            part = 1.0 if full or asked.points or sharp else SHORT.get(count, 1.0)
            tally = measured(family, round(part * arms), count, asked.seeds)
            totals[count][0] += tally.outside
            totals[count][1] += tally.runs
            examples += tally.examples
            if tally.runs:
                print(
                    f"  {family:<18}{count:>9}{tally.runs:>7}{tally.outside:>9}{np.median(tally.bounds):>14.1e}"
                    f"{max(tally.ratios):>11.2f} b{tally.seconds:>8.1f}"
                )
    for count, (outside, runs) in totals.items():
        if runs:
            print(f"  all{count:>24}{runs:>7}{outside:>9}   {outside / runs:.2%}, limit 1 %")
    print("\noutside  the size is not within the bound;  b  the greatest error, in bounds;  s  processor time")
    for example in examples[:20]:
        print(f"  {example} bounds")


if __name__ == "__main__":
    main()
