"""Parquet and Arrow files as the text of a CSV, for readers that look at cells one by one."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from robokin.errors import InputError
from robokin.tables.arrow_library import ENDINGS
from robokin.tables.arrow_rows import ArrowBatches, cells_of, kind_of_cells
from robokin.tables.carried import cell_text
from robokin.tables.written_rows import csv_records


def as_csv(stream: Any, name: str, most: int) -> Any:
    """A stream as it is; or, where its name's ending says that it is a Parquet or an Arrow file, as the CSV of it.

    The name alone decides: what is handed in under another one is text, whatever it begins with. A column that has no
    cells is left out. Raises InputError for a file that is none, and where its text has more than `most` bytes.
    """
    kind = ENDINGS.get(Path(name).suffix.lower())
    if kind is None:
        return stream
    source = ArrowBatches(stream if hasattr(stream, "peek") else io.BufferedReader(stream), name, kind)
    places = [i for i, field in enumerate(source.schema) if kind_of_cells(field.type)]
    text = io.BytesIO()
    text.write(csv_records([source.names[place] for place in places], []))
    for batch in source.batches(places):
        columns = [[cell_text(cell) for cell in cells_of(column)] for column in batch.columns]
        text.write(csv_records(None, zip(*columns, strict=True)))
        if text.tell() > most:
            raise InputError(f"{name}: found more than {most} bytes of text, expected the answers of a class")
    text.seek(0)
    return text
