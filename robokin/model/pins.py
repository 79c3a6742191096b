"""Joints of many links as joints of two: which pairs, so that no loop goes through a link that only hangs there.

Statement. A joint that pins m links is m - 1 joints of two links; every tree over the links is the same joint. With a
link that no loop holds in the middle, all loops through the pin would go through it, and would be one block where there
are several. So the links are grouped by the loops that go through the pin: each group is a star about one of its links,
and the groups are joined by one pair each, through which no loop goes.

Model. Links and pins are the corners of a graph, and each link that a pin holds an edge. The groups of a pin are its
edges' biconnected components. In a group the link in the middle is one with which that component falls into most
blocks; if there are several, the first.
"""

from __future__ import annotations

from robokin.model.topology import components


def pairs(joints: list[tuple[int, ...]]) -> list[list[tuple[int, int]]]:
    """For each joint of links (two or more) the pairs of links that it joins, one fewer than it has links."""
    if all(len(links) == 2 for links in joints):
        return [[(links[0], links[1])] for links in joints]
    first = 1 + max(max(links) for links in joints)
    edges = [(link, first + number) for number, links in enumerate(joints) for link in links]
    group_of = {}
    for group in components(edges):
        for edge in group:
            group_of[edges[edge]] = [edges[other] for other in group]
    return [_tree(links, first + number, group_of) for number, links in enumerate(joints)]


def _tree(
    links: tuple[int, ...], pin: int, group_of: dict[tuple[int, int], list[tuple[int, int]]]
) -> list[tuple[int, int]]:
    """The pairs of the links of a pin: stars of the links in one component, the stars' middles joined."""
    if len(links) == 2:
        return [(links[0], links[1])]
    stars: list[list[int]] = []
    for link in links:
        star = next((s for s in stars if (link, pin) in group_of[s[0], pin]), None)
        if star is None:
            stars.append([link])
        else:
            star.append(link)
    middles = [_middle(star, pin, group_of[star[0], pin]) for star in stars]
    middle_of = {link: middle for star, middle in zip(stars, middles, strict=True) for link in star}
    joined = []
    for link in links:
        if link != middle_of[link]:
            joined.append((middle_of[link], link))
        elif link != middles[0]:
            joined.append((middles[0], link))
    return joined


def _middle(star: list[int], pin: int, edges: list[tuple[int, int]]) -> int:
    """The link of a star with which, put in the place of the pin, the component's edges are in most blocks."""

    def blocks(link: int) -> int:
        merged = [(link if a == pin else a, link if b == pin else b) for a, b in edges if (a, b) != (link, pin)]
        return len(components(merged))

    return max(star, key=blocks) if len(star) > 2 else star[0]
