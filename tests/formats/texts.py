"""Descriptions as texts, and what the reader says of wrong ones."""

from __future__ import annotations

import pytest

from robokin.errors import DescriptionError
from robokin.formats import read_text

HEAD = "robokin: 1\nname: arm\n"
DEGREES = HEAD + "units: {length: mm, angle: deg}\n"
MECHANISM = "robokin: 1\nname: linkage\nspace: {space}\nlinks: [ground, crank, coupler, rocker]\njoints:\n"

# Whatever ends in a question, or says what was expected, tells how to go on.
HELPFUL = ("expected", "did you mean")


def arm(*rows, head=DEGREES, tail=""):
    """A robot with these rows, written without their braces; a row of `type: R` for none."""
    table = "".join(f"  - {{{row}}}\n" for row in rows or ["type: R"])
    return f"{head}joints:\n{table}{tail}"


def linkage(*joints, space="planar", tail=""):
    """A mechanism with four links and these joints, written without their braces."""
    table = "".join(f"  - {{{joint}}}\n" for joint in joints)
    return MECHANISM.format(space=space) + table + tail


def only_row(row, head=DEGREES, tail=""):
    """The row that is read from this text."""
    return read_text(arm(row, head=head, tail=tail)).rows[0]


def cell(expression, name="a", head=DEGREES):
    """What a cell of a prismatic row holds [m | rad]; the expression may hold commas."""
    return getattr(only_row(f'type: P, {name}: "{expression}"', head=head), name)


def error_of(text, *, mistakes=1, **given):
    """The first error that a text makes; it names a line and a column and says what was expected.

    So many mistakes are listed, and nothing that follows from them.
    """
    with pytest.raises(DescriptionError) as caught:
        read_text(text, "arm.yaml", **given)
    error = caught.value
    for one in error.errors:
        assert one.line >= 1
        assert one.column >= 1
        assert one.sentence == f"arm.yaml:{one.line}:{one.column}: {one.message}"
        assert any(word in one.message for word in HELPFUL), one.message
        assert one.sentence.isprintable()
        assert all(line.isprintable() for line in one.excerpt.split("\n"))
    assert str(error).startswith(error.sentence)
    assert len(error.errors) == mistakes, str(error)
    return error


def place(text, **given):
    """`line:column` of the error that a text makes."""
    error = error_of(text, **given)
    return f"{error.line}:{error.column}"
