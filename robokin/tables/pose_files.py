"""One pose from a file, or from a JSON document."""

from __future__ import annotations

import contextlib
import io

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.files import open_input, read_up_to
from robokin.formats.printed_matrices import pose_from_matrix
from robokin.json_text import value_in
from robokin.tables.near_targets import near_enough
from robokin.tables.target_rows import one_pose, pose_of
from robokin.tables.text_source import Say
from robokin.units import Units

MOST_OF_A_MATRIX = 1 << 20
"""Bytes of a file with one pose: a page, were it written with a thousand digits."""


def pose_in_json(text: str, name: str, units: Units) -> tuple[Array, str]:
    """The pose (4, 4) [m] of a JSON document, and a note or "". Raises InputError, ValueError for no pose."""
    try:
        document = value_in(text)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    except (ValueError, RecursionError):
        raise InputError(f"{name}: this is not JSON, expected [[…], […], […], […]]") from None
    T, task, note = pose_of(document, units)
    if task != "pose":
        raise ValueError(f"found a target of the task {task}, expected a whole pose")
    return T, note


def pose_in_file(source: str, name: str, units: Units, say: Say) -> tuple[Array, str]:
    """The pose (4, 4) [m] of a file of one, and a note or "".

    The file is an array, JSON, rows of numbers, or a CSV with a header, as `fk` and `frame` write them. Raises
    InputError, or ValueError for what is no pose.
    """
    expected = "[[…], …] or a file with a 4×4 matrix"
    with open_input(source, expected) as (stream, place):
        data = read_up_to(stream, place, MOST_OF_A_MATRIX, expected)
    if len(data) > MOST_OF_A_MATRIX:
        raise InputError(f"{name}: found more than 1 MiB, expected {expected}")
    if not data.startswith(b"\x93NUMPY"):
        try:
            text = data.decode().removeprefix("\ufeff")
        except UnicodeDecodeError:
            raise InputError(f"{name}: found bytes that are no text, expected 4 rows of 4 numbers") from None
        if text.lstrip().startswith(("[", "{")):
            return pose_in_json(text, name, units)
        lines = [line.replace(",", " ").split() for line in text.splitlines() if line.strip(" \t,")]
        with contextlib.suppress(ValueError):
            rows = [[float(cell) for cell in line] for line in lines if not line[0].startswith("#")]
            if len(rows) != 1:
                T, note = pose_from_matrix(rows, units)
                return near_enough(T, units), note
    return one_pose(io.BytesIO(data), place, source, units, say), ""
