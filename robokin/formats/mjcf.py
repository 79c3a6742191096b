"""A MuJoCo file (MJCF) to a tree of links.

What kinematics needs is read: bodies, joints, frames, sites, defaults, equalities of joints, keyframes; meshes, masses,
actuators and contacts are passed over. Files that it includes are read from the folder of the main file and below it.

Source: MuJoCo 4.0, XML reference.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from robokin.errors import DescriptionError, InputError, shown
from robokin.files import open_path, read_up_to
from robokin.formats.faults import Faults
from robokin.formats.mjcf_bodies import MjcfBodies
from robokin.formats.mjcf_settings import MjcfClasses, MjcfPoses, compiler_of
from robokin.formats.mjcf_tree import MjcfTree
from robokin.formats.snapped_angles import RoundedAngles
from robokin.formats.xml_tree import MAX_DEPTH, MAX_XML_BYTES, XmlNode, XmlText, read_xml
from robokin.model.tree import Tree

EXPECTED = "a MuJoCo description (.xml)"


def read_mjcf(
    source: Path | bytes | str,
    place: str = "",
    exact: bool = False,
    id: str = "",
    *,
    balls: bool = False,
    folder: Path | None = None,
) -> Tree:
    """The tree of links that a MuJoCo file, or its text, describes; `place` is the name that errors give it.

    exact: angles in radians as they are written, also those plainly cut in print. balls: a ball joint is three hinges
    about x, y and z in turn, and no mistake. folder: where a text's includes are, by default nowhere; a file's are in
    its own. Raises one DescriptionError for all mistakes, InputError for a file that cannot be read.
    """
    place = place or (str(source) if isinstance(source, Path) else "description")
    if isinstance(source, Path):
        folder = folder or source.parent
        id = id or source.stem
        source_path: Path | None = source
        with open_path(str(source), EXPECTED) as stream:
            source = read_up_to(stream, place, MAX_XML_BYTES, EXPECTED)
    else:
        source_path = None
    root = read_xml(source, place)
    files = _Includes(folder, source_path, len(source), root.document)
    faults = Faults()
    try:
        tree = _read(files.expanded(root), exact, id, balls, faults)
        faults.stop()
    except DescriptionError as error:
        whole = faults.ended(error, "")
        for known in whole.errors:
            if known.file in files.documents:
                files.documents[known.file].with_line(known)
        raise whole from None
    return tree


def _read(root: XmlNode, exact: bool, id: str, balls: bool, faults: Faults) -> Tree:
    """The tree of a file whose includes are in place."""
    if root.tag != "mujoco":
        raise root.error(f"found <{shown(root.tag)}>, expected <mujoco>")
    rounded = RoundedAngles(exact)
    compiler = compiler_of(root.all("compiler"))
    classes = MjcfClasses()
    for section in root.all("default"):
        classes.add(section)
    bodies = MjcfBodies(root, MjcfPoses(compiler, rounded), classes, faults)
    worlds = root.all("worldbody")
    if not worlds:
        raise root.error("found no <worldbody>, expected one with bodies")
    for section in worlds:
        bodies.read(section)
    bodies.finish()
    faults.stop()
    maker = MjcfTree(bodies, faults, balls)
    try:
        graph = maker.graph(_inside(root, "equality"))
        _ = graph.value_map
    except DescriptionError:
        raise
    except InputError as error:
        raise (root.first("equality") or root).error(str(error)) from None
    poses = maker.poses(graph, (key for key in _inside(root, "keyframe") if key.tag == "key"), bodies.values)
    name = root.attributes.get("model", "").strip() or id or "robot"
    notes = (*root.document.notes, *bodies.notes, *maker.notes, *rounded.notes())
    return Tree(name, graph, id=id, poses=poses, notes=notes)


def _inside(root: XmlNode, tag: str) -> Iterator[XmlNode]:
    """What stands in all sections of a kind."""
    for section in root.all(tag):
        yield from section.children


class _Includes:
    """Puts included files in the place of `<include>`; `documents`: the texts of all, by the names that errors give."""

    def __init__(self, folder: Path | None, main: Path | None, size: int, document: XmlText) -> None:
        self.folder = folder
        self.seen = {main} if main is not None else set()
        self.documents = {document.file: document}
        self.size = size

    def expanded(self, node: XmlNode, depth: int = 0) -> XmlNode:
        """An element with included files in place. Raises DescriptionError."""
        if depth > 2 * MAX_DEPTH:
            raise node.error(f"found elements more than {2 * MAX_DEPTH} deep, expected a description of a robot")
        if not node.children:
            return node
        children: list[XmlNode] = []
        for child in node.children:
            if child.tag == "include":
                children += self.expanded(self._included(child), depth + 1).children
            else:
                children.append(self.expanded(child, depth + 1))
        return node.derived(node.attributes, children, node.text)

    def _included(self, node: XmlNode) -> XmlNode:
        """The root of the file that an `<include>` names. Raises DescriptionError."""
        name = node.attributes.get("file", "").strip()
        if not name:
            raise node.error("found <include> without a file, expected its name", "file")
        if self.folder is None:
            raise node.error("found <include> in a text of no folder, expected a file", "file")
        parts = PurePosixPath(name.replace("\\", "/"))
        if parts.is_absolute() or ".." in parts.parts or ":" in parts.parts[0]:
            raise node.error(
                f"found the file {shown(repr(name))}, expected one in the folder of the main file or below it", "file"
            )
        try:
            path = (self.folder / parts).resolve()
            inside = path.is_relative_to(self.folder.resolve())
        except (OSError, ValueError, RuntimeError):
            inside = False
        if not inside:
            raise node.error(f"found the file {shown(repr(name))} outside the main file's folder", "file")
        named = (
            self.folder / parts
        )  # by its name, as in MuJoCo: links of other names to one file are a way to repeat it
        if named in self.seen:
            raise node.error(f"found the file {shown(repr(name))} twice, expected to include a file once", "file")
        self.seen.add(named)
        return self._read(node, named)

    def _read(self, node: XmlNode, path: Path) -> XmlNode:
        file = str(path)
        try:
            with open_path(file, EXPECTED) as stream:
                data = read_up_to(stream, file, MAX_XML_BYTES - self.size, EXPECTED)
        except InputError as error:
            raise node.error(str(error), "file") from None
        self.size += len(data)
        if self.size > MAX_XML_BYTES:
            raise node.error(f"found files over {MAX_XML_BYTES >> 20} MiB together, expected a description", "file")
        root = read_xml(data, file)
        self.documents[file] = root.document
        return root
