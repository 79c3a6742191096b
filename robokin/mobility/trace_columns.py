"""The columns of a trace: what each joint's values are called, and what they are measured from."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.mobility.assembly import Assembly
from robokin.mobility.linkage import LinkageState
from robokin.mobility.pins import from_first, pairs
from robokin.mobility.screws import logarithm


def labels_of(assembly: Assembly, names: list[str]) -> tuple[str, ...]:
    """A name for each freedom: the joint's, with a number where it has several."""
    labels = []
    for number, name in enumerate(names):
        count = int(np.sum(assembly.own == number))
        labels += [name] if count == 1 else [f"{name}.{k + 1}" for k in range(count)]
    return tuple(labels)


def of_pins(assembly: Assembly, values: Array) -> Array:
    """The values (m, f) with those of hinges that pin several links measured from the first link that is listed."""
    links = [tuple(assembly.mechanism.links.index(name) for name in joint.links) for joint in assembly.mechanism.joints]
    for number, (own, joined) in enumerate(zip(links, pairs(links), strict=True)):
        (columns,) = np.nonzero(assembly.own == number)
        if len(own) > 2 and len(columns) == len(joined):
            values[:, columns] = values[:, columns] @ from_first(own, joined).T
    return values


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
