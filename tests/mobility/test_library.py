"""Every mechanism of the library against what its file expects, and the files against a table copied independently."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from library_entries import entry, names_of
from sweeps import sweep

import robokin
from robokin.formats import load_any
from robokin.mobility.assembly import CONTACTS
from robokin.mobility.count import grubler, grubler_by_constraints
from robokin.mobility.true_mobility import kernel_at
from robokin.mobility.verdict import Mobility, mobility_of
from robokin.model import Mechanism

# n, j, sum of f, lambda, Grübler's F, true mobility, freedoms of the output (None: no output is named).
# Table of a study of mobility counts: F recomputed in both forms; the true values from the singular values of the
# loops' equations and a finite test, most of them with Exudyn too (Exudyn calls the shaky triangle mobile); those of
# gears from their linear equations, those of cams and of the 3-RRR in space from an argument. Why counts fail: G. Gogu,
# "Mobility of mechanisms: a critical review", Mech. Mach. Theory 40, 2005. The Delta's 17 links and 15 freedoms and
# the three arms' 9 are those of K. M. Lynch and F. C. Park, Modern Robotics, chapter 2.
TABLE = {
    "four-bar": (4, 4, 4, 3, 1, 1, 1),
    "four-bar-in-space": (4, 4, 4, 6, -2, 1, 1),
    "five-bar": (5, 5, 5, 3, 2, 2, 2),
    "slider-crank": (4, 4, 4, 3, 1, 1, 1),
    "parallel-four-bar-redundant": (5, 6, 6, 3, 0, 1, 1),
    "parallel-four-bar-detuned": (5, 6, 6, 3, 0, 0, 0),
    "elliptic-trammel": (4, 4, 4, 3, 1, 1, 1),
    "wedge": (3, 3, 3, 3, 0, 1, 1),
    "six-bar": (6, 7, 7, 3, 1, 1, 1),
    "stephenson": (6, 7, 7, 3, 1, 1, 1),
    "jansen-leg": (8, 10, 10, 3, 1, 1, 1),
    "peaucellier-lipkin": (8, 10, 10, 3, 1, 1, 1),
    "3-rrr": (8, 9, 9, 3, 3, 3, 3),
    "3-rrr-in-space": (8, 9, 9, 6, -3, 3, 3),
    "shaky-triangle": (3, 3, 3, 3, 0, 0, 0),
    "bennett": (4, 4, 4, 6, -2, 1, 1),
    "sarrus": (6, 6, 6, 6, 0, 1, 1),
    "bricard-line-symmetric": (6, 6, 6, 6, 0, 1, 1),
    "generic-6r": (6, 6, 6, 6, 0, 0, 0),
    "generic-7r": (7, 7, 7, 6, 1, 1, 1),
    "rssr": (4, 4, 8, 6, 2, 2, 1),
    "universal-joint": (4, 4, 4, 3, 1, 1, 1),
    "universal-joint-in-space": (4, 4, 4, 6, -2, 1, 1),
    "spherical-four-bar": (4, 4, 4, 3, 1, 1, 1),
    "spherical-four-bar-in-space": (4, 4, 4, 6, -2, 1, 1),
    "6-ups": (14, 18, 36, 6, 6, 6, 6),
    "6-sps": (14, 18, 42, 6, 12, 12, 6),
    "delta": (11, 15, 39, 6, 9, 9, 3),
    "delta-with-bars": (17, 21, 45, 6, 15, 15, 3),
    "tripteron": (11, 12, 12, 6, 0, 3, 3),
    "orthoglide": (17, 21, 21, 6, -9, 3, 3),
    "3-rps": (8, 9, 15, 6, 3, 3, 3),
    "3-upu": (8, 9, 15, 6, 3, 3, 3),
    "3-upu-snu": (8, 9, 15, 6, 3, 3, 3),
    "three-arms": (8, 9, 21, 6, 9, 9, 6),
    "puma560-mechanism": (7, 6, 6, 6, 6, 6, 6),
    "arm-srs": (4, 3, 7, 6, 7, 7, 6),
    "planetary-ring-free": (5, 6, 8, 3, 2, 2, None),
    "planetary": (4, 5, 7, 3, 1, 1, 1),
    "cam-knife-edge": (3, 3, 4, 3, 1, 1, 1),
    "cam-roller": (4, 4, 5, 3, 2, 2, 1),
}

# The kernel's dimension at the configuration drawn, where it is not the mobility; by hand and from the same study.
INSTANTANEOUS = {"shaky-triangle": 1, "shaky-triangle-on-a-hinge": 2, "flat-parallelogram": 2, "3-upu-snu": 5,
                 "kinematotropic-cranks": 3}  # fmt: skip

# Redundant constraints that the study gives beside the table.
REDUNDANT = {
    "four-bar-in-space": 3, "parallel-four-bar-redundant": 1, "bennett": 3, "sarrus": 1, "bricard-line-symmetric": 1,
    "tripteron": 3, "orthoglide": 12, "6-sps": 0, "6-ups": 0, "delta": 0, "delta-with-bars": 0, "3-rps": 0,
}  # fmt: skip

VERDICTS = {
    "shaky-triangle": "shaky", "shaky-triangle-on-a-hinge": "shaky", "flat-parallelogram": "singular",
    "3-upu-snu": "singular", "kinematotropic-cranks": "singular",
}  # fmt: skip

MECHANISMS = names_of(Mechanism)


@cache
def found(name: str) -> Mobility:
    return mobility_of(load_any(name))


def answers(mobility: Mobility) -> dict[str, int | None]:
    return {
        "grubler": mobility.count,
        "mobility": mobility.mobility,
        "overconstraints": mobility.redundant,
        "output": None if mobility.output is None else mobility.output.freedoms,
        "idle": mobility.idle,
    }


def assert_expected(mechanism: Mechanism, mobility: Mobility) -> None:
    said = {key: value for key, value in answers(mobility).items() if key in mechanism.expected}
    assert said == dict(mechanism.expected)


def moved(mechanism: Mechanism, R, t, scale: float = 1.0) -> Mechanism:
    """The mechanism scaled, turned and shifted as a whole."""
    joints = tuple(
        replace(
            joint,
            at=None if joint.at is None else scale * (R @ joint.at) + t,
            axes=None if joint.axes is None else joint.axes @ R.T,
            pitch=scale * joint.pitch,
        )
        for joint in mechanism.joints
    )
    return replace(mechanism, joints=joints)


def shuffled(mechanism: Mechanism, rng: np.random.Generator) -> Mechanism:
    """The mechanism with its links, its joints, and the links of each joint in any order."""
    links = tuple(str(name) for name in rng.permutation(mechanism.links))
    joints = []
    for i in rng.permutation(len(mechanism.joints)):
        joint = mechanism.joints[i]
        if rng.random() < 0.5:
            axes = joint.axes[::-1] if joint.type == "universal" else joint.axes
            joint = replace(joint, links=joint.links[::-1], axes=axes)
        joints.append(joint)
    return replace(mechanism, links=links, joints=tuple(joints))


def anywhere(mechanism: Mechanism, rng: np.random.Generator, scale: float) -> Mechanism:
    """The mechanism in any order, scaled, and moved as far as its space lets it be."""
    R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    R *= np.sign(np.linalg.det(R))
    if mechanism.space == "planar":
        angle = rng.uniform(-np.pi, np.pi)
        R = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    t = scale * rng.normal(size=3) * np.array([1.0, 1.0, mechanism.space != "planar"])
    return moved(shuffled(mechanism, rng), R, t, scale)


def elsewhere(mobility: Mobility, rng: np.random.Generator) -> Mechanism:
    """The mechanism drawn at another configuration of its motion."""
    mechanism, assembly = mobility.mechanism, mobility.assembly
    linkage, state = assembly.linkage, mobility.motion.state
    for size in (0.2, 0.15, 0.1):
        first = state is mobility.motion.state
        kernel = mobility.motion.tangent if first else kernel_at(linkage, state)[1]
        direction = kernel @ rng.normal(size=kernel.shape[1])
        step = size * direction / np.max(np.abs(direction))
        after, _, lacking = linkage.closed(linkage.moved(state, step), 1e-15)
        if lacking < 1e-12:
            state = after
    points = np.array([joint.at for joint in mechanism.joints if joint.at is not None])
    middle = points.mean(axis=0)
    joints, at = [], 0
    for joint in mechanism.joints:
        elements = []
        while at < len(linkage.elements) and linkage.elements[at].name == joint.name:
            elements.append(linkage.elements[at])
            at += 1
        g = state.bodies[elements[0].a]
        axes = joint.axes
        if axes is not None:
            # The second axis of a universal joint is carried by the cross.
            bodies = [e.a for e in elements] if joint.type == "universal" else [elements[0].a] * len(axes)
            axes = np.array([state.bodies[b][:3, :3] @ axis for b, axis in zip(bodies, axes, strict=True)])
        place = None if joint.at is None else middle + g[:3, :3] @ (joint.at - middle) + assembly.size * g[:3, 3]
        joints.append(replace(joint, at=place, axes=axes))
    return replace(mechanism, joints=tuple(joints))


def test_the_table_s_mechanisms_are_there():
    assert set(TABLE) <= set(MECHANISMS)
    assert len(MECHANISMS) >= 7 + 36


@pytest.mark.parametrize("name", TABLE)
def test_the_file_is_the_table_s(name):
    mechanism = load_any(name)
    n, j, f, order, count, true, out = TABLE[name]
    assert len(mechanism.links) == n
    assert sum(joint.multiplicity for joint in mechanism.joints) == j
    assert sum(joint.freedoms * joint.multiplicity for joint in mechanism.joints) == f
    assert mechanism.order == order
    assert mechanism.expected["grubler"] == count == order * (n - j - 1) + f
    assert mechanism.expected["mobility"] == true
    assert mechanism.expected.get("output") == out
    if name in REDUNDANT:
        assert mechanism.expected["overconstraints"] == REDUNDANT[name]


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_file_agrees_with_itself(name):
    mechanism = load_any(name)
    said = mechanism.expected
    assert {"grubler", "mobility", "overconstraints"} <= set(said)
    freedoms = [joint.freedoms for joint in mechanism.joints for _ in range(joint.multiplicity)]
    n = len(mechanism.links)
    assert grubler(mechanism.order, n, freedoms) == grubler_by_constraints(mechanism.order, n, freedoms)
    assert grubler(mechanism.order, n, freedoms) == said["grubler"]
    # What a shaky structure cannot do is still a kernel of its constraints.
    tremble = 1 if VERDICTS.get(name) == "shaky" else 0
    assert said["mobility"] + tremble == said["grubler"] + said["overconstraints"]
    assert ("output" in said) == ("idle" in said) == bool(mechanism.output)
    if mechanism.output:
        assert said["idle"] == said["mobility"] - said["output"]


@pytest.mark.parametrize("name", sweep(MECHANISMS, 2))
def test_the_mobility_is_the_expected_one(name):
    mechanism, mobility = load_any(name), found(name)
    assert_expected(mechanism, mobility)
    usual = "right" if mobility.mobility == mobility.count else "exceptional"
    assert mobility.verdict == VERDICTS.get(name, usual)
    assert mobility.motion.instantaneous == INSTANTANEOUS.get(name, mobility.mobility)
    assert (mobility.note is None) == (mobility.verdict == "right")
    least, rest = mobility.motion.gap
    assert rest < 1e-14
    assert least == 0.0 or least > 1e-2


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@pytest.mark.parametrize("name", sweep(MECHANISMS, 4))
def test_neither_order_nor_size_nor_place_matters(name, scale):
    mechanism = load_any(name)
    other = anywhere(mechanism, np.random.default_rng(int(scale) + 7), scale)
    mobility = mobility_of(other, seed=3)
    assert_expected(mechanism, mobility)
    assert mobility.verdict == found(name).verdict
    assert mobility.motion.instantaneous == found(name).motion.instantaneous


def goes_elsewhere(name: str) -> bool:
    """Whether the file says how the mechanism moves on: a structure does not, contacts wander."""
    mechanism = entry(name)
    return mechanism.expected["mobility"] > 0 and not any(joint.type in CONTACTS for joint in mechanism.joints)


@pytest.mark.parametrize("name", sweep([name for name in MECHANISMS if goes_elsewhere(name)], 3))
def test_the_mobility_is_that_of_the_motion_not_of_the_pose(name):
    mechanism = load_any(name)
    other = elsewhere(found(name), np.random.default_rng(11))
    before = [joint.at for joint in mechanism.joints] + [joint.axes for joint in mechanism.joints]
    after = [joint.at for joint in other.joints] + [joint.axes for joint in other.joints]
    changes = [np.max(np.abs(a - b)) for a, b in zip(after, before, strict=True) if b is not None]
    assert max(changes) > 1e-3 * min(found(name).assembly.size, 1.0)
    mobility = mobility_of(other)
    assert_expected(mechanism, mobility)
    tremble = 1 if VERDICTS.get(name) == "shaky" else 0
    assert mobility.motion.instantaneous == mechanism.expected["mobility"] + tremble


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_usual_drives_hold_the_output(name):
    mobility = found(name)
    if mobility.actuated:
        assert mobility.output_undriven in (0, None)
        # A differential's pinion spins with its wheels: what does not move the output is driven, too.
        assert mobility.undriven == (0 if name == "bevel-differential" else mobility.idle or 0)


SETTINGS = [
    ("bennett", {"angle": "15"}), ("bennett", {"angle": "160", "alpha": "100"}), ("bennett", {"b": "0.3"}),
    ("goldberg-5r", {"angle": "40"}), ("goldberg-5r", {"c": "0.7", "angle": "110"}),
    ("bricard-octahedron", {"ax": "1.5", "cy": "-0.8"}), ("kaleidocycle", {"tilt": "60"}),
    ("kaleidocycle", {"lean": "-20"}), ("kaleidocycle", {"r": "1", "s": "2"}), ("miura-ori", {"theta": "75"}),
    ("miura-ori", {"gamma": "80", "a": "2"}), ("double-cardan", {"bend": "50", "turn": "10"}),
    ("dixon", {"a1": "0.6", "b3": "-1.7"}), ("sarrus", {"angle": "20"}), ("wedge", {"slope": "-50"}),
    ("parallel-four-bar-redundant", {"middle": "3"}), ("universal-joint-in-space", {"turn": "0"}),
    ("orthoglide", {"inset": "20"}), ("delta", {"angle": "45"}), ("3-upu", {"platform": "1.5"}),
    ("3-upu-snu", {"platform": "2"}), ("flat-parallelogram", {"crank": "3"}), ("peaucellier-lipkin", {"angle": "-25"}),
    ("jansen-leg", {"angle": "200"}), ("klann-leg", {"angle": "300"}), ("planetary-three-planets", {"sun": "5"}),
    ("burmester-focal", {"a": "4", "t2": "100"}), ("burmester-focal", {"b": "4.5", "t4": "320"}),
    ("dixon-second", {"a": "1.4", "d": "0.9"}), ("roberts-cognates", {"u": "1.3", "v": "-0.4"}),
    ("roberts-cognates", {"AD": "3", "Cy": "2"}), ("kinematotropic-cranks", {"r1": "0.4"}),
]  # fmt: skip


@pytest.mark.parametrize("name, values", SETTINGS, ids=[f"{name} {' '.join(values)}" for name, values in SETTINGS])
def test_what_is_special_is_in_the_expressions(name, values):
    """Other lengths and poses keep the mobility: no number in the file had to be just so."""
    mechanism = load_any(name, values)
    assert dict(mechanism.parameters) != dict(load_any(name).parameters)
    assert_expected(mechanism, mobility_of(mechanism))


@pytest.mark.parametrize("name, values, mobility", [
    ("bennett", {"beta": "40"}, 0), ("goldberg-5r", {"gamma": "30"}, 0),
    ("parallel-four-bar-detuned", {"excess": "0"}, 1), ("burmester-focal", {"s": "0.9"}, 0),
    ("roberts-cognates", {"C1x": "2"}, 0),
])  # fmt: skip
def test_what_is_special_can_be_spoiled(name, values, mobility):
    assert mobility_of(load_any(name, values)).mobility == mobility


# What makes the files special, from their joints.


def joints_of(name: str) -> dict:
    return {joint.name: joint for joint in load_any(name).joints}


def distance(joints, a: str, b: str) -> float:
    return float(np.linalg.norm(joints[a].at - joints[b].at))


def twist(joints, a: str, b: str) -> float:
    """The sine of the angle between two axes."""
    return float(np.linalg.norm(np.cross(joints[a].axes[0], joints[b].axes[0])))


def test_the_jansen_leg_has_jansen_s_lengths():
    joints = joints_of("jansen-leg")
    lengths = {
        ("axle", "M"): 15, ("M", "T"): 50, ("M", "K"): 61.9, ("pivot", "T"): 41.5, ("pivot", "D"): 40.1,
        ("T", "D"): 55.8, ("pivot", "K"): 39.3, ("D", "N"): 39.4, ("K", "N"): 36.7,
    }  # fmt: skip
    for (a, b), length in lengths.items():
        assert 1e3 * distance(joints, a, b) == pytest.approx(length, rel=1e-12)
    assert 1e3 * joints["pivot"].at == pytest.approx([-38, -7.8, 0], rel=1e-12)


def test_the_klann_leg_has_its_lengths():
    joints = joints_of("klann-leg")
    lengths = {"AC": 17.5, "BH": 23.7, "CF": 73.4, "CH": 38.8, "DE": 34.1, "EF": 57.7, "FH": 35.2}
    for (a, b), length in lengths.items():
        assert 1e3 * distance(joints, a, b) == pytest.approx(length, rel=1e-12)


@pytest.mark.parametrize("name, ring", [("bennett", "CBAD"), ("goldberg-5r", "ABFGD")])
def test_hinges_of_bennett_s_linkages_are_at_right_angles_to_their_links(name, ring):
    joints = joints_of(name)
    for a, b in zip(ring, ring[1:] + ring[0], strict=True):
        link = joints[b].at - joints[a].at
        assert max(abs(link @ joints[a].axes[0]), abs(link @ joints[b].axes[0])) < 1e-14


def test_bennett_s_ratio():
    joints = joints_of("bennett")
    assert distance(joints, "D", "C") == pytest.approx(distance(joints, "A", "B"), rel=1e-14)
    assert distance(joints, "C", "B") == pytest.approx(distance(joints, "D", "A"), rel=1e-14)
    ratio = distance(joints, "D", "C") / twist(joints, "D", "C")
    for a, b in ("CB", "BA", "AD"):
        assert distance(joints, a, b) / twist(joints, a, b) == pytest.approx(ratio, rel=1e-13)
    assert twist(joints, "C", "B") == pytest.approx(np.sin(load_any("bennett").parameters["beta"] * np.pi / 180))


def test_goldberg_s_linkage_is_made_of_two_of_bennett_s():
    joints = joints_of("goldberg-5r")
    values = load_any("goldberg-5r").parameters
    ratio = values["a"] / np.sin(np.radians(values["alpha"]))
    for (a, b), length in {"AB": values["a"], "FG": values["a"], "GD": values["c"], "DA": values["b"]}.items():
        assert distance(joints, a, b) == pytest.approx(length, rel=1e-13)
        assert distance(joints, a, b) / twist(joints, a, b) == pytest.approx(ratio, rel=1e-13)
    assert distance(joints, "B", "F") == pytest.approx(values["b"] + values["c"], rel=1e-14)


def test_neighbours_in_a_kaleidocycle_are_at_right_angles():
    axes = [joint.axes[0] for joint in load_any("kaleidocycle").joints]
    assert max(abs(a @ b) for a, b in zip(axes, axes[1:] + axes[:1], strict=True)) < 1e-15


def velocity_at(name: str, link: str, point) -> np.ndarray:
    """The velocity (3,) of a point of a link in the mechanism's one motion, at the configuration drawn."""
    mobility = found(name)
    assembly = mobility.assembly
    linkage = assembly.linkage
    middle = np.mean([joint.at for joint in mobility.mechanism.joints], axis=0)
    speeds = kernel_at(linkage, linkage.reference)[1]
    body = linkage.body_twists(linkage.reference, speeds)[assembly.link(link)][:, 0]
    return body[:3] + np.cross(body[3:], (point - middle) / assembly.size)


def test_peaucellier_s_corner_moves_across_the_line_of_the_pivots():
    joints = joints_of("peaucellier-lipkin")
    v = velocity_at("peaucellier-lipkin", "bar AD", joints["D"].at)
    assert abs(v[0]) < 1e-14 < 1e-2 < abs(v[1])


def test_hart_s_point_moves_across_the_line_of_the_pivots():
    joints = joints_of("hart-inversor")
    ratio = load_any("hart-inversor").parameters["ratio"]
    # O divides 1-4, P 1-2 and Q 3-4 in one ratio.
    bars = {"O": "14", "P": "12", "Q": "34"}
    point = {n: joints[a].at + ratio * (joints[b].at - joints[a].at) for n, (a, b) in bars.items()}
    assert np.allclose(point["O"], joints["O"].at, atol=1e-15)
    assert np.allclose(point["P"], joints["P"].at, atol=1e-15)
    v = velocity_at("hart-inversor", "long 2", point["Q"])
    along = joints["O"].at - joints["M"].at
    assert abs(v @ along) < 1e-14 < 1e-2 < np.linalg.norm(v)


@pytest.mark.parametrize("name, first, last", [
    ("double-cardan", "first shaft", "last shaft"), ("oldham-coupling", "first shaft", "second shaft"),
])  # fmt: skip
def test_couplings_that_turn_at_one_speed(name, first, last):
    mobility = found(name)
    twists = mobility.assembly.linkage.body_twists(mobility.motion.state, mobility.motion.tangent)
    speeds = [twists[mobility.assembly.link(link)][3:, 0] for link in (first, last)]
    assert np.linalg.norm(speeds[0]) > 0.1
    assert np.allclose(*speeds, atol=1e-12)


def test_the_gears_turn_as_their_radii_say():
    """Willis: the carrier of a train with a fixed ring turns sun / (sun + ring) as fast as the sun."""
    for name in ("planetary", "planetary-three-planets"):
        mobility = found(name)
        radii = mobility.mechanism.parameters
        twists = mobility.assembly.linkage.body_twists(mobility.motion.state, mobility.motion.tangent)
        speed = {link: twists[mobility.assembly.link(link)][5, 0] for link in ("sun", "carrier")}
        ring = radii["sun"] + 2 * radii["planet"]
        assert speed["carrier"] / speed["sun"] == pytest.approx(radii["sun"] / (radii["sun"] + ring), rel=1e-12)


@pytest.mark.parametrize("name, kind", [
    ("delta", "translation in space"), ("delta-with-bars", "translation in space"),
    ("tripteron", "translation in space"), ("orthoglide", "translation in space"),
    ("3-upu", "translation in space"), ("sarrus", "translation along a line"),
    ("scissor-lift", "translation along a line"), ("wedge", "translation along a line"),
    ("agile-eye", "rotation about a point"), ("3-rrr", "planar: translation in a plane and rotation about its normal"),
])  # fmt: skip
def test_what_the_outputs_do(name, kind):
    assert found(name).output.kind == kind


def test_the_puma_is_the_puma_of_the_library():
    """Its hinges are where the D-H table puts them at q = (0, q2, q3, 0, q5, 0)."""
    mechanism, robot = load_any("puma560-mechanism"), robokin.load("puma560")
    q = np.radians([0.0, mechanism.parameters["q2"], mechanism.parameters["q3"], 0.0, mechanism.parameters["q5"], 0.0])
    frames = robokin.link_frames(robot, q)
    for joint, T in zip(mechanism.joints, frames, strict=False):
        assert np.allclose(T[:3, 2], joint.axes[0], atol=1e-14)
        # Where along its axis a hinge is does not matter.
        assert np.allclose(np.cross(joint.at - T[:3, 3], T[:3, 2]), 0, atol=1e-14)
