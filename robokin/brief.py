"""How values show themselves: a line in a console, a table in a notebook, the shell's document as plain data."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robokin.units import Units

MOST_NUMBERS = 8
"""Numbers of an array that are shown; of a longer one the shape."""

MOST_CHARACTERS = 400
"""Characters of a value on a console: a few lines."""


class Brief:
    """A frozen value whose `repr` is short: of long arrays and lists only the size."""

    def __repr__(self) -> str:
        """The class with its fields."""
        parts = [f"{part.name}={shown_value(getattr(self, part.name))}" for part in fields(self)]  # type: ignore[arg-type]
        text = f"{type(self).__name__}({', '.join(parts)})"
        return text if len(text) <= MOST_CHARACTERS else f"{text[: MOST_CHARACTERS - 4]} …)"

    def _repr_html_(self) -> str:
        """A table for a notebook: the command's, or a row for each field."""
        import robokin  # the package's own face: tables are made in a room above this one

        return robokin.notebook.html_of(self)


class Answer(Brief):
    """The answer to a question that the command line can ask too."""

    def record(self, units: Units | None = None) -> Any:
        """The document that the command prints with --json, in the units (by default the description's).

        Raises InputTypeError where `units` are none.
        """
        import robokin  # the package's own face, as above

        return robokin.documents.document_of(self, units)

    def to_pandas(self, units: Units | None = None) -> Any:
        """The answer as a data frame with the columns of its CSV: see `robokin.dataframes.of`.

        In metres and radians, or in the units, which the headings then say. Raises InputTypeError for what is no table.
        """
        import robokin

        return robokin.dataframes.of(self, units)


class Described(Answer):
    """What a description describes: copied and pickled by its fields, of which some are read-only views of mappings."""

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """The class and its fields, mappings as plain ones: a read-only view cannot be pickled."""
        values = (getattr(self, part.name) for part in fields(self))  # type: ignore[arg-type]
        return type(self), tuple(dict(value) if isinstance(value, MappingProxyType) else value for value in values)


def shown_value(value: Any) -> str:
    """A value in a few words: of a long array or list only the size."""
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        if len(shape) == 1 and shape[0] <= MOST_NUMBERS:
            return f"[{', '.join(f'{number:.6g}' for number in value.tolist())}]"
        return f"array{shape}" if shape else f"{value:.6g}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str):
        return repr(str(value))
    if callable(value):
        return "…"
    if isinstance(value, tuple | list | dict) or hasattr(value, "keys"):
        short = isinstance(value, tuple | list) and all(isinstance(one, int | float | str | bool) for one in value)
        if short and len(value) <= MOST_NUMBERS:
            return f"({', '.join(map(shown_value, value))}{',' * (len(value) == 1)})"
        return f"({len(value)} items)" if len(value) else "()"
    if is_dataclass(value) and type(value).__repr__ is Brief.__repr__:
        return f"{type(value).__name__}(…)"
    text = repr(value)
    return text if len(text) <= MOST_CHARACTERS // 4 else f"{type(value).__name__}(…)"
