"""What a function of the package was given, checked: a sentence says what was found and what was expected instead.

Every error is an `InputError`, and so a `ValueError`; where the type is wrong it is a `TypeError` too.
"""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

from robokin.errors import InputError, InputTypeError, did_you_mean, or_list, shown

if TYPE_CHECKING:
    from robokin.arrays import Array


SHOWN_DIGITS = 30
"""Digits of a whole number that a message repeats: of some thousands Python makes no text."""

NUMBER_KINDS = "fiu"
"""Kinds of numpy's numbers that are real: floating-point, signed and unsigned whole ones."""


def described(value: Any) -> str:
    """What a value is, in a few words for a message."""
    if value is None:
        return "None"
    if isinstance(value, str):
        return f"the string '{shown(value)}'"
    if isinstance(value, bool | float | complex) or (isinstance(value, int) and abs(value) < 10**SHOWN_DIGITS):
        return repr(value)
    name = type(value).__name__
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"an array of shape {shape}"
    return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"


def names_of(value: Any) -> list[Any]:
    """The names of a data frame's columns, or of the cells of a row of one; [] for all else.

    Frames of pandas and polars, tables of pyarrow, rows of pandas, rows and columns as a dict.
    """
    if isinstance(value, dict):
        return [*value]
    for holder in ("column_names", "columns", "index"):
        names = getattr(value, holder, None)
        if names is None or callable(names) or (holder == "index" and not hasattr(value, "iloc")):
            continue
        try:
            return [*names]
        except TypeError:
            return []
    return []


def has_names(value: Any) -> bool:
    """Whether numbers are in a data frame whose columns have names, and so have no order of their own.

    Columns that are only numbered are an array's.
    """
    return not all(isinstance(name, Integral) for name in names_of(value))


def _hides_numbers(value: Any) -> bool:
    """Whether something in an array, or in a list of arrays, is masked, which numpy would read as NaN or bare."""
    import numpy as np

    if isinstance(value, np.ma.MaskedArray):
        return bool(np.ma.is_masked(value))
    if not isinstance(value, list | tuple):
        return False
    kinds = set(map(type, value))
    if not any(issubclass(kind, np.ma.MaskedArray | list | tuple) for kind in kinds):
        return False
    return any(map(_hides_numbers, value))


def expect_numbers(value: Any, argument: str, what: str) -> Array:
    """An array of real numbers as float64, of whatever shape; NaN and infinity pass.

    `what` says what was expected. Refused are texts, complex numbers, truth values, hidden (masked) numbers, and lists
    whose rows differ in length: numpy would read some of them as numbers without a word.
    """
    import numpy as np

    if type(value) is np.ndarray and value.dtype == np.float64:
        return value
    if has_names(value):
        raise InputTypeError(f"{argument}: found a table whose columns have names, expected {what}")
    if _hides_numbers(value):
        raise InputError(f"{argument}: found an array with masked values, expected {what}")
    try:
        array = np.asarray(value)
    except (ValueError, TypeError, OverflowError):
        raise InputError(f"{argument}: found rows of different lengths, expected {what}") from None
    if array.dtype.kind in NUMBER_KINDS:
        return np.asarray(array, dtype=np.float64)
    if array.dtype.kind == "O" and all(isinstance(one, Real) and not isinstance(one, bool) for one in array.flat):
        try:
            return np.asarray(array, dtype=np.float64)
        except (ValueError, TypeError, OverflowError):
            raise InputError(f"{argument}: found a number that is too large, expected {what}") from None
    if array.dtype.kind == "c":
        raise InputTypeError(f"{argument}: found complex numbers, expected {what}")
    if array.dtype.kind == "b":
        raise InputTypeError(f"{argument}: found truth values, expected {what}")
    found = described(value) if array.ndim == 0 else f"{described(value)} with something that is no number"
    raise InputTypeError(f"{argument}: found {found}, expected {what}")


def expect_columns(table: Any, places: Iterable[int], argument: str) -> Array:
    """The numbers (m, k) of k columns of a data frame, by where they stand; of a row (k,)."""
    import numpy as np

    names = names_of(table)
    columns = []
    for place in places:
        if isinstance(table, dict) or not hasattr(table, "columns"):
            column = table[names[place]] if isinstance(table, dict) else table.iloc[place]
        else:
            column = table.iloc[:, place] if hasattr(table, "iloc") else table[names[place]]
        column = np.asarray(column) if names_of(column) or not isinstance(table, dict) else column
        columns.append(expect_numbers(column, f"{argument}, column '{shown(str(names[place]))}'", "numbers"))
    if columns[0].ndim > 1 or len({column.shape for column in columns}) > 1:  # of a dict: a frame's are of one length
        raise InputError(f"{argument}: found columns of different lengths, expected a number, or as many, in each")
    return np.stack(columns, axis=-1)


def expect_finite(value: Any, argument: str, what: str, shape: tuple[int, ...] | None = None) -> Array:
    """The same, all of them finite and, if it is given, of this shape."""
    import numpy as np

    array = expect_numbers(value, argument, what)
    if shape is not None and array.shape != shape:
        raise InputError(f"{argument}: found an array of shape {array.shape}, expected {what}")
    if not np.isfinite(array).all():
        raise InputError(f"{argument}: found a number that is not finite, expected {what}")
    return array


def expect_number(value: Any, argument: str, what: str) -> float:
    """A finite number."""
    return float(expect_finite(value, argument, what, ()))


def expect_choice(value: Any, choices: Iterable[str], argument: str) -> str:
    """One of some words."""
    names = list(choices)
    if not isinstance(value, str):
        raise InputTypeError(f"{argument}: found {described(value)}, expected {or_list(map(repr, names))}")
    if value not in names:
        hint = did_you_mean(value, names)
        raise InputError(f"{argument}: found '{shown(value)}', expected {or_list(map(repr, names))}{hint}")
    return value


def expect_whole(value: Any, argument: str, least: int, most: int | None = None) -> int:
    """A whole number from `least` to `most`."""
    import numpy as np

    limits = f"of {least} or more" if most is None else f"from {least} to {most}"
    whole = isinstance(value, Integral) or (
        isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "iu"
    )
    if not whole or isinstance(value, bool):
        raise InputTypeError(f"{argument}: found {described(value)}, expected a whole number {limits}")
    number = int(value)
    if number < least or (most is not None and number > most):
        raise InputError(f"{argument}: found {described(number)}, expected a whole number {limits}")
    return number


def expect_flag(value: Any, argument: str) -> bool:
    """True or False; 0 and 1 pass."""
    import numpy as np

    if isinstance(value, bool | np.bool_) or (isinstance(value, Integral) and value in (0, 1)):
        return bool(value)
    raise InputTypeError(f"{argument}: found {described(value)}, expected True or False")


def expect_kind(value: Any, kind: type | tuple[type, ...], argument: str, how: str) -> Any:
    """A value of a class of the package; `how` says how to get one."""
    if isinstance(value, kind):
        return value
    raise InputTypeError(f"{argument}: found {described(value)}, expected {how}")
