"""The gallery: everything in the library by what it is, with a picture each."""

from __future__ import annotations

import html
from typing import Any

from website.thumbnails import HEIGHT, WIDTH

ARMS = {
    "lectures": "Arms of lectures and papers",
    "six": "Arms of six joints",
    "seven": "Arms of seven joints and more",
    "fewer": "Arms of five joints and fewer",
    "scara": "SCARA arms",
    "hands": "Hands, and bodies with two arms",
}

GROUPS = {
    **ARMS,
    "planar": "Planar mechanisms",
    "spatial": "Mechanisms in space",
    "spherical": "Spherical mechanisms",
    "bases": "Bases on wheels",
}
"""Groups by a word, in order, with their headings."""

FILTER = """<p class="filter"><label for="wanted">Find in the gallery</label>
<input id="wanted" type="search" autocomplete="off" placeholder="a name, a maker, a class, joints such as RRPR">
<span id="found" role="status"></span></p>"""


def group_of(entry: dict[str, Any], lectures: dict[str, str]) -> str:
    """The group that an entry is in."""
    if entry["kind"] == "wheeled":
        return "bases"
    if entry["kind"] == "mechanism":
        return str(entry["space"])
    if entry["folder"] == "hands" or entry["kind"] == "tree":
        return "hands"
    if any(who in entry["source"] for who in lectures):
        return "lectures"
    if entry["class"] == "SCARA":
        return "scara"
    count = int(entry["joints"].partition(":")[0])
    return "seven" if count > 6 else "six" if count == 6 else "fewer"


def gallery_text(entries: list[dict[str, Any]], lectures: dict[str, str]) -> str:
    """The gallery's page in Markdown."""
    groups: dict[str, list[dict[str, Any]]] = {word: [] for word in GROUPS}
    for entry in sorted(entries, key=lambda entry: (entry["name"].casefold(), entry["id"])):
        groups[group_of(entry, lectures)].append(entry)
    lines = [
        "# Gallery",
        f"The library has {len(entries)} robots, mechanisms and bases, each with its source. `robokin list` has the "
        "same in the shell; every name works in every command. Pictures show the pose `home`, or all joints at zero.",
        FILTER,
    ]
    for word, group in groups.items():
        if not group:
            continue
        cards = "\n".join(card(entry) for entry in group)
        lines += [f"({word})=\n## {GROUPS[word]}", f'<ul class="cards">\n{cards}\n</ul>']
    return "\n\n".join(lines) + "\n"


def card(entry: dict[str, Any]) -> str:
    """An entry's picture and name, which lead to its page."""
    words = " ".join(
        str(entry[key] or "") for key in ("id", "name", "description", "class", "space", "joints", "source")
    )
    return (
        f'<li data-words="{html.escape(words.casefold())}"><a href="{entry["id"]}.html">'
        f'<img src="pictures/{entry["id"]}.png" alt="" width="{WIDTH}" height="{HEIGHT}" loading="lazy">'
        f'<span class="name">{html.escape(entry["name"])}</span>'
        f"<code>{html.escape(entry['id'])}</code></a></li>"
    )
