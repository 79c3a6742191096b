"""What a text is that is no description but something that is often mistaken for one."""

from __future__ import annotations

import re

XML = re.compile(r"\s*<(?!<)[\w!?]")

ROOTS = {
    "<robot": "a URDF",
    "xacro:": "a xacro file",
    "<mujoco": "an MJCF file",
    "<sdf": "an SDF file",
    "<COLLADA": "a COLLADA file",
    "<html": "a web page",
}
"""What an XML file is that has this in it."""

START = 4096
"""Characters in which a file says what it is."""

ROWS = "expected YAML: `robokin: 1`, `name: …`, `joints:` and a line `- {type: R, d: …, a: …, alpha: …}` for each row"


def other_format(text: str) -> str:
    """A sentence on the format that a text is in, or "" for none that is known."""
    start = text[:START]
    if XML.match(start):
        kind = next((name for root, name in ROOTS.items() if root.lower() in start.lower()), "XML")
        return (
            f"found {kind}, expected YAML: robokin reads descriptions of its own; a joint of a URDF is a row "
            '`- {type: R, origin: "Trans(x, y, z) RPY(roll, pitch, yaw)", axis: [x, y, z]}` with `convention: frames`'
        )
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
