"""Paths one after the other as one path."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.inverse.joint_paths import Path, PathTurn


def joined(paths: Sequence[Path], rate: float | None = None) -> Path:
    """Paths one after the other as one, each the same part of the way; the last need not be followed to its end.

    rate: the rows' [1/s]; the end of a path that is at none of its times is no row then, but for the last one's.
    """
    if len(paths) == 1:
        return paths[0]
    times, parts, events, start = [], [], [], 0.0
    turns: list[PathTurn] = []
    ends: list[int | None] = []
    written = 0
    for k, path in enumerate(paths):
        count = rate * (start + (path.duration or 1.0)) if rate is not None else 0.0
        off = k + 1 < len(paths) and abs(count - round(count)) > 1e-9 * max(1.0, count)
        ends.append(-1 if off else None)
        times.append(start + path.t)
        parts.append((k + path.s) / len(paths))
        events += [replace(event, fraction=(k + event.fraction) / len(paths)) for event in path.events]
        # What a piece begins with is the last one's end, where that is a row.
        begun = k > 0 and ends[k - 1] is None
        since = written - begun
        for turn in path.turns:
            steps = max(turn.steps - off - (k > 0 and not begun), 0)
            turns.append(replace(turn, fraction=(k + turn.fraction) / len(paths), row=since, steps=steps))
        written += len(path) - (k > 0) - off
        start += path.duration or 1.0
    timed = all(path.duration is not None for path in paths)
    last = paths[-1]

    def rows(values: Iterable[Array | None]) -> Array:
        """The rows of all paths, each without its first, which is the last one's end."""
        return np.concatenate([np.asarray(one)[1 if k else 0 : ends[k]] for k, one in enumerate(values)])

    return replace(
        last,
        t=rows(times) if timed else rows(times) / len(paths),
        s=rows(parts),
        q=rows(path.q for path in paths),
        T=rows(path.T for path in paths),
        fraction=(len(paths) - 1 + last.fraction) / len(paths),
        events=tuple(events),
        manipulability=rows(path.manipulability for path in paths),
        reorientation=turns[0].steps if paths[0].turns else 0,
        turns=tuple(turns),
        blends=tuple(
            replace(one, **{name: (k + getattr(one, name)) / len(paths) for name in ("fraction", "begins", "ends")})
            for k, path in enumerate(paths)
            for one in path.blends
        ),
        choices=tuple(words for path in paths for words in path.choices),
        steps=sum(path.steps for path in paths) - sum(end is not None for end in ends),
        duration=start if timed else None,
        velocity=rows(path.velocity for path in paths) if timed else None,
        acceleration=rows(path.acceleration for path in paths) if timed else None,
    )
