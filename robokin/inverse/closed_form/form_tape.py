"""The code of a closed form as a tape for the native kernel.

Statement. Give the operations of a `straight_form` as a table that needs no interpreter: what is done, with which
registers, on how many roots at a time.
Derivation. The source is read again, statement by statement, so that each formula has one home and every root comes
from the same operations in the same order. A loop over two roots is a new level: a register of level k holds 2^k
numbers, one for each root that was chosen so far. What depends on no root of a level is worked out for all of
them at once, the same product is worked out once, two products and their sum are one step, and a register whose number
is not asked for any more is given to another.
Degenerate case. `return None` is a condition for there being an answer, `continue` one for a root being real, as is
`return leaves` where there are no roots yet. Of a
condition on a lever only the last of which is known that nothing but nearness is at stake: the kernel looks at that.
Source that is not understood has no tape (None).
"""

from __future__ import annotations

import ast
from collections import Counter
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.inverse.closed_form.gather import LEVER
from robokin.kernel.traced_numbers import NAME

OPERATIONS = (
    "added", "less", "times", "over", "minus", "root", "magnitude", "signed", "clamped", "chosen", "greater", "angle",
    "paired", "crossed", "entered", "both", "real", "needed", "lever",
)  # fmt: skip
"""What a step may do, in the kernel's order (native/tape.h)."""

BINARY: dict[type[ast.operator], str] = {
    ast.Add: "added",
    ast.Sub: "less",
    ast.Mult: "times",
    ast.Div: "over",
}

SUMS = {"added": "paired", "less": "crossed"}

_Step = tuple[str, int, tuple[int, ...], int]
"""The operation, the register of its result or -1, those of its operands, and the level."""

CALLS = {"sqrt": "root", "abs": "magnitude", "copysign": "signed", "max": "greater"}


@dataclass(frozen=True)
class FormTape:
    """A tape.

    steps: (k, 11) the operation, and first slot and level of its result and of four operands; constants: (c,), which
    the slots after the inputs hold; leaves: (r, 6, 2) where the joint values [rad] of the roots are; levels: how many
    loops over two roots there are; slots: how many slots there are; names: of constants that have a name instead of a
    number, with their places.
    """

    steps: Array
    constants: Array
    leaves: Array
    levels: int
    slots: int
    names: tuple[tuple[int, str], ...] = ()


class _UnknownError(Exception):
    """A piece of source that has no tape."""


class _SourceReader:
    """Registers and steps, as the source is read: a register is its number, `levels[number]` its level."""

    def __init__(self) -> None:
        self.levels: list[int] = []
        self.inputs = 0
        self.constants: dict[str, int] = {}
        self.steps: list[_Step] = []
        self.known: dict[tuple[str, tuple[int, ...]], int] = {}
        self.names: dict[str, int] = {}
        self.level = 0
        self.pairs: dict[str, list[int]] = {"ys": [], "xs": []}
        self.leaves: list[list[int]] = []

    def made(self, operation: str, *operands: int) -> int:
        """The register of an operation's result."""
        if (operation, operands) not in self.known:
            level = self.level if operation == "both" else max(self.levels[one] for one in operands)
            self.levels.append(level)
            self.known[operation, operands] = len(self.levels) - 1
            self.steps.append((operation, len(self.levels) - 1, operands, level))
        return self.known[operation, operands]

    def told(self, operation: str, *operands: int) -> None:
        """A step without a result."""
        self.steps.append((operation, -1, operands, self.level))

    def constant(self, value: float) -> int:
        """The register of a number; -0 is another one than 0."""
        return self.unvaried(repr(value))

    def unvaried(self, text: str) -> int:
        """The register of a number or of one that has a name."""
        if text not in self.constants:
            self.levels.append(0)
            self.constants[text] = len(self.levels) - 1
        return self.constants[text]

    def value(self, node: ast.expr) -> int:
        """The register of an expression."""
        match node:
            case ast.Name(id=name):
                return self.unvaried(name) if NAME.fullmatch(name) else self.names[name]
            case ast.Constant(value=float(number)):
                return self.constant(number)
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=float(number))):
                return self.constant(-number)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self.made("minus", self.value(operand))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in BINARY:
                return self.made(BINARY[type(op)], self.value(left), self.value(right))
            case ast.Call(func=ast.Name(id=name), args=arguments) if name in CALLS:
                return self.made(CALLS[name], *map(self.value, arguments))
            case ast.IfExp(orelse=ast.IfExp(orelse=ast.Name() as clamped)):
                return self.made("clamped", self.value(clamped))
            case ast.IfExp(
                test=ast.Compare(left=left, ops=[ast.Gt()], comparators=[ast.Constant(value=0.0)]),
                body=body,
                orelse=orelse,
            ):
                return self.made("chosen", *map(self.value, (left, body, orelse)))
        raise _UnknownError(ast.unparse(node))

    def condition(self, node: ast.expr, operation: str) -> None:
        """A condition for an answer, or for a root."""
        match node:
            case ast.BoolOp(op=ast.Or(), values=[ast.Compare() as first, *rest]):
                great = self.value(first.left)
                for one in rest:
                    assert isinstance(one, ast.Compare)
                    great = self.made("greater", great, self.value(one.left))
                self.told(operation, great, self.value(first.comparators[0]))
            case ast.Compare(left=left, ops=[ast.GtE()], comparators=[right]):
                lever = isinstance(right, ast.Constant) and right.value == LEVER**2 and operation == "needed"
                self.told("lever" if lever else operation, self.value(left), self.value(right))
            case ast.Compare(left=left, ops=[ast.LtE()], comparators=[right]):
                self.told(operation, self.value(right), self.value(left))
            case _:
                raise _UnknownError(ast.unparse(node))

    def loop(self, target: ast.expr, both: ast.expr) -> None:
        """The names of a loop over two roots."""
        assert isinstance(both, ast.Tuple)
        first, second = both.elts
        names, pairs = [target], [(first, second)]
        if isinstance(target, ast.Tuple):
            assert isinstance(first, ast.Tuple)
            assert isinstance(second, ast.Tuple)
            names, pairs = target.elts, list(zip(first.elts, second.elts, strict=True))
        values = [(self.value(one), self.value(other)) for one, other in pairs]
        self.level += 1
        self.told("entered")
        for name, pair in zip(names, values, strict=True):
            assert isinstance(name, ast.Name)
            self.names[name.id] = self.made("both", *pair)

    def statements(self, body: list[ast.stmt]) -> None:
        """Read statements in their order."""
        for statement in body:
            match statement:
                case ast.Assign(targets=[ast.Name(id=name)], value=value):
                    if name != "angles":
                        self.names[name] = self.value(value)
                case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Name(id="rows")):
                    self.names |= {name.id: k for k, name in enumerate(names) if isinstance(name, ast.Name)}
                    self.inputs, self.levels = len(names), [0] * len(names)
                case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Subscript()):
                    together = zip(names, self.pairs["ys"], self.pairs["xs"], strict=True)
                    self.names |= {
                        name.id: self.made("angle", y, x) for name, y, x in together if isinstance(name, ast.Name)
                    }
                case ast.Assign(value=ast.Tuple()) | ast.Return():
                    pass
                case ast.If(test=ast.UnaryOp(op=ast.Not(), operand=test), body=[ast.Return(value=ast.Constant())]):
                    self.condition(test, "needed")
                case ast.If(test=ast.UnaryOp(op=ast.Not(), operand=test), body=[ast.Continue() | ast.Return()]):
                    self.condition(test, "real")
                case ast.For(iter=ast.Call(), body=inner):
                    self.statements(inner)
                case ast.For(target=target, iter=both, body=inner):
                    self.loop(target, both)
                    self.statements(inner)
                case ast.AugAssign(target=ast.Name(id=name), value=ast.Tuple(elts=values)):
                    self.pairs[name] = [self.value(value) for value in values]
                case ast.Expr(value=ast.Call(args=[ast.Tuple(elts=values)])):
                    self.leaves.append([self.value(value) for value in values])
                case _:
                    raise _UnknownError(ast.unparse(statement))


def form_tape(source: str) -> FormTape | None:
    """The tape of a closed form's code; None where some of it has none."""
    (function,) = ast.parse(source).body
    assert isinstance(function, ast.FunctionDef)
    reader = _SourceReader()
    try:
        reader.statements(function.body)
    except _UnknownError:
        return None
    return _placed(reader)


def _joined(reader: _SourceReader) -> list[_Step]:
    """The steps, with sums of two products that nothing else asks for as one step each."""
    uses = Counter(one for _, _, operands, _ in reader.steps for one in operands)
    uses.update(one for leaf in reader.leaves for one in leaf)
    products = {
        result: operands
        for operation, result, operands, level in reader.steps
        if operation == "times" and uses[result] == 1
    }
    steps: list[_Step] = []
    gone: set[int] = set()
    for operation, result, operands, level in reader.steps:
        if operation in SUMS and all(one in products and reader.levels[one] == level for one in operands):
            gone.update(operands)
            operation, operands = SUMS[operation], (*products[operands[0]], *products[operands[1]])
        steps.append((operation, result, operands, level))
    return [step for step in steps if step[1] not in gone]


def _placed(reader: _SourceReader) -> FormTape:
    """The tape with a place for each register, given to another when it is asked for no more."""
    slots = {k: k for k in range(reader.inputs)}
    slots |= {one: reader.inputs + k for k, one in enumerate(reader.constants.values())}
    kept = {*slots, *(one for leaf in reader.leaves for one in leaf)}
    joined = _joined(reader)
    last = {one: k for k, (_, _, operands, _) in enumerate(joined) for one in operands}
    free: dict[int, list[int]] = {}
    end = len(slots)
    steps = []
    for k, (operation, result, operands, level) in enumerate(joined):
        slot = 0
        if result >= 0:
            if free.get(level):
                slot = free[level].pop()
            else:
                slot, end = end, end + 2**level
            slots[result] = slot
        where = [(slots[one], reader.levels[one]) for one in operands]
        where += [(0, 0)] * (4 - len(where))
        steps.append([OPERATIONS.index(operation), slot, level, *(number for place in where for number in place)])
        for one in {*operands, result} - kept - {-1}:
            if last.get(one, k) == k:
                free.setdefault(reader.levels[one], []).append(slots[one])
    leaves = [[(slots[one], reader.levels[one]) for one in leaf] for leaf in reader.leaves]
    names = tuple((k, text) for k, text in enumerate(reader.constants) if NAME.fullmatch(text))
    named = {text for _, text in names}
    constants = np.array([np.nan if text in named else float(text) for text in reader.constants])
    table, ends = np.array(steps, dtype=np.float64), np.array(leaves, dtype=np.float64)
    return FormTape(table, constants, ends, reader.level, end, names)
