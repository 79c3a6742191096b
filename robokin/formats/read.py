"""A file or a text to a Robot, a Mechanism or a WheeledBase: what all kinds of description share."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from pathlib import Path

from robokin.errors import DescriptionError, ExpressionError, InputError, did_you_mean, nearest, shown
from robokin.files import open_path, read_up_to
from robokin.formats.description_head import Head
from robokin.formats.excerpts import LINE_BREAK
from robokin.formats.expression_tokens import NAME
from robokin.formats.faults import Faults
from robokin.formats.foreign_texts import other_format
from robokin.formats.kept_descriptions import read_once
from robokin.formats.node_values import Context, choice_of, expression_text, fields_of, text_of
from robokin.formats.number_expressions import RESERVED, Scope, Value
from robokin.formats.parameters import Parameters
from robokin.formats.plain_yaml import plain_tree
from robokin.formats.schema import KINDS, MECHANISM, TREE, UNITS, VERSION, WHEELED
from robokin.formats.yaml_tree import FilePlace, Mapping, Node, Scalar, describe
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.units import Units

MAX_BYTES = 1 << 20
"""A description is a page; a file over 1 MiB is something else."""


def read_file(
    path: Path, overrides: MappingType[str, str] | None = None, id: str = "", mode: int | None = None
) -> Robot | Mechanism | WheeledBase | Tree:
    """The robot, mechanism, wheeled base or tree in a file.

    `overrides` replaces parameters by expressions in the file's units, `mode` says in which way a mechanism by lengths
    is put together. Raises DescriptionError with line and column when the description is wrong, InputError when the
    file cannot be read.
    """
    place = str(path)
    expected = "a description (.yaml)"
    with open_path(place, expected) as stream:
        data = read_up_to(stream, place, MAX_BYTES, expected)
    key = data, place, tuple((overrides or {}).items()), id or path.stem, mode
    return read_once(key, lambda: read_bytes(data, place, overrides, id or path.stem, mode))


def read_bytes(
    data: bytes,
    place: str,
    overrides: MappingType[str, str] | None = None,
    id: str = "",
    mode: int | None = None,
) -> Robot | Mechanism | WheeledBase | Tree:
    """What the bytes of a file describe; `place` is the name that errors give it. Raises DescriptionError."""
    if len(data) > MAX_BYTES:
        raise DescriptionError("found a file over 1 MiB, expected a description: a page of text", place, 1, 1)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        lines = LINE_BREAK.split(error.object[: error.start].decode("utf-8"))  # without the byte order mark
        line, column = len(lines), len(lines[-1]) + 1
        raise DescriptionError("found bytes that are no text, expected YAML in UTF-8", place, line, column) from None
    return read_text(text, place, overrides, id, mode)


def read_text(
    text: str,
    file: str = "description",
    overrides: MappingType[str, str] | None = None,
    id: str = "",
    mode: int | None = None,
) -> Robot | Mechanism | WheeledBase | Tree:
    """The robot, mechanism, wheeled base or tree that a text describes; `file` is the name that errors give it.

    Raises one DescriptionError for all mistakes of the text.
    """
    faults = Faults()
    try:
        described = _described(text, file, overrides or {}, id, mode, faults)
        faults.stop()
    except DescriptionError as error:
        raise faults.ended(error, text) from None
    return described


def _described(
    text: str, file: str, overrides: MappingType[str, str], id: str, mode: int | None, faults: Faults
) -> Robot | Mechanism | WheeledBase | Tree:
    try:
        root = plain_tree(text, file) or _any_tree(text, file, faults)
        if not isinstance(root, Mapping):
            raise root.mark.error(
                f"found {describe(root)}, expected a description: `robokin: 1`, `name: …`, `joints: …`"
            )
    except DescriptionError:
        if other := other_format(text):
            raise FilePlace(file, 1, 1).error(other) from None
        raise
    if not root.entries:
        faults.stop()
        raise root.mark.error("found nothing in the file, expected a description: `robokin: 1`, `name: …`")
    _check_version(root, faults)
    kind = _kind(root, faults)
    # Only the reader that is needed is imported: it is part of the time that a command takes to start.
    if kind == "wheeled":
        from robokin.formats.wheeled_fields import read_wheeled

        head = _head(fields_of(root, WHEELED, "a wheeled base", faults), overrides, id, file, faults)
        _refuse_mode(mode, head)
        return read_wheeled(head)
    if kind == "mechanism":
        from robokin.formats.mechanism_fields import read_mechanism

        return read_mechanism(
            _head(fields_of(root, MECHANISM, "a mechanism", faults), overrides, id, file, faults), mode
        )
    if kind == "tree":
        from robokin.formats.tree_fields import read_tree_fields

        head = _head(fields_of(root, TREE, "a tree", faults), overrides, id, file, faults)
        _refuse_mode(mode, head)
        return read_tree_fields(head)
    from robokin.formats.chain_forms import FORMS, form_of, without_other_keys
    from robokin.formats.robot_fields import read_robot

    form = form_of(root)
    fields = fields_of(without_other_keys(root, form, faults), FORMS[form], "a robot", faults)
    head = _head(fields, overrides, id, file, faults)
    _refuse_mode(mode, head)
    return read_robot(head)


def _any_tree(text: str, file: str, faults: Faults) -> Node:
    """The tree of a text that is not plain."""
    from robokin.formats.yaml_reader import read_tree  # PyYAML, which takes longer to load than most answers

    return read_tree(text, file, faults)


def _refuse_mode(mode: int | None, head: Head) -> None:
    if mode is not None:
        raise InputError(f"--mode: {head.name} is no mechanism, expected a mechanism whose links have lengths")


def _check_version(root: Mapping, faults: Faults) -> None:
    """See that this robokin reads the format. A version that is forgotten ends nothing where there is a table."""
    node = root.entries.get("robokin")
    if node is not None:
        text = text_of(node, "the format's version")
        if text != str(VERSION):
            expected = f"expected {VERSION}: this robokin reads no other"
            raise node.mark.error(f"found format version '{shown(text)}', {expected}")
        return
    error = root.mark.error(f"found no key 'robokin', expected `robokin: {VERSION}`, the format's version")
    for near in nearest("robokin", root.entries, 1):
        error = root.keys.pop(near).error(f"found the unknown key '{shown(near)}', expected `robokin: {VERSION}`")
        del root.entries[near]
    if not {"joints", "branches", "links", "wheels", "ets", "c2"} & root.entries.keys():
        faults.stop()  # what is wrong may be why there is no table
        raise error
    faults.add(error)
    root.entries["robokin"] = Scalar("", root.mark.silent())


def _kind(root: Mapping, faults: Faults) -> str:
    """What is described: `robot`, `tree`, `mechanism` or `wheeled`, as the keys say it; a wrong `kind` is taken out."""
    wheeled = "kind" in root.entries or "wheels" in root.entries
    if "kind" in root.entries:
        known = faults.attempt(False, _check_kind, root.entries["kind"])
        if not known:
            wheeled = "wheels" in root.entries or not {"joints", "branches", "links"} & root.entries.keys()
            root.entries["kind"] = Scalar("", root.entries["kind"].mark.silent())
            if not wheeled:
                del root.entries["kind"], root.keys["kind"]
    if wheeled:
        return "wheeled"
    if "branches" in root.entries:
        return "tree"
    return "mechanism" if "links" in root.entries or "space" in root.entries else "robot"


def _check_kind(node: Node) -> bool:
    text = text_of(node, "the kind: wheeled")
    if text in ("robot", "tree", "mechanism"):
        raise node.mark.error(f"found '{text}' as the kind, expected no 'kind' in the description of a {text}")
    return bool(choice_of(node, KINDS, "the kind"))


def _head(fields: dict[str, Node], overrides: MappingType[str, str], id: str, file: str, faults: Faults) -> Head:
    units = _units(fields.get("units"), faults)
    parameters = faults.attempt(None, _parameters, fields.get("parameters"), units, overrides, file, faults)
    if parameters is None:  # what cells name is not known
        parameters = Parameters({}, units.degrees)
        scope = Scope(units.degrees, _AnyName(), _unknown)
    else:
        scope = parameters.scope()
    values = {name: parameters.value(name).number for name in parameters.texts if name not in parameters.broken}
    texts = {
        name: faults.attempt("", text_of, fields[name], f"the {name}, a line of text") if name in fields else ""
        for name in ("name", "description", "source")
    }
    context = Context(units, scope, faults, parameters=parameters.texts)
    return Head(fields, id, texts["name"], texts["description"], texts["source"], values, context)


class _AnyName(frozenset[str]):
    """Every name."""

    def __contains__(self, name: object) -> bool:
        return True


def _unknown(name: str) -> Value:
    raise ExpressionError("found parameters that cannot be read, expected a mapping", parameter=name)


def _units(node: Node | None, faults: Faults) -> Units:
    if node is None:
        return Units()
    # Where a unit is not known, one is taken in which nothing is too long and pi is no mistake.
    unknown = Units("mm", "rad")
    given = faults.attempt(None, fields_of, node, UNITS, "units", faults)
    if given is None:
        return unknown

    def unit(name: str) -> str | None:
        otherwise = getattr(unknown, name)
        if name not in given:
            return otherwise if len(given) < len(getattr(node, "entries", ())) else None
        return faults.attempt(otherwise, choice_of, given[name], UNITS[name].choices, f"the unit of {name}")

    return Units().override(unit("length"), unit("angle"))


def _parameters(
    node: Node | None, units: Units, overrides: MappingType[str, str], file: str, faults: Faults
) -> Parameters:
    given: dict[str, Node] = {}
    keys: dict[str, FilePlace] = {}
    if node is not None and not (isinstance(node, Scalar) and node.empty):
        if not isinstance(node, Mapping):
            raise node.mark.error(f"found {describe(node)}, expected parameters: a mapping of names to numbers")
        given, keys = node.entries, node.keys
    texts: dict[str, str] = {}
    wrong: list[str] = []
    for name, value in given.items():
        try:
            _check_name(name, keys[name])
            texts[name] = expression_text(value, f"parameter {name}")
        except DescriptionError as error:
            faults.add(error)
            wrong.append(name)
    for name in overrides:
        if name not in texts and name not in wrong:
            known = f", expected one of {', '.join([*texts][:12])}" if texts else ": it has none"
            raise InputError(f"{file} has no parameter '{shown(name)}'{did_you_mean(name, texts) or known}")
    parameters = Parameters({**texts, **dict.fromkeys(wrong, ""), **overrides}, units.degrees)
    for name in wrong:
        parameters.broken[name] = ExpressionError("found a mistake in a parameter", parameter=name)
    said = set(wrong)
    for name in texts:
        try:
            parameters.value(name)
        except ExpressionError as error:
            broken = error.parameter
            if broken in overrides:
                raise InputError(f"parameter {broken}={shown(overrides[broken])}: {error}") from None
            if broken not in said:
                said.add(broken)
                faults.add(given[broken].mark.error(f"parameter {broken}: {error}"))
    return parameters


def _check_name(name: str, mark: FilePlace) -> None:
    if name.lower() in RESERVED:
        raise mark.error(f"found the parameter '{name}', expected another name: this one has a meaning already")
    if not NAME.fullmatch(name):
        raise mark.error(f"found the parameter '{shown(name)}', expected a name of letters, digits and _")
