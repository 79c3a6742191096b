"""The pages of docs/: their commands print what they show, none is missing, and every link leads somewhere."""

from __future__ import annotations

import re
import sys

import documentation
import pytest
import yaml
from documentation import DOCS, INDEX, ROOT, command_page, output, pages, rewritten, runs, same, steps, with_commands

from robokin.cli.app import COMMANDS
from robokin.formats import schema
from robokin.formats.read import read_text

PAGES = [page for page in pages() if page.parent != ROOT]


def name_of(page):
    return str(page.relative_to(ROOT))


LONG = {DOCS / "shell.md", DOCS / "commands" / "workspace.md"}
"""Pages whose commands take seconds."""


@pytest.mark.parametrize(
    "page", [pytest.param(page, marks=[pytest.mark.slow] if page in LONG else []) for page in PAGES], ids=name_of
)
def test_commands_print_what_is_shown(page, tmp_path, monkeypatch):
    documentation.lay_out(page, tmp_path)
    monkeypatch.chdir(tmp_path)
    wrong = []
    for step in steps(page.read_text()):
        if runs(step.command) and not same(printed := output(step.command), step.shown):
            wrong.append(f"$ {step.command}\n{printed}")
    assert not wrong, "these print something else now; `make docs` rewrites them:\n" + "\n".join(wrong)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_its_page(name):
    text = command_page(name).read_text()
    commands = [step.command for step in steps(text)]
    assert text.startswith(f"# robokin {name}\n\n{COMMANDS[name]}\n")
    assert f"robokin {name} --help" in commands
    assert any(command.startswith(f"robokin {name} ") and "--help" not in command for command in commands)


def test_no_page_is_left_of_a_command_that_is_gone():
    assert {page.stem for page in (DOCS / "commands").iterdir()} == {*COMMANDS}


def test_the_index_lists_every_page():
    index = INDEX.read_text()
    assert index == with_commands(index)
    listed = {(DOCS / target).resolve() for target in re.findall(r"\]\(([^)#]+)", index)}
    assert [name_of(page) for page in PAGES if page != INDEX and page.resolve() not in listed] == []


def anchors(page):
    """What a heading is called in a link, as GitHub makes it."""
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page):
    for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)]*))?\)", re.sub(r"`[^`]*`", "", page.read_text())):
        if target.startswith("http"):
            continue
        goal = page.parent / target if target else page
        assert goal.exists(), target
        assert not anchor or anchor in anchors(goal), f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_descriptions_in_the_text_can_be_read(page):
    for block in re.findall(r"^```yaml\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL):
        if "robokin:" in block:
            assert read_text(block).name == yaml.safe_load(block)["name"]


@pytest.mark.parametrize(
    "fields",
    [
        "ROBOT",
        "SCREWS",
        "SCREW_ROW",
        "ETS",
        "OPW",
        "UNITS",
        "DH_ROW",
        "FRAME_ROW",
        "MECHANISM",
        "EXPECTED",
        "MECHANISM_JOINT",
        "LINK",
        "WHEELED",
        "WHEEL",
        "BASE_EXPECTED",
    ],
)
def test_the_format_s_page_knows_every_key(fields):
    text = (DOCS / "format.md").read_text()
    for name, field in getattr(schema, fields).items():
        for word in (name, *field.choices):
            assert re.search(rf"`{word}`|\b{word}:|[|:] {word}\b", text), f"{fields}: {word}"


# What reruns and rewrites ---------------------------------------------------------------------------------------

PAGE = """# A page

```console
$ make test
$ robokin frame "Rot(z,90)" --point 1,2,3 | tail -n 1
{shown}
$ cat > arm.yaml <<'END'
> robokin: 1
> name: Arm
> joints: [{{type: R, a: 1}}]
> END
$ robokin validate arm.yaml
{verdict}
```

Text with $ and `code`.
"""
TRUE = PAGE.format(shown="point           -2  1  3", verdict="ok     arm.yaml: robot Arm")


def test_a_page_is_taken_apart():
    first, second, third, last = steps(TRUE)
    assert (first.command, first.shown) == ("make test", "")
    assert second.shown == "point           -2  1  3"
    assert third.command.splitlines()[0] == "cat > arm.yaml <<'END'"
    assert third.command.splitlines()[-1] == "END"
    assert last.command == "robokin validate arm.yaml"
    assert [runs(step.command) for step in (first, second, third, last)] == [False, True, True, True]


@pytest.mark.parametrize("shown", ["point           -2  1  4", "", "something\nlong"])
def test_what_is_not_true_is_rewritten(shown):
    lines = [line for line in PAGE.format(shown=shown, verdict="wrong").splitlines() if line or shown]
    page = "\n".join(lines) + "\n"
    assert [line for line in rewritten(page).splitlines() if line] == [line for line in TRUE.splitlines() if line]


def test_what_is_true_to_the_last_digits_stays():
    assert rewritten(TRUE) == TRUE
    command = "robokin frame 'Rot(z,30)' --as euler -f csv"
    page = f"```console\n$ {command}\nx,y,z,phi,theta,psi\n0,0.0,0,0,0,30.00000000001\n```\n"
    assert rewritten(page) == page


def test_same_compares_words_exactly_and_numbers_closely():
    assert same("at 1.0000000000001 m", "at 1 m")
    assert same("the next is 5.7e-17", "the next is 0")
    assert not same("at 1.00001 m", "at 1 m")
    assert not same("at 1 m", "at 1 cm")
    assert not same("1 2", "1 2 3")


@pytest.mark.parametrize(
    "command",
    [
        "robokin frame 'Rot(z,90)' --as quaternion -f csv | tail -n 1",
        "robokin fk puma650 --q home",
        "robokin list nobody",
    ],
)
def test_in_this_process_and_in_a_shell_the_same_is_seen(command):
    assert documentation.in_this_process(command) == documentation.in_a_shell(command)


def test_a_new_command_gets_a_page():
    page = rewritten(documentation.new_command_page("schema", COMMANDS["schema"]))
    assert page.startswith("# robokin schema\n\n")
    assert "robokin schema [COMMAND] [OPTIONS]" in page


def test_make_docs_has_nothing_to_do_on_a_true_page(monkeypatch, capsys):
    page = DOCS / "commands" / "schema.md"
    before = page.read_text()
    monkeypatch.setattr(sys, "argv", ["documentation.py", str(page)])
    documentation.main()
    assert capsys.readouterr().out == ""
    assert page.read_text() == before


# The pages for who changes the code -----------------------------------------------------------------------------

FOR_CHANGES = [ROOT / "CONTRIBUTING.md", DOCS / "architecture.md"]
PLACE = re.compile(r"(?<![\w./])(?:robokin|robots|tests|docs|benchmarks|\.ci)/[\w./-]*\w|\.pre-commit[\w.-]+\w")
"""A file or a folder of the checkout."""


@pytest.mark.parametrize("page", FOR_CHANGES, ids=name_of)
def test_every_place_that_is_named_is_there(page):
    named = [place for place in PLACE.findall(page.read_text()) if "NAME" not in place]
    assert len(named) > 20
    assert [place for place in named if not (ROOT / place).exists()] == []


@pytest.mark.parametrize("page", FOR_CHANGES, ids=name_of)
def test_every_target_that_is_named_is_in_the_makefile(page):
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.M)
    named = re.findall(r"(?:`|^)make ([a-z-]+)", page.read_text(), re.M)
    assert named
    assert set(named) <= set(targets)


def test_links_of_the_page_at_the_top_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", FOR_CHANGES[0].read_text()):
        assert (ROOT / target).exists(), target


def test_ten_questions_have_a_place_each():
    rows = re.findall(r"^\| (Where [^|]+\?) \| `([^`]+)` \|$", FOR_CHANGES[1].read_text(), re.M)
    assert len(rows) == 10
    assert all((ROOT / place).is_file() for _, place in rows)


def test_every_room_is_on_the_map():
    text = FOR_CHANGES[1].read_text()
    rooms = {path.parent.name for path in (ROOT / "robokin").glob("*/__init__.py")}
    assert {room for room in rooms if f"`robokin/{room}/`" not in text} == set()


def test_what_is_looked_at_with_a_commit_is_what_lint_looks_at():
    (local,) = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    entries = {" ".join(hook["entry"].split()[:2]) for hook in local["hooks"]}
    assert entries == {".venv/bin/ruff check", ".venv/bin/ruff format", ".venv/bin/mypy"}
    recipe = re.search(r"^lint:.*\n((?:\t.*\n)+)", (ROOT / "Makefile").read_text(), re.M)[1]
    assert re.findall(r"\$\(BIN\)/(\w+(?: check| format)?)", recipe) == ["ruff check", "ruff format", "mypy"]


def test_a_change_lands_after_all_tests():
    """What `make test` leaves out is what `make test-slow` runs."""
    targets = re.search(r"^for target in (.*)$", (ROOT / ".ci" / "run").read_text(), re.M)[1].split()
    assert {"lint", "test", "test-slow"} <= set(targets)
    marks = re.findall(r"\$\(PYTEST\) -m (.*)$", (ROOT / "Makefile").read_text(), re.M)
    assert marks == ["'not slow'", "slow"]
