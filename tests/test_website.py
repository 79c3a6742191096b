"""The site: what needs no generator. Whole builds are `make site`, which looks at every link, and `make site-check`."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("PIL")
from PIL import Image
from website import docs_pages, gallery, links
from website.entry_pages import commands, facts, page_text, plain, printed, write_entry, write_turning
from website.thumbnails import HEIGHT, WIDTH, thumbnail

from robokin import documents
from robokin.formats.library import library_file, library_names, load_any
from robokin.formats.library_index import library_entries
from robokin.kinematics.forward import forward_kinematics
from robokin.pictures.arm import default_configuration

KINDS = ["puma560", "scara-frames", "assembly", "human-hand", "four-bar", "gear-pair", "car", "omni-three"]
"""An arm, one in frames, one without joints, a tree, mechanisms with and without places, bases."""


def page_of(id):
    path = library_file(id)
    entry = load_any(id)
    return page_text(entry, documents.show(entry), path.read_text(), docs_pages.lecturers())


@pytest.mark.parametrize("id", KINDS)
def test_a_page_has_picture_facts_table_source_description_and_commands(id):
    text = page_of(id)
    record = documents.show(load_any(id))
    assert f"# {plain(record['name'])}\n" in text
    assert f'src="pictures/{id}.png" alt="' in text
    assert ("turning/" in text) == (record["kind"] != "wheeled")
    assert plain(record["source"]) in text
    assert library_file(id).read_text().rstrip() in text
    assert f"| name in commands | `{id}` |" in text
    assert f"robokin show {id}" in text


def test_the_table_is_the_one_that_is_published():
    """C. Laschi, Robot mechanics and kinematics, D-H for PUMA 560: the table of Fu, Gonzalez & Lee."""
    rows = re.findall(r"^\| (\d) \| [\w ]+ \| revolute \| q\d \| (\S+) \| (\S+) \| (\S+) \|", page_of("puma560"), re.M)
    assert rows == [
        ("1", "0", "0", "-90"), ("2", "149.09", "431.8", "0"), ("3", "0", "-20.32", "90"),
        ("4", "433.07", "0", "-90"), ("5", "0", "0", "90"), ("6", "56.25", "0", "0"),
    ]  # fmt: skip


@pytest.mark.parametrize("id", ["puma560", "ur5", "scara", "panda", "stanford"])
def test_the_flange_is_where_forward_kinematics_has_it(id):
    robot = load_any(id)
    q, _ = default_configuration(robot)
    block = page_of(id).partition("in the first pose")[2].partition("```\n")[0]
    shown = re.search(r"^position +(\S+) +(\S+) +(\S+)$", block, re.M).groups()
    T = forward_kinematics(robot, q)
    assert np.allclose([float(x) * robot.units.metres for x in shown], T[:3, 3], atol=1e-5)


@pytest.mark.parametrize("id", KINDS)
def test_each_command_of_a_page_is_one(id, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for line in commands(load_any(id), id):
        if not re.search(r"workspace|\|", line):
            said = printed(*line.split()[1:])
            assert not said.startswith("robokin:"), said


@pytest.mark.parametrize("id", KINDS)
def test_a_picture_has_no_background_and_something_on_it_and_is_the_same_each_time(id):
    data = thumbnail(load_any(id))
    picture = np.array(Image.open(io.BytesIO(data)).convert("RGBA"))
    assert picture.shape == (HEIGHT, WIDTH, 4)
    assert not picture[:4, :, 3].any()
    assert 0.005 < np.mean(picture[..., 3] > 0) < 0.9
    assert data == thumbnail(load_any(id))


def test_what_an_entry_writes_and_what_the_gallery_says_of_it(tmp_path):
    for folder in ("pages", "files/pictures", "files/descriptions", "files/turning"):
        (tmp_path / folder).mkdir(parents=True)
    told = [write_entry(id, tmp_path / "pages", tmp_path / "files", {}, id == "car") for id in ("four-bar", "car")]
    led = [
        f"playground/index.html#r={id}" in (tmp_path / "pages" / f"{id}.md").read_text() for id in ("four-bar", "car")
    ]
    assert led == [False, True]
    for id in ("four-bar", "car"):
        write_turning(id, tmp_path / "files")
    written = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {
        "pages/four-bar.md", "pages/car.md", "files/pictures/four-bar.png", "files/pictures/car.png",
        "files/descriptions/four-bar.yaml", "files/descriptions/car.yaml", "files/turning/four-bar.html",
    }  # fmt: skip
    text = gallery.gallery_text(told, {})
    assert text.index("## Planar mechanisms") < text.index('href="four-bar.html"') < text.index("## Bases on wheels")
    assert "## SCARA arms" not in text


def test_every_entry_of_the_library_has_its_group():
    lectures = docs_pages.lecturers()
    groups = {}
    for entry in library_entries():
        told = {
            "kind": entry.kind,
            "source": entry.source,
            "folder": library_file(entry.id).parent.name,
            "class": entry.words.split()[1],
            "space": entry.words.split()[1],
            "joints": f"{len(entry.joints)}: {entry.joints}",
        }
        groups.setdefault(gallery.group_of(told, lectures), []).append(entry.id)
    assert groups.keys() == gallery.GROUPS.keys()
    assert sum(map(len, groups.values())) == len(library_names())
    assert "puma560" in groups["lectures"] and "scara" in groups["lectures"]
    assert {"ur5e", "irb140"} <= set(groups["six"])
    assert {"panda", "iiwa14"} <= set(groups["seven"])
    assert {"human-hand", "yumi"} <= set(groups["hands"])


def test_text_is_taken_for_text():
    assert plain("a_b *c* [d](e) <f> `g` |h| $i$ #j") == r"a\_b \*c\* \[d\](e) \<f\> \`g\` \|h\| \$i\$ \#j"


def test_a_mechanism_s_facts_name_its_ground():
    entry = load_any("four-bar")
    assert dict(facts(entry, documents.show(entry)))["links"] == "4, the ground (ground) included"


# The pages of docs/ ---------------------------------------------------------------------------------------------


def test_every_lecturer_s_page_is_known():
    assert set(docs_pages.lecturers()) == {"C. Laschi", "R. Ahmed", "M. Yim", "W. Lucia"}


def test_links_lead_on_the_site_where_they_lead_on_a_forge():
    page = docs_pages.DOCS / "grading.md"
    said = "see [a](README.md), [b](../README.md#install), [c](grading), [d](x.ipynb), [e](https://x.y/README.md)"
    shown = "see [a](index.md), [b](../index.md#install), [c](grading/files.md), [d](x.md), [e](https://x.y/README.md)"
    assert docs_pages.on_site(said, page) == shown
    fenced = "```text\n[a](README.md)\n```\n"
    assert docs_pages.on_site(fenced, page) == fenced


def test_the_source_has_every_page_and_the_index_leads_to_it(tmp_path):
    docs_pages.write_docs(tmp_path, playground=True)
    pages = {path.relative_to(tmp_path).with_suffix("").as_posix() for path in tmp_path.rglob("*.md")}
    led = {"index"}
    for path in tmp_path.rglob("*.md"):
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```", path.read_text(), re.M | re.S):
            for line in block.splitlines():
                if line and not line.startswith(":"):
                    goal = tmp_path / line[1:] if line.startswith("/") else path.parent / line
                    led.add(goal.resolve().relative_to(tmp_path.resolve()).as_posix().removesuffix(".md"))
    assert led - pages == {"gallery/index"}
    alone = {page for page in pages - led if "orphan: true" not in (tmp_path / f"{page}.md").read_text()}
    assert alone == set()


def test_a_notebook_becomes_a_page():
    cells = [
        {"cell_type": "markdown", "source": ["# Title\n", "text"]},
        {"cell_type": "code", "source": ["1 + 1"], "outputs": [{"data": {"text/plain": ["2"]}}]},
        {"cell_type": "code", "source": ["print(3)"], "outputs": [{"name": "stdout", "text": ["3\n"]}]},
        {"cell_type": "code", "source": [" "], "outputs": []},
    ]
    assert docs_pages.notebook_text({"cells": cells}) == (
        "# Title\ntext\n\n```python\n1 + 1\n```\n\n```text\n2\n```\n\n```python\nprint(3)\n```\n\n```text\n3\n```\n"
    )


# Links ----------------------------------------------------------------------------------------------------------


def site(folder: Path, body: str) -> Path:
    (folder / "sub").mkdir()
    (folder / "index.html").write_text('<h1 id="top">x</h1>')
    (folder / "sub" / "page.html").write_text(body)
    return folder


@pytest.mark.parametrize(
    "link",
    [
        '<a href="../index.html#top">',
        '<a href="..">',
        '<a href="https://example.org/x">',
        '<a href="mailto:a@b.c">',
        '<b id="here"><a href="#here">',
        '<img alt="" src="data:image/png;base64,AA">',
    ],
)
def test_links_that_lead_somewhere(link, tmp_path):
    assert links.faults(site(tmp_path, link)) == []


@pytest.mark.parametrize(
    ("link", "fault"),
    [
        ('<a href="../other.html">', "../other.html: there is no such file"),
        ('<a href="../index.html#bottom">', "../index.html#bottom: there is no place 'bottom' in it"),
        ('<a href="#bottom">', "#bottom: there is no place 'bottom' in it"),
        ('<a href="/index.html">', "/index.html: begins at the server's root, expected a relative link"),
        ('<script src="https://example.org/x.js">', "https://example.org/x.js: fetched from elsewhere"),
        ('<link rel="stylesheet" href="//example.org/x.css">', "//example.org/x.css: fetched from elsewhere"),
        ('<img src="../index.html">', "../index.html: a picture without words (alt)"),
    ],
)
def test_links_that_do_not(link, fault, tmp_path):
    assert links.faults(site(tmp_path, link)) == [f"sub/page.html: {fault}"]


def test_what_a_style_sheet_fetches_is_looked_at(tmp_path):
    folder = site(tmp_path, "")
    (folder / "style.css").write_text(
        "a { background: url('no.png') } b { background: url(https://example.org/f.woff2) }"
    )
    assert links.faults(folder) == [
        "style.css: no.png: there is no such file",
        "style.css: https://example.org/f.woff2: fetched from elsewhere",
    ]


def test_a_lecture_leads_to_itself_and_to_its_robots_in_the_playground():
    found = {}
    for path in (docs_pages.DOCS / "lectures").glob("*.md"):
        text = path.read_text(encoding="utf-8")
        found[path.stem] = docs_pages.entries_of(text)
        page = docs_pages.with_playground(text, path.stem)
        addresses = re.findall(r'<a href="../../playground/index.html#([^"]+)">', page)
        assert addresses[0] == f"r={found[path.stem][0]}&amp;t=lectures&amp;l={path.stem}"
        assert addresses[1:] == [f"r={name}" for name in found[path.stem]]
        assert page.partition("\n")[0] == text.partition("\n")[0] and page.endswith(text.partition("\n\n")[2])
    # As `robokin list lucia` and `robokin list ahmed` print them; the third lecture has Craig's arm alone.
    assert found["lucia"] == ["anthropomorphic", "planar3r"] and found["transforms"] == ["puma560-craig"]
    assert found["ahmed"] == ["fanuc", "planar3r-brac", "scara", "scorbot"]
    assert {"human-hand", "thumb", "human-body", "car"} <= set(found["laschi"])
    assert {"four-bar", "sarrus", "planar2r"} <= set(found["yim"])
