"""`robokin fk --symbolic`: which form is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from robokin.cli.options import FORMATS, ROW_FORMATS
from robokin.errors import InputError, or_list
from robokin.tables.sink import format_of

ENDINGS = {".tex": "latex", ".py": "python"}
"""Forms by the ending of the output's name, beside those of every command."""


def check_options(symbolic: bool, forms: Mapping[str, bool], others: Mapping[str, object]) -> None:
    """Refuse `forms` without --symbolic, and `others`, which ask for poses, with it."""
    for option, given in forms.items():
        if given and not symbolic:
            raise InputError(f"{option} says how to write matrices in symbols, expected --symbolic with it")
    for option, value in others.items():
        if value:
            raise InputError(f"--symbolic writes the matrices for all joint values, expected no {option} with it")


def form_of(output: str | None, chosen: str | None, *, latex: bool, python: bool) -> str:
    """What to write: latex, python, or one of the formats of every command."""
    asked = [name for name, given in (("latex", latex), ("python", python)) if given]
    if len(asked) > 1:
        raise InputError("--latex and --python exclude each other, expected one of them")
    if asked and chosen is not None:
        raise InputError(f"--{asked[0]} and --format {chosen} exclude each other, expected one of them")
    if chosen in ROW_FORMATS and chosen not in FORMATS:
        raise InputError(f"--symbolic: found the format {chosen}, expected {or_list(FORMATS)}")
    ending = ENDINGS.get(Path(output).suffix.lower()) if output is not None else None
    if output is not None and asked and ending != asked[0]:
        expected = next(name for name, form in ENDINGS.items() if form == asked[0])
        raise InputError(f"--output: found '{output}', expected a name that ends with {expected}")
    if ending is not None and chosen is not None:
        raise InputError(f"--output {output} and --format {chosen} say different things, expected one of them")
    return asked[0] if asked else ending or format_of(output, chosen)
