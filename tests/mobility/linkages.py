"""Mechanisms made of a few numbers."""

from __future__ import annotations

import numpy as np

from robokin.model import Mechanism, MechanismJoint

Z = (0.0, 0.0, 1.0)
TYPES = {"R": ("revolute", 1), "P": ("prismatic", 1), "S": ("spherical", 3), "U": ("universal", 2),
         "C": ("cylindrical", 2), "H": ("helical", 1), "E": ("planar", 3)}  # fmt: skip


def unit(vector):
    return np.array(vector, dtype=float) / np.linalg.norm(vector)


def linkage(joints, space="planar", actuated=()):
    """A mechanism of joints (letter, links, at, axis …); its ground is link "0", its joints are 0, 1, …"""
    links = dict.fromkeys(["0", *(link for _, names, *_ in joints for link in names)])
    made = []
    for i, (letter, names, at, *axes) in enumerate(joints):
        kind, f = TYPES[letter]
        directions = [unit(axis) for axis in axes or ([Z] if letter not in "SP" else [])]
        made.append(
            MechanismJoint(
                str(i), kind, tuple(names), f, None if at is None else np.append(at, [0.0])[:3],
                np.array(directions) if directions else None, 0.1 if letter == "H" else 0.0, i in actuated,
            )
        )  # fmt: skip
    return Mechanism("a linkage", space, tuple(links), tuple(made), "0")


def loop(axes, space="spatial"):
    """A ring of hinges (point, axis)."""
    n = len(axes)
    return linkage([("R", (str(i), str((i + 1) % n)), p, z) for i, (p, z) in enumerate(axes)], space)


def four_bar(points):
    """A planar ring of hinges at points."""
    return loop([(np.array([*p, 0.0]), Z) for p in points], "planar")


def slider_crank(r=1.0, rod=3.0, angle=0.8):
    """A crank at the origin and a slider on the x axis."""
    B = r * np.array([np.cos(angle), np.sin(angle)])
    C = np.array([B[0] + np.sqrt(rod**2 - B[1] ** 2), 0.0])
    return linkage(
        [("R", "01", (0.0, 0.0)), ("R", "12", B), ("R", "23", C), ("P", "30", C, (1.0, 0.0, 0.0))], actuated=[0]
    )


def bennett(wrong=0.0):
    """Bennett's linkage: links of lengths 1 and 0.7 in turn, twists of 50° and the angle whose sine is 0.7 of its;
    the axes off by about `wrong`, in directions drawn at random once and for all."""
    a, b, alpha, first = 1.0, 0.7, np.radians(50.0), np.radians(70.0)
    beta = np.arcsin(b * np.sin(alpha) / a)
    second = 2.0 * np.arctan(np.sin((beta + alpha) / 2) / np.sin((beta - alpha) / 2) / np.tan(first / 2))
    T, axes = np.eye(4), []
    for theta, length, twist in ((first, a, alpha), (second, b, beta), (-first, a, alpha), (-second, b, beta)):
        axes.append((T[:3, 3], T[:3, 2]))
        c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(twist), np.sin(twist)
        T = T @ [[c, -s * ca, s * sa, length * c], [s, c * ca, -c * sa, length * s], [0, sa, ca, 0], [0, 0, 0, 1]]
    assert np.allclose(T, np.eye(4), atol=1e-14)
    rng = np.random.default_rng(3)
    return loop([(p, unit(z + wrong * rng.normal(size=3))) for p, z in axes])


def generic_loop(count, seed=0):
    """A ring of hinges without anything special."""
    rng = np.random.default_rng(seed)
    return loop([(rng.normal(size=3), rng.normal(size=3)) for _ in range(count)])


def chain_of_four_bars(count):
    """Planar four-bars, each standing on the coupler of the one before: 3 count + 1 links."""
    joints = []
    for k in range(count):
        base = "0" if k == 0 else f"b{k - 1}"
        x, y = 3.0 * k, 2.0 * k
        joints += [
            ("R", (base, f"a{k}"), (x, y)),
            ("R", (f"a{k}", f"b{k}"), (x + 0.2, y + 2.0)),
            ("R", (f"b{k}", f"c{k}"), (x + 2.5, y + 2.3)),
            ("R", (f"c{k}", base), (x + 2.0, y)),
        ]
    return linkage(joints)
