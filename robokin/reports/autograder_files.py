"""A Gradescope autograder for a sheet: the zip with setup.sh, run_autograder, the key and robokin itself.

Source: Gradescope, Autograder specifications (setup.sh and run_autograder at the top of the zip, which is unpacked to
/autograder/source; the submission in /autograder/submission; results in /autograder/results/results.json).
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Iterator
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

import robokin

TAKEN = (".py", ".html", ".css", ".js", ".json", ".jsonl", ".typed")
"""Files of the package that an autograder needs."""

LEFT = ("__pycache__", "native")
"""Folders of it that an autograder does without: Python's kernel gives the same answers."""

EPOCH = (1980, 1, 1, 0, 0, 0)
"""The time of all files of the zip, so that the same sheet is the same zip."""

NEEDED = ("numpy>=1.26.0", "pyyaml>=6.0.1", "rich>=13.8.0", "typer>=0.26.0")
"""What robokin needs, where its own list is not known."""

SETUP = """\
#!/bin/sh
# Runs once, when Gradescope builds the autograder's image.
set -eu
python=""
for one in python3.14 python3.13 python3.12 python3.11; do
    if command -v "$one" >/dev/null; then python="$one"; break; fi
done
if [ -z "$python" ]; then
    apt-get update
    apt-get install -y --no-install-recommends python3.11 python3.11-venv
    python=python3.11
else
    apt-get update && apt-get install -y --no-install-recommends "$python-venv" || true
fi
"$python" -m venv /autograder/venv
/autograder/venv/bin/pip install --no-cache-dir -r /autograder/source/requirements.txt
"""

RUN = """\
#!/bin/sh
# Runs for each submission. Nothing of what a student handed in is run: robokin reads the files, and no more.
set -u
root="${AUTOGRADER:-/autograder}"
python="${PYTHON:-$root/venv/bin/python}"
mkdir -p "$root/results"
cd "$root/source"
PYTHONPATH="$root/source/python" "$python" -P -m robokin check sheet key -i "$root/submission" \\
    --metadata "$root/submission_metadata.json" --gradescope "$root/results/results.json" @OPTIONS@ \\
    >/dev/null 2>"$root/notes.txt"
status=$?
# 0: all right; 3: something wrong, which is no failure of the autograder. What was not marked is told, and why.
"$python" -c 'import json, sys
status, notes, results = sys.argv[1:]
said = open(notes, encoding="utf-8", errors="replace").read(4000).strip()
if status in ("0", "3"):
    with open(results, encoding="utf-8") as file:
        document = json.load(file)
    document["output"] = "\\n".join(filter(None, (document["output"], said)))
else:
    document = {"score": 0.0, "output": "Not marked. " + said}
with open(results, "w", encoding="utf-8") as file:
    json.dump(document, file, indent=2, ensure_ascii=False)' "$status" "$root/notes.txt" "$root/results/results.json"
"""

DOCKERFILE = """\
# Try the autograder as Gradescope runs it, with one submission:
#   docker build -t sheet . && docker run --rm -v "$PWD/submission:/autograder/submission:ro" \\
#       -v "$PWD/submission_metadata.json:/autograder/submission_metadata.json:ro" sheet
FROM gradescope/autograder-base:ubuntu-22.04
COPY . /autograder/source
RUN cp /autograder/source/run_autograder /autograder/run_autograder \\
    && chmod +x /autograder/run_autograder && sh /autograder/source/setup.sh
CMD ["sh", "-c", "/autograder/run_autograder && cat /autograder/results/results.json"]
"""


def autograder_zip(key: Iterable[tuple[str, bytes]], options: str) -> bytes:
    """The zip: key holds the files of the key by their paths, options are those of `robokin check sheet`."""
    wanted = "".join(f"{one}\n" for one in _requirements())
    files = {
        "setup.sh": SETUP.encode(), "run_autograder": RUN.replace("@OPTIONS@", options).encode(),
        "Dockerfile": DOCKERFILE.encode(), "requirements.txt": wanted.encode(), **dict(key), **dict(_package()),
    }  # fmt: skip
    kept = io.BytesIO()
    with zipfile.ZipFile(kept, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path, EPOCH)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
            entry.external_attr = (0o100755 if path in ("setup.sh", "run_autograder") else 0o100644) << 16
            archive.writestr(entry, data)
    return kept.getvalue()


def autograder_options(partial: float | None, points: float | None) -> str:
    """Those options of `robokin check sheet`; None is not said."""
    given = {"--partial": partial, "--points": points}
    return " ".join(f"{name} {value:.12g}" for name, value in given.items() if value is not None)


def _package() -> Iterator[tuple[str, bytes]]:
    """The package as it runs here, so that marks in the autograder are those of the teacher's machine."""
    package = Path(robokin.__file__).parent
    for path in sorted(package.rglob("*")):
        below = path.relative_to(package)
        if path.suffix in TAKEN and path.is_file() and not set(below.parts) & set(LEFT):
            yield f"python/robokin/{below.as_posix()}", path.read_bytes()


def _requirements() -> list[str]:
    """What pip has to install."""
    try:
        own = requires("robokin") or []
    except PackageNotFoundError:
        own = []
    return sorted(one for one in own if "extra ==" not in one) or [*NEEDED]
