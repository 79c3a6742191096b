"""The joint's own variable in its cell, as lectures print it: `theta: q1 + 90`, `d: 40 - d3`."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from robokin.errors import ExpressionError, or_list, shown
from robokin.formats.expression_tokens import NAME, Token, tokenize
from robokin.formats.number_expressions import RESERVED, Scope


@dataclass(frozen=True)
class VariableCell:
    """What a cell says of its variable: cell = sense · q + constant; `constant` is an expression, "" for none."""

    sense: int
    constant: str


def own_names(cell: str, number: int, name: str) -> tuple[str, ...]:
    """What the variable of a joint is called in its cell: q, q1, theta1 or d1, its name; `number` counts from 1."""
    names = ["q", f"q{number}", f"{cell}{number}"]
    if NAME.fullmatch(name) and name.lower() not in RESERVED:
        names.append(name)
    return tuple(dict.fromkeys(names))


def shift_of(text: str, own: Collection[str], scope: Scope) -> VariableCell | None:
    """What a cell says of a variable with these names; None where it names none of them.

    Raises ExpressionError where it says more than the variable and a constant.
    """
    tokens = tokenize(text)
    places = [i for i, token in enumerate(tokens) if token.kind == "name" and token.text in own]
    if not places:
        return None
    at = places[0]
    variable = tokens[at]
    if variable.text in scope.names:
        raise ExpressionError(
            f"found '{variable.text}', which is a parameter and the joint's variable, expected another name for the "
            "parameter",
            text,
            variable.position,
        )
    first = at
    sense = 1
    while first > 0 and _sign(tokens[first - 1]):
        first -= 1
        sense = -sense if tokens[first].text == "-" else sense
    depth = sum((token.text in "([") - (token.text in ")]") for token in tokens[:at] if token.kind == "symbol")
    ends = tokens[at + 1].kind == "end" or _sign(tokens[at + 1])
    # What stands right before the signs must be the end of a term.
    starts = first == 0 or (first < at and (tokens[first - 1].kind != "symbol" or tokens[first - 1].text in ")]"))
    if len(places) > 1 or depth or not starts or not ends:
        raise ExpressionError(
            f"found more than the joint's variable {variable.text} and a constant, expected such as "
            f"'{variable.text}', '{variable.text} + c' or 'c - {variable.text}'",
            text,
            variable.position,
        )
    before = text[: tokens[first].position]
    after = text[variable.position + len(variable.text) :]
    constant = (before + after).strip()
    return VariableCell(sense, constant.removeprefix("+").strip() or constant)


def other_variable(text: str, own: Collection[str], cell: str, count: int, scope: Scope) -> ExpressionError | None:
    """The error for a cell that names the variable of another joint of `count`, if it does."""
    for token in tokenize(text):
        for letter in ("q", cell):
            digits = token.text.removeprefix(letter)
            if token.kind != "name" or digits == token.text or not (digits.isascii() and digits.isdecimal()):
                continue
            if token.text not in own and token.text not in scope.names and len(digits) < 5 and int(digits) <= count:
                return ExpressionError(
                    f"found '{shown(token.text)}', the variable of joint {int(digits)}, expected this joint's own: "
                    f"{or_list(own)}",
                    text,
                    token.position,
                )
    return None


def _sign(token: Token) -> bool:
    return token.kind == "symbol" and token.text in ("+", "-")
