"""What `robokin show` prints: a robot's table as a lecture has it, a mechanism's joints, a base's wheels."""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.number_text import show, show_range
from robokin.reports.page_parts import Heading, Part, Table
from robokin.reports.page_tables import heading, pairs, render, table
from robokin.spatial import rpy_from_rotation
from robokin.units import RADIANS

MOST_POSES = 40
"""Named poses that a table shows: a description may have thousands."""


def description_table(record: dict[str, Any]) -> bytes:
    """The page about what a description describes, from its document."""
    return render(*description_parts(record))


def description_parts(record: dict[str, Any]) -> list[Part]:
    """The same as the parts of a page."""
    return {"robot": _robot, "tree": _tree, "mechanism": _mechanism, "wheeled": _wheels}[record["kind"]](record)


def row_table(record: dict[str, Any]) -> Table:
    """The rows of a robot's table as a lecture prints them."""
    drawn = table()
    frames = record["convention"] == "frames"
    modified = record["convention"] == "modified"
    headings = ["origin", "axis"] if frames else ["theta", "d", "a", "alpha"]
    if modified:
        headings = ["alpha i-1", "a i-1", "theta", "d"]
    named = any(row["name"] != str(row["i"]) for row in record["rows"])
    for name in ["i", *(["joint"] if named else []), "type", *headings, "limits"]:
        drawn.add_column(name, justify="right" if name not in ("joint", "type", "origin", "axis") else "left",
                         no_wrap=name not in ("joint", "origin"))  # fmt: skip
    angle = record["units"]["angle"]
    for row in record["rows"]:
        cells = [variable_cell(row, name, angle) for name in ("origin", "axis")] if frames else []
        if not frames:
            order = ("alpha", "a", "theta", "d") if modified else ("theta", "d", "a", "alpha")
            cells = [variable_cell(row, name, angle) for name in order]
        limits = "" if row["limits"] is None else show_range(*row["limits"])
        drawn.add_row(str(row["i"]), *([row["name"]] if named else []), row["type"], *cells, limits)
    return drawn


def row_heading(record: dict[str, Any]) -> Heading:
    """What stands above the rows: the robot, the convention, the units."""
    units = record["units"]
    rest = f"{record['convention']} convention, lengths in {units['length']}, angles in {units['angle']}"
    return heading(record["name"], rest)


def _robot(record: dict[str, Any]) -> list[Part]:
    """A robot's table, and what else is known of it."""
    units, angle = record["units"], record["units"]["angle"]
    entries = [("class", record["class"])]
    if record["wrist"]:
        entries.append(("wrist", record["wrist"]))
    entries += [
        ("joints N", str(record["n"])),
        ("task M", f"{record['m']}  (dimension of the poses that it can reach)"),
        ("R = N - M", f"{record['redundancy']}"),
        ("Grübler", f"F = 6({record['n'] + 1} - {record['n']} - 1) + {record['n']} = {record['grubler']}"),
    ]
    if record["inverse"]:
        inverse = record["inverse"]
        some = "some of infinitely many solutions" if record["redundancy"] else "solutions, perhaps not all"
        whole = "every solution" if inverse["complete"] else some
        entries.append(("inverse", f"{inverse['method']}: {inverse['reason']}; {whole}"))
    entries += _coupled_entries(record)
    if record["parameters"]:
        listed = ", ".join(f"{name} = {show(value)}" for name, value in record["parameters"].items())
        entries.append(("parameters", listed))
    poses = list(record["poses"].items())
    entries += [(f"pose {name}", "  ".join(show(value) for value in pose)) for name, pose in poses[:MOST_POSES]]
    if len(poses) > MOST_POSES:
        entries.append(("", f"and {len(poses) - MOST_POSES} more poses, which --json has"))
    for name in ("base", "tool"):
        text = transform_in_short(record[name], angle)
        if text:
            entries.append((name, text))
    if record.get("made_from"):
        entries.append(("made from", "the joints' frames, which robokin convert --convention frames prints"))
    entries.append(("at zero", _zero_text(record["at_zero"], units["length"])))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    return [row_heading(record), "", row_table(record), "", pairs(entries)]


def _coupled_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    """What joints hang on, and how those move that are not as what is typed."""
    entries = [("coupled", coupling_in_short(coupling)) for coupling in record.get("couplings", ())]
    for one in record.get("beside", ()):
        within = "" if one["limits"] is None else f", {show_range(*one['limits'])}"
        entries.append(("beside", f"{one['variable']} is {one['joint']}{within}"))
    for row in record["rows"]:
        if "motion_limits" in row:
            entries.append(("moves", f"{row['name']} itself {show_range(*row['motion_limits'])}"))
        if "pitch" in row:
            entries.append(("advances", f"{row['name']} {show(row['pitch'])} {record['units']['length']} a turn"))
    return entries


def coupling_in_short(coupling: dict[str, Any]) -> str:
    """`J3 adds -1 J2`, `dip follows 0.6667 pip + 5`."""
    others = " + ".join(f"{show(other['ratio'])} {other['joint']}" for other in coupling["ratios"])
    offset = coupling["offset"]
    shift = f" {'+' if offset > 0 else '-'} {show(abs(offset))}" if offset else ""
    return f"{coupling['joint']} {'adds' if coupling['own'] else 'follows'} {others}{shift}"


def _tree(record: dict[str, Any]) -> list[Part]:
    """A tree's joints with the links that they join, and its tips."""
    drawn = table()
    for name in ("", "joint", "type", "on", "limits", "follows"):
        drawn.add_column(name, justify="right" if name in ("", "limits") else "left", no_wrap=name in ("", "type"))
    for joint in record["joints"]:
        limits = "" if joint["limits"] is None else show_range(*joint["limits"])
        others = " + ".join(f"{show(other['ratio'])} {other['joint']}" for other in joint["follows"])
        row = (joint["variable"] or "", joint["name"], joint["type"], joint["parent"], limits, others)
        drawn.add_row(*row)
    units, poses = record["units"], list(record["poses"])
    entries = [("joints N", str(record["n"])), ("tips", ", ".join(tip["name"] for tip in record["tips"]))]
    if record["parameters"]:
        listed = ", ".join(f"{name} = {show(value)}" for name, value in record["parameters"].items())
        entries.append(("parameters", listed))
    entries += [("poses", ", ".join(poses[:MOST_POSES]))] if poses else []
    entries.append(("one tip", "its table and all else: --tip with its name"))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    rest = f"tree of links, lengths in {units['length']}, angles in {units['angle']}"
    return [heading(record["name"], rest), "", drawn, "", pairs(entries)]


def _zero_text(zero: dict[str, Any], unit: str) -> str:
    """`tool frame at (980, 0, 435) mm, z along +x`; a slanting z as a vector."""

    def vector(values: list[float]) -> str:
        return f"({', '.join(show(value) for value in values)})"

    return f"tool frame at {vector(zero['position'])} {unit}, z along {zero['z_along'] or vector(zero['z'])}"


def variable_cell(row: dict[str, Any], name: str, angle: str) -> str:
    """A cell as a lecture prints it: the variable with its offset, or the constant."""
    value = row[name]
    if name == "origin":
        return transform_in_short(value, angle) or "identity"
    if name == "axis":
        axis = "" if value is None else " ".join(show(part) for part in value)
        return f"{axis}  for {_shifted(row)}" if row["sense"] == -1 or row["offset"] else axis
    return _shifted(row) if value is None else show(value)


def _shifted(row: dict[str, Any]) -> str:
    """A row's variable, or that it has none of its own, with its sense and its offset."""
    offset, variable = row["offset"], row["variable"] or row["name"]
    if row["sense"] == -1:
        return f"{show(offset)} - {variable}" if offset else f"-{variable}"
    if not offset:
        return str(variable)
    return f"{variable} {'+' if offset > 0 else '-'} {show(abs(offset))}"


def transform_in_short(matrix: list[list[float]], angle: str) -> str:
    """A constant transform in short, its angles in the unit; "" for the identity."""
    T = np.array(matrix)
    parts = []
    if np.any(np.abs(T[:3, 3]) > 0):
        parts.append(f"Trans({', '.join(show(value) for value in T[:3, 3])})")
    if np.max(np.abs(T[:3, :3] - np.eye(3))) > 1e-12:
        angles = rpy_from_rotation(T[:3, :3]) / RADIANS[angle]
        parts.append(f"RPY({', '.join(show(value) for value in angles)})")
    return " ".join(parts)


def _mechanism(record: dict[str, Any]) -> list[Part]:
    """A mechanism's joints below one another."""
    drawn = table()
    for name in ("joint", "type", "links", "f", "at", "axis"):
        drawn.add_column(name, justify="right" if name == "f" else "left")
    for joint in record["joints"]:
        at = "" if joint["at"] is None else " ".join(show(value) for value in joint["at"])
        axes = "; ".join(" ".join(show(part) for part in axis) for axis in joint["axes"] or [])
        if joint["turns"]:
            axes += ("; " if axes else "") + "turns " + " : ".join(show(turns) for turns in joint["turns"])
        drawn.add_row(joint["name"], joint["type"], " ".join(joint["links"]), str(joint["freedoms"]), at, axes)
    entries = [
        ("space", record["space"]),
        ("links", f"{len(record['links'])}: {', '.join(record['links'])} (ground: {record['ground']})"),
        ("Grübler", f"F = {record['grubler']}"),
    ]
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    return [heading(record["name"], f"lengths in {record['units']['length']}"), "", drawn, "", pairs(entries)]


def _wheels(record: dict[str, Any]) -> list[Part]:
    """The wheels below one another, and what else the description says."""
    drawn = table()
    numbers = ("x", "y", "angle", "radius", *(key for key in ("offset", "roller") if _some(record, key)))
    for name in ("wheel", "type", *numbers, "motor"):
        drawn.add_column(name, justify="right" if name in numbers else "left")
    for wheel in record["wheels"]:
        values = dict(zip("xy", wheel["at"], strict=True)) | wheel
        cells = ["" if values[name] is None else show(values[name]) for name in numbers]
        motors = [word for word in ("driven", "turned") if wheel[word]]
        drawn.add_row(wheel["name"], wheel["type"], *cells, ", ".join(motors))
    units = record["units"]
    entries = [("steering", "the steered wheels stay parallel")] if record["steering"] == "parallel" else []
    if record["parameters"]:
        listed = ", ".join(f"{name} = {show(value)}" for name, value in record["parameters"].items())
        entries.append(("parameters", listed))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    rest = f"a wheeled base, lengths in {units['length']}, angles in {units['angle']}"
    return [heading(record["name"], rest), "", drawn, "", pairs(entries)]


def _some(record: dict[str, Any], key: str) -> bool:
    return any(wheel[key] is not None for wheel in record["wheels"])
