"""A xacro file to a tree of links: its includes, properties, macros and conditions are carried out, then it is a URDF.

Nothing of a file is run as Python, nothing is read but files below its own folder and its packages, and all that
grows is bounded. Every node of the outcome knows the place where it was written. What no link moves by (meshes,
inertia, control) is left out unread.

Source: ROS wiki, xacro.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from robokin.errors import DescriptionError, ExpressionError, InputError, did_you_mean, shown
from robokin.files import open_path, read_up_to
from robokin.formats.urdf import tree_of_urdf
from robokin.formats.xacro_folders import MOST_TABLE_BYTES, TABLES, XacroFolders
from robokin.formats.xacro_scope import XacroProperty, XacroScope, XacroTexts
from robokin.formats.xacro_tables import XacroList, XacroTable, XacroValue, xacro_table, xacro_typed
from robokin.formats.xml_tree import MAX_XML_BYTES, XmlNode, XmlText, read_xml
from robokin.model.tree import Tree

MOST_STEPS = 40_000
"""Elements that are expanded and parameters that are set; a dual arm takes 1,000."""

MOST_INCLUDES = 500
DEEPEST_CALL = 150
"""Macros within macros, conditions and elements within each other."""

UNREAD = {"visual", "collision", "inertial", "gazebo", "transmission", "ros2_control", "material", "sensor"}
"""Elements that move no link, left empty."""

PARAMETER = re.compile(
    r"\s*(?P<star>\*{0,2})(?P<name>[\w.]+)"
    r"(?::?=(?P<pass>\^\|?)?(?P<default>'[^']*'|\"[^\"]*\"|(?:\$\{[^}]*\}|\$\([^)]*\)|[^\s'\"])*))?(?=\s|$)"
)
PREFIX = "xacro:"


def read_xacro(
    path: Path | str,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    exact: bool = False,
) -> Tree:
    """The tree of links that a xacro file describes.

    `packages` are folders by the names in `$(find …)`; others are sought in the folders above the file. `arguments`
    are the values of `$(arg …)` in place of their defaults. `exact` as for `read_urdf`. Raises DescriptionError with
    file, line and column for what is wrong, InputError for a file that cannot be read.
    """
    path = Path(path)
    expected = "a xacro file"
    with open_path(str(path), expected) as stream:
        data = read_up_to(stream, str(path), MAX_XML_BYTES, expected)
    root = read_xml(data, str(path))
    expansion = XacroExpansion(path, packages or {}, arguments or {})
    try:
        robot = expansion.robot(root)
    except DescriptionError as error:
        for one in error.errors:
            if one.file in expansion.texts:
                expansion.texts[one.file].with_line(one)
        raise
    return tree_of_urdf(robot, exact, path.name.split(".")[0], [*expansion.texts.values()], least_joints=1)


class XacroExpansion:
    """One file being expanded."""

    def __init__(self, main: Path, packages: Mapping[str, str], arguments: Mapping[str, str]) -> None:
        self.folders = XacroFolders(main, packages)
        self.arguments = dict(arguments)
        self.asked: set[str] = set()
        self.texts: dict[str, XmlText] = {}
        self.evaluator = XacroTexts(
            {"find": self.find, "arg": self.argument, "optenv": self.environment, "dirname": self.folder},
            self.load,
        )
        self.steps = self.includes = self.depth = 0
        self.parameters: dict[XmlNode, list[tuple[str, str, tuple[str, str] | None]]] = {}
        self.open_files: list[str] = [str(main.resolve())]
        self.tables: dict[Path, XacroValue] = {}

    def robot(self, root: XmlNode) -> XmlNode:
        """The `robot` element with all that is in it carried out. Raises DescriptionError."""
        self.texts[root.document.file] = root.document
        scope = XacroScope()
        try:
            attributes = self.attributes(root, scope)
            children = self.expand_all(root.children, scope)
        except RecursionError:
            raise root.error("found macros nested too deep, expected those of a robot") from None
        unknown = [name for name in self.arguments if name not in self.asked]
        if unknown:
            hint = did_you_mean(unknown[0], self.asked) or ", expected the name of an <xacro:arg>"
            raise root.error(f"found the argument '{shown(unknown[0])}', which the file does not ask for{hint}")
        return root.derived(attributes, children)

    def expand_all(self, nodes: list[XmlNode], scope: XacroScope) -> list[XmlNode]:
        """What nodes become, in turn."""
        found: list[XmlNode] = []
        for node in nodes:
            found += self.expand(node, scope)
        return found

    def expand(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """What a node becomes: itself with its attributes evaluated, or what a word of xacro makes of it."""
        self.steps += 1
        if self.steps > MOST_STEPS:
            raise node.error(f"found more than {MOST_STEPS} elements and parameters in all, expected a robot")
        if self.depth >= DEEPEST_CALL:
            raise node.error(f"found macros and elements nested more than {DEEPEST_CALL} deep, expected fewer")
        self.depth += 1
        try:
            if not node.tag.startswith(PREFIX):
                if node.tag in UNREAD:
                    return [node.derived({}, [])]
                return [node.derived(self.attributes(node, scope), self.expand_all(node.children, scope))]
            word = node.tag.removeprefix(PREFIX)
            carried_out = WORDS_OF_XACRO.get(word)
            return carried_out(self, node, scope) if carried_out else self.call(node, word, scope)
        finally:
            self.depth -= 1

    def attributes(self, node: XmlNode, scope: XacroScope) -> dict[str, str]:
        """The attributes with their texts evaluated."""
        return {
            name: self.evaluator.text_of(node, name, scope) for name in node.attributes if not name.startswith("xmlns")
        }

    def required(self, node: XmlNode, attribute: str, scope: XacroScope) -> str:
        """The text of an attribute that must be there."""
        if attribute not in node.attributes:
            raise node.error(f"found <{shown(node.tag)}> without '{attribute}', expected it")
        return self.evaluator.text_of(node, attribute, scope)

    # Commands of `$(…)`.

    def find(self, name: str, node: XmlNode) -> str:
        """The folder of a package."""
        try:
            return str(self.folders.package(name))
        except InputError as error:
            raise ExpressionError(str(error)) from None

    def argument(self, name: str, node: XmlNode) -> str:
        """The value of an argument."""
        self.asked.add(name)
        if name not in self.arguments:
            hint = did_you_mean(name, self.arguments)
            raise ExpressionError(
                f"found no value of the argument '{shown(name)}'{hint or ', expected one, or a default'}"
            )
        return self.arguments[name]

    def environment(self, rest: str, node: XmlNode) -> str:
        """The default of an environment variable: none is read."""
        return rest.partition(" ")[2].strip()

    def folder(self, rest: str, node: XmlNode) -> str:
        """The folder of the file that a node stands in."""
        return str(Path(node.document.file).parent)

    def load(self, name: str, node: XmlNode) -> XacroValue:
        """What is in a YAML file, which is read once."""
        try:
            path = self.folders.included(name, Path(node.document.file).resolve().parent, TABLES)
            if path not in self.tables:
                text = self.folders.read(path, "a YAML file", MOST_TABLE_BYTES).decode("utf-8-sig", "replace")
                self.tables[path] = xacro_table(text, str(path))
        except DescriptionError as error:
            raise ExpressionError(f"{error.file}:{error.line}: {error.message}") from None
        except InputError as error:
            raise ExpressionError(str(error)) from None
        return self.tables[path]

    # Words of xacro.

    def declare(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:arg`: a default for an argument."""
        name = self.required(node, "name", scope)
        self.asked.add(name)
        if name not in self.arguments and "default" in node.attributes:
            self.arguments[name] = self.evaluator.text_of(node, "default", scope)
        return []

    def set_property(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:property`: a text that is evaluated later, or a block."""
        name = self.required(node, "name", scope)
        if not re.fullmatch(r"[A-Za-z_]\w*", name):
            raise node.error(f"found the property '{shown(name)}', expected a name of letters, digits and _", "name")
        where = node.attributes.get("scope", "")
        place = scope.outermost() if where == "global" else (scope.outer or scope) if where == "parent" else scope
        attribute = "value" if "value" in node.attributes else "default"
        if attribute == "default" and (scope.has(name) or scope.block(name) is not None):
            return []
        place.forget(name)
        if attribute not in node.attributes:
            if node.attributes.get("remove", "").lower() != "true":
                place.blocks[name] = node.children
            return []
        added = XacroProperty(node, attribute, scope)
        if place is not scope or "$" not in node.attributes[attribute] or self._names_itself(node, attribute, name):
            value = self.evaluator.value_of(node, attribute, scope)
            place.values[name] = xacro_typed(value) if isinstance(value, str) else value
        else:
            place.properties[name] = added
        return []

    def _names_itself(self, node: XmlNode, attribute: str, name: str) -> bool:
        """Whether a text uses its own name, which then means the value before."""
        return name in re.findall(r"\w+", node.attributes[attribute])

    def condition(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:if` and `xacro:unless`."""
        if "value" not in node.attributes:
            raise node.error(f"found <{node.tag}> without 'value', expected it")
        value: XacroValue = self.evaluator.value_of(node, "value", scope)
        value = xacro_typed(value) if isinstance(value, str) else value
        if isinstance(value, XacroTable | XacroList):
            raise node.error("found a table or a list as a condition, expected true, false or a number", "value")
        if isinstance(value, str):
            raise node.error(f"found '{shown(value)}' as a condition, expected true, false or a number", "value")
        return self.expand_all(node.children, scope) if bool(value) == (node.tag == "xacro:if") else []

    def include(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:include`: what is in another file's root."""
        name = self.required(node, "filename", scope)
        if "ns" in node.attributes:
            raise node.error("found an include with a namespace, expected none: it is not read", "ns")
        self.includes += 1
        if self.includes > MOST_INCLUDES:
            raise node.error(f"found more than {MOST_INCLUDES} includes, expected fewer")
        try:
            path = self.folders.included(name, Path(node.document.file).resolve().parent)
            if str(path) in self.open_files:
                raise InputError(f"found '{shown(name)}' included within itself, expected no circle")
            root = read_xml(self.folders.read(path), str(path))
        except DescriptionError:
            raise
        except InputError as error:
            if node.attributes.get("optional", "").lower() == "true":
                return []
            raise node.error(str(error), "filename") from None
        self.texts[root.document.file] = root.document
        self.open_files.append(str(path))
        found = self.expand_all(root.children, scope)
        self.open_files.pop()
        return found

    def define(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:macro`."""
        scope.macros[self.required(node, "name", scope).removeprefix(PREFIX)] = node
        return []

    def insert(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """`xacro:insert_block`."""
        name = self.required(node, "name", scope)
        block = scope.block(name)
        if block is None:
            raise node.error(f"found the unknown block '{shown(name)}', expected a parameter *{shown(name)}", "name")
        return self.expand_all(block, scope)

    def refuse(self, node: XmlNode, scope: XacroScope) -> list[XmlNode]:
        """A word that is not read."""
        raise node.error(f"found <{node.tag}>, expected elements as they are: make a URDF of it with ROS's own xacro")

    def call(self, node: XmlNode, name: str, scope: XacroScope) -> list[XmlNode]:
        """A macro's contents with its parameters set."""
        given = dict.fromkeys(node.attributes)
        if name == "call":
            name = self.required(node, "macro", scope).removeprefix(PREFIX)
            given.pop("macro")
        macro = scope.macro(name)
        if macro is None:
            known = scope.outermost().macros
            hint = did_you_mean(name, known) or ", expected a word of xacro, or a macro that is defined before"
            raise node.error(f"found the unknown macro '{shown(name)}'{hint}")
        inner = XacroScope(scope)
        blocks = [block for child in node.children for block in self.expand(child, scope)]
        parameters = self.parameters_of(macro)
        self.steps += len(parameters)
        for star, parameter, default in parameters:
            given.pop(parameter, None)
            self._set(inner, macro, node, star, parameter, default, blocks)
        if given:
            names = [parameter for _, parameter, _ in parameters]
            wrong = next(iter(given))
            hint = did_you_mean(wrong, names) or f", expected {', '.join(names) or 'none'}"
            raise node.error(f"found the parameter '{shown(wrong)}' of the macro '{shown(name)}'{hint}", wrong)
        if blocks:
            raise blocks[0].error(f"found a block too many for the macro '{shown(name)}', expected none")
        return self.expand_all(macro.children, inner)

    def parameters_of(self, macro: XmlNode) -> list[tuple[str, str, tuple[str, str] | None]]:
        """A macro's parameters, which are read once."""
        if macro not in self.parameters:
            self.parameters[macro] = _parameters(macro)
        return self.parameters[macro]

    def _set(
        self,
        inner: XacroScope,
        macro: XmlNode,
        node: XmlNode,
        star: str,
        name: str,
        default: tuple[str, str] | None,
        blocks: list[XmlNode],
    ) -> None:
        """Set a parameter of a macro from a call, or from its default."""
        assert inner.outer is not None
        if star:
            if blocks:
                block = blocks.pop(0)
                inner.blocks[name] = block.children if star == "**" else [block]
            elif default is None or inner.outer.block(name) is None:
                raise node.error(f"found no block '{shown(name)}' within <{shown(node.tag)}>, expected it")
            return
        if name in node.attributes:
            value = self.evaluator.value_of(node, name, inner.outer)
        elif default is None:
            raise node.error(f"found <{shown(node.tag)}> without the parameter '{shown(name)}', expected it")
        elif default[0] and inner.outer.has(name):
            return
        elif default[0] == "^":
            raise node.error(f"found <{shown(node.tag)}> without the parameter '{shown(name)}', expected it")
        else:
            try:
                value = self.evaluator.evaluated(default[1], macro, inner.outer)
            except ExpressionError as error:
                raise macro.error(error.message, "params") from None
        inner.values[name] = xacro_typed(value) if isinstance(value, str) else value


def _parameters(macro: XmlNode) -> list[tuple[str, str, tuple[str, str] | None]]:
    """Stars, name, and (how it passes, text) of the default of a macro's parameters, in their order."""
    text = macro.attributes.get("params", "")
    found: list[tuple[str, str, tuple[str, str] | None]] = []
    at = 0
    text = text.rstrip()
    while at < len(text):
        match = PARAMETER.match(text, at)
        if match is None:
            raise macro.error(
                f"found '{shown(text[at:].strip())}' among parameters, expected name or name:=value", "params"
            )
        default = match["default"]
        if default is not None and default[:1] in ("'", '"'):
            default = default[1:-1]
        found.append((match["star"], match["name"], None if default is None else (match["pass"] or "", default)))
        at = match.end()
    return found


WORDS_OF_XACRO = {
    "arg": XacroExpansion.declare,
    "property": XacroExpansion.set_property,
    "if": XacroExpansion.condition,
    "unless": XacroExpansion.condition,
    "include": XacroExpansion.include,
    "macro": XacroExpansion.define,
    "insert_block": XacroExpansion.insert,
    "element": XacroExpansion.refuse,
    "attribute": XacroExpansion.refuse,
}
