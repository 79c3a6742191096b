"""Ways to put planar mechanisms of given lengths together: all of them, and how much is lacking where there is none."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from robokin.assembly.assembly_modes import assemblies_of
from robokin.errors import InputError
from robokin.model.blueprint import BlueJoint, Blueprint


def four_bar(ground=100.0, crank=40.0, coupler=120.0, rocker=80.0, degrees=60.0):
    joints = (
        BlueJoint("A", "revolute", ("g", "crank"), (0j, 0j), value=math.radians(degrees)),
        BlueJoint("B", "revolute", ("crank", "coupler"), (crank + 0j, 0j)),
        BlueJoint("C", "revolute", ("coupler", "rocker"), (coupler + 0j, 0j)),
        BlueJoint("D", "revolute", ("rocker", "g"), (rocker + 0j, ground + 0j)),
    )
    return Blueprint(("g", "crank", "coupler", "rocker"), "g", joints)


def platform(A, T, L):
    """A plate with hinges T on bars of lengths L in hinges A of the ground: up to six ways."""
    joints = []
    for i in range(3):
        joints.append(BlueJoint(f"A{i}", "revolute", ("g", f"bar {i}"), (A[i], 0j)))
        joints.append(BlueJoint(f"T{i}", "revolute", (f"bar {i}", "plate"), (L[i] + 0j, T[i])))
    return Blueprint(("g", "bar 0", "bar 1", "bar 2", "plate"), "g", tuple(joints))


def lack(blueprint, mode):
    """What the joints of a way lack of closing, from each body's angle and one of its joints."""
    origin = {}
    for joint in blueprint.joints:
        for body, place in zip(joint.bodies, joint.places, strict=True):
            u = cmath.exp(1j * mode.angles[body])
            if joint.type == "revolute" and body not in origin:
                origin[body] = mode.places[joint.name] - u * place
    worst = 0.0
    for joint in blueprint.joints:
        u = [cmath.exp(1j * mode.angles[body]) for body in joint.bodies]
        if any(body not in origin for body in joint.bodies):
            continue
        points = [origin[body] + w * place for body, w, place in zip(joint.bodies, u, joint.places, strict=True)]
        gap = points[1] - points[0]
        if joint.type == "revolute":
            worst = max(worst, abs(gap))
        else:
            way = u[0] * cmath.exp(1j * joint.angles[0])
            turned = u[1] * cmath.exp(1j * joint.angles[1]) / way
            worst = max(worst, abs((gap * way.conjugate()).imag), abs(turned - 1.0))
    return worst


def test_a_four_bar_has_the_two_ways_of_two_circles():
    found = assemblies_of(four_bar())
    assert found.complete
    assert [mode.double for mode in found.modes] == [False, False]
    B = 40 * cmath.exp(1j * math.radians(60))
    # By hand: the circles of radius 120 about B and 80 about D = 100.
    d = 100 - B
    a = (abs(d) ** 2 + 120**2 - 80**2) / (2 * abs(d))
    h = math.sqrt(120**2 - a**2)
    for mode, side in zip(found.modes, (1, -1), strict=True):
        assert mode.places["C"] == pytest.approx(B + d / abs(d) * (a + side * 1j * h), abs=1e-10)
        assert lack(four_bar(), mode) < 1e-10


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"ground": 300.0}, ("do not reach", 300 * 1.0)), ({"coupler": 10.0, "rocker": 20.0}, ("do not reach", None)),
        ({"coupler": 300.0, "rocker": 20.0}, ("too near", None)),
    ],
)  # fmt: skip
def test_what_lacks_is_said(numbers, said):
    with pytest.raises(InputError, match=said[0]) as caught:
        assemblies_of(four_bar(**numbers))
    B = 40 * cmath.exp(1j * math.radians(60))
    size = {"ground": 100.0, "coupler": 120.0, "rocker": 80.0} | numbers
    distance = abs(size["ground"] - B)
    gap = distance - size["coupler"] - size["rocker"]
    if gap < 0:
        gap = abs(size["coupler"] - size["rocker"]) - distance
    told = [float(part) for part in str(caught.value).split("@")[1::2]]
    assert told[-1] == pytest.approx(gap)


@pytest.mark.parametrize(("coupler", "rocker"), [(20.0, 40.0), (140.0, 80.0), (1 / 3, 60 - 1 / 3)])
def test_a_dead_point_is_one_way_that_is_double(coupler, rocker):
    found = assemblies_of(four_bar(100.0, 40.0, coupler, rocker, 0.0))
    assert [mode.double for mode in found.modes] == [True]
    assert abs(found.modes[0].places["C"].imag) < 1e-6
    # A hair's breadth away there are two, or none.
    assert len(assemblies_of(four_bar(100.0, 40.0, coupler, rocker * (1 + 1e-9), 0.0)).modes) in (0, 2)


def test_folded_links_are_free():
    with pytest.raises(InputError, match="fold onto one another"):
        assemblies_of(four_bar(40.0, 40.0, 70.0, 70.0, 0.0))


def test_too_few_and_too_many_values():
    blueprint = four_bar()
    free = tuple(BlueJoint(j.name, j.type, j.bodies, j.places) for j in blueprint.joints)
    with pytest.raises(InputError, match="found 0 values, which leave 1 free, expected the `value` of 1 more joint"):
        assemblies_of(Blueprint(blueprint.bodies, "g", free))
    both = (*blueprint.joints[:3], BlueJoint("D", "revolute", ("rocker", "g"), (80 + 0j, 100 + 0j), value=1.0))
    with pytest.raises(InputError, match="1 more conditions than"):
        assemblies_of(Blueprint(blueprint.bodies, "g", both))


def newton_ways(A, T, L, rng, starts=600):
    """The ways of a platform on three bars that Newton's steps reach from many places: an independent count."""
    A, T, L = np.array(A), np.array(T), np.array(L)
    x = np.column_stack([rng.uniform(-np.pi, np.pi, starts), rng.uniform(-250, 250, (starts, 2))])
    for _ in range(60):
        u = np.exp(1j * x[:, :1])
        d = x[:, 1:2] + 1j * x[:, 2:] + u * T - A
        J = np.stack([2 * (d.conjugate() * 1j * u * T).real, 2 * d.real, 2 * d.imag], -1)
        step = np.linalg.solve(J + 1e-12 * np.eye(3), (L**2 - np.abs(d) ** 2)[..., None])[..., 0]
        x = x + step / np.maximum(1.0, np.abs(step[:, :1]) / 0.7)
    u = np.exp(1j * x[:, :1])
    closed = np.max(np.abs(np.abs(x[:, 1:2] + 1j * x[:, 2:] + u * T - A) - L), axis=1) < 1e-8
    ways = []
    for a, p, q in x[closed]:
        if all(abs(np.exp(1j * (a - b)) - 1) + abs(p - r) + abs(q - s) > 1e-4 for b, r, s in ways):
            ways.append((a, p, q))
    return len(ways)


def test_a_platform_on_three_bars_has_as_many_ways_as_newton_finds(rng):
    counts = []
    for _ in range(25):
        A = [complex(*rng.uniform(-100, 100, 2)) for _ in range(3)]
        T = [complex(*rng.uniform(-100, 100, 2)) for _ in range(3)]
        t, u = complex(*rng.uniform(-30, 30, 2)), cmath.exp(1j * rng.uniform(-3, 3))
        L = [abs(t + u * q - p) for p, q in zip(A, T, strict=True)]
        blueprint = platform(A, T, L)
        found = assemblies_of(blueprint)
        assert found.complete
        assert max(lack(blueprint, mode) for mode in found.modes) < 1e-8
        assert len(found.modes) == newton_ways(A, T, L, rng)
        counts.append(len(found.modes))
    assert {2, 4} <= set(counts) <= {2, 4, 6}


# Mechanisms made from a pose: that pose must be among the ways ---------------------------------------------------


def made(rng, pairs, cut, slides, scale):
    """A blueprint of bodies in poses drawn at random, and their turns: pairs of bodies, then a group that no pairs
    place."""
    pose, joints = {"g": (1 + 0j, 0j)}, []

    def body():
        name = f"b{len(pose)}"
        pose[name] = cmath.exp(1j * rng.uniform(-np.pi, np.pi)), scale * complex(*rng.uniform(-1, 1, 2))
        return name

    def joint(a, b, slide, valued=False):
        (u, t), (w, s) = pose[a], pose[b]
        place, way = scale * complex(*rng.uniform(-1, 1, 2)), rng.uniform(-np.pi, np.pi)
        slid = rng.uniform(-1, 1) * scale if slide else 0.0
        places = ((place - t) / u, (place + slid * cmath.exp(1j * way) - s) / w)
        angles = (way - cmath.phase(u), way - cmath.phase(w)) if slide else (0.0, 0.0)
        value = (slid if slide else cmath.phase(w / u)) if valued else None
        if rng.random() < 0.5 and not valued:
            a, b, places, angles = b, a, places[::-1], angles[::-1]
        joints.append(BlueJoint(f"j{len(joints)}", "prismatic" if slide else "revolute", (a, b), places, angles, value))

    def pair(x, y):
        a, b = body(), body()
        kinds = [rng.random() < slides for _ in range(3)]
        kinds[1] &= not (kinds[0] and kinds[2])
        for ends, slide in zip(((x, a), (a, b), (b, y)), kinds, strict=True):
            joint(*ends, slide)
        return b

    first = body()
    joint("g", first, rng.random() < slides, valued=True)
    for _ in range(pairs):
        pair(*rng.choice([*pose], 2))
    for _ in range(cut):
        old = [*pose]
        start = body()
        joint(str(rng.choice(old)), start, slide=False)
        last = pair(start, str(rng.choice(old)))
        rest = body()
        joint(last, rest, slide=False)
        joint(rest, str(rng.choice(old)), rng.random() < slides)
    order = rng.permutation(len(joints))
    return Blueprint(tuple(pose), "g", tuple(joints[i] for i in order)), pose


@pytest.mark.parametrize(("pairs", "cut"), [(1, 0), (2, 0), (3, 0), (0, 1), (1, 1)])
@pytest.mark.parametrize("slides", [0.0, 0.4])
def test_the_pose_that_a_mechanism_was_made_in_is_one_of_its_ways(pairs, cut, slides, rng):
    for _ in range(6):
        scale = 10.0 ** rng.uniform(-3, 3)
        blueprint, pose = made(rng, pairs, cut, slides, scale)
        try:
            found = assemblies_of(blueprint)
        except InputError as error:  # a bar drawn between bodies that hold one another already
            assert cut, str(error)
            assert "held twice" in str(error) or "hang together" in str(error), str(error)
            continue
        assert len(found.modes) <= 2**pairs * 6**cut
        assert max(lack(blueprint, mode) for mode in found.modes) < 1e-7 * scale
        assert any(
            all(abs(cmath.exp(1j * mode.angles[name]) - u) < 1e-6 for name, (u, _) in pose.items())
            for mode in found.modes
        )


def test_neither_place_nor_size_nor_order_matters(rng):
    blueprint, _ = made(rng, 1, 1, 0.3, 1.0)
    count = len(assemblies_of(blueprint).modes)
    for scale in (1e-3, 1e3):
        joints = [
            BlueJoint(j.name, j.type, j.bodies, tuple(scale * p for p in j.places), j.angles,
                      None if j.value is None else j.value * (scale if j.type == "prismatic" else 1.0))
            for j in blueprint.joints
        ]  # fmt: skip
        order = rng.permutation(len(joints))
        scaled = Blueprint(blueprint.bodies, "g", tuple(joints[i] for i in order))
        assert len(assemblies_of(scaled).modes) == count
