"""The bodies of a MuJoCo file as a tree of links: which of them are the robot, what joins them, what holds joints
together, what may be asked for.

Links are bodies. Of a body that several joints move, the links between these are `BODY~1`, `BODY~2`, …; what no joint
moves is held by a fixed joint `BODY~fixed`. A body that floats is a robot with a free base, which is its root then.

Source: MuJoCo 4.0, XML reference, `equality`, `keyframe`; what it leaves open was tried with mujoco 4.0.0.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from robokin.arrays import Array
from robokin.errors import Note, counted, did_you_mean, shown
from robokin.formats.faults import Faults
from robokin.formats.mjcf_bodies import WORLD, MjcfBodies, MjcfBody, MjcfJoint
from robokin.formats.mjcf_settings import MAIN, flag_of, values_of
from robokin.formats.xml_tree import XmlNode
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.spatial import exact, invert, translation_transform, z_to

TYPES = {"hinge": "revolute", "slide": "prismatic"}

NOT_HELD = ("tendon", "flex", "flexvert", "flexstrain", "distance")
"""Equalities that no joint's value follows from."""

MOST_BESIDE = 100_000
"""Values of a keyframe that are read before their number is judged."""

MOST_SHOWN = 8
"""Names that a note lists."""


class MjcfTree:
    """Makes a graph of the bodies of a file; mistakes are gathered in `faults`, doubts in `notes`.

    balls: whether a ball joint is taken as three revolute ones about x, y and z in turn.
    """

    def __init__(self, bodies: MjcfBodies, faults: Faults, balls: bool) -> None:
        self.classes = bodies.classes
        self.bodies = bodies.found
        self.names = bodies.names
        self.faults = faults
        self.balls = balls
        self.notes: list[Note] = []
        self.links: list[str] = []
        self.joints: list[GraphJoint] = []
        self.addresses: list[int] = []
        """Of each joint the place of its value in MuJoCo's qpos, -1 where it has none."""
        self.tops = self._tops()
        self.root = self._chosen()
        self.link_of: dict[int, int] = {}
        self.joint_of = {joint.name: (n, joint) for n, body in enumerate(self.bodies) for joint in body.joints}

    def graph(self, equalities: Iterable[XmlNode]) -> Graph:
        """The graph of the robot. Raises DescriptionError for what no graph can be made of."""
        self.link_of = {self.root: 0}
        self.links = [self.bodies[self.root].name]
        for number, body in enumerate(self.bodies):
            if number != self.root and self.tops[number] == self.root and body.parent in self.link_of:
                self.faults.attempt(None, self._add, number, body)
        self._say_what_is_left_out()
        couplings = [found for node in equalities if (found := self.faults.attempt(None, self._equality, node))]
        self.faults.stop()
        base = self.bodies[self.root].pose
        return Graph(tuple(self.links), tuple(self.joints), 0, exact(base), self._tips(), tuple(couplings))

    def _tops(self) -> list[int]:
        """Of each body the one that it stands on in the end, by number: the world, or a floating body."""
        tops = [0]
        for number, body in enumerate(self.bodies[1:], 1):
            tops.append(number if body.free else tops[body.parent])
        return tops

    def _chosen(self) -> int:
        """The root of the robot: what most joints stand on; the world if nothing has more."""
        counts = dict.fromkeys(self.tops, 0)
        for top, body in zip(self.tops, self.bodies, strict=True):
            counts[top] += len(body.joints)
        if not any(counts.values()) and all(body.free or body.parent < 0 for body in self.bodies[:2]):
            return min(1, len(self.bodies) - 1)  # a thing that floats alone
        return max(counts, key=lambda top: (counts[top], -top))

    def _say_what_is_left_out(self) -> None:
        """Notes of a free base, and of bodies that are no part of the robot."""
        root = self.bodies[self.root]
        if root.free:
            self._note(root.node, f"{shown(root.name)} floats: it is the root, and its free joint is no variable")
        others = [body for n, body in enumerate(self.bodies) if self.tops[n] != self.root and body.name != WORLD]
        if not others:
            return
        names = ", ".join(shown(body.name) for body in others[:MOST_SHOWN])
        more = ", …" if len(others) > MOST_SHOWN else ""
        joins = "is" if len(others) == 1 else "are"
        self._note(
            others[0].node,
            f"{counted(len(others), 'body').replace('bodys', 'bodies')} that no joint holds to {shown(root.name)} "
            f"{joins} left out: {names}{more}",
        )

    def _note(self, node: XmlNode, message: str) -> None:
        place = node.mark
        self.notes.append(Note(message, place.file, place.line, place.column))

    def _add(self, number: int, body: MjcfBody) -> None:
        """Add a body: the links between its joints, and its own."""
        parent = self.link_of[body.parent]
        singles = [single for joint in body.joints for single in self._singles(joint)]
        carried = body.pose
        for place, joint in enumerate(singles[:-1], 1):
            self.links.append(self.names.free("body", f"{body.name}~{place}"))
            self._join(joint, parent, carried)
            parent, carried = len(self.links) - 1, np.eye(4)
        self.links.append(body.name)
        self.link_of[number] = len(self.links) - 1
        if singles:
            self._join(singles[-1], parent, carried)
            return
        name = self.names.free("joint", f"{body.name}~fixed")
        link = self.link_of[number]
        self.joints.append(GraphJoint(name, "fixed", parent, link, 0, before=exact(carried), row=len(self.joints)))
        self.addresses.append(-1)

    def _singles(self, joint: MjcfJoint) -> list[MjcfJoint]:
        """A joint as joints of one freedom. Raises DescriptionError for a ball, unless it may be three."""
        if joint.type != "ball":
            return [joint]
        if not self.balls:
            raise joint.node.error(
                f"found the ball joint {shown(joint.name)}, expected hinges and slides; with balls=True it is read as "
                "three hinges about x, y and z in turn",
                "type",
            )
        if math.isfinite(joint.limits[1]):
            self._note(joint.node, f"the limit of the ball joint {shown(joint.name)} is left out: it is of a cone")
        return [
            MjcfJoint(
                self.names.free("joint", f"{joint.name}~{axis}"), "hinge", joint.node, along, joint.point, address=-1
            )
            for axis, along in zip("xyz", np.eye(3), strict=True)
        ]

    def _join(self, joint: MjcfJoint, parent: int, carried: Array) -> None:
        """Add a joint to the last link; `carried` (4, 4) is the body's pose before it moves in the parent's frame."""
        point = joint.point if joint.type == "hinge" else np.zeros(3)
        A = z_to(joint.axis)
        self.joints.append(
            GraphJoint(
                name=joint.name,
                type=TYPES[joint.type],
                parent=parent,
                child=len(self.links) - 1,
                before=exact(carried @ translation_transform(point) @ A),
                after=exact(invert(A) @ translation_transform(-point)),
                zero=-joint.ref + 0.0,
                limits=joint.limits,
                row=len(self.joints),
            )
        )
        self.addresses.append(joint.address)

    def _equality(self, node: XmlNode) -> Coupling | None:
        """The coupling that an equality is, if it is one. Raises DescriptionError for what closes a loop."""
        full = self.classes.filled(node, MAIN, "equality")
        if not flag_of(full, "active", True):
            return None
        if node.tag == "joint":
            return self._coupling(full)
        if node.tag in ("connect", "weld"):
            self._refuse_loop(full)
        elif node.tag in NOT_HELD:
            self._note(node, f"the equality <{node.tag}> is left out: no joint's value follows from it")
        else:
            hint = did_you_mean(node.tag, ("joint", "connect", "weld", *NOT_HELD)) or ", expected joint"
            raise node.error(f"found the equality <{shown(node.tag)}>{hint}")
        return None

    def _coupling(self, node: XmlNode) -> Coupling | None:
        """q1 - ref1 = a0 + a1 (q2 - ref2) as a coupling. Raises DescriptionError for a polynomial of more."""
        follower = self._joint_named(node, "joint1")
        if follower is None:
            return None
        master = self._joint_named(node, "joint2") if node.attributes.get("joint2") else None
        if node.attributes.get("joint2") and master is None:
            raise node.error("found a joint of the robot that follows one of what floats beside it", "joint2")
        a = [*(values_of(node, "polycoef", None) or (0.0, 1.0)), 0.0, 0.0][:5]
        if len(values_of(node, "polycoef", None) or ()) > 5:
            raise node.error("found more than five coefficients, expected a0 to a4", "polycoef")
        if any(a[2:]) and master is not None:
            raise node.error(
                f"found that {shown(follower.name)} follows {shown(master.name)} by a polynomial, expected a straight "
                "line: coefficients a0 and a1 alone",
                "polycoef",
            )
        if master is None:
            return Coupling(follower.name, (), follower.ref + a[0])
        return Coupling(follower.name, ((master.name, a[1]),), follower.ref + a[0] - a[1] * master.ref)

    def _joint_named(self, node: XmlNode, key: str) -> MjcfJoint | None:
        """The joint that an attribute names, None if it is no part of the robot. Raises DescriptionError."""
        name = node.attributes.get(key, "")
        if name in self.joint_of:
            number, joint = self.joint_of[name]
            if joint.type == "ball":
                raise node.error(f"found the ball joint {shown(name)} in a coupling, expected a hinge or slide", key)
            return joint if self.tops[number] == self.root else None
        hint = did_you_mean(name, self.joint_of) or ", expected the name of a joint"
        raise node.error(f"found the unknown joint {shown(repr(name))}{hint}", key)

    def _refuse_loop(self, node: XmlNode) -> None:
        """Raise DescriptionError where two bodies of the robot are held together; only note what is no part of it.

        A weld to a mocap body is how a simulation leads a robot: it holds nothing by itself.
        """
        ends = [self._body_named(node, *keys) for keys in (("body1", "site1"), ("body2", "site2"))]
        names = " and ".join(shown(self.bodies[end].name) for end in ends)
        if any(self.bodies[end].mocap for end in ends):
            self._note(node, f"the <{node.tag}> of {names} is left out: a mocap body is where the user puts it")
        elif any(self.tops[end] != self.root for end in ends):
            self._note(node, f"the <{node.tag}> of {names} is left out: one of them is no part of the robot")
        else:
            raise node.error(f"found a <{node.tag}> of {names}, which closes a loop, expected a tree of joints")

    def _body_named(self, node: XmlNode, body_key: str, site_key: str) -> int:
        """The number of the body that one of two attributes names or whose site it names; the world for neither."""
        name, site = node.attributes.get(body_key, ""), node.attributes.get(site_key, "")
        if site:
            for number, body in enumerate(self.bodies):
                if any(one.name == site for one in body.sites):
                    return number
            known = [one.name for body in self.bodies for one in body.sites]
            hint = did_you_mean(site, known) or ", expected the name of a site"
            raise node.error(f"found the unknown site {shown(repr(site))}{hint}", site_key)
        names = [body.name for body in self.bodies]
        if not name:
            return 0
        if name not in names:
            hint = did_you_mean(name, names) or ", expected the name of a body"
            raise node.error(f"found the unknown body {shown(repr(name))}{hint}", body_key)
        return names.index(name)

    def _tips(self) -> tuple[Tip, ...]:
        """The named sites that joints move, else the bodies that joints move and no other stands on, else all those."""
        kept = sorted(self.link_of)
        moved: dict[int, bool] = {self.root: False}
        for number in kept[1:] if kept[0] == self.root else [n for n in kept if n != self.root]:
            body = self.bodies[number]
            moved[number] = bool(body.joints) or moved[body.parent]
        parents = {self.bodies[number].parent for number in kept}
        sites = [(n, site) for n in kept for site in self.bodies[n].sites]
        if found := [Tip(site.name, self.link_of[n], exact(site.pose)) for n, site in sites if moved[n]]:
            return tuple(found)
        leaves = [n for n in kept if n not in parents]
        leaves = [n for n in leaves if moved[n]] or leaves
        return tuple(Tip(self.bodies[n].name, self.link_of[n]) for n in leaves)

    def poses(self, graph: Graph, keys: Iterable[XmlNode], values: int) -> dict[str, Array]:
        """The keyframes with a name as configurations (n,) of the graph's variables. Raises DescriptionError."""
        places = [self.addresses[number] for number in graph.variables]
        found: dict[str, Array] = {}
        for node in keys:
            name, text = node.attributes.get("name", ""), node.attributes.get("qpos", "")
            count = len(text.split())
            if count > max(values, MOST_BESIDE):  # counted before they are read: there may be millions
                raise node.error(f"found {counted(count, 'value')} in qpos, expected {values}", "qpos")
            qpos = values_of(node, "qpos", None)
            if not name or qpos is None or any(place < 0 for place in places):
                continue
            if len(qpos) != values:
                raise node.error(f"found {counted(len(qpos), 'value')} in qpos, expected {values}", "qpos")
            found[name] = np.array([qpos[place] for place in places])
        return found
