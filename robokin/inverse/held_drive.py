"""What is left of a robot whose joints hang on each other when some of what is typed is held.

Statement. Given values for some variables u_h of v = S u + o, say the robot of the others.
Derivation. Its joints have v = S_f u_f + (o + S_h u_h). A joint that no other variable moves stands still, and its row
becomes a fixed one. Where those that are left are moved by as many variables, S regular, everything that is known of
arms holds again; where each is moved by a variable of its own alone, at its own speed, it is an arm without couplings.
Degenerate case. Where two joints that moved against each other now move together there are fewer freedoms than joints:
such a robot is searched, and nothing is said to be all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from robokin.arrays import Array, Flags
from robokin.errors import InputError
from robokin.kernel.chain import row_standing
from robokin.model import CoupledRobot, Joint, Robot
from robokin.model.coupled_robot import Drive, with_followers_limits
from robokin.model.graph import NO_LIMITS
from robokin.model.robot import within


def drive_left(robot: CoupledRobot, hold: Mapping[int, float], name: str) -> tuple[Robot, bool]:
    """The robot of the variables that are not held (from 0) at values [rad | m], and whether limits leave it a value.

    Those are the limits of joints that now stand still, and of those that one variable alone now moves.
    """
    drive, held = robot.drive, sorted(hold)
    free = [i for i in range(robot.n) if i not in hold]
    S = drive.S[:, free]
    o = drive.offsets + drive.S[:, held] @ np.array([hold[i] for i in held])
    moved: Flags = np.any(S != 0.0, axis=1)
    inside = bool(np.all(within(drive.limits[~moved], o[~moved])))
    rows = _rows_left(robot, o, moved)
    variables = tuple(drive.variables[i] for i in free)
    S, o, limits = S[moved], o[moved], drive.limits[moved]
    try:
        variables = with_followers_limits(variables, S, o, limits)
    except InputError:
        inside = False
    if np.array_equal(S, np.eye(len(free))):
        return _uncoupled(robot, rows, variables, o, name), inside
    part = replace(
        robot, name=name, rows=rows, poses={}, texts=(), drive=Drive(variables, S, o, limits, drive.couplings)
    )
    return part, inside


def _rows_left(robot: CoupledRobot, values: Array, moved: Flags) -> tuple[Joint, ...]:
    """The rows that one value (m,) [rad | m] each moves, those that are not moved as fixed ones."""
    rows, number = [], 0
    for row in robot.free_motion.rows:
        if row.moves:
            rows.append(row if moved[number] else row_standing(row, float(values[number]), robot.convention))
            number += 1
        else:
            rows.append(row)
    return tuple(rows)


def _uncoupled(
    robot: CoupledRobot, rows: tuple[Joint, ...], variables: tuple[Joint, ...], o: Array, name: str
) -> Robot:
    """The arm whose joints each have a variable alone, v = u + o."""
    own = iter(zip(variables, o.tolist(), strict=True))
    shifted = []
    for row in rows:
        if row.moves:
            variable, offset = next(own)
            offset = row.offset + row.sense * offset
            row = replace(row, limits=variable.limits, motion_limits=NO_LIMITS, offset=offset, texts=())
        shifted.append(row)
    return Robot(
        name, tuple(shifted), robot.convention, robot.id, robot.description, robot.source, robot.units,
        robot.parameters, robot.base, robot.tool,
    )  # fmt: skip
