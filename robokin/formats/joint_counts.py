"""Joints by letters and names, as people type them: `6R`, `12S,6P`, `3 revolute, 1 prismatic`."""

from __future__ import annotations

import re

from robokin.errors import InputError, nearest, or_list, shown

LAMBDA = {"planar": 3, "spherical": 3, "spatial": 6}
"""Grübler's λ of each space. (The model has it too, but arrays with it, and a bare count needs none.)"""

LETTERS = {
    "R": ("revolute", 1), "P": ("prismatic", 1), "H": ("helical", 1), "C": ("cylindrical", 2), "U": ("universal", 2),
    "S": ("spherical", 3), "E": ("planar", 3), "F": ("fixed", 0), "G": ("contact", 5),
}  # fmt: skip
"""Joints by their letters, with their freedoms f in space; G is any contact, such as of gears or a cam, or a belt."""

FLAT_CONTACT = 2
"""Freedoms of a contact in the plane and on the sphere: it takes one of the three, as it takes one of six in space."""

OUT_OF_SPACE = {"planar": "HCUS", "spherical": "PHCE", "spatial": ""}
"""Joints that do not exist in a space: they would lead out of it."""

OTHER_WORDS = {
    "pin": "R", "hinge": "R", "rotary": "R", "turning": "R", "T": "P", "slider": "P", "sliding": "P", "linear": "P",
    "screw": "H", "hooke": "U", "cardan": "U", "B": "S", "ball": "S", "weld": "F", "rigid": "F", "gear": "G",
    "cam": "G", "rolling": "R", "point": "G", "belt": "G", "chain": "G", "bevel": "G", "worm": "G", "contact": "G",
}  # fmt: skip
"""What other books call the joints."""

MOST = 10**6
"""Links or joints in a count; more are a slip of the key."""

PART = re.compile(r"(\d*)\s*\*?\s*([^\W\d_]+)")


def parse_joints(text: str, space: str) -> dict[str, int]:
    """The joints of a text such as `6R`, `12S,6P`, `3 revolute, 1 prismatic` or `RRRP`: counts by letter.

    Raises InputError, which names the nearest joint for one that is not known.
    """
    counts: dict[str, int] = {}
    parts = [part.strip() for part in text.replace(";", ",").replace("+", ",").split(",")]
    if len(parts) == 1 and re.fullmatch(r"(\d+\s*[^\W\d_]\s+)+\d+\s*[^\W\d_]", parts[0]):
        parts = re.findall(r"\d+\s*[^\W\d_]", parts[0])  # 12S 6P
    for part in parts:
        match = PART.fullmatch(part)
        if match is None:
            found = shown(part or text)
            raise InputError(f"--joints: found '{found}', expected a count and a letter, such as 6R or 12S,6P")
        number, word = match.groups()
        letters = [word.upper()] if len(word) == 1 else _letters(number, word)
        for letter in letters:
            count = int(number[:8] or "1")
            if count > MOST:
                raise InputError(f"--joints: found {shown(number)} joints, expected at most {MOST}")
            counts[_known(letter)] = counts.get(_known(letter), 0) + count
    for letter in counts:
        if letter in OUT_OF_SPACE[space]:
            allowed = [known for known in LETTERS if known not in OUT_OF_SPACE[space]]
            raise InputError(
                f"--joints: found a {LETTERS[letter][0]} joint ({letter}) in a {space} mechanism, "
                f"expected {or_list(allowed)}, or --space spatial"
            )
    return counts


def _letters(number: str, word: str) -> list[str]:
    """The letters that a word of several stands for: a joint's name, or one joint a letter."""
    names = {name: letter for letter, (name, _) in LETTERS.items()} | OTHER_WORDS
    for end in ("", "s", "joint", "joints"):
        name = word.casefold().removesuffix(end)
        if name in names:
            return [names[name]]
    if all(letter in LETTERS for letter in word.upper()) and (not number or word.upper() == word):
        if not number:
            return list(word.upper())
        each = ",".join(f"{number}{letter}" for letter in dict.fromkeys(word.upper()))
        raise InputError(
            f"--joints: found '{number}{word}', which may mean {number} legs {word} or {number} {word[0]} and the "
            f"rest, expected a count for each letter: {each}"
        )
    raise _unknown(word)


def _known(letter: str) -> str:
    if letter not in LETTERS:
        raise _unknown(letter)
    return letter


def _unknown(word: str) -> InputError:
    names = {name: letter for letter, (name, _) in LETTERS.items()} | OTHER_WORDS
    close = [word.upper()] if word.upper() in names else nearest(word, names, 1)
    hint = f"; did you mean {names[close[0]]} ({LETTERS[names[close[0]]][0]})?" if close else ""
    known = ", ".join(f"{letter} {name}" for letter, (name, _) in LETTERS.items())
    return InputError(f"--joints: found the unknown joint '{shown(word)}', expected one of {known}{hint}")
