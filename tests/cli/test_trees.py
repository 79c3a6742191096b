"""Trees in the shell: all tips, one tip, what is said where several are meant."""

from __future__ import annotations

import json

import numpy as np
import pytest
from jsonschema import validate

import robokin

from .conftest import refused

FINGERS = """\
robokin: 1
name: Two fingers
units: {length: mm, angle: deg}
branches:
  palm:  {joints: [{name: wrist, type: revolute, alpha: 90, limits: [-60, 60]}]}
  index:
    {on: palm, base: "Trans(90, 20, 0)",
     joints: [{name: mcp, type: revolute, a: 45}, {name: pip, type: revolute, a: 26}]}
  ring:  {on: palm, base: "Trans(88, -18, 0)", joints: [{name: mcp, type: revolute, a: 41}]}
poses: {point: [0, 0, 0, 90]}
"""


@pytest.fixture
def fingers(tmp_path):
    path = tmp_path / "fingers.yaml"
    path.write_text(FINGERS)
    return str(path)


def poses_at(path, q):
    """The poses of all tips in millimetres, as the package computes them; q in degrees."""
    T = robokin.tip_poses(robokin.load_tree(path), np.deg2rad(q))
    T[..., :3, 3] *= 1e3
    return T


def test_every_format_says_the_same_of_all_tips(call, fingers, tmp_path):
    q = np.random.default_rng(3).uniform(-50.0, 50.0, (4, 4))
    T = poses_at(fingers, q)
    rows = "".join(",".join(map(repr, row.tolist())) + "\n" for row in q).encode()
    documents = call("fk", fingers, "--q", "-", "-f", "jsonl", stdin=rows).jsonl
    for document, own in zip(documents, T, strict=True):
        assert [*document["tips"]] == ["index", "ring"]
        for pose, matrix in zip(document["tips"].values(), own, strict=True):
            np.testing.assert_allclose(pose["matrix"], matrix, atol=1e-11)
    answer = call("fk", fingers, "--q", "-", "-f", "csv", "--as", "matrix", stdin=rows)
    assert answer.columns[:5] == ["q1", "q2", "q3", "q4", "index.x"]
    names = [f"ring.{axis}" for axis in "xyz"]
    np.testing.assert_allclose(
        np.transpose([answer.numbers_of(name) for name in names]), T[:, 1, :3, 3], rtol=1e-12, atol=1e-11
    )
    target = tmp_path / "tips.npy"
    assert call("fk", fingers, "--q", "-", "-o", str(target), stdin=rows).status == 0
    np.testing.assert_allclose(np.load(target), T, atol=1e-11)
    table = call("fk", fingers, "--q", "-", stdin=rows)
    assert [line.split()[:2] for line in table.lines if line[:5].strip().isdigit()] == [
        [str(i), "index"] for i in range(1, 5)
    ]


def test_one_configuration_is_a_page_and_a_document_of_its_schema(call, fingers):
    answer = call("fk", fingers, "--q", "point")
    assert answer.status == 0
    assert "index" in answer.text
    assert "161.000       0.000      20.000" in answer.text
    document = call("fk", fingers, "--q", "point", "--json").json
    np.testing.assert_allclose(document["tips"]["index"]["position"], [161.0, 20.0 * 0, 20.0], atol=1e-9)
    validate(document, call("schema", "fk").json)


def test_one_tip_is_a_robot_in_every_command(call, fingers):
    answer = call("fk", fingers, "--tip", "ring", "--q", "10,20", "--json").json
    np.testing.assert_allclose(answer["pose"]["matrix"], poses_at(fingers, [10, 0, 0, 20])[1], atol=1e-11)
    x, y, z = answer["pose"]["position"]
    found = call("ik", fingers, "--tip", "ring", f"--xyz={x!r},{y!r},{z!r}", "--json").json
    assert any(np.allclose(solution["q"], [10, 20], atol=1e-6) for solution in found["solutions"])
    for command in (["show"], ["jacobian", "--q", "1,2"], ["singular"], ["dof"], ["workspace"], ["plot"]):
        done = call(command[0], fingers, "--tip", "ring", *command[1:])
        assert done.status == 0, done
    assert call("fk", fingers, "--root", "palm.wrist", "--tip", "index", "--q", "0,0", "--json").json["pose"][
        "position"
    ] == pytest.approx([161.0, 20.0, 0.0])


def test_where_one_is_meant_of_several_they_are_listed(call, fingers):
    for command in (
        ["ik", "--xyz", "1,2,3"],
        ["jacobian", "--q", "1"],
        ["workspace"],
        ["singular"],
    ):
        refused(call(command[0], fingers, *command[1:]), "has 2 tips, expected --tip with one of index, ring")
    refused(call("fk", fingers, "--tip", "rin", "--q", "0"), "found the unknown link 'rin'; did you mean 'ring'")
    refused(call("fk", fingers, "--root", "index.mcp", "--tip", "ring", "--q", "0"), "no joints lead from link")
    refused(call("fk", fingers, "--frames", "--q", "point"), "is a tree, expected --tip")
    refused(call("plot", fingers, "--ik", "1,2,3"), "--ik: Two fingers is a tree", "--tip with one of index, ring")
    refused(call("plot", fingers, "--xyz", "1,2,3"), "--xyz: Two fingers is a tree")
    refused(call("plot", fingers, "--q", "1,2,3"), "found 3 values", "expected 4")
    refused(call("plot", fingers, "--root", "palm.wrist"), "has 2 tips")
    refused(call("fk", fingers, "--q", "1,2,3"), "found 3 values", "expected 4")
    refused(call("dof", "four-bar", "--tip", "x"), "expected the description of a robot or a tree")


def test_a_chain_with_a_joint_that_follows_answers(call, tmp_path):
    path = tmp_path / "coupled.yaml"
    couplings = "couplings: [{joint: index.pip, follows: index.mcp, ratio: 2/3}]\n"
    path.write_text(FINGERS.replace("[0, 0, 0, 90]", "[0, 0, 90]") + couplings)
    pose = call("fk", path, "--tip", "index", "--q", "10,30", "--json").json["pose"]
    found = call("ik", path, "--tip", "index", "--xyz", ",".join(map(repr, pose["position"])), "--json").json
    assert not found["complete"]
    assert any(abs(s["q"][0] - 10) + abs(s["q"][1] - 30) < 1e-6 for s in found["solutions"])
    place = ",".join(map(repr, pose["position"]))
    assert call("workspace", path, "--tip", "index", "--at", place).status == 0
    assert call("fk", path, "--q", "0,30,0").status == 0


def test_a_trees_freedoms(call, tmp_path, fingers):
    record = call("dof", fingers, "--json").json
    assert (record["kind"], record["grubler"], record["mobility"], record["verdict"]) == ("tree", 4, 4, "right")
    assert [tip["name"] for tip in record["tips"]] == ["index", "ring"]
    assert not any(tip["alone"] for tip in record["tips"])  # both turn with the wrist
    path = tmp_path / "coupled.yaml"
    path.write_text(FINGERS.replace("[0, 0, 0, 90]", "[0, 0, 90]") + "couplings: [{joint: pip, follows: index.mcp}]\n")
    record = call("dof", path, "--json").json
    assert (record["grubler"], record["mobility"], record["following"]) == (4, 3, 1)
    assert "of 4 freedoms 3 are left" in record["note"]
    validate(record, call("schema", "dof").json)
    assert all(tip["alone"] for tip in call("dof", "human-hand", "--json").json["tips"])


def test_show_has_the_joints_and_the_tips_of_a_tree(call, tmp_path):
    path = tmp_path / "coupled.yaml"
    path.write_text(FINGERS.replace("[0, 0, 0, 90]", "[0, 0, 90]") + "couplings: [{joint: pip, follows: index.mcp}]\n")
    record = call("show", path, "--json").json
    validate(record, call("schema", "show").json)
    assert [tip["link"] for tip in record["tips"]] == ["index.pip", "ring.mcp"]
    assert [joint["variable"] for joint in record["joints"]] == ["q1", "q2", None, "q3"]
    assert record["joints"][2]["follows"] == [{"joint": "index.mcp", "ratio": 1.0}]
    assert record["joints"][0]["limits"] == [-60.0, 60.0]
    assert record == robokin.load_tree(path).record()
    assert "1 index.mcp" in call("show", path).text


def test_validate_and_list_know_trees(call, fingers):
    assert call("validate", fingers, "--json").json[0]["kind"] == "tree"
    (entry,) = [one for one in call("list", "--json").json if one["id"] == "human-hand"]
    assert (entry["kind"], entry["dof"]) == ("tree", 21)


def test_joint_values_of_a_file_may_be_called_by_the_joints_names(call, fingers):
    rows = json.dumps({"palm.wrist": 1, "index.mcp": 2, "index.pip": 3, "ring.mcp": 4})
    by_name = call("fk", fingers, "--q", "-", "-f", "jsonl", stdin=rows.encode()).jsonl
    by_order = call("fk", fingers, "--q", "1,2,3,4", "-f", "jsonl").jsonl
    assert by_name[0]["tips"] == by_order[0]["tips"]


def test_a_tree_with_one_tip_is_shown_as_a_table_and_rows_of_frames_as_they_are(call, tmp_path):
    tree = tmp_path / "tree.yaml"
    tree.write_text(
        "robokin: 1\nname: One tip\nunits: {length: mm, angle: deg}\nbranches:\n"
        "  palm: {joints: [{name: wrist, type: R, alpha: 90}]}\n"
        "  index: {on: palm, base: 'Trans(90, 20, 0)', joints: [{name: mcp, type: R, a: 45}]}\n"
    )
    record = call("show", tree, "--json").json
    assert (record["convention"], record["made_from"]) == ("standard", "frames")
    assert [(row["a"], row["d"], row["alpha"]) for row in record["rows"]] == [(90.0, 20.0, 90.0), (45.0, 0.0, 0.0)]
    assert record == call("show", tree, "--tip", "index", "--json").json
    assert call("show", "scara-frames", "--json").json["convention"] == "frames"
