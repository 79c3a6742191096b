"""The real ways to place a pair of bodies, and how much a pair lacks of closing."""

from __future__ import annotations

import numpy as np

from robokin.assembly.planar_groups import Dyad, Pose, dyad_poses
from robokin.errors import InputError

REAL = 1e-6
"""A turn whose size is off 1 by less is real: two ways that fall together miss it by the root of rounding."""

SAME = 1e-6
"""Turns and places (in the mechanism's size) nearer than this are one way, which is double."""


class Gaps:
    """By how little the mechanism missed being assembled: the least gap of all branches, in words."""

    def __init__(self) -> None:
        self.least = np.inf
        self.words = ""

    def note(self, gap: float, words: str) -> None:
        """Keep the least gap [m]."""
        if gap < self.least:
            self.least, self.words = gap, words


def pair_ways(
    dyad: Dyad, known: dict[int, Pose], size: float, gaps: Gaps, names: list[str]
) -> list[tuple[Pose, Pose, bool]]:
    """The real ways to place a pair, each with whether it is double; the gap is noted where there is none."""
    _check_free(dyad, known, size, names)
    found, _ = dyad_poses(dyad, known)
    if any(not np.all(np.isfinite([pose.u, pose.t])) for pair in found for pose in pair):
        raise InputError(
            f"joints {dyad.first.name}, {dyad.middle.name} and {dyad.last.name} slide in parallel, so that nothing "
            "places their links, expected other directions"
        )
    if len(found) == 2:
        pairs = [[pose.u[0] for pose in pair] for pair in found]
        if any(abs(abs(u) - 1.0) > REAL for turns in pairs for u in turns):
            gap, words = _gap(dyad, known, names)
            gaps.note(gap, words)
            return []
        if max(abs(u / abs(u) - w / abs(w)) for u, w in zip(*pairs, strict=True)) < SAME:
            return [(*_real(found[0], found[1]), True)]
    return [(*_real(pair, pair), False) for pair in found]


def _real(one: tuple[Pose, Pose], other: tuple[Pose, Pose]) -> tuple[Pose, Pose]:
    """Real poses half way between two complex ones."""
    poses = []
    for p, q in zip(one, other, strict=True):
        u = p.u / abs(p.u) + q.u / abs(q.u)
        u = u / abs(u)
        # Origins of real poses are the conjugates' conjugates: what is left of the imaginary part is rounding.
        t = 0.25 * (p.t + p.c.conjugate() + q.t + q.c.conjugate())
        poses.append(Pose(u, u.conjugate(), t, t.conjugate()))
    return poses[0], poses[1]


def _check_free(dyad: Dyad, known: dict[int, Pose], size: float, names: list[str]) -> None:
    """Raise InputError where the pair may turn freely: all of its equation vanishes."""
    if dyad.linear:
        return
    _, numbers = dyad_poses(dyad, known)
    scale = size if (dyad.first.slides or dyad.last.slides or dyad.middle.slides) else size * size
    folded = max(float(np.max(np.abs(number))) for number in numbers) < 1e-12 * scale
    # A link without length between two hinges turns freely.
    short = not dyad.middle.slides and any(
        not edge.slides and abs(dyad.middle.at(body) - edge.at(body)) < 1e-12 * size
        for edge, body in ((dyad.first, dyad.a), (dyad.last, dyad.b))
    )
    if folded or short:
        raise InputError(
            f"{names[dyad.a]} and {names[dyad.b]} fold onto one another, so that they are free to turn together, "
            "expected another value or other lengths"
        )


def _gap(dyad: Dyad, known: dict[int, Pose], names: list[str]) -> tuple[float, str]:
    """How much a pair lacks of closing [m], and in words with the length in metres between @ signs."""
    pair = f"{names[dyad.a]} and {names[dyad.b]}"
    hinged = [edge for edge in (dyad.first, dyad.last) if not edge.slides]
    ends = []
    for edge, body in ((dyad.first, dyad.a), (dyad.last, dyad.b)):
        ends.append(None if edge.slides else complex(known[edge.other(body)].point(edge.at(edge.other(body)))[0][0]))
    lengths = [abs(dyad.middle.at(dyad.a) - dyad.first.at(dyad.a)), abs(dyad.middle.at(dyad.b) - dyad.last.at(dyad.b))]
    if len(hinged) == 2 and not dyad.middle.slides:
        assert ends[0] is not None
        assert ends[1] is not None
        distance = abs(ends[1] - ends[0])
        far = distance - sum(lengths)
        if far > 0.0:
            words = (
                f"{dyad.first.name} and {dyad.last.name} are @{distance}@ apart, which {pair} with @{sum(lengths)}@ "
            )
            return far, words + f"do not reach by @{far}@"
        near = abs(lengths[0] - lengths[1]) - distance
        words = (
            f"{dyad.first.name} and {dyad.last.name} are @{distance}@ apart, which is too near for {pair} by @{near}@"
        )
        return near, words
    # A circle and a line that miss one another, or a hinge inside the circle that a slide passes at.
    if dyad.middle.slides:
        assert ends[0] is not None
        assert ends[1] is not None
        e, f = dyad.middle.way(dyad.a), dyad.middle.way(dyad.b)
        kappa = (dyad.middle.at(dyad.b) - dyad.last.at(dyad.b)) * e / f
        kappa -= dyad.middle.at(dyad.a) - dyad.first.at(dyad.a)
        lack = abs((kappa * e.conjugate()).imag) - abs(ends[1] - ends[0])
        return lack, f"{dyad.first.name} and {dyad.last.name} are too near for {pair} by @{lack}@"
    edge, body, link = (dyad.last, dyad.b, dyad.a) if dyad.last.slides else (dyad.first, dyad.a, dyad.b)
    guide = known[edge.other(body)]
    e = complex((guide.u * edge.way(edge.other(body)))[0])
    G = complex(guide.point(edge.at(edge.other(body)))[0][0])
    w = e / edge.way(body)
    P = ends[0] if ends[0] is not None else ends[1]
    assert P is not None
    offset = abs(((P - G - w * (dyad.middle.at(body) - edge.at(body))) * e.conjugate()).imag)
    reach = lengths[0] if link == dyad.a else lengths[1]
    lack = offset - reach
    words = f"{dyad.middle.name} is @{offset}@ beside the slide {edge.name}, which {names[link]} with @{reach}@ "
    return lack, words + f"does not reach by @{lack}@"
