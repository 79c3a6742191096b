"""A URDF is read as the format has it, and what is none is refused where it stands."""

import math
from itertools import pairwise

import numpy as np
import pytest

import robokin
from robokin.errors import DescriptionError
from robokin.formats.snapped_angles import snapped_angle
from robokin.formats.urdf import read_urdf
from robokin.formats.xml_tree import read_xml


def links(*names):
    return "".join(f'<link name="{name}"/>\n' for name in names)


def joint(name, parent, child, type="revolute", inner=""):
    return f'<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/>{inner}</joint>\n'


def robot(*parts):
    return '<?xml version="1.0"?>\n<robot name="r">\n' + "".join(parts) + "</robot>\n"


def read(*parts, **options):
    return read_urdf(robot(*parts), "r.urdf", **options)


def refusal(*parts):
    text = parts[0] if len(parts) == 1 and isinstance(parts[0], bytes) else robot(*parts)
    with pytest.raises(DescriptionError) as caught:
        read_urdf(text, "r.urdf")
    return caught.value


def motion(kind, value):
    """Along or about z."""
    c, s = math.cos(value), math.sin(value)
    if kind == "prismatic":
        return np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, value], [0, 0, 0, 1.0]])
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def pose(tree, link, values):
    """The pose of a link, by the product of the graph's joints."""
    if link == tree.graph.links[tree.graph.root]:
        return np.eye(4)
    one = next(j for j in tree.graph.joints if tree.graph.links[j.child] == link)
    moved = motion(one.type, values[one.name]) if one.moves else np.eye(4)
    return pose(tree, tree.graph.links[one.parent], values) @ one.before @ moved @ one.after


def step(xyz, rpy, axis, kind, value):
    """Trans(xyz) Rz(y) Ry(p) Rx(r) and the motion by Rodrigues' formula, as urdfdom says it."""
    (r, p, y), T = rpy, np.eye(4)
    Rx = np.array([[1, 0, 0], [0, math.cos(r), -math.sin(r)], [0, math.sin(r), math.cos(r)]])
    Ry = np.array([[math.cos(p), 0, math.sin(p)], [0, 1, 0], [-math.sin(p), 0, math.cos(p)]])
    Rz = np.array([[math.cos(y), -math.sin(y), 0], [math.sin(y), math.cos(y), 0], [0, 0, 1]])
    T[:3, :3], T[:3, 3] = Rz @ Ry @ Rx, xyz
    u, M = np.array(axis) / np.linalg.norm(axis), np.eye(4)
    if kind == "prismatic":
        M[:3, 3] = u * value
    elif kind != "fixed":
        K = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
        M[:3, :3] += math.sin(value) * K + (1 - math.cos(value)) * K @ K
    return T @ M


@pytest.mark.parametrize("seed", range(20))
def test_random_trees_stand_where_the_format_says(seed):
    rng = np.random.default_rng(seed)
    count = 12
    kinds = rng.choice(["revolute", "continuous", "prismatic", "fixed"], count)
    parents = [int(rng.integers(0, i + 1)) for i in range(count)]
    numbers = rng.uniform(-2, 2, (count, 9))
    order = rng.permutation(count)  # a joint may stand before the one that it hangs on
    parts = []
    for i in order:
        xyz, rpy, axis = (" ".join(map(repr, row.tolist())) for row in numbers[i].reshape(3, 3))
        inner = f'<axis xyz="{axis}"/><origin xyz="{xyz}" rpy="{rpy}"/><limit lower="-9" upper="9"/>'
        parts.append(joint(f"j{i + 1}", f"l{parents[i]}", f"l{i + 1}", kinds[i], inner))
    tree = read(links(*(f"l{i}" for i in range(count + 1))), *parts)
    values = {f"j{i + 1}": float(rng.uniform(-3, 3)) for i in range(count)}
    expected = [np.eye(4)]
    for i in range(count):
        xyz, rpy, axis = numbers[i].reshape(3, 3)
        expected.append(expected[parents[i]] @ step(xyz, rpy, axis, kinds[i], values[f"j{i + 1}"]))
    for i, T in enumerate(expected):
        assert np.abs(pose(tree, f"l{i}", values) - T).max() < 1e-13


def test_what_is_left_out_has_the_formats_defaults():
    tree = read(links("a", "b"), joint("j", "a", "b", "continuous"))
    assert np.allclose(pose(tree, "b", {"j": 0.3}), step((0, 0, 0), (0, 0, 0), (1, 0, 0), "revolute", 0.3), atol=1e-16)
    assert tree.limits.tolist() == [[-math.inf, math.inf]]
    assert not tree.notes


def test_a_robot_needs_no_name_and_a_link_no_joint():
    tree = read_urdf("<robot><link name='a'/></robot>", "r.urdf", id="mine")
    assert (tree.name, tree.n, tree.tips) == ("mine", 0, ("a",))


def test_only_the_robots_own_children_are_links_and_joints():
    inner = (
        '<transmission><joint name="j"/><link name="q"/></transmission><ros2_control><joint name="k"/></ros2_control>'
    )
    assert read(links("a", "b"), joint("j", "a", "b"), inner).graph.links == ("a", "b")


def test_limits_that_say_nothing_are_none_and_noted():
    tree = read(
        links("a", "b", "c", "d"),
        joint("j", "a", "b", inner='<limit effort="1" velocity="2"/>'),
        joint("k", "b", "c", "continuous", '<limit lower="-1" upper="1"/>'),
        joint("m", "c", "d", inner='<limit upper="1"/>'),
    )
    assert tree.limits.tolist() == [[-math.inf, math.inf], [-math.inf, math.inf], [0.0, 1.0]]
    assert [note.line for note in tree.notes] == [7, 8, 9]


def test_mimics_follow_in_chains_and_in_any_order():
    tree = read(
        links("a", "b", "c", "d", "e"),
        joint("j", "a", "b", inner='<mimic joint="k" multiplier="2" offset="0.5"/>'),
        joint("k", "b", "c", "prismatic", '<mimic joint="m" multiplier="-3"/>'),
        joint("m", "c", "d", "continuous"),
        joint("f", "d", "e", "fixed", '<mimic joint="m"/>'),
    )
    S, o = tree.graph.value_map
    assert tree.n == 1
    assert S.tolist() == [[-6.0], [-3.0], [1.0]]
    assert o.tolist() == [0.5, 0.0, 0.0]


def test_a_mimic_of_no_joint_moves_freely_with_a_note():
    tree = read(links("a", "b"), joint("j", "a", "b", "continuous", '<mimic joint="gone"/>'))
    assert tree.n == 1
    assert "'gone'" in tree.notes[0].message


def test_a_mimic_of_a_fixed_joint_stands_still():
    tree = read(
        links("a", "b", "c"), joint("f", "a", "b", "fixed"), joint("j", "b", "c", inner='<mimic joint="f" offset="2"/>')
    )
    assert tree.n == 0
    assert tree.graph.value_map[1].tolist() == [2.0]


@pytest.mark.parametrize("type", ["floating", "planar"])
def test_a_joint_that_moves_the_whole_robot_is_left_out_with_a_note(type):
    tree = read(
        links("world", "foot", "a", "b"),
        joint("w", "world", "foot", "fixed"),
        joint("f", "foot", "a", type),
        joint("j", "a", "b", "continuous"),
    )
    assert tree.graph.links == ("a", "b")
    assert "'a' is the root" in tree.notes[0].message


@pytest.mark.parametrize("type", ["floating", "planar"])
def test_a_joint_of_many_freedoms_elsewhere_is_refused(type):
    error = refusal(links("a", "b", "c"), joint("j", "a", "b"), joint("f", "b", "c", type))
    assert "freedoms" in error.message
    assert error.line == 7


def test_tips_are_last_links_and_tools_first():
    arm = [joint("j", "a", "b"), joint("f", "b", "camera", "fixed"), joint("g", "b", "tool0", "fixed")]
    assert read(links("a", "b", "camera", "tool0"), *arm).tips == ("tool0",)
    fingers = [joint("l", "b", "left"), joint("r", "b", "right")]
    assert read(links("a", "b", "camera", "tool0", "left", "right"), *arm, *fingers).tips == ("tool0", "left", "right")
    assert read(
        links("a", "b", "x", "y"), joint("j", "a", "b"), joint("f", "b", "x", "fixed"), joint("g", "b", "y", "fixed")
    ).tips == ("x", "y")


# Angles cut in print.


@pytest.mark.parametrize(
    ("text", "twelfths"),
    [("1.57", 6), ("1.5708", 6), ("-1.5707", -6), ("3.141", 12), ("3.14", 12), ("3.1416", 12), ("0.785", 3),
        ("2.0944", 8), ("4.71", 18), ("1.570796327", 6)],
)  # fmt: skip
def test_parts_of_pi_cut_in_print_are_meant(text, twelfths):
    assert snapped_angle(float(text), text) == twelfths * (math.pi / 12)


@pytest.mark.parametrize(
    "text", ["0", "0.001", "-3.67e-06", "1.58", "1.572", "3.15", "3.13", "1.05", "0.26", "1.6", "3", "0.0001"]
)
def test_other_angles_are_not(text):
    assert snapped_angle(float(text), text) == float(text)


def test_right_angles_are_snapped_with_one_note_unless_exact():
    inner = '<origin rpy="1.5708 0 -3.14"/><limit lower="-1" upper="1"/>'
    parts = [links("a", "b", "c"), joint("j", "a", "b", inner=inner), joint("k", "b", "c", inner=inner)]
    tree, exact = read(*parts), read(*parts, exact=True)
    assert len(tree.notes) == 1
    assert "j, k" in tree.notes[0].message
    assert not exact.notes
    T, E = pose(tree, "b", {"j": 0.0}), pose(exact, "b", {"j": 0.0})
    assert np.array_equal(T[:3, :3], np.round(T[:3, :3]))
    assert np.allclose(E, step((0, 0, 0), (1.5708, 0, -3.14), (1, 0, 0), "fixed", 0), atol=1e-15)


# What is wrong.


@pytest.mark.parametrize(
    ("inner", "column", "words"),
    [
        ('<axis xyz="0 0 0"/>', 79, "0 0 0"),
        ('<axis xyz="0 0 nan"/>', 79, "'nan'"),
        ('<axis xyz="0 0 1_0"/>', 79, "'1_0'"),
        ('<axis xyz="0 0 １"/>', 79, "'１'"),
        ('<axis xyz="0 0 1e999"/>', 79, "finite"),
        ('<axis xyz="0 1"/>', 79, "3 numbers"),
        ('<axis xyz=""/>', 79, "3 numbers"),
        ('<origin rpy="0,1,2"/>', 81, "commas"),
        ('<origin xyz="0 0 -1.57."/>', 81, "'-1.57.'"),
        ('<origin xyz="0 0 1e13"/>', 81, "up to"),
        ('<origin xyz="0 0 $(arg x)"/>', 81, "3 numbers"),
        ('<limit lower="1" upper="-1"/>', 82, "above"),
        ('<limit lower="inf" upper="1"/>', 82, "'inf'"),
        ('<mimic joint="j"/>', 68, "circle"),
        ('<mimic joint="k" multiplier="1e300"/>', 97, "multiplier"),
    ],
)
def test_wrong_values_are_refused_where_they_stand(inner, column, words):
    error = refusal(links("a", "b"), joint("j", "a", "b", inner=inner))
    assert words in error.message
    assert (error.file, error.line, error.column) == ("r.urdf", 5, column)
    assert error.excerpt


@pytest.mark.parametrize(
    ("parts", "line", "words"),
    [
        ([""], 2, "no <link>"),
        ([links("a", "a")], 4, "second link 'a'"),
        ([links("a", "b", "c"), joint("j", "a", "b"), joint("j", "b", "c")], 7, "second joint 'j'"),
        ([links("a", "b"), joint("j", "a", "a")], 5, "own parent"),
        ([links("a", "b", "c"), joint("j", "a", "c"), joint("k", "b", "c")], 7, "one parent"),
        ([links("a", "b", "c")], 4, "3 links without a parent, a, b, c"),
        ([links("a", "b"), joint("j", "a", "b"), joint("k", "b", "a")], 5, "b → a → b"),
        ([links("a", "b", "c"), joint("j", "b", "c"), joint("k", "c", "b")], 6, "circle"),
        ([links("a", "base"), joint("j", "a", "bas")], 5, "did you mean 'base'"),
        ([links("a", "b"), joint("j", "a", "b", "revolut")], 5, "did you mean 'revolute'"),
        ([links("a", "b"), joint("j", "a", "b", "spherical")], 5, "'spherical'"),
        ([links("a", "b"), '<joint name="j"/>'], 5, "no type"),
        ([links("a", "b"), '<joint type="fixed"/>'], 5, "without a name"),
        ([links("a"), '<link name="b\x9b2J"/>'], 4, "printable"),
        ([links("a"), "<link/>"], 4, "without a name"),
        ([links("a", "b"), '<joint name="j" type="fixed"><parent link="a"/></joint>'], 5, "without a child"),
        (['<xacro:include filename="x"/>'], 3, ".xacro"),
    ],
)  # fmt: skip
def test_what_is_no_tree_is_refused_with_its_line(parts, line, words):
    error = refusal(*parts)
    assert words in error.message
    assert error.line == line


def test_all_mistakes_are_said_at_once():
    error = refusal(links("a", "b", "b"), joint("j", "a", "b", inner='<axis xyz="x"/>'), joint("k", "a", "c"))
    assert [one.line for one in error.errors] == [5, 6, 7]


def test_a_circle_of_mimics_is_printed():
    error = refusal(
        links("a", "b", "c"),
        joint("j", "a", "b", inner='<mimic joint="k"/>'),
        joint("k", "b", "c", inner='<mimic joint="j"/>'),
    )
    assert "j → k → j" in error.message


def test_commas_before_blanks_are_blanks_with_a_note():
    tree = read(links("a", "b"), joint("j", "a", "b", "fixed", '<origin xyz="1, 2, 3"/>'))
    assert pose(tree, "b", {})[:3, 3].tolist() == [1.0, 2.0, 3.0]
    assert "commas" in tree.notes[0].message


# What is no XML, or too much.


@pytest.mark.parametrize(
    ("data", "line", "column", "words"),
    [
        (b"", 1, 1, "no element"),
        (b"robokin: 1", 1, 1, "no XML"),
        (b"<robot>\n<link>\n</robot>", 3, 3, "<link> of line 2"),
        (b"<robot>\n  <link name='a' name='b'/>\n</robot>", 2, 18, "twice"),
        (b"<robot>&bomb;</robot>", 1, 8, "entity"),
        (b"<robot/><robot/>", 1, 9, "after the end"),
        (b"<robot>\n\xe9</robot>", 2, 1, "UTF-8"),
        (b"<mujoco/>", 1, 1, "expected <robot>"),
        (b'<?xml version="1.0" encoding="utf-7"?><robot/>', 1, 1, "utf-7"),
        (b"\n<!DOCTYPE r [<!ENTITY a 'b'>]><robot>&a;</robot>", 2, 1, "document type"),
        (b"<!DOCTYPE r SYSTEM '/etc/passwd'><robot/>", 1, 1, "document type"),
    ],
)
def test_what_is_no_xml_is_refused_with_its_place(data, line, column, words):
    error = refusal(data)
    assert words in error.message
    assert (error.line, error.column) == (line, column)


@pytest.mark.parametrize(
    "data",
    [
        b"\n\n <?xml version='1.0'?><robot><link name='\xc3\xa9'/></robot>",
        b"<robot><link name='\xc3\xa9'/></robot>\r\n\0",
        b"\xef\xbb\xbf<robot><link name='\xc3\xa9'/></robot>",
        b"<?xml version='1.0' encoding='ISO-8859-1'?><robot><link name='\xe9'/></robot>",
        "<?xml version='1.0' encoding='UTF-16'?><robot><link name='é'/></robot>".encode("utf-16"),
        "<robot><drake:joint/><!-- a -- b ---><link name='é'/></robot>",
    ],
)
def test_what_files_in_the_wild_have_is_read(data):
    assert read_urdf(data, "r.urdf").graph.links == ("é",)


def test_places_are_those_of_the_text():
    root = read_xml("\n  <?xml version='1.0'?><a>\n<é b='1'\n   c = '&lt;x'/></a>", "f")
    (node,) = root.children
    assert [(p.line, p.column) for p in (root.mark, node.mark, node.place_of("b"), node.place_of("c"))] == [
        (2, 24), (3, 1), (3, 7), (4, 9),
    ]  # fmt: skip
    assert node.attributes["c"] == "<x"


@pytest.mark.parametrize(
    "text",
    [
        "<robot>" * 300_000,
        "<robot>" + "<a/>" * 2_000_000,
        "<robot><link name='a'/><link name='" + "b" * 10_000_000 + "'/></robot>",
        "<!--" * 2_000_000,
        "<robot>" + "".join(f"<link name='{i}'/>" for i in range(100_000)) + "</robot>",
        "<robot>" + "<link name='a'/>" * 2000 + "</robot>",
        "<a>" + "x" * (1 << 24) + "</a>",
        robot(
            links(*range(1000)),
            *(joint(f"j{i}", i, i + 1, inner=f'<mimic joint="j{(i + 1) % 999}"/>') for i in range(999)),
        ),
    ],
    ids=["deep", "many", "long name", "comments", "links", "one name", "text", "mimics"],
)
def test_hostile_texts_end_in_a_sentence(text):
    with pytest.raises(DescriptionError) as caught:
        read_urdf(text, "r.urdf")
    assert caught.value.line
    assert len(str(caught.value)) < 20_000


def test_an_entity_bomb_is_refused_at_its_first_word():
    names = "abcdefghij"
    entities = "".join(f"<!ENTITY {b} '{f'&{a};' * 10}'>" for a, b in pairwise(names))
    error = refusal(f"<!DOCTYPE r [<!ENTITY a 'lol'>{entities}]><robot>&j;</robot>".encode())
    assert "document type" in error.message


# An XML declaration that does not stand first ----------------------------------------------------------------------

LICENCE = "<!-- A licence - -- of\n     several lines <?xml version='1.0' encoding='utf-16'?> -->\r\n\n<!---->  "
ARM = (
    "<robot name='é'><link name='a'/><link name='b'/>\n"
    "  <joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>"
)


def test_a_declaration_behind_comments_is_read_with_a_note():
    """As other readers take it; five of 1,826 files in the wild have one."""
    text = LICENCE + '<?xml version="1.0" encoding="utf-8"\n ?>\n' + ARM
    for given in (text, text.encode(), b"\xef\xbb\xbf" + text.encode(), "\n \n" + text):
        tree = read_urdf(given, "a.urdf")
        note = tree.notes[0]
        down = 2 if given[:1] == "\n" else 0
        assert (note.file, note.line, note.column) == ("a.urdf", 4 + down, 10)
        assert "found the XML declaration behind a comment" in note.message
        assert tree.name == "é"
    wrong = text.replace("link='a'", "link='x'")
    with pytest.raises(DescriptionError) as raised:
        read_urdf(wrong, "a.urdf")
    assert (raised.value.line, raised.value.column) == (7, 51)
    assert "<joint name='j'" in str(raised.value)


def test_the_encoding_of_a_declaration_behind_comments():
    text = LICENCE + '<?xml version="1.0" encoding="latin-1"?>' + ARM
    assert read_urdf(text.encode("latin-1"), "a.urdf").name == "é"
    with pytest.raises(DescriptionError, match="utf-7"):
        read_urdf(text.replace("latin-1", "utf-7").encode(), "a.urdf")


@pytest.mark.parametrize(
    "text",
    [
        "<!-- <?xml version='1.0'?>" + ARM,
        "<?xml version='1.0'?><!-- --><?xml version='1.0'?>" + ARM,
        "<!-- --><?xml version='1.0'" + ARM,
        "<!-- --><?xmlversion='1.0'" + ARM,
        "x<?xml version='1.0'?>" + ARM,
        ARM[:60] + "<?xml version='1.0'?>" + ARM[60:],
        "<!---->" * 200_000,
    ],
)
def test_other_declarations_are_no_xml(text):
    with pytest.raises(DescriptionError):
        read_urdf(text, "a.urdf")
    with pytest.raises(DescriptionError):
        read_urdf(text.encode(), "a.urdf")


def test_other_formats_tell_of_it_too(tmp_path):
    before = "<!-- a --><?xml version='1.0'?>"
    texts = {
        "a.xml": before + "<mujoco><worldbody><body><joint/><geom/></body></worldbody></mujoco>",
        "a.xacro": before + "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'>"
        "<parent link='a'/><child link='b'/></joint></robot>",
        "a.sdf": before + "<sdf version='1.7'><model name='m'><link name='a'/><link name='b'/>"
        "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>"
        "</model></sdf>",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        notes = robokin.load_tree(tmp_path / name).notes
        assert (notes[0].line, notes[0].column) == (1, 11), name
        assert "behind a comment" in notes[0].message
