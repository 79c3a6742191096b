"""Runs all benchmarks, or those whose names are given: `python -m benchmarks forward inverse names start`."""

from __future__ import annotations

import sys

from benchmarks import (
    flagged,
    forward,
    history,
    inverse,
    machine,
    mobility,
    names,
    nearest,
    one_call,
    pairs,
    pipes,
    plausibility,
    redundant,
    scale,
    start,
    workspace,
)

BENCHMARKS = {
    "forward": forward.run,
    "one-call": one_call.run,
    "pairs": pairs.run,
    "pipes": pipes.run,
    "inverse": inverse.run,
    "flagged": flagged.run,
    "names": names.run,
    "nearest": nearest.run,
    "redundant": redundant.counted,
    "workspace": workspace.run,
    "mobility": mobility.run,
    "start": start.run,
    "scale": scale.run,
    "plausibility": plausibility.run,
}


def main() -> None:
    chosen = sys.argv[1:] or list(BENCHMARKS)
    unknown = [name for name in chosen if name not in BENCHMARKS]
    if unknown:
        sys.exit(f"there is no benchmark {', '.join(unknown)}, expected some of {', '.join(BENCHMARKS)}")
    print(machine.describe())
    for name in chosen:
        print()
        machine.begin(name)
        BENCHMARKS[name]()
    history.keep()


if __name__ == "__main__":
    main()
