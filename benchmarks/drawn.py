"""Mechanisms drawn without a plan: whether each has one answer, whatever the order of its lines, its size and place.

`python -m benchmarks.drawn` takes some minutes for 1,000 of them; `--mechanisms 10000` and `--first` choose which.
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections import Counter

import numpy as np
from mobility.drawn import drawn
from mobility.test_drawn import answer
from mobility.test_library import anywhere

from benchmarks import machine
from robokin.mobility.verdict import mobility_of

SCALES = (1e-3, 1e3)
SHOWN = 20


def run(count: int = 1000, first: int = 0) -> None:
    """Print what the answers are, and the mechanisms of which a copy has another one."""
    seen: Counter[str] = Counter()
    times, different = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for seed in range(first, first + count):
            mechanism = drawn(np.random.default_rng(seed))
            start = time.process_time()
            try:
                found = mobility_of(mechanism)
                times.append(time.process_time() - start)
                copies = [
                    mobility_of(anywhere(mechanism, np.random.default_rng(2 * seed + k), scale))
                    for k, scale in enumerate(SCALES)
                ]
            except Exception as error:  # what is counted here is that there is none
                seen["error"] += 1
                different.append(f"{seed}: {type(error).__name__}: {error}")
                continue
            seen["decided" if found.mobility is not None else "undecided or not assembled"] += 1
            if any(answer(other) != answer(found) for other in copies):
                seen["a copy has another answer"] += 1
                different.append(f"{seed}: {answer(found)}, {[answer(other) for other in copies]}")
    for name, number in seen.most_common():
        machine.line(name, str(number), f"of {count}")
    machine.line("median, slowest", f"{1e3 * np.median(times):.1f}, {1e3 * np.max(times):.0f} ms", "of the first copy")
    print(*different[:SHOWN], sep="\n")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.drawn", description=__doc__)
    parser.add_argument("--mechanisms", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="the seed of the first one")
    chosen = parser.parse_args()
    print(f"{machine.describe()}\nmechanisms drawn without a plan, each beside two copies that are shuffled and moved")
    run(chosen.mechanisms, chosen.first)


if __name__ == "__main__":
    main()
