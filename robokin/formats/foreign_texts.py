"""What a text is that is no description but something that is often mistaken for one."""

from __future__ import annotations

import re

XML = re.compile(r"\s*<(?!<)[\w!?]")

ROOTS = {
    "<robot": ("a URDF", ".urdf or .xacro"),
    "xacro:": ("a xacro file", ".xacro"),
    "<mujoco": ("an MJCF file", ".xml"),
    "<sdf": ("an SDF file", ".sdf"),
    "<COLLADA": ("a COLLADA file", ""),
    "<html": ("a web page", ""),
}
"""What an XML file is that has this in it, and with which ending it would be read as that."""

START = 4096
"""Characters in which a file says what it is."""

ROWS = (
    "expected YAML: `robokin: 1`, `name: …`, `joints:` and a line `- {type: R, d: …, a: …, alpha: …}` for each row, "
    "which `robokin new FILE --table TABLE` makes of it"
)


def other_format(text: str) -> str:
    """A sentence on the format that a text is in, or "" for none that is known."""
    start = text[:START]
    if XML.match(start):
        kinds = (kind for root, kind in ROOTS.items() if root.lower() in start.lower())
        kind, ending = next(kinds, ("XML", ""))
        return f"found {kind}, expected YAML" + (f", or a file that is called {ending}" if ending else "")
    lines = [line for line in start.splitlines() if line.strip()][:2]
    if lines and lines[0].lstrip().startswith("|") and lines[0].count("|") > 2:
        return f"found a table in Markdown, {ROWS}"
    if re.match(r"\s*\\(begin|documentclass|hline)\b", start):
        return f"found LaTeX, {ROWS}"
    for separator in (",", ";", "\t"):
        counts = [line.count(separator) for line in lines]
        if counts and min(counts) >= 2 and not any(sign in line for line in lines for sign in (": ", "{", "[")):
            return f"found a table in CSV, {ROWS}"
    return ""
