"""The poses that others find in a description: Pinocchio, MuJoCo, yourdfpy, and products of a file's own numbers.

Each peer reads a file without anything of robokin's; what it is given are the values of the joints by their names. What
joints follow others is read here again from the file.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

Poses = dict[str, Any]
"""Poses (4, 4) [m] in the world by `link NAME`, and `tip NAME` of sites."""


class NotComparedError(Exception):
    """A peer reads a file and cannot be asked for the poses of it; says why."""


def importable() -> list[str]:
    """The packages for comparison that are there."""
    names = ("pinocchio", "mujoco", "yourdfpy", "xacro")
    return [name for name in names if importlib.util.find_spec(name) is not None]


def peers_of(kind: str) -> dict[str, Callable[[Path, bytes, Mapping[str, str]], Any]]:
    """What makes a model of a file, by the names of the peers that read its format."""
    there = importable()
    if kind == "MJCF":
        return {"mujoco": MujocoModel} if "mujoco" in there else {}
    if kind == "SDF":
        return {"product": SdfProduct}
    found: dict[str, Any] = {"product": UrdfProduct, "pinocchio": PinocchioUrdf, "mujoco": MujocoUrdf}
    if "pinocchio" not in there and "mujoco" not in there:
        found["yourdfpy"] = YourdfpyUrdf
    found = {name: make for name, make in found.items() if name == "product" or name in there}
    if kind == "xacro":
        return {name: _expanding(make) for name, make in found.items()} if "xacro" in there else {}
    return found


@contextlib.contextmanager
def silent() -> Iterator[None]:
    """Nothing is printed, not by compiled code either."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(number) for number in (1, 2)]
    with Path(os.devnull).open("w", encoding="utf-8") as nothing:
        for number in (1, 2):
            os.dup2(nothing.fileno(), number)
        try:
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                yield
        finally:
            for number, copy in zip((1, 2), kept, strict=True):
                os.dup2(copy, number)
                os.close(copy)


def _expanding(make: Callable[..., Any]) -> Callable[[Path, bytes, Mapping[str, str]], Any]:
    """A maker for xacro files: the package `xacro` expands them first."""

    def made(path: Path, data: bytes, packages: Mapping[str, str]) -> Any:
        return make(path, _expanded(path, packages), packages)

    return made


_LAST: tuple[Path, bytes] | None = None


def _expanded(path: Path, packages: Mapping[str, str]) -> bytes:
    """A xacro file's URDF by the package `xacro`; `$(find …)` finds what robokin is given."""
    global _LAST
    if _LAST is not None and _LAST[0] == path:
        return _LAST[1]
    import xacro
    from xacro import substitution_args

    def find(resolved: str, a: str, args: list[str], context: Any) -> str:
        above = next((one for one in path.resolve().parents if one.name == args[0]), None)
        return resolved.replace(f"$({a})", packages.get(args[0]) or str(above or f"/missing/{args[0]}"))

    substitution_args._find = find
    with silent():
        text: str = xacro.process_file(str(path)).toxml()
    _LAST = path, text.encode()
    return _LAST[1]


def turned(axis: Any, angle: float) -> Any:
    """A rotation (4, 4) about an axis through the origin, by Rodrigues' formula."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    return T


def moved(x: float, y: float, z: float) -> Any:
    """A translation (4, 4)."""
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def rolled(roll: float, pitch: float, yaw: float) -> Any:
    """The rotation (4, 4) Rz(yaw) Ry(pitch) Rx(roll)."""
    return turned([0, 0, 1], yaw) @ turned([0, 1, 0], pitch) @ turned([1, 0, 0], roll)


def placed(R: Any, p: Any) -> Any:
    """The pose (4, 4) of a rotation (3, 3) or its nine entries, and a place (3,)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.reshape(R, (3, 3)), p
    return T


def numbers(text: str | None, otherwise: list[float]) -> list[float]:
    """The numbers in a text, three where there are more; some files have commas between them."""
    found = [float(one) for one in (text or "").replace(",", " ").split()]
    return found[:3] if found else otherwise


class UrdfNumbers:
    """The joints of a URDF text, by name and by the link that each carries."""

    def __init__(self, data: bytes) -> None:
        text = data.strip()
        self.root = _parsed(text)
        self.joints = [joint for joint in self.root.findall("joint") if joint.find("child") is not None]
        self.above = {_link(joint, "child"): joint for joint in self.joints}
        self.named = {joint.get("name"): joint for joint in self.joints}
        self.links = [link.get("name") for link in self.root.findall("link")]
        if not self.links:
            raise NotComparedError("has no links")

    def values(self, tree: Any, q: Any) -> dict[str, float]:
        """Every joint's value; those that follow others by their `<mimic>`."""
        known = dict(zip([joint.name for joint in tree.joints], (float(one) for one in q), strict=True))

        def value(name: str) -> float:
            joint = self.named.get(name)
            if name in known or joint is None:
                return known.get(name, 0.0)
            mimic = joint.find("mimic")
            if mimic is None or joint.get("type") == "fixed":
                return 0.0
            factor, offset = mimic.get("multiplier"), mimic.get("offset")
            return float(factor or 1.0) * value(mimic.get("joint", "")) + float(offset or 0.0)

        return {name: value(name) for name in self.named if name is not None}


def _parsed(text: bytes) -> ElementTree.Element:
    """XML as robots have it: prefixes that are nowhere declared are part of the names."""
    parser = ElementTree.XMLParser()
    with contextlib.suppress(ElementTree.ParseError):
        parser.feed(text)
        return parser.close()
    plain = re.sub(rb"(</?|\s)([A-Za-z_][\w.-]*):(?=[A-Za-z_])", rb"\1\2_", text)
    return ElementTree.fromstring(plain)


def _link(joint: ElementTree.Element, end: str) -> str:
    found = joint.find(end)
    return "" if found is None else found.get("link", "")


class UrdfProduct:
    """The product of a URDF's own transforms."""

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        self.urdf = UrdfNumbers(data)

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of all links."""
        values = self.urdf.values(tree, q)
        done: Poses = {}

        def pose(link: str) -> Any:
            if link not in done:
                joint = self.urdf.above.get(link)
                step = np.eye(4) if joint is None else _urdf_step(joint, values)
                done[link] = step if joint is None else pose(_link(joint, "parent")) @ step
            return done[link]

        for link in self.urdf.links:
            pose(link)
        return in_root(done, tree)


def in_root(poses: Poses, tree: Any) -> Poses:
    """Poses of links in that of the tree's root."""
    root = poses.get(tree.graph.links[tree.graph.root])
    if root is None:
        raise NotComparedError("has another root")
    back = np.linalg.inv(root)
    return {f"link {name}": back @ T for name, T in poses.items()}


def _urdf_step(joint: ElementTree.Element, values: Mapping[str, float]) -> Any:
    """Trans(xyz) RPY(rpy) and the motion of a joint."""
    origin = joint.find("origin")
    given = {} if origin is None else origin.attrib
    zero = [0.0, 0.0, 0.0]
    step = moved(*numbers(given.get("xyz"), zero)) @ rolled(*numbers(given.get("rpy"), zero))
    axis = joint.find("axis")
    along = numbers(None if axis is None else axis.get("xyz"), [1.0, 0.0, 0.0])
    value = values[joint.get("name", "")]
    if joint.get("type") == "prismatic":
        return step @ moved(*(value * np.array(along) / np.linalg.norm(along)))
    return step @ turned(along, value) if joint.get("type") in ("revolute", "continuous") else step


class PinocchioUrdf:
    """A URDF by Pinocchio, its mimics left out: their values are given."""

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        import pinocchio

        self.urdf, self.pin = UrdfNumbers(data), pinocchio
        with silent():
            self.model = pinocchio.buildModelFromXML(data.decode())
        self.data = self.model.createData()

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of all links."""
        values, pin, model = self.urdf.values(tree, q), self.pin, self.model
        given = pin.neutral(model)
        for number in range(1, model.njoints):
            joint, value = model.joints[number], values.get(model.names[number])
            if value is not None and joint.nv == 1:
                given[joint.idx_q : joint.idx_q + joint.nq] = (
                    [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
                )
        pin.framesForwardKinematics(model, self.data, given)
        bodies = [(number, frame) for number, frame in enumerate(model.frames) if frame.type == pin.FrameType.BODY]
        return in_root({frame.name: self.data.oMf[number].homogeneous for number, frame in bodies}, tree)


class YourdfpyUrdf:
    """A URDF by yourdfpy, without meshes."""

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        import yourdfpy

        self.urdf = UrdfNumbers(data)
        with silent():
            self.model = yourdfpy.URDF.load(io.BytesIO(data), build_scene_graph=True, load_meshes=False)

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of all links."""
        values = self.urdf.values(tree, q)
        self.model.update_cfg({name: values[name] for name in self.model.actuated_joint_names})
        return in_root({name: self.model.get_transform(name) for name in self.model.link_map}, tree)


class MujocoUrdf:
    """A URDF by MuJoCo, without shapes and with masses that let it compile."""

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        import mujoco

        self.urdf, self.mj = UrdfNumbers(data), mujoco
        mujoco.set_mju_user_warning(lambda _: None)
        root = _parsed(data.strip())
        for link in root.findall("link"):
            for part in [*link]:
                link.remove(part)
            inertial = ElementTree.SubElement(link, "inertial")
            ElementTree.SubElement(inertial, "mass", value="1")
            ElementTree.SubElement(inertial, "inertia", ixx="1", iyy="1", izz="1", ixy="0", ixz="0", iyz="0")
        for part in root.findall("mujoco") + root.findall("transmission") + root.findall("gazebo"):
            root.remove(part)
        ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", fusestatic="false")
        with silent():
            self.model = mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of all links; the root is the world where it has no body of its own."""
        values, model = self.urdf.values(tree, q), self.model
        data = self.mj.MjData(model)
        data.qpos[:] = model.qpos0
        for number in range(model.njnt):
            if model.jnt_type[number] in (2, 3):
                data.qpos[model.jnt_qposadr[number]] = values.get(model.joint(number).name, 0.0)
        self.mj.mj_kinematics(model, data)
        found = {model.body(n).name: placed(data.xmat[n], data.xpos[n]) for n in range(model.nbody)}
        found.setdefault(tree.graph.links[tree.graph.root], np.eye(4))
        return in_root({name: T for name, T in found.items() if name in self.urdf.links}, tree)


class MujocoModel:
    """A MuJoCo file by MuJoCo; where meshes are missing, without shapes and with masses that let it compile.

    Bodies and joints are told by their order, names or not.
    """

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        import mujoco

        self.mj = mujoco
        mujoco.set_mju_user_warning(lambda _: None)  # else a file of warnings is left in the folder
        with silent():
            try:
                self.model = mujoco.MjModel.from_xml_path(str(path))
            except ValueError:
                self.model = _without_shapes(mujoco, path)

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of the bodies that stand on the tree's root, and of their sites."""
        mj, model, graph = self.mj, self.model, tree.graph
        data = mj.MjData(model)
        data.qpos[:] = model.qpos0
        mine, own = self._bodies(graph)
        joints = [n for n in range(model.njnt) if model.jnt_bodyid[n] in mine and model.jnt_type[n] in (2, 3)]
        moving = [graph.joints[number] for number in graph.moving]
        if len(moving) != len(joints):
            raise NotComparedError(f"has {len(joints)} joints there, and not {len(moving)}")
        values = dict(zip([joint.name for joint in tree.joints], q, strict=True))
        numbers = {joint.name: number for joint, number in zip(moving, joints, strict=True)}
        for joint, number in zip(moving, joints, strict=True):
            if model.joint(number).name not in ("", joint.name):
                raise NotComparedError(f"has {model.joint(number).name} in the place of {joint.name}")
            data.qpos[model.jnt_qposadr[number]] = values.get(joint.name, 0.0)
        followers = {numbers[joint.name] for joint in moving if joint.name not in values}
        self._follow(data, followers)
        mj.mj_kinematics(model, data)
        poses = {f"link {name}": placed(data.xmat[n], data.xpos[n]) for name, n in own.items()}
        for n in range(model.nsite):
            if model.site_bodyid[n] in mine and model.site(n).name:
                poses[f"tip {model.site(n).name}"] = placed(data.site_xmat[n], data.site_xpos[n])
        return poses

    def _bodies(self, graph: Any) -> tuple[set[int], dict[str, int]]:
        """The bodies that stand on the root, and those of the links; links between joints have none."""
        model = self.model
        tops = [0]
        for n in range(1, model.nbody):
            first = model.body_jntadr[n]
            free = first >= 0 and model.jnt_type[first] == 0
            tops.append(n if free else tops[model.body_parentid[n]])
        name = graph.links[graph.root]
        candidates = [n for n in dict.fromkeys(tops) if model.body(n).name == name]
        counts = {top: sum(model.body_jntnum[n] for n in range(model.nbody) if tops[n] == top) for top in tops}
        top = candidates[0] if candidates else max(counts, key=lambda one: counts[one])
        mine = [n for n in range(model.nbody) if tops[n] == top]
        between = {f"{model.body(n).name}~{k}" for n in mine for k in range(1, model.body_jntnum[n])}
        unnamed = any(not model.body(n).name for n in mine)
        links = [link for link in graph.links if link not in between] if not unnamed else []
        if unnamed:
            return set(mine), {link: n for n in mine for link in graph.links if model.body(n).name == link}
        if len(links) != len(mine):
            raise NotComparedError(f"has {len(mine)} bodies there, and not {len(links)}")
        return set(mine), {model.body(n).name: n for n in mine}

    def _follow(self, data: Any, followers: set[int]) -> None:
        """Give the joints that equalities hold their values, one after the other."""
        model = self.model
        for _ in range(len(followers)):
            for n in range(model.neq):
                one, other = model.eq_obj1id[n], model.eq_obj2id[n]
                if model.eq_type[n] != self.mj.mjtEq.mjEQ_JOINT or one not in followers:
                    continue
                at = model.jnt_qposadr
                x = data.qpos[at[other]] - model.qpos0[at[other]] if other >= 0 else 0.0
                data.qpos[at[one]] = model.qpos0[at[one]] + np.polyval(model.eq_data[n][4::-1], x)


def _without_shapes(mujoco: Any, path: Path) -> Any:
    """The model of a file without what has meshes, pictures and forces."""
    spec = mujoco.MjSpec.from_file(str(path))
    for group in (spec.geoms, spec.meshes, spec.hfields, spec.textures, spec.materials, spec.sensors, spec.actuators):
        for one in [*group]:
            spec.delete(one)
    for group in (spec.tendons, spec.excludes, spec.pairs, spec.keys, spec.cameras, spec.lights):
        for one in [*group]:
            spec.delete(one)
    spec.compiler.boundmass, spec.compiler.boundinertia = 1.0, 1.0
    return spec.compile()


class SdfProduct:
    """The product of an SDF model's own transforms: models of one level, joints of one axis."""

    def __init__(self, path: Path, data: bytes, packages: Mapping[str, str]) -> None:
        self.root = ElementTree.fromstring(data.strip())
        major, minor = self.root.get("version", "").split(".")[:2]
        self.version = int(major), int(minor)

    def poses(self, tree: Any, q: Any) -> Poses:
        """The poses of the links that hang on the tree's root, in the world."""
        models = [model for model in self.root.iter("model") if model.get("name", "").strip() == tree.name]
        root = tree.graph.links[tree.graph.root]
        if len(models) != 1 or models[0].find("model") is not None:
            raise NotComparedError("has models in models, or several of one name")
        model = models[0]
        values = dict(zip([joint.name for joint in tree.joints], q, strict=True))
        parts = {(one.tag, one.get("name")): one for one in model if one.tag in ("link", "joint", "frame")}
        joints = {(one.findtext("child") or "").strip(): one for one in model.findall("joint")}
        above = _sdf_pose(model)[0]
        done: Poses = {}

        def pose(link: str) -> Any:
            joint = joints.get(link)
            if link not in done and (joint is None or link == root):
                known = ("link", link) in parts
                done[link] = np.eye(4) if link == "world" and not known else above @ self._place(("link", link), parts)
            elif link not in done and joint is not None:
                parent = (joint.findtext("parent") or "").strip()
                outside = parent == "world" and ("link", parent) not in parts
                start = np.linalg.inv(above) if outside else self._place(("link", parent), parts)
                at = self._place(("joint", joint.get("name")), parts)
                end = self._place(("link", link), parts)
                step = np.linalg.inv(start) @ at @ self._motion(joint, at, values, parts) @ np.linalg.inv(at) @ end
                done[link] = pose(parent) @ step
            return done[link]

        names = [one.get("name", "") for one in model.findall("link") if one.get("name") in tree.graph.links]
        return {f"link {name}": pose(name) for name in names}

    def _place(self, key: tuple[str, str | None], parts: Mapping[Any, ElementTree.Element]) -> Any:
        """Where a link, joint or frame is in the model, as the file has it."""
        if key not in parts:
            raise NotComparedError(f"has no {key[0]} {key[1]}")
        one = parts[key]
        T, towards = _sdf_pose(one)
        if self.version < (1, 7):
            towards = ""
        if not towards:
            towards = (one.findtext("child") or "").strip() if one.tag == "joint" else one.get("attached_to", "")
        if not towards or towards == "__model__":
            return T
        kinds = [kind for kind in ("link", "frame", "joint") if (kind, towards) in parts]
        if not kinds:
            raise NotComparedError(f"has nothing called {towards}")
        return self._place((kinds[0], towards), parts) @ T

    def _motion(
        self, joint: ElementTree.Element, at: Any, values: Mapping[str, float], parts: Mapping[Any, Any]
    ) -> Any:
        """The motion of a joint of one axis, or of none."""
        kind, axis = joint.get("type"), joint.find("axis")
        if kind == "fixed":
            return np.eye(4)
        name = joint.get("name", "")
        if kind not in ("revolute", "continuous", "prismatic") or axis is None or name not in values:
            raise NotComparedError(f"has the joint {name} of type {kind}, or one that follows another")
        along = np.array(numbers(axis.findtext("xyz"), [0.0, 0.0, 1.0]))
        xyz = axis.find("xyz")
        named = xyz.get("expressed_in", "") if xyz is not None and self.version >= (1, 7) else ""
        flag = (axis.findtext("use_parent_model_frame") or "false").strip() in ("1", "true")
        if self.version < (1, 5) or (self.version < (1, 7) and flag) or named == "__model__":
            along = at[:3, :3].T @ along
        elif named:
            kinds = [kind for kind in ("link", "frame", "joint") if (kind, named) in parts]
            along = at[:3, :3].T @ self._place((kinds[0], named), parts)[:3, :3] @ along
        value = values[name]
        return moved(*(value * along / np.linalg.norm(along))) if kind == "prismatic" else turned(along, value)


def _sdf_pose(one: ElementTree.Element) -> tuple[Any, str]:
    """The pose (4, 4) of an element, and what it is in."""
    pose = one.find("pose")
    if pose is None or not (pose.text or "").strip():
        return np.eye(4), "" if pose is None else pose.get("relative_to", "")
    if pose.get("rotation_format", "euler_rpy") != "euler_rpy":
        raise NotComparedError("has quaternions")
    values = [float(part) for part in (pose.text or "").split()]
    angles = np.radians(values[3:]) if pose.get("degrees") in ("true", "1") else values[3:]
    return moved(*values[:3]) @ rolled(*angles), pose.get("relative_to", "")
