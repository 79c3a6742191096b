"""`robokin list`: what the library holds."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.option_groups import OutputOptions
from robokin.cli.statuses import DONE, NO, say


def command(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="[WORD]...", help="Only what has all of these words.")
    ] = None,
    *,
    output: OutputOptions,
) -> int:
    """The library of robots, mechanisms and wheeled bases: names to use in every other command.

    The freedoms (dof) of a mechanism are those that its file states: where a count is wrong only its geometry tells,
    and robokin dof works that out. Those of a wheeled base are its degree of mobility.

    A word is found where a word of an entry's id, name, kind, class, description or source starts with it; in a
    description or a source one of up to three letters must stand alone. The status is 3 when nothing has all words.

    Examples:
        robokin list
        robokin list kuka
        robokin list scara epson
        robokin list mechanism --json
        robokin list wheeled
    """
    from robokin.quick.library_list import listed
    from robokin.tables.sink import sink

    data, sentence = listed(words or [], output.kind)
    with sink(output.file) as stream:
        stream.writelines(data)
    if sentence:
        say(sentence)
        return NO
    return DONE
