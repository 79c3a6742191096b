"""The closed forms as code without arrays for one target, made once for an arm.

Statement. Six turning joints with a spherical wrist, or with three parallel axes: give all joint values for one pose in
some ten microseconds, where the arrays of `spherical_wrist` and `three_parallel_axes` take hundreds.
Derivation. The solvers' own equations are walked with terms in place of columns (`straight_line`). Where arrays have a
new axis for two roots the code has a loop over both; what is not real is passed over there. Every root is worked out by
the operations of the arrays, in their order, so that it is the same to the last digit. But of an equation of the second
degree in cosine and sine the arrays find eigenvalues and the code chords (`two_chords`), which agree to rounding.
Degenerate case. Code is for what is regular. Wherever the arrays would mark a target (a short lever, an equation that
says nothing) the code gives no answer (None), and the arrays are asked. Arms with sliding joints have no code.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np

from robokin.inverse.closed_form.backwards import backwards_closing
from robokin.inverse.closed_form.form_code import (
    FormCode,
    NoCodeError,
    in_two_turns,
    linear_turn,
    made_unit,
    quadratic,
    root_of,
    says_something,
    turning_onto,
)  # fmt: skip
from robokin.inverse.closed_form.gather import LEVER
from robokin.inverse.closed_form.joint_functions import LOOSE, Form, Prismatic, Revolute, combined, parallel_gradient
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple, along_gradient, sum_of_products
from robokin.inverse.closed_form.three_parallel_axes import ThreeParallel
from robokin.inverse.closed_form.trigonometry import CLAMP, FREE, Turn, turned
from robokin.inverse.closed_form.turns import lever_of, right_angled
from robokin.inverse.closed_form.two_chords import turns_of_second_degree
from robokin.kernel.code_lines import Term, written
from robokin.kernel.entries import (
    Entry,
    EntryFrame,
    Matrix,
    Vector,
    angle,
    applied,
    applied_back,
    minus,
    moved,
    plus,
    times,
    transposed,
)

Leaves = list[tuple[float, ...]]
StraightForm = Callable[[list[float]], Leaves | None]
"""Joint values (6) [rad] of each real root, for the first three rows of L6 in reading order; None for no answer.

There may be no such root."""


def straight_form(solver: Any) -> StraightForm | None:
    """The code of a solver as a function, or None where there is none."""
    source = straight_source(solver)
    return None if source is None else compiled_form(source)


def straight_source(solver: Any) -> str | None:
    """The code of a solver as the source of a function, or None where there is none."""
    code = FormCode()
    head = ", ".join(f"r{i}{j}" for i in range(3) for j in range(4))
    rows = [[cast(Entry, Term.named(code, f"r{i}{j}")) for j in range(4)] for i in range(3)]
    target = EntryFrame([row[:3] for row in rows], [row[3] for row in rows])
    try:
        if isinstance(solver, SphericalTriple):
            values = _spherical(code, solver, target)
        elif isinstance(solver, ThreeParallel):
            values = _parallel(code, solver, target)
        else:
            return None
    except NoCodeError:
        return None
    return _function(code, head, values)


def _function(code: FormCode, head: str, leaves: list[list[str]]) -> str:
    """The source of a code, whose roots' joint values are given by the angles a0, a1, …"""
    many = len(code.pairs)
    code.say(f"ys += ({', '.join(y for y, _ in code.pairs)},)")
    code.say(f"xs += ({', '.join(x for _, x in code.pairs)},)")
    rest = ["    angles = arctan2(ys, xs).tolist()", f"    for k in range(0, len(ys), {many}):"]
    rest.append(f"        {', '.join(f'a{k}' for k in range(many))}, = angles[k : k + {many}]")
    rest += [f"        leaves.append(({', '.join(leaf)}))" for leaf in leaves]
    whole = ["def straight(rows):", f"    {head} = rows", "    ys, xs, leaves = [], [], []", *code.text, *rest]
    return "\n".join([*whole, "    return leaves"])


def compiled_form(source: str) -> StraightForm:
    """The function that a source defines."""
    names: dict[str, Any] = {"sqrt": math.sqrt, "copysign": math.copysign, "arctan2": np.arctan2}
    exec(compile(source, "<straight form>", "exec"), names)
    return cast(StraightForm, names["straight"])


def form_maker(source: str, names: Sequence[str]) -> Callable[..., StraightForm]:
    """A function that gives the function of a source for numbers that have names in it."""
    lines = [f"def maker({', '.join(names)}):", *source.splitlines()]
    known: dict[str, Any] = {"sqrt": math.sqrt, "copysign": math.copysign, "arctan2": np.arctan2}
    exec(compile("\n    ".join([*lines, "return straight"]), "<straight forms>", "exec"), known)
    return cast(Callable[..., StraightForm], known["maker"])


def _source(value: int | float) -> str:
    """An angle as it stands in the code: its place among those that are worked out together, or a number."""
    return f"a{value}" if isinstance(value, int) else written(value)


def _all_revolute(solver: SphericalTriple | ThreeParallel) -> bool:
    return solver.a is Revolute and solver.b is Revolute and solver.c is Revolute


def _in_order(solver: SphericalTriple | ThreeParallel, values: list[str]) -> list[str]:
    """The values of joints a, b, c and of the other three in the arm's order."""
    order = [5 - j for j in solver.joints] if solver.reversed else list(solver.joints)
    return [value for _, value in sorted(zip(order, values, strict=True))]


# Spherical wrist ----------------------------------------------------------------------------------------------


def _spherical(code: FormCode, solver: SphericalTriple, target: EntryFrame) -> list[list[str]]:
    """The leaves of an arm whose three axes meet in a point."""
    if not _all_revolute(solver):
        raise NoCodeError
    if solver.reversed:
        target = backwards_closing(target)
    B, D = solver.B or target, solver.D or target
    g = solver.point(D)
    code.long(g[0], g[1], LEVER)
    v, square, e = solver.equations(B, g)
    q_c = _third(code, solver, v, square, e)
    q_b, y = _second(code, solver, v, e, q_c)
    code.long(y[0], y[1], LEVER)
    x = moved(solver.A, y)
    q_a = turning_onto(code, x, g)
    if not right_angled(solver.P, solver.Q):
        code.long(x[0], x[1], LOOSE)
    R: Matrix = transposed(D.R)
    for turn, link in zip((q_a, q_b, q_c), (solver.A, B, solver.C), strict=True):
        R = transposed([applied_back(link.R, Revolute.back_direction(turn, part)) for part in transposed(R)])
    code.long(R[0][2], R[1][2], LEVER)
    angles = [code.angle(turn) for turn in (q_a, q_b, q_c)]
    return [_in_order(solver, [*map(_source, angles), *wrist]) for wrist in _wrist(code, solver.P, solver.Q, R)]


def _third(code: FormCode, solver: SphericalTriple, v: list[Form], square: Form, e: list[Form]) -> Turn:
    """q_c."""
    pair = solver.pair
    if pair.rank == 1:
        f = combined((1.0, -pair.ratio), (e[pair.rest], e[pair.main]))
        says_something(code, f)
        return linear_turn(code, f[1], f[2], times(-1.0, f[0]))
    forms = [*(combined(row, e) for row in pair.inverse), v[2]]
    linear = combined((-1.0,), (square,))
    n = parallel_gradient([linear, *forms])
    if n is None:
        f = combined((1.0, 1.0), (sum_of_products(Revolute, [(1.0, form, form) for form in forms]), linear))
        says_something(code, f)
        return turns_of_second_degree(code, f)
    along = [along_gradient(form, n) for form in forms]
    products = sum_of_products(Prismatic, [(1.0, form, form) for form in along])
    k = combined((1.0, 1.0), (products, along_gradient(linear, n)))
    says_something(code, k)
    return linear_turn(code, n[0], n[1], quadratic(code, k[2], k[1], k[0]))


def _second(
    code: FormCode, solver: SphericalTriple, v: list[Form], e: list[Form], q_c: Turn
) -> tuple[Turn, list[Entry]]:
    """q_b and y."""
    v_x, v_y, v_z = (Revolute.at(part, q_c) for part in v)
    pair = solver.pair
    if pair.rank == 1:
        square = plus(times(v_x, v_x), times(v_y, v_y))
        along = times(Revolute.at(e[pair.main], q_c), 1.0 / pair.size)
        rest = written(minus(square, times(along, along)))
        code.real(f"{rest} >= {-CLAMP!r}")
        side = code.term(f"sqrt({rest} if {rest} > 0.0 else 0.0)")
        (across,) = code.loop((0.0 + side, 0.0 - side))
        n_x, n_y = pair.n
        y = [minus(times(n_x, along), times(n_y, across)), plus(times(n_y, along), times(n_x, across)), v_z]
    else:
        y = [*(Revolute.at(combined(row, e), q_c) for row in pair.inverse), v_z]
    return turning_onto(code, (v_x, v_y), y), y


def _wrist(code: FormCode, P: Matrix, Q: Matrix, R: Matrix) -> list[list[str]]:
    """The three turns that make up R."""
    s = [row[2] for row in Q]
    axis = [row[2] for row in P]
    if not right_angled(P, Q):
        alpha, beta = in_two_turns(code, P, s, [row[2] for row in R])
        return [[_source(code.angle(turn)) for turn in (alpha, beta, _last(Q, R, turned(alpha, axis)))]]
    x, y, z = (row[2] for row in R)
    a, b = lever_of(P[2], s)
    phi = written(angle(a, b))
    theta = _source(code.angle((z, root_of(code, x * x + y * y))))
    alpha = turning_onto(code, applied(P[:2], turned((-b, a), s)), (x, y), FREE)
    first, last = (_source(code.angle(turn)) for turn in (alpha, _last(Q, R, turned(alpha, axis))))
    return [
        [first, f"{phi} + {theta}", last],
        [f"{first} + {math.pi!r}", f"{phi} - {theta}", f"{last} + {math.pi!r}"],
    ]


def _last(Q: Matrix, R: Matrix, axis: Vector) -> Turn:
    """The third turn of a wrist, by any multiple of its cosine and sine."""
    x, y = applied_back([row[:2] for row in R], axis)
    k_x, k_y = Q[2][0], Q[2][1]
    return plus(times(k_x, x), times(k_y, y)), minus(times(x, k_y), times(k_x, y))


# Three parallel axes ------------------------------------------------------------------------------------------


def _first(code: FormCode, solver: ThreeParallel, f: list[Form]) -> Turn:
    """q_a."""
    if solver.rank == 2:
        products = [Revolute.product(part, part) for part in (combined(row, f) for row in solver.G.inverse)]
        equation = combined((1.0, 1.0, -1.0), (*products, [1.0]))
        says_something(code, equation)
        return turns_of_second_degree(code, equation)
    equation = combined((1.0, -solver.G.ratio), (f[solver.G.rest], f[solver.G.main]))
    says_something(code, equation)
    return linear_turn(code, equation[1], equation[2], times(-1.0, equation[0]))


def _parallel(code: FormCode, solver: ThreeParallel, target: EntryFrame) -> list[list[str]]:
    """The leaves of an arm with three parallel axes."""
    if not _all_revolute(solver):
        raise NoCodeError
    if solver.reversed:
        target = backwards_closing(target)
    A, D = solver.A or target, solver.D or target
    f = solver.equations(A, D)
    q_a = _first(code, solver, f)
    w = applied_back(A.R, Revolute.back(q_a, D.R[2]))
    code.long(w[0], w[1], LEVER)
    if solver.rank == 2:
        minus_c, minus_s = (Revolute.at(combined(row, f), q_a) for row in solver.G.inverse)
        q_c = made_unit(code, times(-1.0, minus_c), times(-1.0, minus_s), FREE)
    elif solver.direct:
        q_b, q_c = in_two_turns(code, solver.B.R, solver.u, w)
    else:
        q_c = linear_turn(code, *solver.height, times(-1.0, Revolute.at(f[1], q_a)))
    if solver.rank == 2 or not solver.direct:
        q_b = turning_onto(code, applied(solver.B.R, Revolute.onward(q_c, solver.u)), w)
    p, across = solver.seen_from_first(A, D, (q_a, q_b, q_c))
    l1, l2 = solver.elbow.l1, solver.elbow.l2
    lever = l1.conjugate() * l2
    e = plus(plus(times(p[0], p[0]), times(p[1], p[1])), -(abs(l1) ** 2) - abs(l2) ** 2)
    cos2, sin2 = linear_turn(code, lever.real, -lever.imag, times(0.5, e))
    inner_x = plus(l1.real, minus(times(l2.real, cos2), times(l2.imag, sin2)))
    inner_y = plus(l1.imag, plus(times(l2.imag, cos2), times(l2.real, sin2)))
    first = plus(times(p[0], inner_x), times(p[1], inner_y)), minus(times(p[1], inner_x), times(p[0], inner_y))
    q1, q2, q3 = (_source(code.angle(turn)) for turn in (first, (cos2, sin2), (across[0], across[1])))
    angles = [_source(code.angle(turn)) for turn in (q_a, q_b, q_c)]
    signs = ["-" if sign < 0.0 else "" for sign in solver.elbow.signs]
    third = f"({q3} - {q1} - {q2} - {written(solver.elbow.turn)})"
    return [_in_order(solver, [*angles, q1, f"{signs[0]}{q2}", f"{signs[1]}{third}"])]
