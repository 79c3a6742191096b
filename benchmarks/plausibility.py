"""Notes on numbers in another unit: how often sound tables are noted, and how many slips are seen."""

from __future__ import annotations

import random

from formats.drawn_tables import SEED, SOUND, false_alarms, noted, seen, slip, tables_of

from robokin.formats import library_names, load_any
from robokin.model import Robot


def run() -> None:
    entries = [load_any(name) for name in library_names()]
    print(f"notes on {len(entries)} descriptions of the library: {sum(bool(entry.notes) for entry in entries)}")
    for seed in (SEED, SEED + 1, SEED + 2):
        print(f"notes on {SOUND} sound tables (seed {seed}): {len(false_alarms(seed=seed))}")
        made, found, _ = seen(seed=seed)
        parts = ", ".join(f"{kind} {found[kind]} of {made[kind]}" for kind in sorted(made))
        print(f"slips seen (seed {seed}): {sum(found.values())} of {sum(made.values())} ({parts})")
    # Tables that the rules were not tried on: those of real arms, in units that they are not published in.
    arms = [entry for entry in entries if isinstance(entry, Robot) and entry.convention != "frames"]
    tables = [table for arm in arms for table in tables_of(arm)]
    print(f"notes on {len(tables)} tables of {len(arms)} real arms: {sum(noted(table.text()) for table in tables)}")
    dice = random.Random(SEED)
    slips = [made for table in tables for _ in range(2) if (made := slip(table, dice)) is not None]
    print(f"slips in these seen: {sum(noted(text) for text, _ in slips)} of {len(slips)}")
