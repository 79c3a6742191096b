"""Reading pipes: nothing is read before it is there, so that a signal that comes while a reader waits is heeded.

A read that is begun before the bytes have come cannot be ended by a signal that came just before it. So whatever reads
waits for the bytes, or for a signal, and asks for no more than what is there.
"""

from __future__ import annotations

import io
import os
import select
import threading
import time

import numpy as np
import pytest

from robokin import files
from robokin.errors import InputError
from robokin.files import HeededStream, open_input, read_up_to
from robokin.grading.answers.answer_records import SheetReader
from robokin.tables import rows
from robokin.tables.carried import nothing
from robokin.tables.target_rows import Targets
from robokin.unfinished_work import in_order
from robokin.units import Units

pytestmark = pytest.mark.skipif(os.name != "posix", reason="waits for pipes with select")


class WatchedPipe(io.RawIOBase):
    """The reading end of a pipe, which is never asked for bytes that are not there."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.reads = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return False

    def fileno(self) -> int:
        return self.number

    def readinto(self, buffer) -> int:
        assert select.select([self.number], [], [], 0)[0], "asked for bytes that are not there"
        self.reads += 1
        data = os.read(self.number, len(buffer))
        buffer[: len(data)] = data
        return len(data)


@pytest.fixture
def heeded(monkeypatch):
    """Requests to end are heeded, as in a command, and none comes."""
    reader, writer = os.pipe()
    os.set_blocking(reader, False)
    monkeypatch.setattr(files, "_woken", lambda: reader)
    monkeypatch.setattr(in_order, "heeded", True, raising=False)
    yield
    os.close(reader)
    os.close(writer)


def slow_pipe(pieces):
    """A stream into which pieces come one after the other, with time between them."""
    reader, writer = os.pipe()

    def write():
        with os.fdopen(writer, "wb", buffering=0) as stream:
            for piece in pieces:
                time.sleep(0.005)
                stream.write(piece)

    threading.Thread(target=write, daemon=True).start()
    return io.BufferedReader(WatchedPipe(reader))


def cut(data: bytes, size: int):
    return [data[i : i + size] for i in range(0, len(data), size)]


def npy(array, version=(1, 0)) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, version=version)
    return stream.getvalue()


PLACES = np.arange(30.0).reshape(10, 3)
TEXT = b"x,y,z\n" + b"".join(b"%d,%d,%d\n" % tuple(row) for row in PLACES.astype(int).tolist())
LINES = b"".join(b"[%d, %d, %d]\n" % tuple(row) for row in PLACES.astype(int).tolist())
FORMS = {
    "csv": TEXT,
    "csv with a mark": b"\xef\xbb\xbf" + TEXT,
    "csv with quotes": TEXT.replace(b"0,1,2", b'"0","\n1",2'),
    "json lines": LINES,
    "json": b"[\n" + LINES.replace(b"\n", b",\n").removesuffix(b",\n") + b"\n]\n",
    "npy": npy(PLACES),
    "npy, version 2": npy(PLACES, (2, 0)),
    "npy, Fortran order": npy(np.asfortranarray(PLACES)),
    "npy, other bytes": npy(PLACES.astype(">f4")),
}


@pytest.mark.parametrize("size", [1, 7, 100])
@pytest.mark.parametrize("form", FORMS)
def test_what_comes_in_pieces_is_read_as_it_comes(heeded, form, size):
    pieces = cut(FORMS[form], size)[:40]
    pieces.append(FORMS[form][len(b"".join(pieces)) :])
    stream = slow_pipe(pieces)
    targets = Targets("-", Units(), None, nothing(), lambda sentence: None)
    found = np.concatenate([*targets.blocks_in(stream, "standard input")])
    assert found[:, :3, 3].tolist() == PLACES.tolist()


def test_answers_of_a_class_and_descriptions_are_read_as_they_come(heeded):
    sheet = SheetReader(slow_pipe(cut(TEXT, 5)), "standard input", lambda sentence: None)
    assert [record.cells for record in sheet.rows()][1:] == [[f"{x:.0f}" for x in row] for row in PLACES.tolist()]
    assert read_up_to(slow_pipe(cut(TEXT, 5)), "a pipe", 1 << 20, "text") == TEXT
    assert len(read_up_to(slow_pipe(cut(TEXT, 5)), "a pipe", 11, "text")) == 12


@pytest.mark.parametrize("short", [1, 8, 9, 20, 200])
def test_an_array_that_ends_early_on_a_pipe_is_refused(heeded, short):
    targets = Targets("-", Units(), None, nothing(), lambda sentence: None)
    with pytest.raises(InputError, match=r"it ends before|no \.npy file"):
        [*targets.blocks_in(slow_pipe([npy(PLACES)[:-short]]), "a.npy")]
    with pytest.raises(InputError, match="more bytes behind"):
        [*targets.blocks_in(slow_pipe([npy(PLACES), b"x"]), "a.npy")]


def test_a_header_that_is_too_long_is_refused_before_it_comes(heeded):
    begun = b"\x93NUMPY\x02\x00" + (1 << 30).to_bytes(4, "little") + b"{"
    targets = Targets("-", Units(), None, nothing(), lambda sentence: None)
    with pytest.raises(InputError, match="header is longer than"):
        [*targets.blocks_in(slow_pipe(cut(begun, 3)), "a.npy")]


def test_a_heeded_stream_gives_every_byte_once(heeded):
    data = bytes(range(256)) * 5
    pipe = slow_pipe(cut(data, 100))
    files.wait_for(pipe)
    assert pipe.peek(1)[:1] == data[:1]
    stream = HeededStream(pipe)
    assert stream.peek(150)[:150] == data[:150]
    got = [stream.read(0), stream.read(1), stream.read(40)]
    while part := stream.read(33):
        got.append(part)
    assert (b"".join(got), stream.read(10), stream.peek(1), stream.seekable()) == (data, b"", b"", False)


def test_a_file_is_read_without_waiting_and_searched(tmp_path, heeded):
    path = tmp_path / "places.npy"
    path.write_bytes(npy(np.asfortranarray(PLACES)))
    with open_input(str(path), "rows") as (stream, name):
        kind, same = rows.kind_of_stream(stream, name)
        assert (kind, same) == ("npy", stream)
