"""A xacro file becomes the URDF that it stands for, runs nothing, and reads no file that is none of its business."""

import math

import numpy as np
import pytest

from robokin.errors import DescriptionError, ExpressionError, InputError
from robokin.formats.urdf import read_urdf
from robokin.formats.xacro import read_xacro
from robokin.formats.xacro_expressions import XacroNames, evaluate_xacro

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
        ("${xacro.load_yaml('x')}", "nothing of a xacro file is run"),
        ("${dict(a=1)}", "nothing of a xacro file is run"),
        ("${().__class__}", "expected a value"),
        ("${x.__class__}", "unknown name"),
        ("${[x for x in (1,)]}", "lists"),
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
