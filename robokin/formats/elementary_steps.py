"""A chain as a product of elementary steps, `tz(0.333) Rz(q1) tx(0.1) Ry(-q2)`, to rows.

    chain = { step }     step = (R | t) (x | y | z) "(" [argument] ")"

with anything of ` * ⊕ + . | , ·` between steps, in either case. An argument is a number or an expression in the file's
units, or the joint's variable, alone or with a constant (`q1`, `-q2`, `q3 - 90`): `q` with its number, `q(3)`,
`theta3` of a turn, `d3` of a slide, or nothing for the next one. Variables stand in the order of their numbers, which
begin at 0 or at 1.
"""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingType
from dataclasses import dataclass, field, replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import DescriptionError, ExpressionError, did_you_mean, shown
from robokin.formats.chain_parts import ChainParts, limits_by_joint
from robokin.formats.expression_tokens import MAX_LENGTH, tokenize
from robokin.formats.joint_variables import VariableCell, shift_of
from robokin.formats.node_values import Context, number_of, parameters_in
from robokin.formats.number_expressions import Scope, names_parameters
from robokin.formats.schema import MAX_ROWS
from robokin.formats.transform_expressions import position_texts
from robokin.formats.yaml_tree import FilePlace, Node, Scalar, describe
from robokin.model import Joint, JointType
from robokin.spatial import rotation_transform, translation_transform

STEPS_KNOWN = ("Rx", "Ry", "Rz", "tx", "ty", "tz")

EXAMPLE = "such as tz(0.3), Rz(q1) or Ry(90)"

BETWEEN = re.compile(r"[\s*⊕+.|,·]*")
STEP_NAME = re.compile(r"[^\W\d]\w*")
DEGREES = re.compile(r"(?<![\w.])((?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*°")
INDEXED = re.compile(r"\b(q|theta|θ|d)\s*(?:\(\s*(\d+)\s*\)|\[\s*(\d+)\s*\])", re.IGNORECASE)
SUBSCRIPTS = str.maketrans("₀₁₂₃₄₅₆₇₈₉", "0123456789")
VARIABLES = {
    "R": re.compile(r"(?:q|theta|θ)_?([0-9₀-₉]{0,4})", re.IGNORECASE),
    "T": re.compile(r"(?:q|d)_?([0-9₀-₉]{0,4})", re.IGNORECASE),
}
"""What the variable of a turn and of a slide is called."""


@dataclass
class ChainReader:
    """Reads the steps of one text; `done` is the product of the constants since the last joint."""

    node: Scalar
    context: Context
    rows: list[Joint] = field(default_factory=list)
    numbered: list[tuple[int, int | None, FilePlace, str]] = field(default_factory=list)
    done: Array = field(default_factory=lambda: np.eye(4))
    pieces: list[str] = field(default_factory=list)
    count: int = 0

    def read(self) -> bool:
        """Every step of the text, to the end; mistakes are gathered. Raises DescriptionError where no step begins."""
        text = self.node.text
        at = end_of_match(BETWEEN, text, 0)
        while at < len(text):
            name = STEP_NAME.match(text, at)
            if name is None:
                raise self._place(at).error(f"found '{shown(text[at : at + 20])}' in ets, expected a step {EXAMPLE}")
            opening = end_of_match(re.compile(r"\s*"), text, name.end())
            if text[opening : opening + 1] != "(":
                raise self._place(at, len(name[0])).error(
                    f"found '{shown(name[0])}' without its argument in ets, expected a step {EXAMPLE}"
                )
            closing = _closing(text, opening)
            if closing is None:
                raise self._place(at, len(name[0])).error(
                    f"found '{shown(name[0])}(' that does not end in ets, expected ')'"
                )
            self.count += 1
            self.context.faults.attempt(None, self._step, name[0], at, text[opening + 1 : closing], opening + 1)
            at = end_of_match(BETWEEN, text, closing + 1)
        return True

    def _step(self, name: str, at: int, argument: str, start: int) -> None:
        """One step; `at` and `start` are the places of its name and of its argument."""
        known = {step.lower(): step for step in STEPS_KNOWN}.get(name.lower())
        if known is None:
            hint = did_you_mean(name, STEPS_KNOWN) or f", expected one of {', '.join(STEPS_KNOWN)}"
            raise self._place(at, len(name)).error(f"found the unknown step '{shown(name)}' in ets{hint}")
        turns = known[0] == "R"
        where = f"{known} in step {self.count} of ets"
        lead = len(argument) - len(argument.lstrip())
        place = self._place(start + lead, max(len(argument.strip()), 1))
        argument = INDEXED.sub(lambda found: found[1] + (found[2] or found[3]), argument).strip()
        if turns:  # how a table that says degrees is printed
            argument = DEGREES.sub(r"\1" if self.context.units.degrees else r"rad(\1)", argument)
        cell = Scalar(argument, place, quoted=True)
        axis = np.array([float(known[1] == letter) for letter in "xyz"])
        shift = self._variable(cell, turns, where, name)
        if shift is not None:
            self._joint(cell, shift, axis, turns, where)
            return
        value = number_of(cell, self.context, where, angle=turns)
        self.done = self.done @ (rotation_transform(axis, value) if turns else translation_transform(value * axis))
        lengths = ", ".join(f"({argument})" if known[1] == letter else "0" for letter in "xyz")
        self.pieces.append(f"Rot({known[1]}, ({argument}))" if turns else f"Trans({lengths})")

    def _variable(self, cell: Scalar, turns: bool, where: str, name: str) -> VariableCell | None:
        """What an argument says of its joint's variable; None for a constant. Keeps the variable's number."""
        if not cell.text:
            self.numbered.append((len(self.numbered), None, cell.mark, f"{name}()"))
            return VariableCell(1, "")
        scope = self.context.scope
        if "" in scope.names:  # every name: the parameters cannot be read, which has been said
            scope = Scope()
        pattern = VARIABLES["R" if turns else "T"]
        try:
            named = [token.text for token in tokenize(cell.text) if token.kind == "name"]
            own = dict.fromkeys(
                word for word in named
                if pattern.fullmatch(word) and (word not in scope.names or word[0] in "qQ")
            )  # fmt: skip
            if not own:
                return None
            if len(own) > 1:
                raise ExpressionError(
                    f"found {' and '.join(own)} in one step, expected one variable: a joint that moves with another is "
                    "a coupling, which ets cannot say"
                )
            shift = shift_of(cell.text, tuple(own), scope)
        except ExpressionError as error:
            raise cell.mark.error(f"{where}: {error}") from None
        (word,) = own
        found = pattern.fullmatch(word)
        assert found is not None
        self.numbered.append(
            (len(self.numbered), int(found[1].translate(SUBSCRIPTS)) if found[1] else None, cell.mark, word)
        )
        return shift

    def _joint(self, cell: Scalar, shift: VariableCell, axis: Array, turns: bool, where: str) -> None:
        offset, texts = 0.0, self.texts()
        if shift.constant:
            constant = Scalar(shift.constant, cell.mark, quoted=True)
            offset = number_of(constant, self.context, where, angle=turns)
            if text := parameters_in(constant, self.context):
                texts = (*texts, ("offset", text))
        self.rows.append(
            Joint(
                name=str(len(self.rows) + 1),
                type=JointType.REVOLUTE if turns else JointType.PRISMATIC,
                offset=offset,
                origin=self.done,
                axis=axis,
                texts=texts,
                sense=shift.sense,
            )
        )
        self.done, self.pieces = np.eye(4), []

    def texts(self) -> tuple[tuple[str, str], ...]:
        """The coordinates of the constants since the last joint that name parameters."""
        text = " ".join(self.pieces)
        if len(text) > MAX_LENGTH or not names_parameters(text, self.context.scope):
            return ()
        try:
            return position_texts(text, self.context.scope, self.context.units)
        except ExpressionError:  # it was read; only its nesting can be too deep for one more parenthesis
            return ()

    def _place(self, at: int, width: int = 1) -> FilePlace:
        """The place of a part of the text; that of the whole where the text goes over lines or has escapes."""
        mark, text = self.node.mark, self.node.text
        if mark.width != len(text) + 2 * self.node.quoted:
            return mark
        return replace(mark, column=mark.column + self.node.quoted + at, width=width)


def chain_of_steps(fields: MappingType[str, Node], context: Context) -> ChainParts:
    """The chain that `ets` and `limits` describe; mistakes are gathered."""
    faults = context.faults
    before = faults.count
    node = fields["ets"]
    if not isinstance(node, Scalar) or node.empty or not node.text.strip():
        raise node.mark.error(f"found {describe(node)} as ets, expected a text of steps {EXAMPLE}")
    if len(node.text) > MAX_LENGTH:
        raise node.mark.error(f"found {len(node.text)} characters in ets, expected at most {MAX_LENGTH}")
    reader = ChainReader(node, context)
    whole = faults.attempt(False, reader.read)
    types = tuple(row.type for row in reader.rows)
    if faults.count > before or not whole:
        return ChainParts(None, None, "frames")
    if not types:
        raise node.mark.error("found no joint in ets, expected a variable in at least one step, such as Rz(q1)")
    if len(types) > MAX_ROWS:
        raise node.mark.error(f"found {len(types)} joints in ets, expected at most {MAX_ROWS}")
    faults.attempt(None, _check_numbers, reader.numbered)
    limits = [row.limits for row in reader.rows]
    if "limits" in fields:
        limits = faults.attempt(limits, limits_by_joint, fields["limits"], types, context)
    if faults.count > before:
        return ChainParts(None, types, "frames")
    rows = tuple(replace(row, limits=limit) for row, limit in zip(reader.rows, limits, strict=True))
    return ChainParts(rows, types, "frames", reader.done, " ".join(reader.pieces) if reader.texts() else "")


def _check_numbers(numbered: list[tuple[int, int | None, FilePlace, str]]) -> None:
    """See that the variables are numbered in their order, from 0 or from 1. Raises DescriptionError."""
    first: int | None = None
    seen: set[int] = set()
    for position, number, place, word in numbered:
        if number is None:
            continue
        if number in seen:
            raise _repeated(place, word)
        seen.add(number)
        if first is None:
            first = number - position
            if first not in (0, 1):
                first = 1
        if number == position + first:
            continue
        due = f"q{position + first}"
        ways = f"{due} (or q{position}, counting from 0)" if not seen - {number} else due
        raise place.error(
            f"found {word} where {ways} is due in ets, expected the variables in the order of the chain, without gaps"
        )


def _repeated(place: FilePlace, word: str) -> DescriptionError:
    return place.error(
        f"found {word} a second time in ets, expected each variable once: two joints that one variable moves are a "
        "coupling, which ets cannot say"
    )


def end_of_match(pattern: re.Pattern[str], text: str, start: int) -> int:
    """Where what a pattern takes from a place of a text ends; the place itself for nothing."""
    match = pattern.match(text, start)
    return match.end() if match else start


def _closing(text: str, opening: int) -> int | None:
    """Where the parenthesis that opens at a place closes; None if it does not."""
    depth = 0
    for i in range(opening, len(text)):
        depth += (text[i] in "([") - (text[i] in ")]")
        if depth == 0:
            return i
    return None
