"""Numbers as tables show them."""

from __future__ import annotations

from collections.abc import Sequence

DECIMALS = 6
"""Decimals of a table: a micrometre in metres, a nanometre in millimetres. JSON and CSV have all."""


def show(value: float) -> str:
    """A number with at most `DECIMALS` decimals and no trailing zeros."""
    text = f"{value:.{DECIMALS}f}" if abs(value) < 1e15 else f"{value:.6e}"
    if "." in text and "e" not in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def show_column(values: Sequence[float]) -> list[str]:
    """Numbers under each other: as many decimals for all as the longest needs."""
    texts = [show(value) for value in values]
    decimals = max((len(text.partition(".")[2]) for text in texts if "e" not in text), default=0)
    return [
        text if "e" in text else f"{float(text):.{decimals}f}" if float(text) else f"{0:.{decimals}f}" for text in texts
    ]


def show_range(low: float, high: float) -> str:
    """`low .. high`, rounded inward: what is shown lies within."""
    step = 10.0**-DECIMALS
    least = show(low) if float(show(low)) >= low else show(low + step)
    most = show(high) if float(show(high)) <= high else show(high - step)
    return f"{least} .. {most}"
