"""`robokin show`: a robot's table as a lecture prints it, and what kind of arm it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from robokin.model import Joint, Mechanism, Robot
    from robokin.units import Units


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
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line
    from robokin.description.library import load_any
    from robokin.model import Mechanism, Robot

    kind = format_of(output, output_format(format, json))
    loaded = load_any(robot, parameter_overrides(set_))
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


def robot_record(robot: Robot, units: Units) -> dict[str, Any]:
    """All that is known of a robot, in the given units."""
    from robokin.cli.arguments import in_units, joint_factors
    from robokin.cli.records import poses_in
    from robokin.kinematics.structure import structure_of
    from robokin.mobility.count import grubler

    structure = structure_of(robot)
    rows = []
    variables = iter(range(1, robot.n + 1))
    for i, row in enumerate(robot.rows, start=1):
        rows.append(_row_record(i, row, f"q{next(variables)}" if row.moves else None, robot.convention, units))
    factors = joint_factors(robot, units)
    return {
        "robot": robot.id,
        "name": robot.name,
        "kind": "robot",
        "description": robot.description,
        "source": robot.source,
        "units": units.as_record(),
        "convention": robot.convention,
        "joints": robot.types,
        "class": structure.arm,
        "wrist": structure.wrist or None,
        "n": robot.n,
        "m": structure.dimension,
        "redundancy": structure.redundancy,
        "grubler": grubler(6, robot.n + 1, [1] * robot.n),
        "inverse": _inverse_record(robot),
        "parameters": dict(robot.parameters),
        "base": poses_in(robot.base.copy(), units).tolist(),
        "tool": poses_in(robot.tool.copy(), units).tolist(),
        "rows": rows,
        "poses": {name: in_units(q, factors).tolist() for name, q in robot.poses.items()},
    }


def _row_record(i: int, row: Joint, variable: str | None, convention: str, units: Units) -> dict[str, Any]:
    import numpy as np

    from robokin.cli.arguments import in_units
    from robokin.cli.records import poses_in

    def in_angle(value: float) -> float:
        return float(in_units(np.array(value), units.radians))

    def in_length(value: float) -> float:
        return float(in_units(np.array(value), units.metres))

    turns = row.type == "revolute"
    own = in_angle if turns else in_length
    record: dict[str, Any] = {"i": i, "name": row.name, "type": str(row.type), "variable": variable}
    if convention == "frames":
        origin = np.eye(4) if row.origin is None else row.origin
        record["origin"] = poses_in(origin.copy(), units).tolist()
        record["axis"] = None if row.axis is None or variable is None else row.axis.tolist()
    else:
        record["theta"] = None if turns else in_angle(row.theta)
        record["d"] = None if row.type == "prismatic" else in_length(row.d)
        record["a"] = in_length(row.a)
        record["alpha"] = in_angle(row.alpha)
    record["offset"] = own(row.offset) if variable else None
    low, high = row.limits
    record["limits"] = None if np.isinf(low) else [own(low), own(high)]
    return record


def _inverse_record(robot: Robot) -> dict[str, Any] | None:
    """How the inverse kinematics is solved, why so, and whether every solution is found."""
    from robokin.inverse.analysis import analysis_of

    if not robot.n:
        return None
    analysis = analysis_of(robot)
    return {"method": analysis.method, "reason": analysis.sentence, "complete": analysis.complete}


def mechanism_record(mechanism: Mechanism, units: Units) -> dict[str, Any]:
    """A mechanism's links and joints and Grübler's count, in the given units."""
    from robokin.mobility.count import grubler

    freedoms = [joint.freedoms for joint in mechanism.joints for _ in range(joint.multiplicity)]
    return {
        "mechanism": mechanism.id,
        "name": mechanism.name,
        "kind": "mechanism",
        "description": mechanism.description,
        "source": mechanism.source,
        "units": units.as_record(),
        "space": mechanism.space,
        "links": list(mechanism.links),
        "ground": mechanism.ground,
        "output": mechanism.output or None,
        "grubler": grubler(mechanism.order, len(mechanism.links), freedoms),
        "parameters": dict(mechanism.parameters),
        "joints": [
            {
                "name": joint.name,
                "type": joint.type,
                "links": list(joint.links),
                "freedoms": joint.freedoms,
                "at": None if joint.at is None else (joint.at / units.metres).tolist(),
                "axes": None if joint.axes is None else joint.axes.tolist(),
                "actuated": joint.actuated,
                "turns": [joint.gearing[0] / number for number in joint.gearing] or None,
                "carrier": joint.carrier or None,
            }
            for joint in mechanism.joints
        ],
    }


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
                         no_wrap=name != "origin", overflow="fold")  # fmt: skip
    for row in record["rows"]:
        cells = [_variable(row, name) for name in ("origin", "axis")] if frames else []
        if not frames:
            order = ("alpha", "a", "theta", "d") if modified else ("theta", "d", "a", "alpha")
            cells = [_variable(row, name) for name in order]
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
    for name, pose in record["poses"].items():
        entries.append((f"pose {name}", "  ".join(show(value) for value in pose)))
    for name in ("base", "tool"):
        text = _transform_text(record[name])
        if text:
            entries.append((name, text))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    rest = f"{record['convention']} convention, lengths in {units['length']}, angles in {units['angle']}"
    return render(heading(record["name"], rest), "", drawn, "", pairs(entries))


def _variable(row: dict[str, Any], name: str) -> str:
    """A cell as a lecture prints it: the variable with its offset, or the constant."""
    from robokin.cli.output.numbers import show

    value = row[name]
    if name == "origin":
        return _transform_text(value) or "identity"
    if name == "axis":
        return "" if value is None else " ".join(show(part) for part in value)
    if value is not None:
        return show(value)
    offset = row["offset"]
    if not offset:
        return str(row["variable"])
    return f"{row['variable']} {'+' if offset > 0 else '-'} {show(abs(offset))}"


def _transform_text(matrix: list[list[float]]) -> str:
    """A constant transform in short; "" for the identity."""
    import numpy as np

    from robokin.cli.output.numbers import show
    from robokin.spatial import rpy_from_rotation

    T = np.array(matrix)
    parts = []
    if np.any(np.abs(T[:3, 3]) > 0):
        parts.append(f"Trans({', '.join(show(value) for value in T[:3, 3])})")
    if np.max(np.abs(T[:3, :3] - np.eye(3))) > 1e-12:
        angles = np.degrees(rpy_from_rotation(T[:3, :3]))
        parts.append(f"RPY({', '.join(show(value) for value in angles)})")
    return " ".join(parts)


def _mechanism_table(record: dict[str, Any]) -> bytes:
    from robokin.cli.output.numbers import show
    from robokin.cli.output.tables import heading, pairs, render, table

    drawn = table()
    for name in ("joint", "type", "links", "f", "at", "axis"):
        drawn.add_column(name, justify="right" if name == "f" else "left", overflow="fold")
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
