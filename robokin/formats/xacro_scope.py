"""The names of a xacro file: properties, parameters and blocks, each in the scope of its macro."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from robokin.errors import DescriptionError, ExpressionError
from robokin.formats.xacro_expressions import XacroNames, evaluate_xacro
from robokin.formats.xacro_tables import XacroValue, xacro_text, xacro_typed
from robokin.formats.xml_tree import XmlNode

MOST_TEXT = 1 << 22
"""Characters of all texts that are computed, those of expressions counted `EXPRESSION` times; robots take 1e5."""

EXPRESSION = 8

MAX_VALUE = 20_000
"""Characters of one text that is computed."""


@dataclass(eq=False)
class XacroProperty:
    """A property with its text, which is evaluated when it is first asked for, in the scope where it stands."""

    node: XmlNode
    attribute: str
    scope: XacroScope
    value: XacroValue | None = None
    waiting: bool = False


@dataclass(eq=False)
class XacroScope:
    """Names of a macro, and behind them those of where it is called."""

    outer: XacroScope | None = None
    properties: dict[str, XacroProperty] = field(default_factory=dict)
    values: dict[str, XacroValue] = field(default_factory=dict)
    blocks: dict[str, list[XmlNode]] = field(default_factory=dict)
    macros: dict[str, XmlNode] = field(default_factory=dict)

    def all_names(self) -> set[str]:
        """Every name of a value that is known here."""
        names: set[str] = set()
        scope: XacroScope | None = self
        while scope is not None:
            names |= scope.properties.keys() | scope.values.keys()
            scope = scope.outer
        return names

    def has(self, name: str) -> bool:
        """Whether a value of that name is known here."""
        scope: XacroScope | None = self
        while scope is not None:
            if name in scope.properties or name in scope.values:
                return True
            scope = scope.outer
        return False

    def outermost(self) -> XacroScope:
        """The scope of the file."""
        scope = self
        while scope.outer is not None:
            scope = scope.outer
        return scope

    def forget(self, name: str) -> None:
        """Make room for another meaning of a name."""
        for table in (self.properties, self.values, self.blocks):
            table.pop(name, None)

    def macro(self, name: str) -> XmlNode | None:
        """The macro of a name."""
        scope: XacroScope | None = self
        while scope is not None:
            if name in scope.macros:
                return scope.macros[name]
            scope = scope.outer
        return None

    def block(self, name: str) -> list[XmlNode] | None:
        """The nodes that a name stands for."""
        scope: XacroScope | None = self
        while scope is not None:
            if name in scope.blocks:
                return scope.blocks[name]
            scope = scope.outer
        return None


class XacroTexts:
    """Evaluates the texts of attributes: `${…}` by the evaluator, `$(…)` by the words there are.

    load: what is in the YAML file of a name.
    """

    def __init__(
        self, commands: Mapping[str, Callable[[str, XmlNode], str]], load: Callable[[str, XmlNode], XacroValue]
    ) -> None:
        self.commands = commands
        self.load = load
        self.computed = 0

    def text_of(self, node: XmlNode, attribute: str, scope: XacroScope) -> str:
        """An attribute's text. Raises DescriptionError at it."""
        try:
            return xacro_text(self.value_of(node, attribute, scope))
        except ExpressionError as error:
            raise node.error(error.message, attribute) from None

    def value_of(self, node: XmlNode, attribute: str, scope: XacroScope) -> XacroValue:
        """An attribute's value: that of the expression where it is nothing else, else its text."""
        text = node.attributes[attribute]
        if "$" not in text:
            return text
        try:
            return self.evaluated(text, node, scope)
        except ExpressionError as error:
            raise node.error(error.message, attribute) from None
        except RecursionError:
            raise node.error("found texts nested too deep, expected flat ones", attribute) from None

    def evaluated(self, text: str, node: XmlNode, scope: XacroScope) -> XacroValue:
        """The value of a text. Raises ExpressionError."""
        self.spend(len(text), text)
        values: list[XacroValue] = []
        at = 0
        while (start := text.find("$", at)) >= 0:
            if start > at:
                values.append(text[at:start])
            word = text[start : start + 2]
            if text[start : start + 3] in ("$$(", "$${"):
                values.append(text[start + 1 : start + 3])
                at = start + 3
            elif word in ("${", "$("):
                at = _end_of(text, start + 1)
                inner = xacro_text(self.evaluated(text[start + 2 : at - 1], node, scope))
                values.append(self.expression(inner, scope, node) if word == "${" else self.command(inner, node, scope))
            else:
                values.append("$")
                at = start + 1
        if at < len(text):
            values.append(text[at:])
        if len(values) == 1:
            return values[0]
        joined = "".join(map(xacro_text, values))
        self.spend(len(joined), joined)
        return joined

    def spend(self, cost: int, text: str = "") -> None:
        """Count what is computed. Raises ExpressionError for a long text, and when it is more than a robot takes."""
        self.computed += cost
        if len(text) > MAX_VALUE or self.computed > MOST_TEXT:
            raise ExpressionError("found texts that grow without end, expected those of a robot")

    def argument(self, name: str, node: XmlNode) -> XacroValue | None:
        """The value of an argument, which `$(eval …)` knows by its name; None where there is none."""
        try:
            return xacro_typed(self.commands["arg"](name, node))
        except ExpressionError:
            return None

    def expression(self, text: str, scope: XacroScope, node: XmlNode, arguments: bool = False) -> XacroValue:
        """The value of what stands between `${` and `}`; of `$(eval …)`, where arguments are names too."""
        self.spend(EXPRESSION * len(text))

        def known(name: str) -> XacroValue | None:
            value = self.lookup(name, scope)
            return self.argument(name, node) if value is None and arguments else value

        names = XacroNames(scope.all_names, known, lambda name: self.load(name, node))
        return evaluate_xacro(text, names)

    def lookup(self, name: str, scope: XacroScope) -> XacroValue | None:
        """The value of a name, None where there is none."""
        here: XacroScope | None = scope
        while here is not None and name not in here.values and name not in here.properties:
            here = here.outer
        if here is None:
            return None
        if name in here.values:
            return here.values[name]
        found = here.properties[name]
        if found.value is None:
            if found.waiting:
                raise ExpressionError(f"found the property '{name}' hanging on itself, expected a value")
            found.waiting = True
            try:
                value = self.value_of(found.node, found.attribute, found.scope)
            except DescriptionError as error:
                raise error from None
            finally:
                found.waiting = False
            found.value = xacro_typed(value) if isinstance(value, str) else value
        return found.value

    def command(self, text: str, node: XmlNode, scope: XacroScope) -> XacroValue:
        """What `$(…)` stands for."""
        word, _, rest = text.strip().partition(" ")
        if word == "eval":
            return self.expression(rest, scope, node, arguments=True)
        if word not in self.commands:
            raise ExpressionError(
                f"found $({text.strip()[:40]}), expected $(find package), $(arg name) or $(eval …): nothing else is "
                "looked up outside the file"
            )
        return self.commands[word](rest.strip(), node)


def _end_of(text: str, start: int) -> int:
    """The index after the bracket that closes the one at `start`. Raises ExpressionError where none does."""
    opening = text[start]
    closing = {"{": "}", "(": ")"}[opening]
    depth = 0
    for at in range(start, len(text)):
        depth += (text[at] == opening) - (text[at] == closing)
        if not depth:
            return at + 1
    raise ExpressionError(f"found '${opening}' without '{closing}', expected it")
