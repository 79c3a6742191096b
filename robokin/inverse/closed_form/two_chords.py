"""The angles of an equation of the second degree in cosine and sine, as lines of code.

Statement. All θ of h0 + h1 cos θ + h2 sin θ + h3 cos 2θ + h4 sin 2θ = 0, at most four, as code without arrays.
Derivation. The points (c, s) of the unit circle that are asked for lie on a conic, and on every other one of the pencil

    h0 + h1 c + h2 s + h3 (c² - s²) + 2 h4 c s + λ (1 - c² - s²) = 0.

Turned by half of the angle of (h3, h4) it has no product c s; with R = |(h3, h4)| and (w1, w2) the half of (h1, h2)
turned, it is two lines where

    (λ² - R²) (λ + h0) + w1² (λ + R) + w2² (λ - R) = 0.

The left side is not positive at λ = -R and not negative at R. Where two or four of the points are real, so are the two
lines for each real λ, and |λ| <= R: the lines are chords through two of the points each. Of the three λ the one that is
farthest from the others is taken, by Newton's steps from beyond it. Then √p c ∓ √n s + (u ± v) = 0 with p + n = 1: each
chord meets the circle in two points (`linear_turn`), and a last Newton's step on θ makes up for what rounding did to λ.
For chords of directions α and β
λ = ±R cos(α - β), so that where |λ| > R no point is real.
Degenerate case. There is no answer where λ is not well apart from the others (three points or more nearly in one), nor
where R is next to nothing (two points are far off). Pairs of points that have nearly met are kept as real, as
`linear_roots` does; what comes of them is verified.
Reference: the three pairs of lines through four points are Ferrari's three ways to part a quartic, seen in the plane.
"""

from __future__ import annotations

from robokin.inverse.closed_form.form_code import FormCode, linear_turn
from robokin.inverse.closed_form.joint_functions import Form, vanishes
from robokin.inverse.closed_form.trigonometry import CLAMP, Turn, turned, turned_back
from robokin.kernel.code_lines import Term, written
from robokin.kernel.entries import Entry, times

LEAST_SECOND = 1e-6
"""R, for h of length 1, below which the equation is taken to be nearly of the first degree, and left to the arrays."""

APART = 1e-6
"""R f'(λ), for h of length 1, below which λ is not apart: rounding, 1e-16, moves λ / R by less than 1e-9 otherwise."""

STEPS = 9
"""Newton's steps to λ: five where it is well apart, and more where the first guess is some times too large."""

SETTLED = 1e-9
"""How much the last of them may change: the next would change it by the square."""

SMALL = 1e-3
"""p or n below which the chord's distance is taken from the other's: √(u² - v²) then keeps more digits than w / √p."""


def turns_of_second_degree(code: FormCode, h: Form) -> Turn:
    """All θ of an equation, as `second_degree_roots` has them but for the order."""
    if all(vanishes(part) for part in h[3:]):
        return linear_turn(code, h[1], h[2], times(-1.0, h[0]))
    h0, h1, h2, h3, h4 = _unit(code, [*h])
    R = _root(code, h3 * h3 + h4 * h4)
    code.unless(f"{written(R)} >= {LEAST_SECOND!r}")
    half = _half(code, R, h3, h4)
    w1, w2 = (0.5 * part for part in turned_back(half, (h1, h2)))
    at = _apart(code, R, h0, w1, w2) / R  # λ / R
    p, n = 0.5 - 0.5 * at, 0.5 + 0.5 * at
    for part in (p, n):
        code.real(f"{written(part)} >= {-CLAMP!r}")
    a, b = (_root(code, part) for part in (p, n))
    g0, g1, g2 = ((0.5 * part) / R for part in (h0 + at * R, w1, w2))
    u = g1 / code.term(f"{written(a)} if {written(p - SMALL)} > 0.0 else 1.0")
    v = g2 / code.term(f"{written(b)} if {written(n - SMALL)} > 0.0 else 1.0")
    other_u, other_v = _root(code, v * v + g0), _root(code, u * u - g0)
    u = code.term(f"{written(u)} if {written(p - SMALL)} > 0.0 else copysign({written(other_u)}, {written(g1)})")
    v = code.term(f"{written(v)} if {written(n - SMALL)} > 0.0 else copysign({written(other_v)}, {written(g2)})")
    e, across = code.loop((-(u + v), v - u), (-b, b))
    code.real(f"abs({written(e)}) <= {1.0 + CLAMP!r}")
    c = code.term(f"-1.0 if {written(e)} < -1.0 else 1.0 if {written(e)} > 1.0 else {written(e)}")
    s = _root(code, (1.0 - c) * (1.0 + c))
    middle, side = turned((c, s), (a, across)), turned_back((c, s), (a, across))
    cosine, sine = code.loop((middle[0], side[0]), (middle[1], side[1]))
    return _stepped(code, (h0, h1, h2, h3, h4), turned(half, (cosine, sine)))


def _unit(code: FormCode, h: list[Entry]) -> list[Entry]:
    """The equation as terms, with coefficients of length 1; at least one is not small (`says_something`)."""
    terms = [one if isinstance(one, Term) else code.term(written(one)) for one in h]
    h0, h1, h2, h3, h4 = terms
    scale = code.term(f"1.0 / sqrt({written(h0 * h0 + h1 * h1 + h2 * h2 + h3 * h3 + h4 * h4)})")
    return [one * scale for one in terms]


def _root(code: FormCode, value: Entry) -> Entry:
    """The square root of a term; 0 of what is negative by rounding."""
    name = written(value)
    return code.term(f"sqrt({name} if {name} > 0.0 else 0.0)")


def _half(code: FormCode, R: Entry, h3: Entry, h4: Entry) -> Turn:
    """Cosine and sine of half of the angle of (h3, h4), whose length is R."""
    great = _root(code, 0.5 + 0.5 * (code.term(f"abs({written(h3)})") / R))
    small = 0.5 * (h4 / R) / great
    right = f"{written(h3)} > 0.0"
    c = code.term(f"{written(great)} if {right} else {written(small)}")
    return c, code.term(f"{written(small)} if {right} else {written(great)}")


def _apart(code: FormCode, R: Entry, h0: Entry, w1: Entry, w2: Entry) -> Entry:
    """The λ that is farthest from the others."""
    first, second, square = w1 * w1, w2 * w2, R * R
    middle = h0 / 3.0
    third = first + second - square
    # With λ = x - middle it is x³ + P x + Q = 0.
    P = third - 3.0 * (middle * middle)
    Q = middle * (2.0 * (middle * middle) - third) + R * (first - second) - h0 * square
    P_name, Q_name = written(P), written(Q)
    code.unless(f"(abs({P_name}) >= {APART * APART!r} or abs({Q_name}) >= {APART * APART!r})")
    size = code.term(f"abs({Q_name})")
    # Beyond the greatest root of x³ + P x - |Q|, and right of where the curve bends, each step stays beyond.
    x = _root(code, -P) + _root(code, _root(code, size))
    before = x
    for _ in range(STEPS):
        before, square = x, x * x
        x = (2.0 * (square * x) + size) / (3.0 * square + P)
    code.unless(f"abs({written(x - before)}) <= {SETTLED!r}")
    code.unless(f"{written((3.0 * (x * x) + P) * R)} >= {APART!r}")
    return code.term(f"copysign({written(x)}, {written(-Q)})") - middle


def _stepped(code: FormCode, h: tuple[Entry, ...], turn: list[Entry]) -> Turn:
    """An angle after a Newton's step on the equation."""
    h0, h1, h2, h3, h4 = h
    c, s = turn
    double_c, double_s = c * c - s * s, 2.0 * (c * s)
    off = h0 + (h1 * c + h2 * s) + (h3 * double_c + h4 * double_s)
    slope = (h2 * c - h1 * s) + 2.0 * (h4 * double_c - h3 * double_s)
    code.unless(f"abs({written(slope)}) >= {APART * APART!r}")
    step = off / slope
    c, s = c + step * s, s - step * c
    scale = code.term(f"1.0 / sqrt({written(c * c + s * s)})")
    return c * scale, s * scale
