"""The pages of docs/, and those at the top of the project, as the source of the site.

They stay where they are, so that links between them lead where they lead on a forge. Only what a forge does by
itself is done here: README.md is the page of its folder, a linked folder lists its files, a notebook is a page.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from robokin.formats.library import library_names

ROOT = Path(__file__).resolve().parent.parent.parent
DOCS = ROOT / "docs"

TOP = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "LICENSE")
"""What pages of docs/ link to outside of it."""

HEADED = ("Commands", "Lectures", "Notebooks")
"""Parts of the index that stand in the head of every page, where there is such a part."""

PROGRAMS = ("website", "playground")
"""Folders of docs/ that make pages and are none."""

LINK = re.compile(r"(?<!\\)(\]\()([^)\s#:]+)((?:#[^)]*)?\))")
"""A link within the project."""

CONSOLE = re.compile(r"^```console\n(.*?)^```", re.M | re.S)
"""A block of commands with what they print."""

FENCE = re.compile(r"(^ *```.*?^ *```)", re.M | re.S)


def lecturers() -> dict[str, str]:
    """The page of each lecturer that the index names, seen from a page of the gallery."""
    found = re.findall(r"\[([A-Z]\. [^],]+),[^]]*\]\((lectures/[^)]+)\)", (DOCS / "README.md").read_text())
    return {who: f"../docs/{page}" for who, page in found}


def write_docs(source: Path, playground: bool) -> None:
    """Write the pages below `source`; `playground` says whether there is one to lead to."""
    for path in sorted(DOCS.rglob("*")):
        if path.is_file() and path.relative_to(DOCS).parts[0] not in PROGRAMS:
            _write(path, source / path.relative_to(ROOT))
    if playground:
        for page in sorted((source / "docs" / "lectures").glob("*.md")):
            page.write_text(with_playground(page.read_text(encoding="utf-8"), page.stem), encoding="utf-8")
    for name in TOP:
        _write(ROOT / name, source / name)
    index = source / "docs" / "index.md"
    parts = parts_of(index.read_text(encoding="utf-8"))
    trees = []
    for title, text in parts.items():
        links = [link for _, link, _ in LINK.findall(text) if link.endswith(".md")]
        if title in HEADED:
            page = source / "docs" / f"{title.lower()}.md"
            if page.exists():
                raise ValueError(f"{page.name} stands in docs/ and is a part of docs/README.md too; expected one")
            page.write_text(f"# {title}\n\n{text}\n\n{toctree(links)}", encoding="utf-8")
        else:
            trees.append(toctree([link for link in links if link != "api.md"], title))
    with index.open("a", encoding="utf-8") as stream:
        project = toctree(["/CHANGELOG.md", "/SECURITY.md"], "The project")
        stream.write("\n\n" + "\n\n".join([toctree(["tour.md"]), *trees, project]))
    headed = [f"docs/{title.lower()}.md" for title in HEADED if title in parts]
    _write_home(source, [*headed, "gallery/index.md", "docs/api.md"], playground)


def parts_of(index: str) -> dict[str, str]:
    """The parts of the documentation's index by their headings."""
    found = re.split(r"^## (.+)$", index, flags=re.M)[1:]
    return {title: text.strip() for title, text in zip(found[::2], found[1::2], strict=True)}


def toctree(pages: list[str], caption: str = "") -> str:
    """What makes Sphinx lead to pages in its sidebar."""
    options = ":hidden:\n" + (f":caption: {caption}\n" if caption else "")
    return f"```{{toctree}}\n{options}\n" + "\n".join(dict.fromkeys(pages)) + "\n```\n"


def on_site(text: str, page: Path) -> str:
    """A page's text with links that lead on the site where they lead on a forge; `page` is its path in the project."""

    def link(match: re.Match[str]) -> str:
        target = match[2]
        if target.rpartition("/")[2] == "README.md":
            target = target.removesuffix("README.md") + "index.md"
        elif target.endswith(".ipynb"):
            target = target.removesuffix(".ipynb") + ".md"
        elif (page.parent / target).is_dir():
            target = target.rstrip("/") + "/files.md"
        return match[1] + target + match[3]

    parts = FENCE.split(text)
    return "".join(part if k % 2 else LINK.sub(link, part) for k, part in enumerate(parts))


def entries_of(page: str) -> list[str]:
    """The robots and mechanisms of the library that a page's commands name or list, in the page's order."""
    words = []
    for block in CONSOLE.findall(page):
        for line in block.splitlines():
            # Of what is printed, the names that `robokin list` has at the start of its lines.
            words += line.split() if line.startswith("$ ") else re.findall(r"^\S+(?=   )", line)
    known = set(library_names())
    return [name for name in dict.fromkeys(words) if name in known]


def with_playground(page: str, lecture: str) -> str:
    """A lecture's page with links below its title: to itself in the playground, and to its robots there."""
    title, _, rest = page.partition("\n\n")
    address, names = "../../playground/index.html#r=", entries_of(page)
    links = ", ".join(f'<a href="{address}{name}">{name}</a>' for name in names)
    own = f'<a href="{address}{names[0]}&amp;t=lectures&amp;l={lecture}">Run these commands in the playground</a>'
    return f"{title}\n\n{own}, or change a robot there and ask about it: {links}.\n\n{rest}"


def notebook_text(notebook: dict[str, object]) -> str:
    """A notebook, as it was run, in Markdown: its texts, its code and what that printed or drew."""
    parts: list[str] = []
    for cell in notebook["cells"]:  # type: ignore[attr-defined]
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source)
        elif cell["cell_type"] == "code" and source.strip():
            parts.append(f"```python\n{source}\n```")
            parts += [text for output in cell["outputs"] if (text := _output_text(output))]
    return "\n\n".join(parts) + "\n"


def _output_text(output: dict[str, object]) -> str:
    """What a cell printed or drew."""
    if "text" in output:
        return f"```text\n{''.join(output['text']).rstrip()}\n```"  # type: ignore[arg-type]
    data: dict[str, list[str] | str] = output.get("data", {})  # type: ignore[assignment]
    if "image/png" in data:
        drawn = "".join(data["image/png"]).strip()
        return f'<img alt="what the cell above draws" src="data:image/png;base64,{drawn}">'
    if "image/svg+xml" in data:
        return re.sub(r"\n\s*\n", "\n", "".join(data["image/svg+xml"]))
    if "text/html" in data and "<script" not in "".join(data["text/html"]):
        return re.sub(r"\n\s*\n", "\n", f"<div>{''.join(data['text/html'])}</div>")
    return f"```text\n{''.join(data['text/plain']).rstrip()}\n```" if "text/plain" in data else ""


def _write(path: Path, to: Path) -> None:
    """A file of the project in the site's source; a README as the page of its folder, with pages of linked folders."""
    to.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".ipynb":
        text = notebook_text(json.loads(path.read_text(encoding="utf-8")))
        # In lists it stands beside the page of the same title.
        text = re.sub(r"^# (.+)$", r"# \1 (notebook)", text, count=1, flags=re.MULTILINE)
        to.with_suffix(".md").write_text(on_site(text, path), encoding="utf-8")
        shutil.copyfile(path, to)
    elif path.suffix != ".md":
        shutil.copyfile(path, to)
    else:
        text = path.read_text(encoding="utf-8")
        for _, target, _ in LINK.findall(text):
            if (path.parent / target).is_dir():
                _write_folder(path.parent / target, to.parent / target / "files.md")
        to = to.with_name("index.md") if to.name == "README.md" else to
        to.write_text(on_site(text, path), encoding="utf-8")


def _write_folder(folder: Path, to: Path) -> None:
    """A page that lists what is in a folder."""
    files = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    to.parent.mkdir(parents=True, exist_ok=True)
    listed = "\n".join(f"- [{name}]({name})" for name in files)
    to.write_text(f"---\norphan: true\n---\n\n# Files in {folder.name}\n\n{listed}\n", encoding="utf-8")


def _write_home(source: Path, headed: list[str], playground: bool) -> None:
    """The home page: the project's README, with ways on below its picture."""
    home = source / "index.md"
    text = home.read_text(encoding="utf-8")
    ways = ["[Documentation](docs/index.md)", "[A tour](docs/tour.md)", "[Gallery](gallery/index.md)"]
    if playground:
        ways.insert(0, "[Try it here](playground.md)")
        headed.append("playground.md")
        (source / "playground.md").write_text(PLAYGROUND, encoding="utf-8")
    picture = re.search(r"^!\[.*\)$", text, re.M)
    assert picture, "the project's README has a picture"
    at = picture.end()
    text = text[:at] + "\n\n" + " · ".join(ways) + text[at:]
    pages = ["docs/index.md", *headed]
    home.write_text(f"{text}\n\n{toctree(pages)}", encoding="utf-8")


PLAYGROUND = """# Playground

robokin in this page, with nothing installed: <a href="playground/index.html">on a page of its own</a>.

<iframe class="playground" src="playground/index.html" title="The playground" loading="lazy"></iframe>
"""
