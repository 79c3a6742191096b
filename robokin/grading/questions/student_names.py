"""Names of students as names of files: no path, no formula, no name that a system keeps for itself."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence

PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9._@+-]{0,62}[A-Za-z0-9]|[A-Za-z0-9]")
"""Names that are names of files as they are, on every system, and no formula in a spreadsheet."""

RESERVED = re.compile(r"(con|prn|aux|nul|com[0-9]|lpt[0-9]|conin\$|conout\$)(\..*)?", re.IGNORECASE)
"""What Windows keeps for devices."""


def file_names(students: Sequence[str]) -> dict[str, str]:
    """A name for each student's folder: the student's own where it is plain, else what is left of it with a number.

    The number comes from the name alone. Names that differ in case only get one each, since some systems take them for
    the same.
    """
    folded: dict[str, int] = {}
    for student in students:
        folded[student.casefold()] = folded.get(student.casefold(), 0) + 1
    return {student: _file_name(student, folded[student.casefold()] > 1) for student in students}


def _file_name(student: str, doubtful: bool) -> str:
    if not doubtful and PLAIN.fullmatch(student) and not RESERVED.fullmatch(student):
        return student
    left = re.sub(r"[^A-Za-z0-9]+", "-", student).strip("-")[:40].strip("-")
    number = hashlib.sha256(student.encode("utf-8", "surrogatepass")).hexdigest()[:8]
    return f"{left}-{number}" if left else f"student-{number}"
