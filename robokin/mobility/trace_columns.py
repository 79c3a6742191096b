"""The columns of a trace: what each joint's values are called, and what they are measured from."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.mobility.assembly import Assembly
from robokin.mobility.linkage import LinkageState
from robokin.spatial.twists import logarithm


def labels_of(assembly: Assembly, names: list[str]) -> tuple[str, ...]:
    """A name for each freedom: the joint's, with a number where it has several."""
    labels = []
    for number, name in enumerate(names):
        count = int(np.sum(assembly.own == number))
        labels += [name] if count == 1 else [f"{name}.{k + 1}" for k in range(count)]
    return tuple(labels)


def of_pins(assembly: Assembly, values: Array) -> Array:
    """The values (m, f) with those of hinges that pin several links measured from the first link that is listed."""
    mechanism = assembly.mechanism
    for number, joint in enumerate(mechanism.joints):
        joined = [(one.parent, one.child) for one in mechanism.graph.joints if one.row == number]
        (columns,) = np.nonzero(assembly.own == number)
        if len(joined) > 1 and len(columns) == len(joined):
            links = tuple(mechanism.links.index(name) for name in joint.links)
            values[:, columns] = values[:, columns] @ _from_first(links, joined).T
    return values


def _from_first(links: tuple[int, ...], joined: list[tuple[int, int]]) -> Array:
    """The matrix (m - 1, m - 1) from the turns of a pin's pairs to those of its links, in order, against the first."""
    ways = {links[0]: np.zeros(len(joined))}
    while len(ways) < len(links):
        for turn, (a, b) in zip(np.eye(len(joined)), joined, strict=True):
            if a in ways:
                ways.setdefault(b, ways[a] + turn)
            elif b in ways:
                ways[a] = ways[b] - turn
    return np.array([ways[link] for link in links[1:]])


def whole_rotations(assembly: Assembly, states: list[LinkageState], values: Array) -> Array:
    """The values with those of joints that turn about a point or move in a plane read off their displacements.

    Turns about different axes do not add: such a joint's values are the parts of its displacement's logarithm.
    """
    linkage = assembly.linkage
    for j, element in enumerate(linkage.elements):
        if len(element.screws) < 3:
            continue
        logs = logarithm(np.stack([state.joints[j] for state in states]))
        parts = np.linalg.lstsq(element.screws.T, logs.T, rcond=None)[0]
        values[:, linkage.joint == j] = parts.T
    return values
