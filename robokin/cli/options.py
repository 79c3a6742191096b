"""The options that commands share, each said once, and what they mean."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Annotated, Any

import typer

from robokin.cli.completion import robots, tips, words
from robokin.errors import InputError, did_you_mean, or_list, shown
from robokin.units import METRES, RADIANS, Units

FORMATS = ("table", "json", "jsonl", "csv")
ROW_FORMATS = (*FORMATS, "parquet", "arrow")
TABLES = ("csv", "parquet", "arrow")
"""Formats with a row an answer, and the same columns."""
POWER = re.compile(r"([0-9]{1,24})[eE]([0-9]{1,2})")
"""A whole number with a power of ten: 1e9."""

ORIENTATIONS = ("rpy", "quaternion", "euler", "matrix")


def option(names: str, metavar: str, help: str, complete: Callable[[str], list[str]] | None = None) -> Any:
    """An option that takes a text: its names with blanks between, what the help calls the text, what a shell offers."""
    return typer.Option(*names.split(), metavar=metavar, help=help, autocompletion=complete)


RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT",
        help="A name of `robokin list`, or a path to a description.",
        autocompletion=robots,
        show_default=False,
    ),
]
FormatOption = Annotated[
    str | None, option("--format -f", "FORMAT", "table, json, jsonl or csv.  [default: table]", words(*FORMATS))
]
RowFormatOption = Annotated[
    str | None,
    option(
        "--format -f", "FORMAT", "table, json, jsonl, csv, parquet or arrow.  [default: table]", words(*ROW_FORMATS)
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Short for -f json.", show_default=False)]
AngleOption = Annotated[str | None, option("--angle", "UNIT", "Angles in deg or rad, in and out.", words(*RADIANS))]
LengthOption = Annotated[
    str | None, option("--length", "UNIT", "Lengths in m, cm, mm or in, in and out.", words(*METRES))
]
SetOption = Annotated[
    list[str] | None, option("--set", "NAME=VALUE", "Override a parameter of the description; repeatable.")
]
TipOption = Annotated[
    str | None,
    option("--tip", "NAME", "The tip or link to which the chain of a tree leads.  [default: the only tip]", tips),
]
RootOption = Annotated[
    str | None, option("--root", "NAME", "The link from which the chain of a tree leads.  [default: the root]")
]
ExactOption = Annotated[
    bool,
    typer.Option("--exact", help="Take angles of a URDF, MJCF or SDF file as written: 1.5708 is no right angle."),
]
PackageOption = Annotated[
    list[str] | None, option("--package", "NAME=DIR", "The folder of a package that a xacro file names; repeatable.")
]
OutputOption = Annotated[
    str | None, option("--output -o", "FILE", "Write to a file, by its ending: .csv, .jsonl or .json.")
]
ArrayOutputOption = Annotated[
    str | None, option("--output -o", "FILE", "Write to a file, by its ending: .csv, .jsonl, .json or .npy.")
]
RowOutputOption = Annotated[
    str | None,
    option("--output -o", "FILE", "Write to a file, by its ending: .csv, .jsonl, .json, .npy, .parquet or .arrow."),
]
AsOption = Annotated[
    str | None,
    option(
        "--as",
        "KIND",
        "How to say the orientation: rpy, quaternion (w x y z), quaternion-xyzw, euler (Z Y Z), rotvec, "
        "abc, wpr or matrix.  [default: rpy]",
        words(*ORIENTATIONS),
    ),
]
DropOption = Annotated[
    bool, typer.Option("--drop", help="Leave out columns of the input that are not understood, such as a time.")
]


def choose(value: str | None, choices: tuple[str, ...], option: str) -> str | None:
    """A choice that is None or one of the words. Raises InputError."""
    if value is None or value in choices:
        return value
    hint = did_you_mean(value, choices)
    raise InputError(f"{option}: found '{value}', expected {or_list(choices)}{hint}")


def orientation_kind(value: str | None) -> str | None:
    """The way to say an orientation that --as asks for; None when it does not. Raises InputError."""
    from robokin.tables.orientations import KINDS, SHORT

    return choose(SHORT.get(value, value) if value else value, KINDS, "--as")


def output_format(format: str | None, json: bool, formats: tuple[str, ...] = FORMATS) -> str | None:
    """The format that --format and --json ask for together; None when neither does."""
    chosen = choose(format, formats, "--format")
    if json and chosen not in (None, "json"):
        raise InputError(f"--json and --format {chosen} exclude each other, expected one of them")
    return "json" if json else chosen


def effective_units(own: Units, length: str | None, angle: str | None) -> Units:
    """A description's units with --length and --angle in their place."""
    return own.override(choose(length, tuple(METRES), "--length"), choose(angle, tuple(RADIANS), "--angle"))


def parameter_overrides(settings: list[str] | None) -> dict[str, str]:
    """The names and expressions of --set."""
    overrides: dict[str, str] = {}
    for setting in settings or []:
        name, equals, value = setting.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise InputError(f"--set: found '{setting}', expected NAME=VALUE")
        overrides[name.strip()] = value.strip()
    return overrides


def package_folders(settings: list[str] | None) -> dict[str, str]:
    """The names and folders of --package. Raises InputError."""
    folders: dict[str, str] = {}
    for setting in settings or []:
        name, equals, folder = setting.partition("=")
        if not equals or not name.strip() or not folder.strip():
            raise InputError(f"--package: found '{shown(setting)}', expected NAME=DIR")
        folders[name.strip()] = folder.strip()
    return folders


def whole_number(text: str | None, option: str, least: int, most: int, *, grouped: bool = False) -> int | None:
    """A whole number within bounds, None for none. Raises InputError.

    `grouped` digits may have _ between them, and a power of ten behind them: 1e9.
    """
    if text is None:
        return None
    digits = text.strip().replace("_", "") if grouped else text.strip()
    if grouped and (power := POWER.fullmatch(digits)):
        digits = power[1] + "0" * int(power[2])
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 25) or not least <= int(digits) <= most:
        limit = f"of {least} or more" if most >= 2**62 else f"from {least} to {most}"
        raise InputError(f"{option}: found '{shown(text)}', expected a whole number {limit}")
    return int(digits)
