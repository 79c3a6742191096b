"""The tree keeps every scalar as it is written, with its place, and refuses what no description needs."""

from __future__ import annotations

import time

import pytest
import yaml
from formats.texts import HEAD, arm, error_of, place
from sweeps import sweep

from robokin.formats import read_text
from robokin.formats.yaml_reader import read_tree
from robokin.formats.yaml_tree import Mapping, Scalar, Sequence, describe

LOADERS = ["libyaml", "python"]


@pytest.fixture(params=LOADERS)
def loader(request, monkeypatch):
    """Both of PyYAML's parsers: where libyaml is missing the one in Python stands in."""
    if request.param == "python":
        monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    return request.param


def entries(text):
    tree = read_tree(text, "t.yaml")
    assert isinstance(tree, Mapping)
    return tree.entries


# Scalars ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["1e-3", "012", "1:30", "no", "yes", "0x10", "1_000", ".5", "2001-01-01", "=", "true"])
def test_a_scalar_stays_text(loader, text):
    node = entries(f"a: {text}\n")["a"]
    assert isinstance(node, Scalar)
    assert node.text == text
    assert not node.quoted
    assert not node.empty


@pytest.mark.parametrize("text", ["", "~", "null"])
def test_nothing_is_empty_and_a_quoted_nothing_is_not(loader, text):
    found = entries(f"a: {text}\nb: '{text}'\nc: \"{text}\"\n")
    assert found["a"].empty
    assert not found["b"].empty
    assert not found["c"].empty


def test_places_count_from_one(loader):
    found = entries("a: 1\nb:\n  - {c: 2, d: [3]}\n")
    inner = found["b"].items[0]
    assert (found["a"].mark.line, found["a"].mark.column) == (1, 4)
    assert (inner.mark.line, inner.mark.column) == (3, 5)
    assert (inner.keys["d"].line, inner.keys["d"].column) == (3, 12)
    assert (inner.entries["d"].items[0].mark.line, inner.entries["d"].items[0].mark.column) == (3, 16)


@pytest.mark.parametrize("lines", ["\n", "\r\n", "\r"], ids=["LF", "CRLF", "CR"])
def test_every_line_ending_counts_lines_alike(loader, lines):
    found = entries(lines.join(["a: 1", "# a comment", "", "b: 2", ""]))
    assert (found["b"].mark.line, found["b"].mark.column) == (4, 4)
    assert found["b"].text == "2"


def test_a_byte_order_mark_is_no_text(loader):
    found = entries("\ufeffa: 1\n")
    assert list(found) == ["a"]
    assert found["a"].mark.column == 4


def test_letters_beyond_ascii_count_as_one_column(loader):
    assert entries("{é𝜃: 1, b: 2}")["b"].mark.column == 12


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1, 2]", "a list of 2"),
        ("[]", "an empty list"),
        ("{}", "an empty mapping"),
        ("{a: 1}", "a mapping"),
        ("~", "nothing"),
        ("'a\n\n  b'", "'a b'"),
        ('"\\e[31m"', "'\\x1b[31m'"),
        ("x" * 1000, f"'{'x' * 57}...'"),
    ],
)
def test_what_a_node_is_in_a_message(text, said):
    assert describe(read_tree(text, "t.yaml")) == said


# Keys, anchors, merges -------------------------------------------------------------------------------


def test_a_key_given_twice_is_refused_and_the_first_line_named(loader):
    error = error_of(HEAD + "joints:\n  - type: R\n    a: 1\n    d: 2\n    a: 3\n")
    assert (error.line, error.column) == (7, 5)
    assert "twice, first on line 5" in error.message


@pytest.mark.parametrize("again", ["a: 2", "'a': 2", '"a": 2'])
def test_quotes_do_not_hide_a_key_given_twice(again):
    assert "twice" in error_of(f"a: 1\n{again}\n").message


def test_an_alias_is_what_it_names(loader):
    found = entries("a: &x [1, 2]\nb: *x\n")
    assert found["b"] is found["a"]


@pytest.mark.parametrize("text", ["a: *x\n", "a: *x\nb: &x 1\n", "a: &x [*x]\n"])
def test_an_alias_without_its_anchor_is_refused(loader, text):
    error = error_of(text)
    assert error.line == 1
    assert "expected an anchor &x before it" in error.message


def test_a_merge_takes_what_is_not_given(loader):
    found = entries("a: &x {p: 1, q: 2}\nb: &y {q: 3, r: 4}\nc: {<<: [*x, *y], p: 0}\nd: {<<: *x}\n")
    assert {name: node.text for name, node in found["c"].entries.items()} == {"p": "0", "q": "2", "r": "4"}
    assert list(found["d"].entries) == ["p", "q"]


def test_a_quoted_merge_key_is_a_key(loader):
    assert list(entries("a: {'<<': 1}")["a"].entries) == ["<<"]


@pytest.mark.parametrize("value", ["1", "[1]", "[[]]", "~"])
def test_only_mappings_can_be_merged(loader, value):
    assert "expected a mapping or its alias" in error_of(f"a: {{<<: {value}}}\n").message


def test_a_merge_given_twice_is_refused(loader):
    assert "'<<' twice" in error_of("a: &x {p: 1}\nb: {<<: *x, <<: *x}\n").message


def test_rows_can_repeat_by_anchors_and_merges():
    text = arm("&row {type: R, a: 100}".strip("{}"), head=HEAD)  # the braces are arm's
    text = HEAD + "joints:\n  - &row {type: R, a: 1, alpha: 0.5}\n  - *row\n  - {<<: *row, a: 3}\n"
    robot = read_text(text)
    assert [(row.name, row.a, row.alpha) for row in robot.rows] == [("1", 1, 0.5), ("2", 1, 0.5), ("3", 3, 0.5)]


@pytest.mark.parametrize("key", ["[1, 2]", "{a: 1}", "? [1]"])
def test_a_key_is_a_word(loader, key):
    assert "as a key, expected a word" in error_of(f"{key}: 1\n", mistakes=2 if key == "? [1]" else 1).message


# What no description needs ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "tag",
    [
        "!!python/object/apply:os.system ['true']",
        "!!python/name:os.system ''",
        "!!python/object:object {}",
        "!!int 1",
        "!!str 1",
        "!!map {}",
        "!mine 1",
        "!<tag:yaml.org,2002:float> 1",
    ],
)
@pytest.mark.parametrize(
    "before", ["", "name: x\njoints: [{type: R}]\nrobokin: ", "robokin: 1\nname: x\njoints: [{type: R, a: "]
)
def test_a_tag_is_refused_and_runs_nothing(loader, tag, before):
    close = "}]" if before.endswith("a: ") else ""
    error = error_of(before + tag + close + "\n")
    assert "expected none" in error.message
    assert error.column == len(before.splitlines()[-1]) + 1 if before else 1


@pytest.mark.parametrize("opening", ["[", "{", "- ", "? ", "[{a: ", "{a: ["])
def test_deep_nesting_is_refused_at_once(loader, opening):
    start = time.process_time()
    assert "levels of nesting" in error_of(opening * 100_000).message
    assert time.process_time() - start < 5.0


def refusing(parser, limit, late):
    """A parser that refuses nesting beyond its own limit, at the opening or just after it."""

    class Refusing(parser):
        def fetch_flow_collection_start(self, *given):
            mark = self.get_mark()
            super().fetch_flow_collection_start(*given)
            if self.flow_level > limit:
                raise yaml.scanner.ScannerError(None, None, "no", self.get_mark() if late else mark)

    return Refusing


DEEP = {
    "lists": ("[" * 5000, "1:33"),
    "mappings": ("{" * 5000, "1:33"),
    "both": ("[{a: " * 5000, "1:78"),
    "mappings in mappings": ("{a: " * 5000, "1:126"),
    "no spaces": ("['',{'':" * 3000, "1:126"),
    "blocks": ("- " * 5000, "1:65"),
    "lists in a block": ("a:\n  - b: " + "[" * 5000, "2:37"),
    "lists, then a tag": ("[" * 40 + "!mine 1", "1:33"),
    "lists, then no value": ("[" * 40 + "@", "1:33"),
    "mappings, then text": ("{a: " * 40 + "b: c: d", "1:126"),
    "lists, then a bracket too many": ("[" * 40 + "]" * 41, "1:33"),
    "a library's own limit, then a mistake": ("[" * 2000 + "@" + "]" * 2000, "1:33"),
}


@pytest.mark.parametrize(("text", "at"), DEEP.values(), ids=DEEP)
def test_deep_nesting_is_said_at_the_place_where_it_exceeds_the_limit(loader, text, at):
    error = error_of(text)
    assert "found more than 32 levels of nesting" in error.message
    assert f"{error.line}:{error.column}" == at


@pytest.mark.parametrize(("text", "at"), DEEP.values(), ids=DEEP)
@pytest.mark.parametrize("limit", sweep([33, 1000], 2))
@pytest.mark.parametrize("late", [False, True], ids=["at the opening", "after it"])
def test_that_place_does_not_depend_on_what_a_library_refuses(monkeypatch, text, at, limit, late):
    monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    monkeypatch.setattr(yaml, "SafeLoader", refusing(yaml.SafeLoader, limit, late))
    error = error_of(text)
    assert "found more than 32 levels of nesting" in error.message
    assert f"{error.line}:{error.column}" == at


def test_deep_nesting_after_a_text_of_a_mebibyte(loader):
    assert place("a: 1\nb: " + "x" * 1_000_000 + "\nc: " + "[" * 5000) == "3:35"


@pytest.mark.parametrize(
    "text",
    sweep(
        [
            "a: '" + "[" * 2000 + "'\n",
            'a: "' + "{a: " * 2000 + '"\n',
            "# " + "[" * 2000 + "\na: 1 # " + "{" * 2000 + "\n",
            "a: x" + "[" * 2000 + "\n",
            "a: |\n  " + "[" * 2000 + "\n",
            "a: [" + "[], " * 2000 + "]\n",
            "a: [" + "{b: [1]}, " * 2000 + "]\n",
        ],
        4,
    ),
)
def test_brackets_that_do_not_nest_are_not_counted(loader, text):
    assert list(entries(text)) == ["a"]
    error = error_of(text + "b: c: d\n")
    assert "levels of nesting" not in error.message
    assert f"{error.line}:{error.column}" == f"{text.count(chr(10)) + 1}:5"


def test_thirty_two_levels_are_read_and_thirty_three_are_not(loader):
    assert isinstance(read_tree("[" * 32 + "]" * 32, "t.yaml"), Sequence)
    assert place("[" * 33 + "]" * 33) == "1:33"


BOMBS = {
    "billion laughs": "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [{f'*a{i - 1}, ' * 9}x]\n" for i in range(1, 30)),
    "merges in many mappings": "a: &a {"
    + ", ".join(f"k{i}: 0" for i in range(20_000))
    + "}\nb: ["
    + "{<<: *a}, " * 3000
    + "]",
    "merges in a list": "a: &a {"
    + ", ".join(f"k{i}: 0" for i in range(20_000))
    + "}\nb: {<<: ["
    + "*a, " * 9000
    + "]}",
    "a long value": "a: &a " + "1+" * 4900 + "1\nb: [" + "*a, " * 50_000 + "]",
    "a long key": f"a: &a {'k' * 900}\nb: [" + "{*a : 1}, " * 9000 + "]",
}


@pytest.mark.parametrize("bomb", sweep(BOMBS.values(), 3), ids=BOMBS)
def test_aliases_cannot_multiply(loader, bomb):
    start = time.process_time()
    assert "aliases written out" in error_of(bomb).message
    assert time.process_time() - start < 10.0


@pytest.mark.parametrize("second", ["---\na: 1\n", "...\n---\n", "--- 1"])
def test_a_second_document_is_refused(loader, second):
    error = error_of(f"a: 1\n{second}")
    assert "second document" in error.message
    assert error.line >= 2


@pytest.mark.parametrize("text", ["", "\n\n", "# only\n# comments\n", "\ufeff", "---\n", "~", " \r\n"])
def test_a_file_that_holds_nothing(loader, text):
    assert "expected a description" in error_of(text).message


def test_one_document_may_be_marked_as_one(loader):
    assert list(entries("%YAML 1.1\n---\na: 1\n...\n")) == ["a"]


@pytest.mark.parametrize(
    ("character", "code"),
    [("\0", "0000"), ("\x07", "0007"), ("\x1b", "001B"), ("\x7f", "007F"), ("\x9f", "009F"), ("\ud800", "D800"),
     ("\ufeff", "FEFF"), ("\uffff", "FFFF")],
)  # fmt: skip
def test_a_character_that_is_no_text_is_named_with_its_place(loader, character, code):
    error = error_of(f"a: 1\nbb: x{character}y\n")
    assert (error.line, error.column) == (2, 6)
    assert f"U+{code}" in error.message


INSIDE = "found ': ' inside a value, expected quotes"
NO_YAML = "this is not YAML: "  # what follows are the library's words


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        ("a: b: c\n", "1:5", INSIDE),
        ("a: 1\n  b: 2\n", "2:4", INSIDE),
        ("a:\n\t- 1\n", "2:1", "found a tab, expected spaces"),
        ("a: @x\n", "1:4", "found '@' where a value starts, expected it in quotes"),
        ("a: `x`\n", "1:4", "found '`' where a value starts, expected it in quotes"),
        ("a: %x\n", "1:4", "found '%' where a value starts, expected it in quotes"),
        ("a: [1, |]\n", "1:8", "found '|' where a value starts, expected it in quotes"),
        ("- - >x\n", "1:6", NO_YAML),
        ("a: 'x\n", "2:1", NO_YAML),
        ("a: [1, 2\n", "2:1", NO_YAML),
        ("a: {b: 1\n", "2:1", NO_YAML),
        ("a: 1]\nb: [1]]\n", "2:7", NO_YAML),
        ("- a\nb: 1\n", "2:1", NO_YAML),
        ('a: "\\q"\n', "1:5", NO_YAML),
        ("a: &\n", "1:5", NO_YAML),
        ("...\n", "1:1", NO_YAML),
    ],
)
def test_what_is_no_yaml_is_said_with_its_place(text, at, said):
    error = error_of(text)
    assert f"{error.line}:{error.column}" == at
    assert error.message.startswith(said)


CUT = [
    ("joints: [{type: R, origin: Trans(0, 0, 1)}]", "1:28"),
    ("joints: [{type: R, origin: DH(0, 0, 0, 0), axis: z}]", "1:28"),
    ("joints: [{origin: Rot(z, 90) Trans(0, 0, 0), type: R}]", "1:19"),
    ("poses: {home: [atan2(1, 2)], a: [0]}", "1:16"),
    ("poses: {home: [max(1, 2, 3)]}", "1:16"),
]


@pytest.mark.parametrize(("text", "at"), CUT)
def test_an_expression_that_a_comma_cuts_wants_quotes(loader, text, at):
    tail = "joints: [{type: R}]\n" if "poses" in text else "convention: frames\n"
    error = error_of(f"{text}\nrobokin: 1\nname: x\n{tail}")
    assert f"{error.line}:{error.column}" == at
    assert "cut off at a comma, expected the expression in quotes" in error.message


def test_parentheses_in_a_text_are_no_expression(loader):
    found = entries("a: (left\nb: [(left), ') right', 'x(', y]\nc: {name: 'arm (', b: 1}\n")
    assert found["b"].items[1].text == ") right"


def test_text_of_a_mebibyte_in_one_value_is_read(loader):
    assert len(entries("a: " + "x" * 1_000_000)["a"].text) == 1_000_000
