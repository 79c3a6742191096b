"""Mechanisms of known freedom: branches, orders, what must not matter, and when a geometry is nearly special."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mobility import known
from mobility.linkages import bennett, four_bar, linkage, loop
from mobility.test_library import anywhere
from sweeps import sweep

from robokin.formats.library import load_any
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism, MechanismJoint

KNOWN = list(known.library_like())
SLOW = ("hexagon U-S", "hexagon S-S, aside", "square of legs")
"""Double branches take a second; the others of their kind are those of `benchmarks`."""
QUICK = [entry for entry in KNOWN if "hexagon" not in entry[0] and "legs" not in entry[0]]


def dimensions(found):
    return [size for size, _ in found.branches]


@pytest.mark.parametrize(
    "name, mechanism, branches",
    sweep([entry for entry in KNOWN if entry in QUICK or entry[0] in SLOW], 3),
    ids=[name for name, *_ in KNOWN if name in SLOW or name in [entry[0] for entry in QUICK]],
)
def test_the_freedom_is_the_known_one(name, mechanism, branches):
    found = mobility_of(mechanism)
    assert (found.mobility, dimensions(found)) == (branches[0], branches)
    assert found.motion.count == len(branches)
    if name in known.ORDERS:
        assert found.motion.order == known.ORDERS[name]
    if len(branches) > 1:
        assert found.verdict == "singular"
        assert f"{len(branches)} branches of configurations meet" in found.note
    elif found.motion.generic > found.mobility:
        assert found.verdict == "shaky"
    linkage_ = found.assembly.linkage
    assert np.max(np.abs(linkage_.lack(found.motion.state)), initial=0.0) < 1e-13, "the branch's point is assembled"
    assert np.max(np.abs(linkage_.jacobian(found.motion.state) @ found.motion.tangent), initial=0.0) < 1e-7


@pytest.mark.parametrize("name, mechanism, branches", sweep(QUICK, 3), ids=[name for name, *_ in QUICK])
def test_neither_order_nor_size_nor_place_nor_seed_matters(name, mechanism, branches):
    rng = np.random.default_rng(len(name))
    for scale, seed in ((1e-3, 7), (1e3, 3)):
        found = mobility_of(anywhere(mechanism, rng, scale), seed=seed)
        assert dimensions(found) == branches
        if name in known.ORDERS:
            assert found.motion.order == known.ORDERS[name]


def test_points_of_coupler_curves_leave_their_tangents_as_the_package_is_told():
    """The orders of the slots, by power series that the package does not know."""
    watt = [(-2.0, 0.5), (0.0, 0.5), (0.0, -0.5), (2.0, -0.5)]
    assert known.leaving(watt, (0.0, 0.0), (0.0, 1.0)) == 5
    for i in range(3):
        assert known.leaving(known.FOUR_BAR, *known.inflection_point(known.FOUR_BAR, 0.3 + 0.9 * i)) == 3
    assert known.leaving(known.FOUR_BAR, *known.ball_point(known.FOUR_BAR), order=8) == 4


@pytest.mark.parametrize("seed", range(12))
def test_a_coupler_point_in_a_slot_trembles_in_the_order_in_which_it_leaves_it(seed):
    rng = np.random.default_rng(seed)
    points = [tuple(np.array(p) + rng.uniform(-0.3, 0.3, 2)) for p in known.FOUR_BAR]
    P = tuple(rng.uniform(-1.0, 4.0, 2))
    velocity = known.coupler_series(points, P, 2)[1]
    axis = (velocity.real, velocity.imag)
    if seed % 3:
        P, axis = known.inflection_point(points, rng.uniform(0.0, np.pi))
    found = mobility_of(known.slotted(points, P, axis))
    assert (found.mobility, found.verdict) == (0, "shaky")
    assert found.motion.order == known.leaving(points, P, axis)


@pytest.mark.parametrize("seed", range(8))
def test_cranks_of_any_number_and_spacing_at_their_change_point(seed):
    rng = np.random.default_rng(seed)
    places = np.cumsum(rng.uniform(0.3, 3.0, int(rng.integers(3, 7))))
    found = mobility_of(known.cranks(places, rng.uniform(0.4, 2.5)))
    assert (found.mobility, dimensions(found), found.verdict) == (1, [1], "singular")
    slanted = [("R", names, (x + (0.6 if "b" in names else 0.0), 1.0 if "b" in names else 0.0))
               for x in places for names in (("0", f"c{x}"), (f"c{x}", "b"))]  # fmt: skip
    assert (mobility_of(linkage(slanted)).mobility, mobility_of(linkage(slanted)).motion.instantaneous) == (1, 1)


@pytest.mark.parametrize("seed, scale", [(2, 1e3), (5, 1.0), (3, 1e-3)])
def test_a_branch_beside_a_surface_is_not_lost_for_rounding(seed, scale):
    """Five equal legs: the swing of the platform is a surface, beside it there is one narrow way to twist and rise."""
    other = anywhere(
        known.hexagon("U", legs=5, radius=1.0, height=2.4), np.random.default_rng(seed), 10.0 ** (seed - 4)
    )
    assert dimensions(mobility_of(other)) == [2, 1]


@pytest.mark.parametrize("far", [0.0, 1e4, 1e8])
def test_a_spherical_mechanism_may_be_anywhere(far):
    axes = [(np.cos(a), np.sin(a), 0.0) for a in (0.0, 0.4, 0.9, 1.3)]
    rng = np.random.default_rng(4)
    R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    found = mobility_of(loop([(far * np.array([0.3, -0.7, 0.5]), R @ axis) for axis in axes], "spherical"))
    assert (found.mobility, found.motion.order) == (0, 2)


def test_branches_say_what_moves_in_them():
    """The folded Sarrus linkage: with its limbs in one another two hinges turn together, and one limb bends alone."""
    found = mobility_of(known.sarrus(0.0))
    (wide, most), (narrow, rest) = found.branches
    assert (wide, narrow) == (2, 1)
    assert set(most) | set(rest) == {joint.name for joint in found.mechanism.joints}
    kite = mobility_of(four_bar([(0, 0), (1, 0), (0, 0), (1, 0)]))
    assert {names for _, names in kite.branches} == {("0", "2"), ("1", "3")}


def test_the_output_s_motion_is_that_of_one_branch_whatever_the_order():
    """The coupler of the flat parallelogram slides on in one branch and turns in the other; the even one is first."""
    kinds = ["translation along a line", "rotation about an axis"]
    mechanism = load_any("flat-parallelogram")
    for seed in range(4):
        found = mobility_of(anywhere(mechanism, np.random.default_rng(seed), 10.0**seed))
        assert [output.kind for output in found.outputs] == kinds
        assert found.output.kind == kinds[0]
    snu = mobility_of(load_any("3-upu-snu"))
    assert snu.output.kind == "translation in space"
    assert dimensions(snu) == [3, 3]


# Contacts.


def joint(name, kind, links, at, axis=None):
    axes = None if axis is None else np.array([axis], dtype=float)
    freedoms = {"revolute": 1, "gear": 2, "cam": 2, "rolling": 1}[kind]
    return MechanismJoint(name, kind, links, freedoms, np.array([*at, 0.0]), axes)


FLAT = [("A", "ground", "crank", 0.0), ("B", "crank", "coupler", 1.0), ("C", "coupler", "rocker", 4.0),
        ("D", "rocker", "ground", 3.0)]  # fmt: skip
Z = (0.0, 0.0, 1.0)


def flat_parallelogram(*more):
    joints = [joint(name, "revolute", (a, b), (x, 0.0), Z) for name, a, b, x in FLAT] + list(more)
    links = dict.fromkeys(["ground", *(link for each in joints for link in each.links)])
    return Mechanism("flat", "planar", tuple(links), tuple(joints), "ground")


def test_a_contact_elsewhere_hides_nothing():
    wheels = (joint("E", "revolute", ("ground", "sun"), (9.0, 0.0), Z),
              joint("F", "revolute", ("ground", "wheel"), (12.0, 0.0), Z))  # fmt: skip
    gear = joint("G", "gear", ("sun", "wheel"), (10.0, 0.0), (0, 1, 0))
    found = mobility_of(flat_parallelogram(*wheels, gear))
    assert (found.verdict, found.mobility, dimensions(found)) == ("singular", 2, [2, 2])
    cam = joint("G", "cam", ("sun", "wheel"), (10.0, 0.3), (0.1, 1, 0))
    found = mobility_of(flat_parallelogram(*wheels, cam))
    assert (found.verdict, found.mobility, found.wandering) == ("singular", 2, ("G",))
    # A gear that holds a wheel to what stands still takes the freedom of the wheel.
    found = mobility_of(flat_parallelogram(wheels[0], joint("G", "gear", ("sun", "ground"), (10.0, 0.0), (0, 1, 0))))
    assert (found.verdict, found.mobility, found.motion.instantaneous) == ("singular", 1, 2)


def test_gears_on_one_carrier_couple_as_the_geometry_goes():
    """Cranks of a flat parallelogram geared to turn alike: only the parallelogram is left. Geared to turn against each
    other, only the antiparallelogram could be, whose cranks do not turn at one ratio."""
    turn_against = joint("G", "gear", ("crank", "rocker"), (1.5, 0.0), (0, 1, 0))
    found = mobility_of(flat_parallelogram(turn_against))
    assert (found.mobility, found.verdict) == (0, "shaky")
    idler = (joint("E", "revolute", ("ground", "idler"), (1.5, 0.0), Z),
             joint("G", "gear", ("crank", "idler"), (1.0, 0.0), (0, 1, 0)),
             joint("H", "gear", ("idler", "rocker"), (2.0, 0.0), (0, 1, 0)))  # fmt: skip
    found = mobility_of(flat_parallelogram(*idler))
    assert (found.mobility, dimensions(found)) == (1, [1])


# Nearly.


def described(tmp_path, joints, space="planar"):
    """A mechanism as typed: joints (type, links, the rest of the line)."""
    links = dict.fromkeys(link for _, names, _ in joints for link in names)
    lines = [
        f"  - {{name: J{i}, type: {kind}, links: [{a}, {b}], {rest}}}" for i, (kind, (a, b), rest) in enumerate(joints)
    ]
    path = tmp_path / "typed.yaml"
    head = f"robokin: 1\nname: typed\nspace: {space}\nunits: {{length: m, angle: deg}}\nlinks: [{', '.join(links)}]\n"
    path.write_text(head + "joints:\n" + "\n".join(lines) + "\n")
    return mobility_of(load_any(str(path)))


R = "revolute"


def braced(middle, height="1.732"):
    """A parallel four-bar with a third crank whose end on the coupler is at `middle`; 2.5 would be right."""
    places = {("g", "a"): "0, 0", ("a", "b"): f"1, {height}", ("b", "c"): f"5, {height}", ("c", "g"): "4, 0",
              ("b", "d"): f"{middle}, {height}", ("d", "g"): "1.5, 0"}  # fmt: skip
    return [(R, links, f"at: [{place}]") for links, place in places.items()]


@pytest.mark.parametrize("middle, verdict", [
    ("2.5", "exceptional"), ("2.501", "nearly"), ("2.51", "nearly"), ("2.6", "right"), ("2.510", "right"),
    ("2.5 + 1e-3", "right"),
])  # fmt: skip
def test_nearly_is_what_a_unit_in_the_last_place_explains(tmp_path, middle, verdict):
    assert described(tmp_path, braced(middle)).verdict == verdict


@pytest.mark.parametrize("digits", [3, 4, 6])
@pytest.mark.parametrize("name", ["bennett", "goldberg-5r", "miura-ori"])
def test_rounded_coordinates_of_what_moves_are_nearly(tmp_path, name, digits):
    mechanism = load_any(name)
    number = {link: f"l{i}" for i, link in enumerate(mechanism.links)}

    def text(vector):
        return "[" + ", ".join(f"{x:.{digits}f}" for x in vector) + "]"

    joints = [(each.type, [number[link] for link in each.links], f"at: {text(each.at)}, axis: {text(each.axes[0])}")
              for each in mechanism.joints]  # fmt: skip
    found = described(tmp_path, joints, "spatial")
    assert (found.verdict, found.mobility, found.nearly) == ("nearly", 0, 1)


def test_exact_dimensions_that_happen_to_be_near_are_not_nearly(tmp_path):
    far = [(R, "ga", "at: [0, 0]"), (R, "ab", "at: [1, 2]"), (R, "bc", "at: [4, 3]"), (R, "cg", "at: [5, 0.5]"),
           (R, "gd", "at: [7, 0]"), (R, "de", "at: [7.005, 0.01]"), (R, "ef", "at: [7.018, 0.014]"),
           (R, "fg", "at: [7.02, 0.002]")]  # fmt: skip
    assert (described(tmp_path, far).verdict, described(tmp_path, far).mobility) == ("right", 2)
    for height in ("0.001", "0.0010", "0.002"):
        truss = [(R, "ga", "at: [0, 0]"), (R, "ab", f"at: [1, {height}]"), (R, "bg", "at: [2, 0]")]
        assert (described(tmp_path, truss).verdict, described(tmp_path, truss).mobility) == ("right", 0)
    for pitches in (("0.1", "0.2", "0.3", "0.15"), ("0.001", "0.002", "0.003", "0.0015")):
        places = ((0, 0), (2, 0), (2, 1), (0, 1.5))
        screws = [("helical", (f"l{i}", f"l{(i + 1) % 4}"), f"at: [{x}, {y}, 0], axis: [0, 0, 1], pitch: {pitch}")
                  for i, ((x, y), pitch) in enumerate(zip(places, pitches, strict=True))]  # fmt: skip
        assert (described(tmp_path, screws, "spatial").verdict) == "right"


def test_parameters_carry_their_rounding():
    for beta, verdict in (("40.505", "nearly"), ("40.51", "nearly"), ("40.4", "right")):
        assert mobility_of(load_any("bennett", {"beta": beta})).verdict == verdict
    assert mobility_of(bennett(1e-4)).verdict == "nearly", "what a program has calculated may be off"


# Whatever comes.


def generated(rng):
    """A mechanism without a plan: points of a coarse grid or none, all joints, loops, contacts anywhere."""
    space = str(rng.choice(["planar", "planar", "spatial"]))
    n, more = int(rng.integers(3, 8)), int(rng.integers(1, 4))
    points = rng.integers(0, 3, (n + more, 3)).astype(float) if rng.random() < 0.7 else rng.normal(size=(n + more, 3))
    pairs = [(i, int(rng.integers(0, i))) for i in range(1, n)]
    pairs += [tuple(int(x) for x in rng.choice(n, 2, replace=False)) for _ in range(more)]
    kinds = {"planar": ["revolute"] * 6 + ["prismatic", "gear", "cam", "rolling", "planar", "fixed"],
             "spatial": ["revolute"] * 4 + ["prismatic", "helical", "cylindrical", "universal", "spherical", "planar",
                                            "fixed"]}[space]  # fmt: skip
    freedoms = {"cylindrical": 2, "universal": 2, "spherical": 3, "planar": 3, "fixed": 0, "gear": 2, "cam": 2}
    joints = []
    for i, (a, b) in enumerate(pairs):
        kind = str(rng.choice(kinds))
        place = points[rng.integers(0, len(points))].copy()
        axis = rng.integers(-1, 2, 3) + np.array([0.0, 0.0, 1e-3])
        if space == "planar":
            place[2] = 0.0
            axis = np.array([*axis[:2], 0.0]) if kind in ("prismatic", "gear", "cam") else np.array(Z)
            axis = axis if np.any(axis) else np.array([1.0, 0.0, 0.0])
        axis = axis / np.linalg.norm(axis)
        axes = np.array([axis, np.roll(axis, 1) + np.array([0.3, 0.1, 0.0])]) if kind == "universal" else axis[None]
        axes = axes / np.linalg.norm(axes, axis=1)[:, None]
        joints.append(MechanismJoint(str(i), kind, (f"l{a}", f"l{b}"), freedoms.get(kind, 1), place, axes, 0.1))
    return Mechanism("generated", space, tuple(f"l{i}" for i in range(n)), tuple(joints), "l0")


@pytest.mark.slow
def test_whatever_is_drawn_has_an_answer_that_no_order_and_no_size_changes():
    for seed in range(150):
        mechanism = generated(np.random.default_rng(seed))
        found = mobility_of(mechanism)
        if found.motion is None:
            continue
        assert found.mobility is None or 0 <= found.mobility <= found.motion.instantaneous
        assert found.mobility is None or found.mobility >= found.count or found.verdict != "right"
        other = mobility_of(anywhere(mechanism, np.random.default_rng(seed), 1e-3 if seed % 2 else 1e3))
        assert (other.mobility, other.motion.instantaneous) == (found.mobility, found.motion.instantaneous)
        assert sorted(dimensions(other)) == sorted(dimensions(found))


def test_a_joint_in_many_places_at_once_has_an_answer():
    """All hinges in one point: each but one turns, by links of no length."""
    spun = mobility_of(four_bar([(0, 0)] * 4))
    assert (spun.mobility, spun.motion.instantaneous) == (3, 3)
    line = [MechanismJoint(str(i), "prismatic", (str(i), str((i + 1) % 3)), 1, None, np.array([[1.0, 0, 0]]))
            for i in range(3)]  # fmt: skip
    assert mobility_of(Mechanism("slides", "planar", ("0", "1", "2"), tuple(line), "0")).mobility == 2
    assert mobility_of(replace(four_bar([(0, 0)] * 4), space="spatial")).mobility == 3
