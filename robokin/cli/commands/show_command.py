"""`robokin show`: a robot's table as a lecture prints it, and what kind of arm it is."""

from __future__ import annotations

from typing import Any

from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    RobotArgument,
    SetOption,
    effective_units,
    output_format,
    parameter_overrides,
)

MOST_POSES = 40
"""Named poses that a table shows: a description may have thousands."""


def command(
    robot: RobotArgument,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """A robot's table, its class, its wrist and its freedoms; a mechanism's joints and its count; a base's wheels.

    Examples:
        robokin show puma560
        robokin show four-bar
        robokin show car
        robokin show arm.yaml --length m --angle rad
        robokin show scara-frames --set l1=500 --json
    """
    from robokin.cli.arguments import load_entry
    from robokin.cli.descriptions import mechanism_record, robot_record
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line
    from robokin.model import Mechanism, Robot

    kind = format_of(output, output_format(format, json))
    loaded = load_entry(robot, parameter_overrides(set_))
    units = effective_units(loaded.units, length, angle)
    if isinstance(loaded, Robot):
        record, rows, drawn = robot_record(loaded, units), "rows", _robot_table
    elif isinstance(loaded, Mechanism):
        record, rows, drawn = mechanism_record(loaded, units), "joints", _mechanism_table
    else:
        from robokin.cli.wheel_tables import wheel_record, wheel_table

        record, rows, drawn = wheel_record(loaded, units), "wheels", wheel_table
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(record))
        elif kind == "jsonl":
            stream.write(json_line(record))
        elif kind == "csv":
            cells = [[_cell(value) for value in row.values()] for row in record[rows]]
            stream.write(csv_records(list(record[rows][0]), cells))
        else:
            stream.write(drawn(record))
    return 0


def _cell(value: Any) -> Any:
    return " ".join(map(str, value)) if isinstance(value, list) else "" if value is None else value


def _robot_table(record: dict[str, Any]) -> bytes:
    from robokin.cli.output.numbers import show, show_range
    from robokin.cli.output.tables import heading, pairs, render, table

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
        cells = [_variable(row, name, angle) for name in ("origin", "axis")] if frames else []
        if not frames:
            order = ("alpha", "a", "theta", "d") if modified else ("theta", "d", "a", "alpha")
            cells = [_variable(row, name, angle) for name in order]
        limits = "" if row["limits"] is None else show_range(*row["limits"])
        drawn.add_row(str(row["i"]), *([row["name"]] if named else []), row["type"], *cells, limits)
    units = record["units"]
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
        whole = "every solution" if inverse["complete"] else "some of infinitely many solutions"
        entries.append(("inverse", f"{inverse['method']}: {inverse['reason']}; {whole}"))
    if record["parameters"]:
        listed = ", ".join(f"{name} = {show(value)}" for name, value in record["parameters"].items())
        entries.append(("parameters", listed))
    poses = list(record["poses"].items())
    entries += [(f"pose {name}", "  ".join(show(value) for value in pose)) for name, pose in poses[:MOST_POSES]]
    if len(poses) > MOST_POSES:
        entries.append(("", f"and {len(poses) - MOST_POSES} more poses, which --json has"))
    for name in ("base", "tool"):
        text = _transform_text(record[name], angle)
        if text:
            entries.append((name, text))
    entries.append(("at zero", _zero_text(record["at_zero"], units["length"])))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    rest = f"{record['convention']} convention, lengths in {units['length']}, angles in {units['angle']}"
    return render(heading(record["name"], rest), "", drawn, "", pairs(entries))


def _zero_text(zero: dict[str, Any], unit: str) -> str:
    """`tool frame at (980, 0, 435) mm, z along +x`; a slanting z as a vector."""
    from robokin.cli.output.numbers import show

    def vector(values: list[float]) -> str:
        return f"({', '.join(show(value) for value in values)})"

    return f"tool frame at {vector(zero['position'])} {unit}, z along {zero['z_along'] or vector(zero['z'])}"


def _variable(row: dict[str, Any], name: str, angle: str) -> str:
    """A cell as a lecture prints it: the variable with its offset, or the constant."""
    from robokin.cli.output.numbers import show

    value = row[name]
    if name == "origin":
        return _transform_text(value, angle) or "identity"
    if name == "axis":
        axis = "" if value is None else " ".join(show(part) for part in value)
        return f"{axis}  for -{row['variable']}" if row["sense"] == -1 else axis
    if value is not None:
        return show(value)
    offset = row["offset"]
    if row["sense"] == -1:
        return f"{show(offset)} - {row['variable']}" if offset else f"-{row['variable']}"
    if not offset:
        return str(row["variable"])
    return f"{row['variable']} {'+' if offset > 0 else '-'} {show(abs(offset))}"


def _transform_text(matrix: list[list[float]], angle: str) -> str:
    """A constant transform in short, its angles in the unit; "" for the identity."""
    import numpy as np

    from robokin.cli.output.numbers import show
    from robokin.spatial import rpy_from_rotation
    from robokin.units import RADIANS

    T = np.array(matrix)
    parts = []
    if np.any(np.abs(T[:3, 3]) > 0):
        parts.append(f"Trans({', '.join(show(value) for value in T[:3, 3])})")
    if np.max(np.abs(T[:3, :3] - np.eye(3))) > 1e-12:
        angles = rpy_from_rotation(T[:3, :3]) / RADIANS[angle]
        parts.append(f"RPY({', '.join(show(value) for value in angles)})")
    return " ".join(parts)


def _mechanism_table(record: dict[str, Any]) -> bytes:
    from robokin.cli.output.numbers import show
    from robokin.cli.output.tables import heading, pairs, render, table

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
    return render(heading(record["name"], f"lengths in {record['units']['length']}"), "", drawn, "", pairs(entries))
