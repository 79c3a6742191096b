"""The curves of one pose of an arm with a spherical shoulder and wrist as straight-line code.

Statement. Give the factors of `SwivelCurves` for one pose in some microseconds.
Derivation. `curves_by_entry` is walked once with terms in place of numbers, which note lines of Python; those are
compiled. The operations are those of columns in their order, so that a pose alone has the digits that it has among
others; the arc cosine, cosines and sines are numpy's.
Degenerate case. Poses with a straight elbow, or one on the line from shoulder to wrist, are left to the columns.
"""

from __future__ import annotations

from collections.abc import Callable
from struct import Struct
from typing import Any, Self

import numpy as np

from robokin.arrays import Array
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_curves import curves_by_entry
from robokin.kernel.code_lines import Lines, Term, folded, made, needed, written
from robokin.kernel.facts import fact

OneCurves = tuple[bool, tuple[float, float], bool, Array]
"""Whether there is doubt; both elbows [rad], offset included; whether these are real; the factors (60,) of their
triples."""


class _Noted(Term):
    """An entry, or a flag, that is a line of code."""

    __slots__ = ()

    def __ge__(self, other: Self | float) -> Self:
        return self._with(">=", other)

    def __gt__(self, other: Self | float) -> Self:
        return self._with(">", other)

    def __le__(self, other: Self | float) -> Self:
        return self._with("<=", other)

    def __lt__(self, other: Self | float) -> Self:
        return self._with("<", other)

    def __and__(self, other: Self) -> Self:
        return self._with("and", other)

    def __or__(self, other: Self) -> Self:
        return self._with("or", other)

    def __rtruediv__(self, other: float) -> Self:
        return type(self)(self.lines, f"{written(other)} / {self.name}")

    def __abs__(self) -> Self:
        return type(self)(self.lines, f"abs({self.name})")

    def _with(self, sign: str, other: Self | float) -> Self:
        return type(self)(self.lines, f"{self.name} {sign} {written(other)}")


class _NotedMaths:
    """The functions of numpy that the curves ask for, noted as lines; left: flags of what is left to the columns."""

    def __init__(self, lines: Lines) -> None:
        self.lines = lines
        self.left: list[str] = []

    def any(self, flag: _Noted) -> bool:
        """No: where it is so the columns answer."""
        self.left.append(flag.name)
        return False

    def hypot(self, x: Any, y: Any) -> _Noted:
        return self._noted(f"abs(complex({written(x)}, {written(y)}))")

    def where(self, flag: _Noted, value: Any, other: Any) -> Any:
        if isinstance(value, float) and value == other:
            return value
        return self._noted(f"{written(value)} if {flag.name} else {written(other)}")

    def maximum(self, a: Any, b: Any) -> _Noted:
        return self._noted(f"{written(b)} if {written(b)} > {written(a)} else {written(a)}")

    def minimum(self, a: Any, b: Any) -> _Noted:
        return self._noted(f"{written(b)} if {written(b)} < {written(a)} else {written(a)}")

    def sqrt(self, x: _Noted) -> _Noted:
        return self._noted(f"sqrt({x.name})")

    def rint(self, x: _Noted) -> _Noted:
        return self._noted(f"round({x.name})")

    def arccos(self, x: _Noted) -> _Noted:
        return self._noted(f"float(arccos({x.name}))")

    def cos(self, x: _Noted) -> _Noted:
        return self._noted(f"float(cos({x.name}))")

    def sin(self, x: _Noted) -> _Noted:
        return self._noted(f"float(sin({x.name}))")

    def _noted(self, source: str) -> _Noted:
        return _Noted(self.lines, source)


@fact
def one_curves(arm: SwivelArm) -> Callable[..., OneCurves | None]:
    """A function of the 16 numbers of a target [m], row after row; it gives None for what is left to the columns."""
    lines: Lines = []
    maths = _NotedMaths(lines)
    targets: list[Any] = [_Noted.named(lines, f"t{k}") for k in range(12)]
    q4, real, numbers, doubt, straight, _, _ = curves_by_entry(arm, targets, maths)
    flags = [doubt.name, *(one.name for one in (*q4, real[0])), straight.name, *maths.left]
    lines, asked = folded(lines, [*flags, *map(written, numbers)])
    doubt, first, second, is_real, *left = asked[: len(flags)]
    entries = asked[len(flags) :]
    body = [f"def straight({', '.join(f't{k}' for k in range(12))}, *bottom):", *needed(lines, asked, "    ")]
    body += [f"    if {' or '.join(left)}:", "        return None", f"    found = empty({len(entries)})"]
    body += [
        f"    fill(found, 0, {', '.join(entries)})",
        "    found += 0.0",
        f"    return {doubt}, ({first}, {second}), {is_real}, found",
    ]
    names = {"empty": np.empty, "fill": Struct(f"{len(entries)}d").pack_into}
    curves: Callable[..., OneCurves | None] = made(body, arccos=np.arccos, cos=np.cos, sin=np.sin, **names)
    return curves
