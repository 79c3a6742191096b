"""Hostile calls of every command for a while: `make fuzz`, FUZZ_SECONDS=300, FUZZ_SEED=7.

What is looked for: tracebacks, warnings, statuses that the command line does not promise, JSON that is none, steering
characters, files left behind, calls that take too long or too much memory. Each finding is made as small as it goes
and kept in build/fuzz/, from where `python tests/fuzz.py --again FILE` runs it. Status 1 if there is any.
"""

from __future__ import annotations

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # before numpy is loaded: each process keeps to its own core

import base64
import json
import shlex
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, replace
from multiprocessing.connection import wait
from pathlib import Path

from fuzz_calls import Call, Caller
from fuzz_run import HARD, Outcome, Worker, faults

FOUND = Path(__file__).parent.parent / "build" / "fuzz"

TRIES, PATIENCE = 120, 30.0
"""Calls and seconds that making one finding smaller may take."""


def main() -> int:
    """Call for a while, or run one finding again; the exit status."""
    if sys.argv[1:2] == ["--again"]:
        return again(Path(sys.argv[2]))
    seconds = float(os.environ.get("FUZZ_SECONDS") or 300)
    seed = os.environ.get("FUZZ_SEED") or str(time.time_ns() % 1_000_000)
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    print(f"FUZZ_SEED={seed} FUZZ_SECONDS={seconds:g}, {cores} processes", flush=True)
    tally: Counter[tuple[str, object]] = Counter()
    found: dict[str, list[tuple[Call, Outcome]]] = {}
    for call, outcome in calls(seed, seconds, cores):
        tally[call.command if call.command in SHORT else call.arguments[0], outcome.status] += 1
        for fault in faults(call, outcome):
            found.setdefault(fault, []).append((call, outcome))
            if len(found[fault]) == 1:
                print(f"found: {fault}", flush=True)
    show_tally(tally)
    for i, (fault, cases) in enumerate(sorted(found.items(), key=lambda item: item[0])):
        show(i, fault, len(cases), *smaller(fault, *min(cases, key=lambda case: weight(case[0]))))
    print(f"{sum(tally.values())} calls, {len(found)} kinds of findings")
    return int(bool(found))


SHORT = ("check fk", "check ik", "check dh", "check jacobian", "check dof")


def calls(seed: str, seconds: float, cores: int = 1, most: int = sys.maxsize) -> Iterator[tuple[Call, Outcome]]:
    """Calls and what came of them, for some seconds or at most `most` of them."""
    workers = [(Worker(), Caller(f"{seed}:{i}")) for i in range(cores)]
    answered = {caller: set[tuple[object, ...]]() for _, caller in workers}
    end = time.monotonic() + seconds
    try:
        for worker, caller in workers:
            worker.ask(caller.call())
        while most > 0 and time.monotonic() < end:
            wait([worker.pipe for worker, _ in workers], timeout=1.0)
            for worker, caller in workers:
                call, outcome = worker.call, worker.answer()
                if outcome is None or call is None:
                    continue
                most -= 1
                yield call, outcome
                if outcome.shape not in answered[caller]:
                    answered[caller].add(outcome.shape)
                    caller.keep(call, refused=outcome.status == 2)
                worker.ask(caller.call())
    finally:
        for worker, _ in workers:
            worker.end()


def weight(call: Call) -> int:
    """How much there is to read in a call."""
    texts = (*call.arguments, *call.files.values(), call.stdin)
    return sum(map(len, texts)) + 50 * len(call.environment)


def smaller(fault: str, call: Call, outcome: Outcome) -> tuple[Call, Outcome]:
    """The call with everything taken away that the fault does not need."""
    if outcome.seconds > HARD / 4:
        return call, outcome
    worker, tries, end = Worker(), 0, time.monotonic() + PATIENCE
    goes_on = True
    while goes_on:
        goes_on = False
        for candidate in cuts(call):
            if (tries := tries + 1) > TRIES or time.monotonic() > end:
                break
            worker.ask(candidate)
            while (answer := worker.answer()) is None:
                wait([worker.pipe], timeout=1.0)
            if fault in faults(candidate, answer):
                call, outcome, goes_on = candidate, answer, True
                break
    worker.end()
    return call, outcome


def cuts(call: Call) -> Iterator[Call]:
    """The call with a part taken away, the large parts first."""
    for part in ("environment", "closed", "terminal", "own_process", "stdin"):
        if getattr(call, part):
            yield replace(call, **{part: type(getattr(call, part))()})
    for name in call.files:
        yield replace(call, files={other: data for other, data in call.files.items() if other != name})
    for count in (2, 1):
        for i in range(1, len(call.arguments) - count + 1):
            yield replace(call, arguments=call.arguments[:i] + call.arguments[i + count :])
    for name, data in call.files.items():
        lines = data.splitlines(keepends=True)
        size = max(1, len(lines) // 2)
        while lines and size:
            for i in range(0, len(lines), size):
                yield replace(call, files={**call.files, name: b"".join(lines[:i] + lines[i + size :])})
            size //= 2


def show(number: int, fault: str, count: int, call: Call, outcome: Outcome) -> None:
    """Print a finding and keep it."""
    FOUND.mkdir(parents=True, exist_ok=True)
    path = FOUND / f"{number}.json"
    path.write_text(json.dumps(packed(call), indent=1))
    print(f"\n{fault}  ({count} times; status {outcome.status}, {outcome.seconds:.1f} s)")
    print(f"  robokin {shlex.join(call.arguments)[:1500]}")
    odd = [f"{name}={value}" for name, value in call.environment.items()] + [f"{name} closed" for name in call.closed]
    odd += ["a terminal"] * call.terminal + ["a process of its own"] * call.own_process
    if odd:
        print(f"  with {', '.join(odd)}")
    for name, data in (*call.files.items(), *([("standard input", call.stdin)] if call.stdin else [])):
        print(f"  {name}: {data[:400]!r}{'…' if len(data) > 400 else ''}")
    for line in (outcome.crash or outcome.err).strip().splitlines()[-6:]:
        print(f"  | {line[:300]}")
    print(f"  again: python tests/fuzz.py --again {path}")


def packed(call: Call) -> dict[str, object]:
    """A call as JSON."""
    text = {name: base64.b64encode(data).decode() for name, data in call.files.items()}
    return {**asdict(call), "files": text, "stdin": base64.b64encode(call.stdin).decode()}


def again(path: Path) -> int:
    """Run a kept finding again."""
    fields = json.loads(path.read_text())
    files = {name: base64.b64decode(data) for name, data in fields.pop("files").items()}
    call = Call(**{**fields, "arguments": tuple(fields["arguments"]), "closed": tuple(fields["closed"]), "files": files,
                   "stdin": base64.b64decode(fields["stdin"])})  # fmt: skip
    worker = Worker()
    worker.ask(call)
    while (outcome := worker.answer()) is None:
        wait([worker.pipe], timeout=1.0)
    worker.end()
    print(outcome.out.decode(errors="replace")[:4000])
    print(outcome.err[:4000], outcome.crash, sep="")
    print(f"status {outcome.status}, {outcome.seconds:.1f} s:", ", ".join(faults(call, outcome)) or "nothing wrong")
    return int(bool(list(faults(call, outcome))))


def show_tally(tally: Counter[tuple[str, object]]) -> None:
    """How often each command ended in each status."""
    statuses = sorted({status for _, status in tally}, key=str)
    print("\ncommand        " + "".join(f"{status!s:>8}" for status in statuses))
    for command in sorted({command for command, _ in tally}):
        print(f"{command:<15}" + "".join(f"{tally[command, status]:>8}" for status in statuses))


if __name__ == "__main__":
    sys.exit(main())
