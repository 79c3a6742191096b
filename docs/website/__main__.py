"""Builds the site: `python -m website [--to FOLDER] [--playground FOLDER]`."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import time
from concurrent.futures import Executor, ProcessPoolExecutor
from functools import partial
from importlib.metadata import distribution
from pathlib import Path

from robokin.formats.library import library_names
from website.docs_pages import ROOT, lecturers, write_docs
from website.entry_pages import write_entry, write_turning
from website.gallery import gallery_text
from website.links import faults

SETTINGS = Path(__file__).resolve().parent


def main() -> int:
    """Build the site and look at its links; 1 where something is wrong."""
    reader = argparse.ArgumentParser(prog="python -m website", description=__doc__)
    reader.add_argument("--to", type=Path, default=ROOT / "build" / "site", help="where the site is put")
    reader.add_argument("--playground", type=Path, help="a folder that is served as playground/ of the site")
    options = reader.parse_args()
    start = time.monotonic()
    site, source = options.to, options.to.with_name(options.to.name + "-source")
    for folder in (site, source):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
    write_docs(source, options.playground is not None)
    if options.playground is not None:
        shutil.copytree(options.playground, site / "playground")
    pages, files = source / "gallery", site / "gallery"
    with ProcessPoolExecutor(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else None) as pool:
        write_gallery(pages, files, pool, options.playground is not None)
        print(f"the pages' source and the gallery's pictures: {time.monotonic() - start:.0f} s", flush=True)
        # What turns is made meanwhile: no other page is made of it.
        turning = pool.map(partial(write_turning, files=files), library_names(), chunksize=4)
        if not sphinx(source, site):
            return 1
        list(turning)
    found = faults(site)
    print(*found, sep="\n", end="\n" if found else "", file=sys.stderr)
    pages = sum(1 for _ in site.rglob("*.html"))
    size = sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) / 1e6
    wrong = f"{len(found)} links are wrong" if found else "every link leads somewhere"
    print(f"{site}: {pages} pages, {size:.0f} MB, {time.monotonic() - start:.0f} s; {wrong}")
    return 1 if found else 0


def write_gallery(pages: Path, files: Path, pool: Executor, playground: bool) -> None:
    """The gallery's page and those of its entries below `pages`, what they show below `files`."""
    pages.mkdir()
    for folder in ("pictures", "turning", "descriptions"):
        (files / folder).mkdir(parents=True)
    write = partial(write_entry, pages=pages, files=files, lectures=lecturers(), playground=playground)
    entries = list(pool.map(write, library_names(), chunksize=4))
    (pages / "index.md").write_text(gallery_text(entries, lecturers()), encoding="utf-8")


def sphinx(source: Path, site: Path) -> bool:
    """Make the pages of their source; False where a word of warning was said."""
    from sphinx.cmd.build import build_main

    doctrees = source.with_name(source.name + "-read")
    shutil.rmtree(doctrees, ignore_errors=True)
    arguments = ["-q", "-W", "--keep-going", "-b", "html", "-c", str(SETTINGS), "-d", str(doctrees)]
    done = build_main([*arguments, str(source), str(site)])
    for name in (".buildinfo", "objects.inv", "_static/webpack-macros.html"):
        (site / name).unlink(missing_ok=True)
    write_licences(site / "_static" / "licences")
    (site / ".nojekyll").touch()  # GitHub's pages leave out _static otherwise
    return done == 0


def write_licences(folder: Path) -> None:
    """The licences of those whose scripts and styles the site serves: they ask to go with them."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("sphinx", "pydata-sphinx-theme"):
        found = next(file for file in distribution(name).files or () if "licenses/LICENSE" in file.as_posix())
        (folder / f"{name}.txt").write_text(found.read_text(encoding="utf-8"), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
