"""Which singular values are zero: one threshold for each way in which a matrix's numbers are come by.

Lengths are in an arm's or a mechanism's size, angles in radians. Ranks are told by the part of the greatest singular
value, where joints are moved by the value itself. Rounding leaves 1e-15 of what is zero; the thresholds differ since
configurations are known more or less well, and an error e of a joint value makes about e of a singular value that is
zero.

Other questions than that of a rank have numbers of their own: from where on solutions may be lost (`window.SINGULAR`,
`root_neighbours.UNRESOLVED`), rows of two equations (`equation_pair.RANK`), paths of complex joint values
(`complex_newton`), couplings (`coupled_robot.SINGULAR`, of numbers that are written).
"""

from __future__ import annotations

RANK = 1e-6
"""Of Jacobians where a description says the geometry and a person or a search the configuration. Joint values are typed
with some six digits, tables printed with five; of configurations that are drawn at random none is so near to a singular
one. The same for directions that are compared: two axes are parallel, a joint does not move the tool."""

ROOT_RANK = 1e-5
"""Of Jacobians at solutions that may be multiple. Newton's method stops some 1e-8 to 1e-6 from a double root, and
leaves a singular value of that size there; away from special points they are above 1e-3."""

TASK_RANK = 1e-7
"""Of Jacobians at points that are brought onto a task: of the 1e-13 that rounding leaves of the error a step makes 1e-6
there, which the next step still sees."""

LOOP_RANK = 1e-8
"""Of the equations of closed loops, which are assembled to rounding before they are looked at: a mechanism whose
dimensions are wrong by e has singular values of about e, and would move where it must not."""

WHEEL_RANK = 1e-9
"""Of what wheels forbid and motors command, rows of size 1 with entries as they are written: where all of them are zero
rounding leaves 1e-16."""
