"""What the headings of a pasted table say: which column is which, units, and the convention."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

from robokin.formats.pasted_cells import UNITS, plain_text

CHINESE_NUMBERS = (
    "序号", "编号", "关节", "连杆", "关节序号", "连杆序号", "关节编号", "连杆编号", "关节号", "连杆号",
)  # fmt: skip
"""Headings of the column of numbers: serial number, joint, link."""
CHINESE = re.compile(r"[\u4e00-\u9fff]+")
NAMES = {
    "theta": ("theta", "th", "thetai", "jointangle", "angle", "thj", "thetaj", "angletheta", "rotz", "rot_z", "phi",
              "phii", "fi"),
    "d": ("d", "di", "dj", "linkoffset", "jointoffset", "jointdistance", "distance", "dist", "offsetd", "transz",
          "s", "si", "b", "bi", "dz"),
    "a": ("a", "ai", "aj", "linklength", "length", "l", "li", "lengtha", "transx"),
    "alpha": ("alpha", "al", "alphai", "alphaj", "twist", "linktwist", "twistangle", "jointtwist", "rotx", "rot_x"),
    "r": ("r", "ri", "rj"),
    "sigma": ("sigma", "sigmai", "sigmaj"),
    "offset": ("offset", "thetaoffset", "thetaioffset", "qoffset", "zero", "angleoffset", "offsettheta"),
    "sense": ("sense", "sign", "direction"),
    "type": ("type", "jointtype", "rp", "kind", "p/r", "r/p", "typeofjoint"),
    "number": ("", "i", "j", "k", "n", "no", "no.", "nr", "#", "link", "axis", "frame", "row", "linki", "jointi",
               "number", "linkno", "links", "joints", "frames", "frameitoi+1", "transform", "transformation",
               "jointno", "link#", "joint#", *CHINESE_NUMBERS, "jointnumber", "linknumber", "axisi", "element"),
    "name": ("name", "jointname", "linkname", "joint"),
    "variable": ("q", "qi", "qj", "variable", "jointvariable", "var", "jointvar"),
    "low": ("min", "qmin", "thetamin", "lower", "lowerlimit", "minimum", "qi,min", "from", "minlimit", "lowerbound",
            "q-", "qj-"),
    "high": ("max", "qmax", "thetamax", "upper", "upperlimit", "maximum", "qi,max", "to", "maxlimit", "upperbound",
             "q+", "qj+"),
    "limits": ("limits", "limit", "range", "jointlimits", "jointlimit", "jointrange", "motionrange", "rangeofmotion",
               "qlim", "anglerange", "workingrange", "workrange", "movement", "qrange", "travel", "jointtravel"),
}  # fmt: skip
"""What headings mean, by how they read without blanks, braces, subscripts and units."""

MEANINGS = {name: meaning for meaning, names in NAMES.items() for name in names}
TABLE = ("theta", "d", "a", "alpha", "r")
SHIFT = re.compile(r"(?:theta|q|joint|angle)?[i0]?,?(?:offset|zero|home|initial|init|bias)(?:theta|angle|value|q)?i?")
RANGE = re.compile(r"(?:theta|q|joint|angle|angular|motion)?i?(?:range|limits?)(?:ofmotion)?")
BEFORE = re.compile(r"_?\(?[ijkn]-1\)?$")
AFTER = re.compile(r"_?\(?[ijkn]\+1\)?$")


@dataclass(frozen=True)
class PastedHeading:
    """A column: its meaning ("" for none known), what its heading says, its units, whether it is of i − 1, of i + 1."""

    meaning: str
    text: str
    units: tuple[str, ...] = ()
    before: bool = False
    after: bool = False


@lru_cache(maxsize=2000)
def heading_of(text: str) -> PastedHeading:
    """What a heading says."""
    plain = plain_text(text)
    units: list[str] = []

    def unit(match: re.Match[str]) -> str:
        words = [word for word in re.split(r"[\s,/]+|(?<=°)", match[1].lower()) if word]
        if words and all(word in UNITS for word in words):
            units.extend(UNITS[word] for word in words)
            return " "
        return match[0]

    plain = re.sub(r"[(\[]\s*([^()\[\]]*?)\s*[)\]]", unit, plain)
    plain = re.sub(r"(?:/|,|\bin)\s*(mm|cm|m|in|deg|degrees|rad|radians|°)$", lambda match: unit(match) or " ", plain)
    if words := re.fullmatch(r"(.*\S)\s+(mm|cm|deg|degrees|rad|radians|°)", plain):
        units.append(UNITS[words[2]])
        plain = words[1]
    name = re.sub(r"[\s{}$:*=]+", "", plain).lower().replace("_", "").rstrip("/,;")
    bracket = r"[(\[]([^()\[\]]*)[)\]]$"
    if whole := re.fullmatch(r"([a-z#.]{3,})[(\[]([a-z]{1,6}_?\(?[ijkn][-+]1)\)?[)\]]", name):
        name = whole[2] if whole[1] in MEANINGS else name  # such as Link Length (a_{i-1})
    before = bool(BEFORE.search(name))
    after = bool(AFTER.search(name))
    name = AFTER.sub("", BEFORE.sub("", name))
    without, within = re.sub(bracket, "", name), re.sub(r"^.*" + bracket, r"\1", name)
    letters = CHINESE.sub("", name) or name  # such as 连杆长度a
    for candidate in (name, without, within, letters, re.sub(r",?(theta|alpha|a|d)(i)?$", "", name) or name):
        if candidate in MEANINGS:
            return PastedHeading(MEANINGS[candidate], text.strip(), tuple(units), before, after)
    for pattern, meaning in ((SHIFT, "offset"), (RANGE, "limits")):
        if pattern.fullmatch(name):
            return PastedHeading(meaning, text.strip(), tuple(units), before, after)
    return PastedHeading("", text.strip(), tuple(units), before, after)


def units_of_row(cells: tuple[str, ...]) -> list[tuple[str, ...]] | None:
    """The units in a row that holds nothing else, such as (deg), (mm); None for any other row."""
    found = []
    for cell in cells:
        words = [word for word in re.split(r"[\s()\[\],]+", plain_text(cell).lower()) if word not in ("", "-")]
        if any(word not in UNITS for word in words):
            return None
        found.append(tuple(UNITS[word] for word in words))
    return found if any(found) else None
