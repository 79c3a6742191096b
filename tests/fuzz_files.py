"""Contents of files for hostile calls: every kind that robokin reads, right and a little wrong."""

from __future__ import annotations

import io
import json
import random
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import yaml
from documentation import DOCS, ROOT

Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
Dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


@cache
def descriptions() -> tuple[bytes, ...]:
    """The library's files and the pages' tables."""
    paths = [*sorted((ROOT / "robots").rglob("*.yaml")), *sorted(DOCS.rglob("*.yaml"))]
    return tuple(path.read_bytes() for path in paths)


@cache
def classes() -> tuple[bytes, ...]:
    """The pages' files of answers and keys."""
    return tuple(path.read_bytes() for path in sorted(DOCS.rglob("*.csv")))


def description(rng: random.Random) -> bytes:
    """A robot or a mechanism; half of the time with one part of its structure changed."""
    text = rng.choice(descriptions())
    if rng.random() < 0.5:
        return text
    document = yaml.load(text, Loader)
    change_document(rng, document)
    return yaml.dump(document, Dumper=Dumper, sort_keys=False, allow_unicode=True).encode()


def change_document(rng: random.Random, document: Any) -> None:
    """Change one part of a document: another value, another kind of value, gone, doubled."""
    places: list[tuple[Any, Any]] = []

    def walk(node: Any) -> None:
        keys = node.keys() if isinstance(node, dict) else range(len(node)) if isinstance(node, list) else ()
        for key in keys:
            places.append((node, key))
            walk(node[key])

    walk(document)
    for _ in range(rng.choice((1, 1, 2, 4))):
        node, key = rng.choice(places)
        odd = (None, True, -1, 0, 1e308, 1e16, "", "x", "q1", "q2*q1", "nan", ".inf", [], {}, [[]], [0, 0], {"a": 1},
               "1/0", [-170, 170], [170, -170], "sqrt(2)", 10**30, "é\u202e\x07", "a" * 3000)  # fmt: skip
        other = rng.choice(places)
        try:
            draw = rng.random()
            if draw < 0.5:
                node[key] = rng.choice(odd)
            elif draw < 0.65:
                node[key] = other[0][other[1]]
            elif draw < 0.8:
                del node[key]
            elif isinstance(node, list):
                node.insert(key, node[key])
            else:
                node[rng.choice(("type", "d", "a", "theta", "limits", "x", "tool", 7))] = node[key]
        except (KeyError, IndexError):  # changed before
            continue


def number(rng: random.Random) -> float:
    """A joint value or a coordinate."""
    return rng.choice((0.0, 90.0, -45.0, 1.0, rng.uniform(-180, 180), rng.uniform(-2, 2), rng.uniform(-900, 900)))


def table(rng: random.Random, separator: str = ",") -> bytes:
    """Rows of numbers, with a header or without."""
    headers: tuple[Sequence[str], ...] = (
        ("x", "y", "z", "roll", "pitch", "yaw"), ("x", "y", "z", "qw", "qx", "qy", "qz"), ("x", "y", "z"),
        [f"q{i + 1}" for i in range(6)], [f"q{i + 1}" for i in range(7)], ("q1", "q2", "q3"),
        [f"r{i}{j}" for i in range(1, 4) for j in range(1, 5)], ("student", "question", "x", "y", "z"),
        ("time", "q1", "q2"),
    )  # fmt: skip
    names = rng.choice(headers)
    rows = [[str(number(rng)) for _ in names] for _ in range(rng.choice((0, 1, 2, 5, 30)))]
    head = [list(names)] if rng.random() < 0.6 else []
    return "".join(separator.join(row) + "\n" for row in head + rows).encode()


def lines(rng: random.Random) -> bytes:
    """JSON documents, one a line."""
    found = []
    for _ in range(rng.choice((0, 1, 2, 5, 30))):
        row: Any = [number(rng) for _ in range(rng.choice((3, 6, 6, 7, 16)))]
        matrix = [[1, 0, 0, number(rng)], [0, 1, 0, number(rng)], [0, 0, 1, number(rng)], [0, 0, 0, 1]]
        document = {
            "q": row,
            "units": {"length": "mm", "angle": "deg"},
            "pose": {"matrix": matrix, "position": row[:3]},
        }
        found.append(rng.choice((row, {"q": row}, document, {"solutions": [{"q": row}]}, {"matrix": matrix}, matrix)))
    return "".join(json.dumps(document) + "\n" for document in found).encode()


def array(rng: random.Random) -> bytes:
    """An array of numpy."""
    shape = rng.choice(((6,), (3, 6), (2, 7), (5, 16), (2, 4, 4), (0, 6), (), (3, 3), (1, 12)))
    numbers = np.array([number(rng) for _ in range(int(np.prod(shape)))]).reshape(shape)
    stream = io.BytesIO()
    kind = rng.choice(("f8", "f4", ">f8", "i4", "u1", "c16", "U5", "?", "f2"))
    with np.errstate(all="ignore"):
        np.save(stream, np.asfortranarray(numbers.astype(kind)) if rng.random() < 0.3 else numbers.astype(kind))
    return stream.getvalue()


def matrix(rng: random.Random) -> bytes:
    """A pose as a matrix in one of the ways to write it."""
    rows = [[1, 0, 0, number(rng)], [0, 0, -1, number(rng)], [0, 1, 0, number(rng)], [0, 0, 0, 1]]
    if rng.random() < 0.3:
        return "\n".join(" ".join(map(str, row)) for row in rows).encode()
    return json.dumps(rows).encode()


KINDS: dict[str, Callable[[random.Random], bytes]] = {
    "arm.yaml": description,
    "robots/arm.yaml": description,
    "other.yml": description,
    "tables/ada.yaml": description,
    "tables/ben.yaml": description,
    "q.csv": table,
    "poses.csv": lambda rng: rng.choice((table(rng), rng.choice(classes()))),
    "joints.csv": lambda rng: rng.choice((table(rng), rng.choice(classes()))),
    "targets.csv": lambda rng: rng.choice(classes()),
    "questions.csv": lambda rng: rng.choice(classes()),
    "class.csv": lambda rng: rng.choice(classes()),
    "q.txt": lambda rng: table(rng, " "),
    "q.jsonl": lines,
    "q.npy": array,
    "T.json": matrix,
    "T.txt": matrix,
    "out.csv": table,
    "out.png": lambda rng: b"",
}
FOLDER = "folder.csv"
"""A folder that is there, named as a file is."""

NAMES = (*KINDS, "missing.yaml", FOLDER, ".", "-", "out.html", "out.svg", "out.jsonl", "out.npy", "a b.csv")


def contents(rng: random.Random, name: str) -> bytes:
    """What a file holds, by its name."""
    return KINDS.get(name, table)(rng)


def mutated(rng: random.Random, data: bytes, numbers: Sequence[str]) -> bytes:
    """A content with one change: of a byte, a number, a line, its end, its encoding."""
    i = rng.randrange(len(data) + 1)
    j = min(len(data), i + rng.choice((1, 1, 2, 5, 40)))
    odd = (b"\0", b"\xff", b"\x1b[2J", b"\xef\xbb\xbf", b"\r", b"\n", b"\t", b'"', b"'", b"[" * 300, b"{", b": ",
           b"&a ", b"*a", b"!!python/object:os.system ", b"#",
           b",", b";", b"nan", "\u2028é".encode(), b"9" * 400)  # fmt: skip
    draw = rng.random()
    if draw < 0.3:
        return data[:i] + rng.choice(odd) + data[i:]
    if draw < 0.45:
        return data[:i] + data[j:]
    if draw < 0.55:
        return data[:i]
    if draw < 0.8:
        pieces = data.replace(b"\n", b",").replace(b" ", b",").split(b",")
        piece = rng.choice(pieces)
        return data.replace(piece, rng.choice(numbers).encode("utf-8", "replace"), 1) if piece else data + b"\n"
    if draw < 0.95:
        rows = data.splitlines(keepends=True)
        rows.insert(rng.randrange(len(rows) + 1), rng.choice(rows or [b""]))
        return b"".join(rows)
    return rng.choice(
        (data.replace(b"\n", b"\r\n"), data.decode("latin-1").encode("utf-16"), data * 3, b"", b"\xef\xbb\xbf" + data)
    )
