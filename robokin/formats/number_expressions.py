"""Number expressions: what a cell of a table may hold, and how much it is.

    number = product { (+ | -) product }        product = signed { (* | /) signed }
    signed = { - | + } power                    power   = atom [ ** signed ]
    atom   = literal | name | function ( number { , number } ) | ( number )

Names are `pi` and the description's parameters; the functions are those of `FUNCTIONS`. Angles are in
the unit of the place where the expression stands: the trigonometric functions take and give them so,
`deg(x)` and `rad(x)` convert. In degrees an angle that mentions `pi` outside `deg(…)` is an error:
1.57 degrees is never what was meant. Nothing else can be named or called, everything is a float, and a
result that is not finite is an error, so no expression can cost much or reach anything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass

from robokin.errors import ExpressionError, did_you_mean, shown
from robokin.formats.expression_functions import (
    ARGUMENTS,
    FUNCTIONS,
    IN_DEGREES,
    IN_RADIANS,
    PLAIN,
    TAKES_ANGLE,
    Function,
)
from robokin.formats.expression_tokens import LOOKALIKES, Token, tokenize

MAX_NESTING = 50
"""Levels of parentheses."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number, and whether it comes from `pi` outside `deg(…)`: that is what no angle in degrees may be.

    rounding: how far the number may be off if each number in the text, and in the parameters that it names, is off by a
    unit in its last place, to first order; 0 where they are exact.
    """

    number: float
    mentions_pi: bool = False
    rounding: float = 0.0


@dataclass(frozen=True)
class Scope:
    """What an expression may refer to.

    `degrees` is the unit of angles; `lookup` gives the value of a parameter (it may raise
    ExpressionError) and `names` lists the parameters there are.
    """

    degrees: bool = False
    names: Collection[str] = ()
    lookup: Callable[[str], Value] | None = None


ROUNDED = 3
"""Digits that a number must be written with to be taken for a rounded one: nobody rounds a measure to 0.2 or 15."""

RESERVED = ("pi", *FUNCTIONS, "nan", "inf", "infinity", *LOOKALIKES)
"""Names that no parameter may have, in lower case: they mean something already, or look as if they did."""


class Parser:
    """Reads and evaluates an expression in one pass, from left to right.

    Also the reader of numbers inside transform expressions, which share its tokens.
    """

    def __init__(self, text: str, scope: Scope) -> None:
        self.text = text
        self.scope = scope
        self.tokens = tokenize(text)
        self.index = 0
        self.depth = 0

    @property
    def token(self) -> Token:
        """The next token."""
        return self.tokens[self.index]

    def error(self, message: str, token: Token | None = None) -> ExpressionError:
        """An ExpressionError at a token, the next one by default."""
        return ExpressionError(message, self.text, (token or self.token).position)

    def found(self) -> str:
        """The next token, as a message says it."""
        return f"'{shown(self.token.text)}'" if self.token.kind != "end" else "the end"

    def accept(self, symbol: str) -> bool:
        """Take the next token if it is this symbol."""
        if self.token.kind == "symbol" and self.token.text == symbol:
            self.index += 1
            return True
        return False

    def expect(self, symbol: str) -> None:
        """Take this symbol or raise."""
        if not self.accept(symbol):
            raise self.error(f"found {self.found()}, expected '{symbol}'")

    def number(self) -> Value:
        """A sum of products."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.error(f"found more than {MAX_NESTING} levels of nesting, expected a simpler expression")
        value = self.product()
        while self.token.text in ("+", "-") and self.token.kind == "symbol":
            sign = 1.0 if self.accept("+") else -1.0
            if sign < 0:
                self.expect("-")
            right = self.product()
            rounding = value.rounding + right.rounding
            value = self.finite(value.number + sign * right.number, value, right, rounding=rounding)
        self.depth -= 1
        return value

    def product(self) -> Value:
        """A product or quotient of signed powers."""
        value = self.signed()
        while self.token.kind == "symbol" and self.token.text in ("*", "/"):
            token = self.token
            self.index += 1
            right = self.signed()
            if token.text == "/" and right.number == 0.0:
                raise self.error("found a division by zero, expected a divisor other than zero", token)
            quotient = token.text == "/"
            number = value.number / right.number if quotient else value.number * right.number
            rounding = value.rounding * abs(right.number) + right.rounding * abs(value.number)
            rounding = rounding / abs(right.number) / abs(right.number) if quotient else rounding
            value = self.finite(number, value, right, rounding=rounding)
        return value

    def signed(self) -> Value:
        """A power with any signs before it; -2**2 is -(2**2)."""
        negative = False
        while self.token.kind == "symbol" and self.token.text in ("-", "+"):
            negative ^= self.token.text == "-"
            self.index += 1
        value = self.power()
        return Value(-value.number, value.mentions_pi, value.rounding) if negative else value

    def power(self) -> Value:
        """An atom, raised to a power if one follows; 2**3**2 is 2**(3**2)."""
        base = self.atom()
        token = self.token
        if not self.accept("**"):
            return base
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.error(f"found more than {MAX_NESTING} levels of nesting, expected a simpler expression")
        exponent = self.signed()
        self.depth -= 1
        number = self.call(math.pow, (base.number, exponent.number), "**", token)
        return self.finite(number, base, exponent, rounding=_spread(math.pow, number, [base, exponent]))

    def atom(self) -> Value:
        """A literal, a name, a call, or an expression in parentheses."""
        token = self.token
        if token.kind == "number":
            self.index += 1
            return self.finite(float(token.text), rounding=last_place(token.text))
        if self.accept("("):
            value = self.number()
            self.expect(")")
            return value
        if token.kind != "name":
            raise self.error(f"found {self.found()}, expected a number or an expression")
        self.index += 1
        if self.token.kind == "symbol" and self.token.text == "(":
            return self.function(token)
        return self.name(token)

    def name(self, token: Token) -> Value:
        """The value of `pi` or of a parameter."""
        if token.text == "pi":
            return Value(math.pi, mentions_pi=True)
        if token.text in self.scope.names and self.scope.lookup is not None:
            return self.scope.lookup(token.text)
        if token.text in FUNCTIONS:
            raise self.error(f"found the function '{token.text}' without its argument, expected {token.text}(…)", token)
        if token.text.lower() in ("nan", "inf", "infinity"):
            raise self.error(f"found '{token.text}', expected a finite number", token)
        if token.text in LOOKALIKES:
            raise self.error(f"found '{token.text}', expected '{LOOKALIKES[token.text]}'", token)
        known = ["pi", *self.scope.names]
        hint = did_you_mean(token.text, known)
        if not hint:
            hint = f", expected {'pi' if len(known) == 1 else 'one of ' + ', '.join(known[:12])} or a number"
        raise self.error(f"found the unknown name '{shown(token.text)}'{hint}", token)

    def function(self, token: Token) -> Value:
        """The value of a call."""
        name = token.text
        if name not in FUNCTIONS:
            hint = did_you_mean(name, FUNCTIONS) or f", expected one of {', '.join(FUNCTIONS)}"
            raise self.error(f"found the unknown function '{shown(name)}'{hint}", token)
        self.expect("(")
        start = self.token.position
        arguments = [self.number()]
        while self.accept(","):
            arguments.append(self.number())
        stop = self.token.position
        self.expect(")")
        least, most = ARGUMENTS.get(name, (1, 1))
        if not least <= len(arguments) <= most:
            expected = str(least) if least == most else f"at least {least}"
            raise self.error(f"found {name}() with {len(arguments)} arguments, expected {expected}", token)
        if name in TAKES_ANGLE and self.scope.degrees and arguments[0].mentions_pi:
            raise pi_in_degrees(self.text[start:stop], self.text, start)
        table = PLAIN if name in PLAIN else IN_DEGREES if self.scope.degrees else IN_RADIANS
        number = self.call(table[name], tuple(value.number for value in arguments), f"{name}()", token)
        rounding = _spread(table[name], number, arguments)
        if name == "deg":
            return self.finite(number, rounding=rounding)
        return self.finite(number, *arguments, rounding=rounding)

    def call(self, function: Function, arguments: tuple[float, ...], name: str, token: Token) -> float:
        """function(*arguments), its refusals in words."""
        try:
            return float(function(*arguments))
        except (ValueError, ZeroDivisionError):
            where = ", ".join(f"{argument:g}" for argument in arguments)
            raise self.error(f"{name} has no value at {where}, expected an argument where it has one", token) from None
        except OverflowError:
            raise self.error("found a result that is too large, expected a finite number", token) from None

    def finite(self, number: float, *origins: Value, rounding: float = 0.0) -> Value:
        """A Value that is finite and remembers pi from where it came."""
        if not math.isfinite(number):
            raise self.error(
                "found a result that is too large, expected a finite number", self.tokens[max(self.index - 1, 0)]
            )
        return Value(number, any(origin.mentions_pi for origin in origins), min(rounding, abs(number) + 1.0))

    def angle(self) -> float:
        """A number at a place where an angle is due, in the scope's angle unit."""
        start = self.token
        value = self.number()
        if value.mentions_pi and self.scope.degrees:
            raise pi_in_degrees(self.text[start.position : self.token.position], self.text, start.position)
        return value.number

    def end(self) -> None:
        """Raise unless all is read."""
        if self.token.kind != "end":
            raise self.error(f"found {self.found()}, expected the end of the expression")


def last_place(text: str) -> float:
    """The unit in the last place of a number as it is written, 0 where it has so few digits that it is exact."""
    mantissa, _, exponent = text.lower().partition("e")
    whole, point, fraction = mantissa.partition(".")
    digits = (whole + fraction).lstrip("0")
    # The zeros that end a whole number say nothing, those of 0.000 that it was rounded.
    digits = digits if digits and point else digits.rstrip("0") or fraction
    # Beyond a thousand a power is 0 or infinite all the same, and Python makes no whole number of thousands of digits.
    power = int(max(-1000.0, min(float(exponent or "0"), 1000.0))) - len(fraction)
    return float(f"1e{power}") if len(digits) >= ROUNDED else 0.0


def _spread(function: Function, number: float, arguments: list[Value]) -> float:
    """How far a function's value may be off with its arguments; as much as where it has none beside them."""
    spread = 0.0
    for i, argument in enumerate(arguments):
        if not argument.rounding:
            continue
        sizes = [0.0]
        for sign in (1.0, -1.0):
            moved = [value.number for value in arguments]
            moved[i] += sign * argument.rounding
            try:
                sizes.append(abs(float(function(*moved)) - number))
            except (ValueError, ZeroDivisionError, OverflowError, TypeError):
                continue
        spread += max(size for size in sizes if math.isfinite(size))
    return spread


def pi_in_degrees(angle: str, text: str, position: int) -> ExpressionError:
    """The error for an angle in degrees that mentions pi, at a position of a text."""
    angle = shown(angle)
    return ExpressionError(
        f"found pi in an angle that is in degrees ('{angle}'), expected degrees: "
        f"write deg({angle}), or the number of degrees, or state angles in rad",
        text,
        position,
    )


def evaluate(text: str, scope: Scope, *, angle: bool = False) -> Value:
    """The value of a whole expression; `angle` says that an angle is due.

    Raises ExpressionError when it cannot be read, has no finite value, or is an angle in degrees that
    mentions pi.
    """
    parser = Parser(text, scope)
    if parser.token.kind == "end":
        raise ExpressionError("found nothing, expected a number", text, 0)
    value = parser.number()
    parser.end()
    if angle and value.mentions_pi and scope.degrees:
        raise pi_in_degrees(text, text, 0)
    return value


def names_parameters(text: str, scope: Scope) -> bool:
    """Whether an expression that can be read names a parameter."""
    return bool(scope.names) and any(token.text in scope.names for token in tokenize(text) if token.kind == "name")
