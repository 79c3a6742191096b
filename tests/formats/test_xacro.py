"""A xacro file becomes the URDF that it stands for, runs nothing, and reads no file that is none of its business."""

import math

import numpy as np
import pytest

from robokin.errors import DescriptionError, ExpressionError, InputError
from robokin.formats.urdf import read_urdf
from robokin.formats.xacro import read_xacro
from robokin.formats.xacro_expressions import XacroNames, evaluate_xacro
from robokin.formats.xacro_tables import xacro_table

ARM = """
<xacro:macro name="arm_segment" params="name parent length:=0.5 type:='revolute' *limits **extra">
  <link name="${name}"><xacro:insert_block name="extra"/></link>
  <joint name="${name}_joint" type="${type}">
    <parent link="${parent}"/><child link="${name}"/>
    <origin xyz="0 0 ${length}" rpy="0 ${radians(90)} 0"/>
    <axis xyz="0 0 1"/>
    <xacro:insert_block name="limits"/>
  </joint>
</xacro:macro>
"""


def robot(*parts):
    return '<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">\n' + "\n".join(parts) + "\n</robot>\n"


def write(path, *parts):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(robot(*parts), encoding="utf-8")
    return path


def read(folder, *parts, **options):
    return read_xacro(write(folder / "r.urdf.xacro", *parts), **options)


def refusal(folder, *parts, **options):
    with pytest.raises(InputError) as caught:
        read(folder, *parts, **options)
    return caught.value


def same(tree, other):
    assert tree.graph.links == other.graph.links
    assert tree.graph.couplings == other.graph.couplings
    for a, b in zip(tree.graph.joints, other.graph.joints, strict=True):
        assert (a.name, a.type, a.parent, a.child, a.limits) == (b.name, b.type, b.parent, b.child, b.limits)
        assert np.array_equal(a.before, b.before)
        assert np.array_equal(a.after, b.after)


def test_macros_blocks_and_defaults_make_the_urdf_that_they_stand_for(tmp_path):
    tree = read(
        tmp_path,
        ARM,
        '<xacro:property name="reach" value="${2*unit}"/><xacro:property name="unit" value="0.1"/>',
        '<link name="base"/>',
        '<xacro:arm_segment name="one" parent="base" length="${reach + 0.1}">',
        '<limit lower="${-pi/2}" upper="1"/><group><visual/></group></xacro:arm_segment>',
        '<xacro:arm_segment name="two" parent="one" type="prismatic">',
        '<limit lower="0" upper="1"/><group/></xacro:arm_segment>',
    )
    text = '<robot name="r"><link name="base"/><link name="one"/><link name="two"/>'
    for name, parent, length, type, low in (
        ("one", "base", 2 * 0.1 + 0.1, "revolute", -math.pi / 2),
        ("two", "one", 0.5, "prismatic", 0),
    ):
        text += f'<joint name="{name}_joint" type="{type}"><parent link="{parent}"/><child link="{name}"/>'
        text += f'<origin xyz="0 0 {length!r}" rpy="0 {math.pi / 2!r} 0"/><axis xyz="0 0 1"/>'
        text += f'<limit lower="{low!r}" upper="1"/></joint>'
    same(tree, read_urdf(text + "</robot>", "r.urdf"))


JOINT = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'


@pytest.mark.parametrize(
    ("value", "holds"),
    [
        ("true", True), ("false", False), ("1", True), ("0", False), ("${1 == 1.0}", True), ("${not x}", False),
        ("${'a' == name}", True), ("${name != 'a' or x > 2}", True), ("$(arg on)", True), ("${$(arg on)}", True),
        ("${'$(arg on)' == 'true'}", True), ("${x if name == 'b' else 0}", False), ("$(eval x - 3)", False),
    ],
)  # fmt: skip
def test_conditions(tmp_path, value, holds):
    names = '<xacro:arg name="on" default="true"/><xacro:property name="x" value="3"/>'
    names += '<xacro:property name="name" value="a"/><link name="a"/><link name="b"/>'
    parts = [f'<xacro:{word} value="{value}"><link name="{word}"/></xacro:{word}>' for word in ("if", "unless")]
    word = "if" if holds else "unless"
    tree = read(
        tmp_path, names, JOINT, *parts, f'<joint name="k" type="fixed"><parent link="b"/><child link="{word}"/></joint>'
    )
    assert tree.graph.links == ("a", "b", word)


def test_arguments_replace_defaults_and_unknown_ones_are_refused(tmp_path):
    parts = ['<xacro:arg name="prefix" default="x_"/><link name="$(arg prefix)a"/><link name="b"/>']
    parts.append(JOINT.replace('"a"', '"$(arg prefix)a"'))
    assert read(tmp_path, *parts).graph.links == ("x_a", "b")
    assert read(tmp_path, *parts, arguments={"prefix": "y_"}).graph.links == ("y_a", "b")
    assert "did you mean 'prefix'" in str(refusal(tmp_path, *parts, arguments={"prefx": "y_"}))


def test_macros_may_call_themselves_until_a_condition_ends_it(tmp_path):
    chain = """<link name="l0"/><xacro:macro name="chain" params="i"><xacro:if value="${i &lt; 20}">
      <link name="l${i + 1}"/><joint name="j${i}" type="fixed"><parent link="l${i}"/><child link="l${i + 1}"/></joint>
      <xacro:chain i="${i + 1}"/></xacro:if></xacro:macro><xacro:chain i="0"/>"""
    assert len(read(tmp_path, chain).graph.joints) == 20


def test_includes_and_packages(tmp_path):
    package = tmp_path / "arm_description"
    write(package / "urdf" / "inc" / "joint.xacro", JOINT)
    write(package / "urdf" / "links.xacro", '<link name="a"/><xacro:include filename="inc/joint.xacro"/>')
    include = '<link name="b"/><xacro:include filename="$(find arm_description)/urdf/links.xacro"/>'
    assert read(package / "robots", include).graph.links == ("b", "a")
    assert read(tmp_path / "far", include, packages={"arm_description": str(package)}).n == 1
    write(package / "urdf" / "arm.gazebo", JOINT)
    gazebo = '<link name="a"/><link name="b"/><xacro:include filename="$(find arm_description)/urdf/arm.gazebo"/>'
    assert read(package / "robots", gazebo).n == 1
    (package / "package.xml").write_text("<package><name>other_name</name></package>")
    assert read(package / "robots", include.replace("arm_d", "other_name").replace("escription", "")).n == 1


@pytest.mark.parametrize(
    "name",
    [
        "../secret.xacro",
        "/etc/passwd",
        "$(find etc)/passwd",
        "link.xacro",
        "a\0b",
        "folder",
        "pipe.xacro",
        "gone.xacro",
    ],
)
def test_no_file_elsewhere_is_read(tmp_path, name):
    write(tmp_path / "secret.xacro", '<link name="secret"/>')
    home = tmp_path / "home"
    (home / "folder").mkdir(parents=True)
    (home / "link.xacro").symlink_to(tmp_path / "secret.xacro")
    name = name.replace("\0", "&#1;") if "\0" in name else name
    assert "secret" not in str(refusal(home, '<link name="a"/>', f'<xacro:include filename="{name}"/>')).replace(
        "secret.xacro", ""
    )


def test_an_error_in_an_included_file_names_that_file(tmp_path):
    write(tmp_path / "part.xacro", '<link name="a"/>\n<link name="b"/>', JOINT.replace("continuous", "floatin"))
    error = refusal(tmp_path, '<xacro:include filename="part.xacro"/>')
    assert (error.file, error.line) == (str(tmp_path / "part.xacro"), 4)
    assert "floatin" in error.excerpt


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("${gone + 1}", "'gone'"),
        ("${1/0}", "1 / 0"),
        ("${xacro.load_yaml('x')}", "no file 'x'"),
        ("${xacro.load_json('x')}", "nothing of a xacro file is run"),
        ("${dict(a=1)}", "table or a list in a text"),
        ("${dict(1)}", "name=value"),
        ("${{'a': 1}['a']}", "only lists are read"),
        ("${().__class__}", "expected a value"),
        ("${x.__class__}", "unknown name"),
        ("${[x for x in (1,)]}", "unknown name 'x'"),
        ("${[1 for x in (1,)]}", "no ']'"),
        ("${'a'.__class__}", "part taken of a list"),
        ("${'a'.format(1)}", "method of strings"),
        ("${'{0.__class__}'.format(1)}", "method of strings"),
        ("${'a b'.split().__class__}", "part taken of a list"),
        ("${pi.real}", "unknown name"),
        ("${open('/etc/passwd')}", "nothing of a xacro file is run"),
        ("${__import__('os')}", "unknown function"),
        ("${p['key']}", "unknown name"),
        ("${pi['key']}", "part taken"),
        ("${9**9**9**9}", "value"),
        ("${'a' * 1000000000}", "string 'a'"),
        ("${(((", "without '}'"),
        ("${" + "(" * 1000 + "1}", "nested"),
        ("${" + "-" * 1990 + "1", "without '}'"),
        ("$(env HOME)", "nothing else is looked up"),
        ("$(find nothing_like_it)", "--package"),
        ("$(arg nothing)", "no value of the argument"),
        ("$(cwd)", "nothing else is looked up"),
        ("${me}", "hanging on itself"),
    ],
)
def test_texts_that_have_no_value_are_refused_where_they_stand(tmp_path, text, words):
    names = '<xacro:property name="me" value="${you}"/><xacro:property name="you" value="${me}"/>'
    error = refusal(tmp_path, names, f'<link name="{text}"/>')
    assert words in str(error).replace("\n", " ")
    assert isinstance(error, DescriptionError)
    assert error.line in (2, 3)


@pytest.mark.parametrize(
    ("parts", "line", "words"),
    [
        (["<xacro:arm/>"], 2, "unknown macro 'arm'"),
        (['<xacro:macro name="arm" params="x"/>', "<xacro:armm/>"], 3, "did you mean 'arm'"),
        (['<xacro:macro name="m" params="x"/>', "<xacro:m/>"], 3, "without the parameter 'x'"),
        (['<xacro:macro name="m" params="x"/>', '<xacro:m x="1" y="2"/>'], 3, "parameter 'y'"),
        (['<xacro:macro name="m" params="*b"/>', "<xacro:m/>"], 3, "no block 'b'"),
        (['<xacro:macro name="m"/>', "<xacro:m><link/></xacro:m>"], 3, "block too many"),
        (['<xacro:macro name="m" params="x:=\'"/>', '<xacro:m x="1"/>'], 2, "among parameters"),
        (['<xacro:if value="maybe"/>'], 2, "'maybe' as a condition"),
        (['<xacro:insert_block name="b"/>'], 2, "unknown block"),
        (["<xacro:element/>"], 2, "ROS's own xacro"),
        (['<xacro:include filename="r.urdf.xacro"/>'], 2, "within itself"),
        (['<xacro:macro name="m"><xacro:m/></xacro:macro>', "<xacro:m/>"], 2, "nested more than"),
        ([], 1, "no <link>"),
        (['<link name="a"/>'], 1, "at least 1"),
    ],
)
def test_what_cannot_be_carried_out_is_refused_with_its_line(tmp_path, parts, line, words):
    error = refusal(tmp_path, *parts)
    assert words in error.message
    assert error.line == line


def test_what_grows_without_end_is_stopped(tmp_path):
    double = "".join(f'<xacro:macro name="m{i + 1}"><xacro:m{i}/><xacro:m{i}/></xacro:macro>' for i in range(40))
    assert "more than" in str(refusal(tmp_path, '<xacro:macro name="m0"/>', double, "<xacro:m40/>"))
    names = '<xacro:property name="p0" value="xxxxxxxxxx"/>'
    names += "".join(f'<xacro:property name="p{i + 1}" value="${{p{i}}}${{p{i}}}"/>' for i in range(40))
    assert "grow" in str(refusal(tmp_path, names, '<link name="${p40}"/>'))
    long = "".join(f'<xacro:property name="q{i + 1}" value="${{q{i}}}"/>' for i in range(3000))
    assert "nested" in str(refusal(tmp_path, '<xacro:property name="q0" value="1"/>', long, '<link name="${q3000}"/>'))


def test_what_moves_no_link_is_not_looked_at(tmp_path):
    parts = ['<link name="a"><visual><mesh filename="$(env HOME)"/></visual></link><link name="b"/>', JOINT]
    assert read(tmp_path, *parts, '<gazebo><x y="${gone}"/></gazebo>').n == 1


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", 7), ("(1 + 2) * 3", 9), ("7 / 2", 3.5), ("7 // 2", 3), ("-7 % 3", 2), ("2 ** 3 ** 2", 512),
        ("-2 ** 2", -4), ("radians(180)", math.pi), ("degrees(pi)", 180.0), ("math.cos(0)", 1.0), ("1 < 2 < 3", True),
        ("1 < 2 > 3", False), ("not 1 == 2", True), ("'a' + \"b\"", "ab"), ("1 if 0 else 2", 2), ("max(1, 2.5)", 2.5),
        ("0 or 5", 5), ("1 and 0", 0), ("True", True), ("1e-3", 1e-3), (".5", 0.5), ("atan2(1, 1)", math.pi / 4),
        ("int(2.9)", 2), ("str(1) + 'x'", "1x"),
    ],
)  # fmt: skip
def test_expressions_have_pythons_values(text, value):
    found = evaluate_xacro(text, XacroNames())
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize("seed", range(30))
def test_random_sums_and_products_have_pythons_values(seed):
    rng = np.random.default_rng(seed)
    text = "3"
    for _ in range(12):
        text = f"({text}) {rng.choice(['+', '-', '*'])} {rng.choice(['2', '-1.5', '.25', '7', '(1 - 4)'])}"
    assert evaluate_xacro(text, XacroNames()) == eval(text)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "1 +",
        "1 2",
        "(1",
        "f(1)",
        "sin()",
        "sin(1, 2)",
        "1_000",
        "１",
        "1 = 2",
        "'a",
        "a.b.c",
        "sqrt(-1)",
        "log(0)",
        "1e308 * 10",
        "'a' < 1",
        "-'a'",
        "if",
        "(-8) ** 0.5",
        "len(1)",
    ],
)
def test_what_is_no_expression_is_refused(text):
    with pytest.raises(ExpressionError, match="expected"):
        evaluate_xacro(text, XacroNames())


LIMITS = """\
# what an arm may do
joint_limits:
  pan: {min: !degrees -180.0, max: !degrees 90, speed: 2.5}
  lift: {min: !radians -1.5, max: 1.5e0, kind: 'revolute', has_brake: true}
names: [pan, lift]
origin: {x: 0.1, rpy: "0 0 1.5"}
"""


def table(folder, *parts, text=LIMITS):
    (folder / "config").mkdir(exist_ok=True)
    (folder / "config" / "limits.yaml").write_text(text, encoding="utf-8")
    return read(folder, *parts)


def test_tables_of_yaml_files_are_read_and_passed_to_macros(tmp_path):
    tree = table(
        tmp_path,
        '<xacro:macro name="arm" params="file limits">',
        '<xacro:property name="all" value="${load_yaml(file)}"/>',
        '<xacro:property name="pan" value="${limits[\'pan\']}"/>',
        '<link name="a"/><link name="b"/><link name="c"/>',
        '<joint name="${all[\'names\'][0]}" type="${limits.lift.kind}"><parent link="a"/><child link="b"/>',
        "<origin xyz=\"${all['origin']['x'] * 2} 0 0\" rpy=\"${all.origin.rpy}\"/>",
        '<limit lower="${pan[\'min\']}" upper="${pan.max}"/></joint>',
        '<joint name="${all.names[-1]}" type="revolute"><parent link="b"/><child link="c"/>',
        "<limit lower=\"${limits['lift']['min']}\" upper=\"${limits['lift']['max']}\"/></joint></xacro:macro>",
        "<xacro:property name=\"found\" value=\"${xacro.load_yaml('config/limits.yaml')['joint_limits']}\"/>",
        '<xacro:arm file="config/limits.yaml" limits="${found}"/>',
    )
    assert [joint.name for joint in tree.joints] == ["pan", "lift"]
    np.testing.assert_allclose(tree.limits, [[-math.pi, math.pi / 2], [-1.5, 1.5]], atol=1e-15)
    np.testing.assert_allclose(tree.graph.joints[0].before[:3, 3], [0.2, 0, 0])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("t['a']['b']", 1.5),
        ("t.a.b + t['l'][1]", 21.5),
        ("'a' in t", True),
        ("t['z'] if 'z' in t else 7", 7),
        ("'z' in 'abc'", False),
        ("'z' in t and t['z'] > 1", False),
        ("20 in t['l']", True),
        ("len(t['l'])", 3),
        ("len(t['z']) if False else 2", 2),
        ("-t['z'] * 2 if False else 3", 3),
        ("[1, 2, 'x'][2]", "x"),
        ("len([])", 0),
        ("'abc'[1]", "b"),
        ("'1 2 3'.split(' ')[2]", "3"),
        ("s.lower()", "left_arm"),
        ("s.find('Arm') > 0", True),
        ("s.startswith('Left')", True),
        ("dict(a=1, b='c')['b']", "c"),
        ("dict() if False else 1", 1),
        ("t['word']", "on"),
        ("t['nothing']", ""),
        ("t[5]", "five"),
    ],
)
def test_parts_of_tables_lists_and_strings(text, value):
    known = xacro_table("a: {b: 1.5}\nl: [10, 20, 30]\nword: on\nnothing: ~\n5: five\n", "t.yaml")
    names = XacroNames(tuple, {"t": known, "s": "Left_Arm"}.get)
    found = evaluate_xacro(text, names)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t['z']", "no part 'z' of a table"),
        ("t['z']['y'] + 1", "no part 'z'"),
        ("not t['z']", "no part 'z'"),
        ("t['z'] or 1", "no part 'z'"),
        ("1 if t['z'] else 2", "no part 'z'"),
        ("len(t['z'])", "no part 'z'"),
        ("t['bb']", "did you mean"),
        ("t['l'][3]", "expected 0 to 2"),
        ("t['l']['a']", "by no number"),
        ("t['l'][True]", "by no number"),
        ("t[t]", "table or a list in a text"),
        ("t + 1", "table or a list"),
        ("-t", "table or a list"),
        ("t < t", "expected two of a kind"),
        ("2 in 3", "'in'"),
        ("1.5.a", "expected numbers"),
        ("(1)['a']", "part taken"),
        ("t['a'", "no ']'"),
        ("t.get('a')", "nothing of a xacro file is run"),
        ("t.__class__", "no part '__class__'"),
        ("''.join(t)", "method of strings"),
        ("'a'.split('')", "other arguments"),
        ("'a'.lower(1)", "other arguments"),
        ("str(t)", "has a value"),
        ("float(t)", "has a value"),
        ("max(t['l'])", "has a value"),
        ("load_yaml('x.yaml')", "no file, expected none"),
        ("load_yaml(1)", "the name of one YAML file"),
        ("dict(a)", "name=value"),
        ("dict(a=1", "no ')'"),
        ("t['twice']", "twice in t.yaml, line"),
    ],
)
def test_parts_that_there_are_not_are_told(text, words):
    known = xacro_table("a: {b: 1.5, b1: 2}\nbbb: 1\nl: [10, 20, 30]\ntwice: 1\ntwice: 2\n", "t.yaml")
    with pytest.raises(ExpressionError) as caught:
        evaluate_xacro(text, XacroNames(tuple, {"t": known}.get))
    assert words in caught.value.message


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("config/gone.yaml", LIMITS, "no file 'config/gone.yaml'"),
        ("r.urdf.xacro", LIMITS, "ends in .yaml, .yml"),
        ("../outside.yaml", LIMITS, "outside the file's own folder"),
        ("/etc/passwd", LIMITS, "outside the file's own folder"),
        ("config/limits.yaml", "a: [1", "limits.yaml:"),
        ("config/limits.yaml", "a: !!python/object/apply:os.system ['true']", "tag"),
        ("config/limits.yaml", "a: !degrees 90/2", "tag"),
        ("config/limits.yaml", "a: *z", "alias"),
        ("config/limits.yaml", "[" * 100 + "]" * 100, "nesting"),
    ],
)
def test_files_of_tables_that_are_no_tables_are_refused_where_they_are_asked_for(tmp_path, name, text, words):
    (tmp_path / "in").mkdir()
    (tmp_path / "outside.yaml").write_text("a: 1\n")
    with pytest.raises(InputError) as caught:
        table(tmp_path / "in", f"<link name=\"${{xacro.load_yaml('{name}')['a']}}\"/>", text=text)
    assert words in str(caught.value)
    assert caught.value.line == 2


def test_a_table_of_a_billion_words_is_refused(tmp_path):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]
    with pytest.raises(InputError, match="more than 100000 values"):
        table(tmp_path, "<link name=\"${load_yaml('config/limits.yaml')['a']}\"/>", text="\n".join(lines))


def test_a_table_file_of_comments_is_an_empty_table_and_a_large_one_is_refused(tmp_path):
    part = "<link name=\"${len(load_yaml('config/limits.yaml'))}\"/>"
    joint = '<link name="b"/><joint name="j" type="fixed"><parent link="0"/><child link="b"/></joint>'
    assert table(tmp_path, part, joint, text="# nothing\n---\n# more\n").graph.links == ("0", "b")
    with pytest.raises(InputError, match="1 MiB"):
        table(tmp_path, part, joint, text="# " + "x" * (1 << 20))


def test_eval_knows_arguments_by_their_names(tmp_path):
    parts = '<xacro:arg name="kind" default="hand"/><xacro:arg name="n" default="3"/>'
    chosen = '<xacro:if value="$(eval kind == \'hand\' and n > 2)"><link name="hand"/></xacro:if>'
    joint = '<joint name="j" type="fixed"><parent link="{}"/><child link="tip"/></joint><link name="tip"/>'
    assert read(tmp_path, parts, chosen, joint.format("hand")).graph.links == ("hand", "tip")
    other = chosen.replace("if", "unless").replace('"hand"', '"arm"')
    tree = read(tmp_path, parts, chosen, other, joint.format("arm"), arguments={"kind": "none"})
    assert tree.graph.links == ("arm", "tip")
    assert "unknown name 'kin'" in str(refusal(tmp_path, parts, '<link name="$(eval kin)"/>'))
