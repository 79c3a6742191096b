"""What symbols are worth: the Python form run, and matrices evaluated by what their symbols mean."""

from __future__ import annotations

import numpy as np

from robokin.derivation.symbolic_kinematics import symbolic_kinematics
from robokin.derivation.symbolic_python import python_source
from robokin.derivation.written_sums import written


def source_of(robot, units=None, numbers=False):
    units = units or robot.units
    return python_source(robot, units, symbolic_kinematics(robot, units, numbers=numbers))


def evaluated(robot, q, units, numbers=False):
    """The poses [m] at q (..., n) [rad | m] that the Python form gives in these units."""
    scope = {}
    exec(compile(source_of(robot, units, numbers), "fk.py", "exec"), scope)
    T = scope["forward_kinematics"](q / np.where(robot.revolute, units.radians, units.metres))
    T[..., :3, 3] *= units.metres
    return T


def matrix_of(robot, symbolic, matrix, q):
    """A matrix of symbols (4, 4) at q (m, n), both in SI."""
    scope = {"__builtins__": {}, "cos": np.cos, "sin": np.sin, **symbolic.values}
    scope |= {f"q{i}": column for i, column in enumerate(q.T, start=1)}
    for name, text in symbolic.definitions.items():
        scope[name] = eval(text, scope)
    for name, function in symbolic.functions.items():
        scope[name] = eval(f"{function.name}({function.argument})", scope)
    value = np.empty((len(q), 4, 4))
    for i, row in enumerate(matrix):
        for j, entry in enumerate(row):
            value[:, i, j] = eval(written(entry), scope)
    return value


def texts(matrix):
    """The entries as they are written, without blanks."""
    return [[written(entry).replace(" ", "") for entry in row] for row in matrix]
