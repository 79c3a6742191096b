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
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from robokin.errors import ExpressionError, did_you_mean

MAX_LENGTH = 10_000
"""Characters of an expression; a 4×4 matrix of them needs a few hundred."""

MAX_NESTING = 50
"""Levels of parentheses."""

TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?![\w.])|(?P<name>[^\W\d]\w*'?)|(?P<symbol>\*\*|[-+*/(),\[\]]))"
)

LOOKALIKES = {
    "−": "-",
    "–": "-",
    "—": "-",
    "·": "*",
    "×": "*",
    "÷": "/",
    "π": "pi",
    "°": "",
    "^": "**",
    ";": ",",
}
"""Characters that a copy from a page brings, and what to write for them."""


@dataclass(frozen=True, slots=True)
class Value:
    """A number, and whether it comes from `pi` outside `deg(…)`: that is what no angle in degrees may be."""

    number: float
    mentions_pi: bool = False


@dataclass(frozen=True)
class Scope:
    """What an expression may refer to.

    `degrees` is the unit of angles; `lookup` gives the value of a parameter (it may raise
    ExpressionError) and `names` lists the parameters there are.
    """

    degrees: bool = False
    names: tuple[str, ...] = ()
    lookup: Callable[[str], Value] | None = None


@dataclass(slots=True)
class Token:
    """A piece of an expression: kind is number, name, symbol or end."""

    kind: str
    text: str
    position: int


def tokenize(text: str) -> list[Token]:
    """The tokens of an expression, an `end` last. Raises ExpressionError at what is none."""
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"an expression of {len(text)} characters, expected at most {MAX_LENGTH}")
    tokens: list[Token] = []
    position = 0
    while text[position:].strip():
        match = TOKEN.match(text, position)
        if match is None or match.end() == position:
            at = position + len(text[position:]) - len(text[position:].lstrip())
            raise _unreadable(text, at)
        kind = match.lastgroup or ""
        tokens.append(Token(kind, match[kind], match.start(kind)))
        position = match.end()
    tokens.append(Token("end", "", len(text)))
    return tokens


def _unreadable(text: str, at: int) -> ExpressionError:
    word = (re.match(r"[\w.]+", text[at:]) or re.match(r".", text[at:], re.DOTALL) or [""])[0]
    if word[:1].isdigit() or word[:1] == ".":
        return ExpressionError(f"found '{word[:40]}', expected a number such as 12, 1.5 or 1e-3", text, at)
    hint = LOOKALIKES.get(word)
    if word == "°":
        return ExpressionError("found '°', expected a bare number: the unit of angles is stated once", text, at)
    if hint is not None:
        return ExpressionError(f"found '{word}', expected '{hint}'", text, at)
    return ExpressionError(f"found {word!r}, expected a number or an expression", text, at)


# Trigonometry in the angle unit at hand --------------------------------------------------------------


def _sine_of_degrees(x: float) -> float:
    """sin of x degrees, exact where it is 0, ±0.5 or ±1 (the sine of a rounded pi/6 is not 0.5)."""
    r = math.fmod(x, 360.0)
    if r < 0.0:
        r += 360.0
    if r >= 180.0:
        return -_sine_of_degrees(r - 180.0) if r < 360.0 else 0.0
    if r > 90.0:
        r = 180.0 - r
    exact = {0.0: 0.0, 30.0: 0.5, 90.0: 1.0}
    return exact[r] if r in exact else math.sin(math.radians(r))


def _cosine_of_degrees(x: float) -> float:
    return _sine_of_degrees(90.0 - math.fmod(x, 360.0))


def _tangent_of_degrees(x: float) -> float:
    r = math.fmod(x, 180.0)
    if abs(r) in (45.0, 135.0):
        return math.copysign(1.0, r) if abs(r) == 45.0 else -math.copysign(1.0, r)
    return _sine_of_degrees(x) / _cosine_of_degrees(x)


Function = Callable[..., float]

IN_RADIANS: dict[str, Function] = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan,
    "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2,
}  # fmt: skip

IN_DEGREES: dict[str, Function] = {
    "sin": _sine_of_degrees,
    "cos": _cosine_of_degrees,
    "tan": _tangent_of_degrees,
    "asin": lambda x: math.degrees(math.asin(x)),
    "acos": lambda x: math.degrees(math.acos(x)),
    "atan": lambda x: math.degrees(math.atan(x)),
    "atan2": lambda y, x: math.degrees(math.atan2(y, x)),
}

PLAIN: dict[str, Function] = {
    "sqrt": math.sqrt, "abs": abs, "min": min, "max": max, "deg": math.degrees, "rad": math.radians,
}  # fmt: skip

FUNCTIONS = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "abs", "min", "max", "deg", "rad")
TAKES_ANGLE = ("sin", "cos", "tan")
ARGUMENTS = {"atan2": (2, 2), "min": (1, 100), "max": (1, 100)}
"""Least and greatest number of arguments, where it is not one."""


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
        return f"'{self.token.text}'" if self.token.kind != "end" else "the end"

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
            raise self.error(f"nested more than {MAX_NESTING} levels deep, expected a simpler expression")
        value = self.product()
        while self.token.text in ("+", "-") and self.token.kind == "symbol":
            sign = 1.0 if self.accept("+") else -1.0
            if sign < 0:
                self.expect("-")
            right = self.product()
            value = self.finite(value.number + sign * right.number, value, right)
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
                raise self.error("a division by zero, expected a number", token)
            quotient = token.text == "/"
            number = value.number / right.number if quotient else value.number * right.number
            value = self.finite(number, value, right)
        return value

    def signed(self) -> Value:
        """A power with any signs before it; -2**2 is -(2**2)."""
        negative = False
        while self.token.kind == "symbol" and self.token.text in ("-", "+"):
            negative ^= self.token.text == "-"
            self.index += 1
        value = self.power()
        return Value(-value.number, value.mentions_pi) if negative else value

    def power(self) -> Value:
        """An atom, raised to a power if one follows; 2**3**2 is 2**(3**2)."""
        base = self.atom()
        token = self.token
        if not self.accept("**"):
            return base
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise self.error("too many powers, expected a simpler expression")
        exponent = self.signed()
        self.depth -= 1
        return self.finite(self.call(math.pow, (base.number, exponent.number), "**", token), base, exponent)

    def atom(self) -> Value:
        """A literal, a name, a call, or an expression in parentheses."""
        token = self.token
        if token.kind == "number":
            self.index += 1
            return self.finite(float(token.text))
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
        raise self.error(f"found the unknown name '{token.text}'{hint}", token)

    def function(self, token: Token) -> Value:
        """The value of a call."""
        name = token.text
        if name not in FUNCTIONS:
            hint = did_you_mean(name, FUNCTIONS) or f", expected one of {', '.join(FUNCTIONS)}"
            raise self.error(f"found the unknown function '{name}'{hint}", token)
        self.expect("(")
        arguments = [self.number()]
        while self.accept(","):
            arguments.append(self.number())
        self.expect(")")
        least, most = ARGUMENTS.get(name, (1, 1))
        if not least <= len(arguments) <= most:
            expected = str(least) if least == most else f"at least {least}"
            raise self.error(f"{name}() with {len(arguments)} arguments, expected {expected}", token)
        if name in TAKES_ANGLE and self.scope.degrees and arguments[0].mentions_pi:
            raise pi_in_degrees(self.text, token.position)
        table = PLAIN if name in PLAIN else IN_DEGREES if self.scope.degrees else IN_RADIANS
        number = self.call(table[name], tuple(value.number for value in arguments), f"{name}()", token)
        if name == "deg":
            return self.finite(number)
        return self.finite(number, *arguments)

    def call(self, function: Function, arguments: tuple[float, ...], name: str, token: Token) -> float:
        """function(*arguments), its refusals in words."""
        try:
            return float(function(*arguments))
        except (ValueError, ZeroDivisionError):
            shown = ", ".join(f"{argument:g}" for argument in arguments)
            raise self.error(f"{name} has no value at {shown}, expected an argument where it has one", token) from None
        except OverflowError:
            raise self.error("the result is too large, expected a finite number", token) from None

    def finite(self, number: float, *origins: Value) -> Value:
        """A Value that is finite and remembers pi from where it came."""
        if not math.isfinite(number):
            raise self.error("the result is too large, expected a finite number", self.tokens[max(self.index - 1, 0)])
        return Value(number, any(origin.mentions_pi for origin in origins))

    def angle(self) -> float:
        """A number at a place where an angle is due, in the scope's angle unit."""
        start = self.token
        value = self.number()
        if value.mentions_pi and self.scope.degrees:
            raise pi_in_degrees(self.text[start.position : self.token.position].strip(" ,"), start.position)
        return value.number

    def end(self) -> None:
        """Raise unless all is read."""
        if self.token.kind != "end":
            raise self.error(f"found {self.found()}, expected the end of the expression")


def pi_in_degrees(text: str, position: int) -> ExpressionError:
    """The error for an angle in degrees that mentions pi."""
    shown = text.strip()
    return ExpressionError(
        f"found pi in an angle that is in degrees ('{shown}'), expected degrees: "
        f"write deg({shown}), or the number of degrees, or state angles in rad",
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
        raise pi_in_degrees(text, 0)
    return value


@dataclass
class Parameters:
    """Named expressions that may refer to each other in any order; evaluated when asked for.

    `texts` maps a name to its expression; `overrides` replaces some.
    """

    texts: Mapping[str, str]
    degrees: bool
    known: dict[str, Value] = field(default_factory=dict)
    open: list[str] = field(default_factory=list)

    def scope(self) -> Scope:
        """A scope in which these parameters can be named."""
        return Scope(self.degrees, tuple(self.texts), self.value)

    def value(self, name: str) -> Value:
        """The value of one parameter. Raises ExpressionError, also for a circle."""
        if name in self.known:
            return self.known[name]
        if name in self.open or len(self.open) > MAX_NESTING:
            circle = " -> ".join([*self.open[self.open.index(name) if name in self.open else 0 :], name])
            raise ExpressionError(f"the parameters refer to each other in a circle: {circle}")
        self.open.append(name)
        try:
            value = evaluate(self.texts[name], self.scope())
        finally:
            self.open.pop()
        self.known[name] = value
        return value
