"""Builds the playground: files for a static site, with Python, numpy and robokin for the browser.

`python docs/playground/build.py FOLDER [--packages CACHE]`, or `make playground`. robokin and the packages that it
needs are packed from where this Python has them. What comes from elsewhere stands in `FETCHED`, each with its digest:
Pyodide and the editor from npm's registry, numpy for Pyodide from Pyodide's own distribution. A file that lies in the
cache already, put there by hand or by an earlier run, is not fetched.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import re
import shutil
import subprocess
import sys
import tarfile
import urllib.error
import urllib.request
import zipfile
from importlib.metadata import distribution
from pathlib import Path

from markdown_it import MarkdownIt

HERE = Path(__file__).parent
ROOT = HERE.parent.parent

PYODIDE = "0.29.5"
NUMPY = "numpy-2.2.5-cp313-cp313-pyemscripten_2025_0_wasm32.whl"
ACE = "1.45.2"

FETCHED = {
    f"pyodide-{PYODIDE}.tgz": (
        f"https://registry.npmjs.org/pyodide/-/pyodide-{PYODIDE}.tgz",
        "6749b10ee515a1458ecea36d860c8ce2a48366e85b3f92d749ad1840e4aff181",
    ),
    f"ace-builds-{ACE}.tgz": (
        f"https://registry.npmjs.org/ace-builds/-/ace-builds-{ACE}.tgz",
        "5260354a14533fa8e94572597b1ff53025b1bb0a9b2e25d50ecf2a01e57aa9e0",
    ),
    NUMPY: (
        f"https://cdn.jsdelivr.net/pyodide/v{PYODIDE}/full/{NUMPY}",
        "800c98edc0c864dfa49f07005680c699b4b42b84eae1f8cb19d35b3634e7f05c",
    ),
}
"""What is fetched: its address and its SHA-256."""

PYODIDE_FILES = ("pyodide.mjs", "pyodide.asm.js", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json")
EDITOR_FILES = ("ace.js", "mode-yaml.js", "ext-language_tools.js", "theme-github.js", "theme-github_dark.js")

PACKAGES = ("typer", "rich", "click", "markdown-it-py", "mdurl", "shellingham", "typing-extensions", "annotated-doc")
"""What robokin and its command line import, all of it Python; PyYAML beside them, without its compiled part.
Pygments, which Rich would colour sources with, is left out."""

NOT_NEEDED = re.compile(r"/tests?/|^numpy/f2py/|\.(pyi|c|h|a|pxd)$|^numpy/_core/include/")
"""What of numpy's wheel nothing here imports."""

LICENCE = re.compile(r"(^|/)(LICENSE|COPYING|NOTICE)[^/]*$")
"""Files that must go wherever a package goes."""

LECTURES = ("lucia", "yim", "transforms", "laschi", "ahmed")


def main() -> None:
    """Build the folder that the command line names."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--packages", type=Path, default=ROOT / "build" / "packages", help="where fetched files are kept"
    )
    parser.add_argument("--numpy", type=Path, help="a wheel of numpy for Pyodide, taken as it is")
    options = parser.parse_args()
    build(options.folder, options.packages, options.numpy)
    size = sum(path.stat().st_size for path in options.folder.rglob("*") if path.is_file())
    print(f"{options.folder}: {size / 1e6:.1f} MB")


def build(folder: Path, cache: Path, numpy: Path | None = None) -> None:
    """Write the playground to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    cache.mkdir(parents=True, exist_ok=True)
    pages(folder)
    unpack(fetched(f"pyodide-{PYODIDE}.tgz", cache), "package", PYODIDE_FILES, folder / "pyodide")
    editor = fetched(f"ace-builds-{ACE}.tgz", cache)
    unpack(editor, "package/src-min-noconflict", EDITOR_FILES, folder / "editor")
    unpack(editor, "package", ("LICENSE",), folder / "editor")
    (folder / "packages.zip").write_bytes(packages(numpy or fetched(NUMPY, cache)))
    if node := shutil.which("node"):
        subprocess.run([node, HERE / "compile.mjs", folder], check=True)
    # Many servers do not know what an .mjs file is, and browsers then refuse it; Node.js refuses it under another name.
    (folder / "pyodide" / "pyodide.mjs").replace(folder / "pyodide" / "pyodide.js")


def pages(folder: Path) -> None:
    """The page with what robokin itself gives it: nothing is fetched."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("index.html", "play.css", "play.js", "worker.js", "licences.txt"):
        shutil.copy(HERE / name, folder / name)
    (folder / "library.json").write_text(json.dumps(library(), ensure_ascii=False), encoding="utf-8")
    (folder / "lectures.json").write_text(json.dumps(lectures(), ensure_ascii=False), encoding="utf-8")


def fetched(name: str, cache: Path) -> Path:
    """A file of `FETCHED`, from the cache or from its address. Raises SystemExit where it cannot be had."""
    address, digest = FETCHED[name]
    path = cache / name
    if not path.is_file():
        try:
            with urllib.request.urlopen(address, timeout=60) as answer:
                data = answer.read()
        except (urllib.error.URLError, TimeoutError) as error:
            sys.exit(f"{address}: {error}\nPut the file into {cache} to build without the network.")
        part = path.with_suffix(".part")
        part.write_bytes(data)
        part.replace(path)
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != digest:
        sys.exit(f"{path}: its SHA-256 is {found}, expected {digest}")
    return path


def unpack(archive: Path, within: str, names: tuple[str, ...], folder: Path) -> None:
    """The named files of a folder of an archive."""
    folder.mkdir(parents=True, exist_ok=True)
    with tarfile.open(archive) as held:
        for name in names:
            member = held.extractfile(f"{within}/{name}")
            assert member is not None
            (folder / name).write_bytes(member.read())


def packages(numpy: Path) -> bytes:
    """A zip archive of robokin, of what it needs, and of the engine, each with its licence; the same bytes for the same
    files."""
    files = {"engine.py": HERE / "engine.py", "robokin/LICENSE": ROOT / "LICENSE"}
    for path in sorted((ROOT / "robokin").rglob("*")):
        if path.is_file() and path.suffix not in (".pyc", ".so", ".pyd", ".c", ".h"):
            files[str(path.relative_to(ROOT))] = path
    for path in sorted((ROOT / "robots").rglob("*")):
        if path.is_file():
            files[f"robokin/{path.relative_to(ROOT)}"] = path
    for name in (*PACKAGES, "pyyaml"):
        for entry in distribution(name).files or ():
            text = str(entry)
            if (text.endswith((".py", "METADATA")) or LICENCE.search(text)) and not text.startswith(".."):
                files[text] = Path(str(entry.locate()))
    data = {name: path.read_bytes() for name, path in files.items()}
    with zipfile.ZipFile(numpy) as wheel:
        data |= {name: wheel.read(name) for name in wheel.namelist() if not NOT_NEEDED.search(name)}
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(data):
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data[name], zipfile.ZIP_DEFLATED, 9)
    return held.getvalue()


def library() -> dict[str, object]:
    """The robots and mechanisms with their names, and the schema of descriptions, for the page's lists."""
    from engine import run

    entries = json.loads(run("list --json")["text"])
    return {
        "entries": [[entry["id"], entry["name"], entry["kind"]] for entry in entries],
        "schema": json.loads(run("schema")["text"]),
    }


def lectures() -> list[dict[str, object]]:
    """The pages of the lectures: their titles, the robots of their commands, and their parts in order, text as HTML and
    commands."""
    from documentation import steps
    from website.docs_pages import entries_of

    found = []
    for name in LECTURES:
        text = (ROOT / "docs" / "lectures" / f"{name}.md").read_text(encoding="utf-8")
        reader = MarkdownIt("commonmark").enable("table")
        tokens, parts, held = reader.parse(text), [], []
        title = next(token.content for token in tokens if token.type == "inline")
        for token in tokens:
            if token.type == "fence" and token.info == "console":
                parts.append({"html": reader.renderer.render(held, reader.options, {})} if held else {})
                parts.extend({"command": step.command} for step in steps(f"```console\n{token.content}```"))
                held = []
            else:
                held.append(token)
        parts.append({"html": reader.renderer.render(held, reader.options, {})} if held else {})
        # Links lead to pages that stand elsewhere: the words stay.
        for part in parts:
            if "html" in part:
                part["html"] = re.sub(r"</?a\b[^>]*>", "", part["html"])
        kept = [part for part in parts if part]
        found.append({"id": name, "title": title, "robots": entries_of(text), "parts": kept})
    return found


if __name__ == "__main__":
    # The engine, what the tests take for the commands of a page, and what the site does.
    sys.path[:0] = [str(HERE), str(ROOT / "tests"), str(ROOT / "docs")]
    main()
