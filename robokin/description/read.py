"""A file or a text to a Robot, a Mechanism or a WheeledBase: what all kinds of description share."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from dataclasses import dataclass
from pathlib import Path

from robokin.description.cells import Context, choice_of, expression_text, fields_of, text_of
from robokin.description.expressions import NAME, RESERVED
from robokin.description.parameters import Parameters
from robokin.description.schema import KINDS, MECHANISM, ROBOT, UNITS, VERSION, WHEELED
from robokin.description.tree import Mapping, Mark, Node, Scalar, describe, read_tree
from robokin.errors import DescriptionError, ExpressionError, InputError, did_you_mean, nearest, shown
from robokin.model import Mechanism, Robot, WheeledBase
from robokin.units import Units

MAX_BYTES = 1 << 20
"""A description is a page; a file over 1 MiB is something else."""


@dataclass(frozen=True)
class Head:
    """What stands before the table: the common fields, read."""

    id: str
    name: str
    description: str
    source: str
    parameters: dict[str, float]
    context: Context


def read_file(
    path: Path, overrides: MappingType[str, str] | None = None, id: str = "", mode: int | None = None
) -> Robot | Mechanism | WheeledBase:
    """The robot, mechanism or wheeled base in a file.

    `overrides` replaces parameters by expressions in the file's units, `mode` says in which way a mechanism by lengths
    is put together. Raises DescriptionError with line and column when the description is wrong, InputError when the
    file cannot be read.
    """
    place = str(path)
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise InputError(f"{place}: no such file, expected a description (.yaml)") from None
    except IsADirectoryError:
        raise InputError(f"{place}: found a directory, expected a description (.yaml)") from None
    except OSError as error:
        raise InputError(f"{place}: cannot be read ({error.strerror}), expected a description (.yaml)") from None
    except ValueError:  # a path with a null character
        raise InputError(f"{shown(place)}: is no path, expected that of a description (.yaml)") from None
    if len(data) > MAX_BYTES:
        raise DescriptionError("found a file over 1 MiB, expected a description: a page of text", place, 1, 1)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = error.object[: error.start]  # without the byte order mark
        line, column = before.count(b"\n") + 1, len(before[before.rfind(b"\n") + 1 :].decode("utf-8")) + 1
        raise DescriptionError("found bytes that are no text, expected YAML in UTF-8", place, line, column) from None
    return read_text(text, place, overrides, id or path.stem, mode)


def read_text(
    text: str,
    file: str = "description",
    overrides: MappingType[str, str] | None = None,
    id: str = "",
    mode: int | None = None,
) -> Robot | Mechanism | WheeledBase:
    """The robot, mechanism or wheeled base that a text describes; `file` is the name that errors give it."""
    root = read_tree(text, file)
    if not isinstance(root, Mapping):
        raise root.mark.error(f"found {describe(root)}, expected a description: `robokin: 1`, `name: …`, `joints: …`")
    if not root.entries:
        raise root.mark.error("found nothing in the file, expected a description: `robokin: 1`, `name: …`")
    wheeled = "kind" in root.entries or "wheels" in root.entries
    mechanism = not wheeled and ("links" in root.entries or "space" in root.entries)
    _check_version(root)
    if "kind" in root.entries:
        _check_kind(root.entries["kind"])
    if wheeled:
        fields = fields_of(root, WHEELED, "a wheeled base")
    else:
        fields = fields_of(root, MECHANISM if mechanism else ROBOT, "a mechanism" if mechanism else "a robot")
    head = _head(fields, overrides or {}, id, file)
    if mode is not None and not mechanism:
        raise InputError(f"--mode: {head.name} is no mechanism, expected a mechanism whose links have lengths")
    # Only the reader that is needed is imported: it is part of the time that a command takes to start.
    if wheeled:
        from robokin.description.wheeled import read_wheeled

        return read_wheeled(fields, head)
    if mechanism:
        from robokin.description.mechanisms import read_mechanism

        return read_mechanism(fields, head, mode)
    from robokin.description.robots import read_robot

    return read_robot(fields, head)


def _check_version(root: Mapping) -> None:
    node = root.entries.get("robokin")
    if node is None:
        for near in nearest("robokin", root.entries, 1):
            raise root.keys[near].error(f"found the unknown key '{near}', expected `robokin: {VERSION}`")
        raise root.mark.error(f"found no key 'robokin', expected `robokin: {VERSION}`, the format's version")
    text = text_of(node, "the format's version")
    if text != str(VERSION):
        raise node.mark.error(f"found format version '{shown(text)}', expected {VERSION}: this robokin reads no other")


def _check_kind(node: Node) -> None:
    text = text_of(node, "the kind: wheeled")
    if text in ("robot", "mechanism"):
        raise node.mark.error(f"found '{text}' as the kind, expected no 'kind' in the description of a {text}")
    choice_of(node, KINDS, "the kind")


def _head(fields: dict[str, Node], overrides: MappingType[str, str], id: str, file: str) -> Head:
    units = _units(fields.get("units"))
    parameters = _parameters(fields.get("parameters"), units, overrides, file)
    values = {name: parameters.value(name).number for name in parameters.texts}
    texts = {
        name: text_of(fields[name], f"the {name}, a line of text") if name in fields else ""
        for name in ("name", "description", "source")
    }
    return Head(id, texts["name"], texts["description"], texts["source"], values, Context(units, parameters.scope()))


def _units(node: Node | None) -> Units:
    if node is None:
        return Units()
    given = fields_of(node, UNITS, "units")
    chosen = {name: choice_of(given[name], UNITS[name].choices, f"the unit of {name}") for name in given}
    return Units().override(**chosen)


def _parameters(node: Node | None, units: Units, overrides: MappingType[str, str], file: str) -> Parameters:
    given: dict[str, Node] = {}
    keys: dict[str, Mark] = {}
    if node is not None and not (isinstance(node, Scalar) and node.empty):
        if not isinstance(node, Mapping):
            raise node.mark.error(f"found {describe(node)}, expected parameters: a mapping of names to numbers")
        given, keys = node.entries, node.keys
    texts: dict[str, str] = {}
    for name, value in given.items():
        if name.lower() in RESERVED:
            raise keys[name].error(
                f"found the parameter '{name}', expected another name: this one has a meaning already"
            )
        if not NAME.fullmatch(name):
            raise keys[name].error(f"found the parameter '{shown(name)}', expected a name of letters, digits and _")
        texts[name] = expression_text(value, f"parameter {name}")
    for name in overrides:
        if name not in texts:
            known = f", expected one of {', '.join([*texts][:12])}" if texts else ": it has none"
            raise InputError(f"{file} has no parameter '{shown(name)}'{did_you_mean(name, texts) or known}")
    parameters = Parameters({**texts, **overrides}, units.degrees)
    for name in texts:
        try:
            parameters.value(name)
        except ExpressionError as error:
            wrong = error.parameter
            if wrong in overrides:
                raise InputError(f"parameter {wrong}={shown(overrides[wrong])}: {error}") from None
            raise given[wrong].mark.error(f"parameter {wrong}: {error}") from None
    return parameters
