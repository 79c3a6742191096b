"""Lines of code for a closed form, and those of its equations in one joint.

Statement. What `trigonometry` and `turns` do with columns, as code without arrays: the same operations in their order.
Derivation. An entry that is a number of the arm stays one; any other is a term, a line that is noted when it is made.
Where arrays have a new axis for two roots the code has a loop over both; what is not real is passed over there.
Degenerate case. Wherever the arrays would mark a target the code gives no answer. What has no code is a NoCodeError.
"""

from __future__ import annotations

from typing import cast

from robokin.inverse.closed_form.joint_functions import LOOSE, Form
from robokin.inverse.closed_form.trigonometry import CLAMP, FREE, Turn, normalized, turned
from robokin.inverse.closed_form.turns import lever_of, zeroed
from robokin.kernel.code_lines import Term, written
from robokin.kernel.entries import Entry, Matrix, Vector, angle, applied, minus, plus, root, times


class NoCodeError(Exception):
    """What an arm asks for is left to the arrays."""


class FormCode(list[tuple[str, str]]):
    """Lines of code: what is assigned to and its source, or nothing and a statement."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = 1
        self.text: list[str] = []
        self.pairs: list[tuple[str, str]] = []

    def append(self, line: tuple[str, str]) -> None:
        """One more line, as deep as the loops are."""
        super().append(line)
        name, source = line
        self.text.append("    " * self.depth + (f"{name} = {source}" if name else source))

    def term(self, source: str) -> Entry:
        """What a source comes to."""
        return cast(Entry, Term(self, source))

    def say(self, statement: str) -> None:
        """A statement."""
        self.append(("", statement))

    def unless(self, condition: str) -> None:
        """No answer unless a condition holds."""
        self.say(f"if not {condition}: return None")

    def real(self, condition: str) -> None:
        """Only roots for which a condition holds; before there are roots, no solution unless it does."""
        self.say(f"if not {condition}: {'continue' if self.depth > 1 else 'return leaves'}")

    def loop(self, *both: tuple[Entry, Entry]) -> list[Entry]:
        """A loop over two values of some entries; what follows is inside it."""
        first, second = (", ".join(written(pair[k]) for pair in both) for k in (0, 1))
        names = [f"w{len(self)}_{k}" for k in range(len(both))]
        self.say(f"for {', '.join(names)} in (({first}), ({second})):" if len(both) > 1 else
                 f"for {names[0]} in ({first}, {second}):")  # fmt: skip
        self.depth += 1
        return [cast(Entry, Term.named(self, name)) for name in names]

    def long(self, x: Entry, y: Entry, least: float) -> None:
        """No answer where a lever (x, y) is shorter; one of the arm's own is looked at now."""
        square = plus(times(x, x), times(y, y))
        if not isinstance(square, float):
            self.unless(f"{written(square)} >= {least * least!r}")

    def angle(self, turn: Turn) -> int | float:
        """The angle of a turn, all of which are worked out together: its place among them, or an angle of the arm."""
        c, s = turn
        if isinstance(c, float) and isinstance(s, float):
            return float(cast(float, angle(c, s)))
        self.pairs.append((written(s), written(c)))
        return len(self.pairs) - 1


def says_something(code: FormCode, f: Form) -> None:
    """No answer where every coefficient vanishes."""
    if any(isinstance(part, float) and abs(part) >= LOOSE for part in f):
        return
    terms = [f"abs({written(part)}) >= {LOOSE!r}" for part in f if not isinstance(part, float)]
    if not terms:
        raise NoCodeError
    code.unless(f"({' or '.join(terms)})")


def linear_turn(code: FormCode, a: Entry, b: Entry, e: Entry) -> Turn:
    """Both θ of a cos θ + b sin θ = e, as `linear_roots` has them."""
    r = root_of(code, plus(times(a, a), times(b, b)))
    if isinstance(r, float) and (isinstance(e, float) or r < FREE):
        raise NoCodeError
    if not isinstance(r, float):
        code.unless(f"{written(r)} >= {FREE!r}")
    code.real(f"abs({written(e)}) <= {written(r)} + {CLAMP!r}")
    scale = 1.0 / r if isinstance(r, float) else code.term(f"1.0 / {written(r)}")
    a, b = times(a, scale), times(b, scale)
    x = written(times(e, scale))
    c = code.term(f"-1.0 if {x} < -1.0 else 1.0 if {x} > 1.0 else {x}")
    s = code.term(f"sqrt({written((1.0 - c) * (1.0 + c))})")
    ends = [(middle + side, middle - side) for middle, side in
            ((times(a, c), -times(b, s)), (times(b, c), times(a, s)))]  # fmt: skip
    cosine, sine = code.loop(*ends)
    return cosine, sine


def quadratic(code: FormCode, a: Entry, b: Entry, c: Entry) -> Entry:
    """Both x of a x² + b x + c = 0, as `quadratic_roots` has them."""
    if not isinstance(a, float) or isinstance(c, float):
        raise NoCodeError
    square, product = b * b, 4.0 * a * c
    D = written(square - product)
    code.real(f"{D} + {CLAMP!r} * ({written(square)} + abs({written(product)}) + {CLAMP!r}) >= 0.0")
    q = code.term(f"-0.5 * ({written(b)} + copysign(sqrt({D} if {D} > 0.0 else 0.0), {written(b)}))")
    code.unless(f"abs({written(q)}) >= {FREE!r}")
    first = code.term(f"{written(c)} / {written(q)}")
    if not abs(a) > FREE:
        return first
    return code.loop((first, code.term(f"{written(q)} / {written(a)}")))[0]


def root_of(code: FormCode, value: Entry) -> Entry:
    """The square root of a sum of squares."""
    return root(value) if isinstance(value, float) else code.term(f"sqrt({written(value)})")


def made_unit(code: FormCode, c: Entry, s: Entry, free_below: float) -> Turn:
    """(c, s) made a cosine and a sine, as `trigonometry.normalized` does; no answer where they are too short."""
    square = plus(times(c, c), times(s, s))
    if isinstance(square, float):
        return normalized(c, s, free_below)
    code.unless(f"{written(square)} >= {free_below * free_below!r}")
    scale = code.term(f"1.0 / sqrt({written(square)})")
    return times(c, scale), times(s, scale)


def turning_onto(code: FormCode, v: Vector, u: Vector, free: float = FREE**2) -> Turn:
    """The turn about z that takes the direction of v to that of u."""
    c = plus(times(u[0], v[0]), times(u[1], v[1]))
    s = minus(times(u[1], v[0]), times(u[0], v[1]))
    return made_unit(code, c, s, free)


def in_two_turns(code: FormCode, P: Matrix, s: Vector, w: Vector) -> tuple[Turn, Turn]:
    """α and β of Rz(α) P Rz(β) s = w for a constant s, as `two_turns` has them."""
    a, b = lever_of(P[2], s)
    A = root(plus(times(a, a), times(b, b)))
    middle = times(P[2][2], s[2])
    if not (isinstance(A, float) and isinstance(middle, float)) or isinstance(w[2], float):
        raise NoCodeError
    square = plus(times(w[0], w[0]), times(w[1], w[1]))
    great = code.term(f"1.0 + abs({written(w[2])})")
    small = code.term(f"{written(square)} / {written(great)}")
    up = f"{written(w[2])} > 0.0"
    near = plus(zeroed(middle + A - 1.0), code.term(f"{written(small)} if {up} else {written(great)}"))
    far = plus(zeroed(A - middle - 1.0), code.term(f"{written(great)} if {up} else {written(small)}"))
    for distance in (near, far):
        code.real(f"{written(distance)} >= {-CLAMP!r}")
    near, far = (code.term(f"{written(end)} if {written(end)} > 0.0 else 0.0") for end in (near, far))
    c, side = made_unit(code, far - near, code.term(f"2.0 * sqrt({written(near * far)})"), FREE)
    cos_phi, sin_phi = normalized(a, b)
    first, second = times(cos_phi, c), times(-1.0, times(sin_phi, side))
    third, fourth = times(sin_phi, c), times(cos_phi, side)
    beta = code.loop((first + second, first - second), (third + fourth, third - fourth))
    alpha = turning_onto(code, applied(P[:2], turned((beta[0], beta[1]), s)), w)
    return alpha, (beta[0], beta[1])
