"""Sums of angles about one axis, and their cosines and sines."""

from __future__ import annotations

from dataclasses import dataclass

from robokin.derivation.symbol_sums import ONE, TURN, ZERO, Sum, negative, symbol


@dataclass(frozen=True)
class NamedAngle:
    """An angle with a name: the label that its cosine and sine carry, and what they are taken of.

    `row` is its place along the chain, `kind` 0 for a turn about z and 1 for a twist about x.
    """

    row: int
    label: str
    argument: str
    kind: int = 0


@dataclass(frozen=True)
class Angle:
    """Quarter turns, and named angles, each with its sign."""

    quarters: int = 0
    parts: tuple[tuple[NamedAngle, int], ...] = ()

    def plus(self, other: Angle, sign: int = 1) -> Angle:
        """This angle and the other one, or less it. What the two have with opposite signs is gone."""
        parts = list(self.parts)
        for part, own in other.parts:
            if (part, -sign * own) in parts:
                parts.remove((part, -sign * own))
            else:
                parts.append((part, sign * own))
        return Angle((self.quarters + sign * other.quarters) % 4, tuple(parts))


@dataclass(frozen=True)
class Function:
    """The meaning of a symbol: `cos` or `sin` of a sum of named angles."""

    name: str
    argument: str
    labels: tuple[tuple[str, int], ...]


class Trigonometry:
    """Names cosines and sines, and remembers what the names mean.

    `spaced` says that labels have more than one character, so that they must be kept apart:
    `c12` is the cosine of joint 12 then, and that of joints 1 and 2 together is `c1_2`.
    """

    def __init__(self, spaced: bool) -> None:
        self.spaced = spaced
        self.functions: dict[str, Function] = {}

    def cos(self, angle: Angle) -> Sum:
        """The cosine."""
        return self._of(angle, 1)

    def sin(self, angle: Angle) -> Sum:
        """The sine: the cosine of a quarter turn less."""
        return self._of(angle, 0)

    def _of(self, angle: Angle, quarter: int) -> Sum:
        """sin(angle + quarter · 90°), by the quadrant that it falls in."""
        quadrant = (angle.quarters + quarter) % 4
        sines = quadrant % 2 == 0
        value = self._named("sin" if sines else "cos", angle.parts)
        return negative(value) if quadrant > 1 else value

    def _named(self, name: str, parts: tuple[tuple[NamedAngle, int], ...]) -> Sum:
        if not parts:
            return ONE if name == "cos" else ZERO
        if parts[0][1] < 0:  # cos(-x) = cos x, sin(-x) = -sin x
            turned = self._named(name, tuple((part, -sign) for part, sign in parts))
            return turned if name == "cos" else negative(turned)
        # m stands for minus: a name has no room for the sign itself.
        labels = [("m" if sign < 0 else "") + part.label for part, sign in parts]
        text = name[0] + ("_" if self.spaced else "").join(labels)
        argument = "".join((" - " if sign < 0 else " + ") + part.argument for part, sign in parts).removeprefix(" + ")
        function = Function(name, argument, tuple((part.label, sign) for part, sign in parts))
        while self.functions.setdefault(text, function) != function:
            text += "_"
        rows = [part.row for part, _ in parts]
        return symbol(text, TURN, rows[0], parts[0][0].kind, len(rows), *rows[1:], int(name == "sin"))
