"""`robokin path`: rows of a path, its summary, and what ends it."""

from __future__ import annotations

import numpy as np
import pytest

import robokin

from .conftest import poses_of, refused

START, END = "90,-30,60,0,40,0", "60,-20,70,10,30,0"
FROM = ["path", "puma560", "--from", START]
DOWN = "0.5,0.3,-1.3"


def test_the_document(call):
    answer = call(*FROM, "--to", END, "--steps", "4", "--json")
    assert (answer.status, answer.err) == (0, "")
    document = answer.json
    assert document["units"] == {"length": "mm", "angle": "deg"}
    assert (document["kind"], document["steps"], document["complete"], document["fraction"]) == ("joint", 4, True, 1.0)
    assert [row["t"] for row in document["path"]] == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert document["path"][0]["q"] == [90, -30, 60, 0, 40, 0]
    assert document["path"][-1]["q"] == [60, -20, 70, 10, 30, 0]
    assert document["greatest_moves"] == [30, 10, 10, 10, 10, 0]
    T = poses_of("puma560", document["path"][2]["q"])
    assert np.allclose(document["path"][2]["position"], T[:3, 3], atol=1e-9)
    q = ",".join(map(repr, document["path"][-1]["q"]))
    least = min(call("jacobian", "puma560", "--q", x, "--json").json["manipulability"] for x in (START, q))
    assert document["least_manipulability"] <= least * (1 + 1e-9)


def test_rows_are_the_same_in_every_format(call, tmp_path):
    arguments = [*FROM, "--xyz", "-300,700,200", "--line", "--steps", "10"]
    table = call(*arguments, "-f", "csv")
    assert table.columns == ["t", "q1", "q2", "q3", "q4", "q5", "q6", "x", "y", "z", "roll", "pitch", "yaw"]
    assert table.numbers.shape == (11, 13)
    rows = call(*arguments, "-f", "jsonl").jsonl
    assert [[row["t"], *row["q"], *row["position"], *row["rpy"]] for row in rows] == table.numbers.tolist()
    assert all(row["units"] == {"length": "mm", "angle": "deg"} for row in rows)
    assert call(*arguments, "-o", tmp_path / "p.npy").status == 0
    assert np.load(tmp_path / "p.npy").tolist() == table.numbers.tolist()
    p = table.numbers[:, 7:10]
    assert np.allclose(p[-1], [-300, 700, 200], atol=1e-6)
    assert np.allclose(table.numbers[:, 10:], table.numbers[0, 10:], atol=1e-6)


def test_a_path_is_legal_input_of_fk(call):
    table = call(*FROM, "--to", END, "--steps", "5", "-f", "csv")
    poses = call("fk", "puma560", "-i", "-", "-f", "csv", stdin=table.out)
    assert poses.columns == table.columns  # the time goes through
    assert np.allclose(poses.numbers, table.numbers, atol=1e-9)


def test_the_ends_of_a_line(call):
    """The same end said in several ways."""
    T = poses_of("puma560", [60, -20, 70, 10, 30, 0])
    x, y, z = T[:3, 3]
    rows = str(T.tolist())
    ways = [["--to", END], ["--matrix", rows], ["--pose", f"Matrix({rows})"]]
    lasts = [call(*FROM, *way, "--line", "--steps", "20", "-f", "csv").numbers[-1] for way in ways]
    assert np.allclose(lasts[0][7:10], [x, y, z], atol=1e-6)
    for last in lasts[1:]:
        assert np.allclose(last, lasts[0], atol=1e-5)


def test_joints_go_to_a_pose_by_the_nearest_solution(call):
    target = ["--xyz", "-300,700,200", "--rpy", "0,90,90"]
    document = call(*FROM, *target, "--steps", "2", "--json").json
    near = call("ik", "puma560", *target, "--near", START, "--max", "1", "--json").json
    assert np.allclose(document["path"][-1]["q"], near["solutions"][0]["q"], atol=1e-9)


def test_what_ends_a_line_is_said(call, tmp_path):
    arguments = [*FROM, "--xyz", "-300,700,-900", "--line"]
    answer = call(*arguments, "--json")
    document = answer.json
    assert (answer.status, answer.err, document["complete"]) == (3, "", False)
    event = document["events"][-1]
    assert event["kind"] in ("limit", "unreachable")
    assert 0.0 < event["fraction"] == document["fraction"] < 1.0
    rows = call(*arguments, "-o", tmp_path / "part.csv")
    assert rows.status == 3
    assert f"{len(document['path'])} rows of 101" in rows.err
    assert len((tmp_path / "part.csv").read_text().splitlines()) == len(document["path"]) + 1
    table = call(*arguments)
    assert (table.status, table.err) == (3, "")
    assert "it can be followed up to" in table.text


def test_an_end_out_of_reach_is_a_no(call):
    answer = call(*FROM, "--xyz", "5000,0,0", "--json")
    assert answer.status == 3
    assert answer.json["fraction"] == 0.0
    assert "out of reach" in answer.json["events"][0]["words"]


def test_limits(call):
    assert call(*FROM, "--to", "90,-30,60,0,150,0").status == 3
    assert call(*FROM, "--to", "90,-30,60,0,150,0", "--no-limits").status == 0


def test_a_redundant_arm_says_where_it_ends(call):
    ends = ["--from", "0,-30,0,-90,0,90,0", "--to", "20,-20,0,-80,0,80,10"]
    answer = call("path", "panda", *ends, "--line", "-f", "csv")
    assert answer.status == 0
    assert "another configuration" in answer.err


def test_tables_fit_a_page(call):
    for arguments in ([*FROM, "--to", END], [*FROM, "--xyz", "-300,700,-900", "--line"]):
        answer = call(*arguments)
        assert max(map(len, answer.lines)) <= 80
        assert "…" not in answer.text


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["puma560"], ["--from is missing", "expected 6 values"]),
        (["puma560", "--from", START], ["there is no end", "expected --to"]),
        (["puma560", "--from", "hom", "--to", END], ["--from", "'hom'", "did you mean 'home'"]),
        (["puma560", "--from", START, "--to", "1,2"], ["--to", "found 2 values", "expected 6"]),
        (["puma560", "--from", START, "--to", END, "--pose", "Trans(1,2,3)"], ["exclude each other"]),
        (["puma560", "--from", START, "--pose", "Trans(1,2)"], ["--pose", "expected Trans(x, y, z)"]),
        (["puma560", "--from", START, "--to", END, "--line", "--joint"], ["exclude each other"]),
        (["puma560", "--from", START, "--to", END, "--steps", "0"], ["--steps", "'0'", "whole number"]),
        (["puma560", "--from", START, "--to", END, "--steps", "ten"], ["--steps", "'ten'", "whole number"]),
        (["puma560", "--from", START, "--to", END, "--task", "pose"], ["--task goes with --line"]),
        (["assembly", "--from", "", "--to", ""], ["no joints"]),
        (["puma560", "--from", START, "--xy", "1,2", "--line"], ["--xy", "expected"]),
        (["scara", "--from", "0,0,1e300,0", "--to", "0,0,0,0"], ["too far"]),
    ],
)
def test_what_is_wrong_is_said(call, arguments, fragments):
    refused(call("path", *arguments), *fragments)


def test_a_path_ends_at_euler_angles_and_at_an_approach(call):
    start = ("path", "puma560", "--from", "90,-30,60,0,40,0", "--no-limits", "--json")
    by_rpy = call(*start, "--xyz", "-300,700,200", "--rpy", "0,90,30").json
    by_euler = call(*start, "--xyz", "-300,700,200", "--euler", "30,90,0").json
    np.testing.assert_allclose(by_euler["path"][-1]["q"], by_rpy["path"][-1]["q"], atol=1e-9)
    for more in ((), ("--line",)):
        path = call(*start, "--xyz", "-300,700,200", "--approach", "0,0,-1", *more).json["path"]
        T = robokin.forward_kinematics(robokin.load("puma560"), np.radians(path[-1]["q"]))
        np.testing.assert_allclose(T[:3, 2], [0.0, 0.0, -1.0], atol=1e-9)
        np.testing.assert_allclose(T[:3, 3], [-0.3, 0.7, 0.2], atol=1e-9)


def test_two_values_place_the_point_of_a_planar_arm(call):
    flat = call("path", "planar3r", "--from", "10,40,20", "--xyz", "0.9,1.2", "--line", "--json")
    solid = call("path", "planar3r", "--from", "10,40,20", "--xyz", "0.9,1.2,0", "--line", "--json")
    assert flat.out == solid.out
    assert call("path", "puma560", "--from", "home", "--xyz", "300,200").status == 2


def test_a_path_in_seconds(call):
    words = [*FROM, "--to", END, "--to", START, "--max-velocity", "40", "--steps", "8"]
    document = call(*words, "--json").json
    assert (
        document["duration"] == pytest.approx(2 * 1.875 * 30 / 40) and document["path"][-1]["t"] == document["duration"]
    )
    assert max(document["fastest"]["velocity"]) == pytest.approx(40)
    assert document["path"][4]["q"] == pytest.approx([60, -20, 70, 10, 30, 0])
    table = call(*words, "-f", "csv")
    assert table.columns[-12:] == [f"{name}{k}" for name in ("qd", "qdd") for k in range(1, 7)]
    assert np.abs(table.numbers[:, -12:-6]).max() == pytest.approx(40)
    page = call(*words).text
    assert "duration" in page and "2.8125 s" in page and "greatest velocity" in page
    again = call("fk", "puma560", "-i", "-", "-f", "csv", stdin=table.out)
    assert again.columns[0] == "t" and np.allclose(again.numbers_of("x"), table.numbers_of("x"))


def test_ways_through_points(call):
    words = ["path", "planar2r", "--from", "0,10", "--to", "40,20", "--to", "20,80", "--duration", "4", "-f", "csv"]
    stop, spline, blend = (call(*words, *more) for more in ([], ["--spline"], ["--blend", "0.5"]))
    moving = [np.abs(answer.numbers[1:-1, -4:-2]).max(axis=1).min() for answer in (stop, spline, blend)]
    assert moving[0] < 1e-9 and min(moving[1:]) > 1.0
    for answer in (stop, spline, blend):
        assert answer.numbers[-1, 0] == 4.0 and answer.numbers[-1, 1:3] == pytest.approx([20, 80])


def test_blends_of_a_path_without_points_between_are_told(call):
    """Only its ends are blended, which a typed --blend may not have meant; the rows are those of parabolic ends."""
    words = ["path", "planar2r", "--from", "0,10", "--to", "30,20", "--blend", "0.3", "--max-velocity", "90"]
    said = call(*words, "-f", "csv")
    assert said.status == 0 and "there is no point between the start and the end" in said.err
    assert call(*words, "--json").json["choices"] == [said.err.removeprefix("robokin: ").strip()]
    assert "no point between" not in call(*words, "--to", "60,50", "-f", "csv").err


def test_a_point_may_be_a_pose(call):
    T = "Trans(-300, 700, 200) RPY(0, 70, 90)"
    document = call(*FROM, "--to", T, "--to", END, "--duration", "2", "--steps", "2", "--json").json
    assert document["complete"] and document["path"][-1]["q"] == pytest.approx([60, -20, 70, 10, 30, 0])
    refused(call(*FROM, "--to", "Trans(1, 2) x"), "--to")


def test_an_arc(call):
    document = call(*FROM, "--xyz", "-300,700,200", "--arc", "-200,700,400", "--duration", "2", "--json").json
    assert document["kind"] == "arc" and document["complete"]
    p = np.array([row["position"] for row in document["path"]])
    assert np.linalg.norm(p - [-200, 700, 400], axis=1).min() < 5
    refused(call(*FROM, "--xyz", "-300,700,200", "--arc", "-300,700,200"), "on a line")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--duration", "0"], "--duration: found '0', expected seconds above 0"),
        (["--duration", "soon"], "--duration: found 'soon'"),
        (["--max-velocity", "-1"], "--max-velocity: found '-1', expected values above 0"),
        (["--max-velocity", "1,2"], "--max-velocity"),
        (["--max-velocity", "inf"], "--max-velocity: found 'inf', which limits no joint, expected a value"),
        (["--max-velocity", "-inf"], "--max-velocity"),
        (["--max-velocity", "inf", "--max-acceleration", "inf"], "--max-velocity and --max-acceleration: found 'inf'"),
        (["--max-velocity", "10", "--duration", "0.1"], "found a duration of 0.1 s, expected at least 5.625 s"),
        (["--spline", "--blend", "0.2"], "--spline and --blend exclude each other"),
        (["--spline", "--profile", "cubic"], "--profile is of pieces with a stop"),
        (["--spline", "--line"], "--spline is of paths by joints, expected --blend or --blend-radius with --line"),
        (["--blend", "2"], "--blend: found '2', expected a part above 0 and up to 1"),
        (["--profile", "quintc"], "--profile: found 'quintc'"),
        (["--rate", "1e12"], "--rate: found '1e12'"),
        (["--line", "--arc", "1,2,3"], "--line and --arc exclude each other"),
        (["--xyz", "1,2,3"], "--to and --xyz exclude each other"),
    ],
)
def test_slips_of_time_are_told(call, words, said):
    refused(call(*FROM, "--to", END, *words), said)


def test_slides_want_limits_of_their_own(call):
    words = ["path", "scara", "--from", "0,60,100,0", "--to", "40,30,50,90", "--max-velocity"]
    refused(call(*words, "90"), "found one value for joints that turn and slide, expected 4 values")
    assert max(call(*words, "90,90,25,90", "--json").json["fastest"]["velocity"]) > 25


@pytest.mark.parametrize("ending", ["html", "gif", "svg"])
def test_a_path_is_drawn_beside_its_answer(call, tmp_path, ending):
    if ending != "html":
        pytest.importorskip("matplotlib")
    path = tmp_path / f"path.{ending}"
    words = ["path", "planar2r", "--from", "30,40", "--xy", "-0.9,0.1", "--line", "--steps", "12"]
    answer = call(*words, "--plot", path)
    assert answer == call(*words)
    assert path.read_bytes().startswith({"html": b"<!DOCTYPE html>", "gif": b"GIF89a", "svg": b"<?xml"}[ending])
    before = path.read_bytes()
    call(*words, "--plot", path, "--json")
    assert path.read_bytes() == before


def test_a_path_that_ends_early_is_drawn_as_far_as_it_goes(call, tmp_path):
    answer = call("path", "planar2r", "--from", "10,20", "--xy", "9,9", "--line", "--plot", tmp_path / "a.html")
    assert answer.status == 3
    assert b"as far as it can be followed" in (tmp_path / "a.html").read_bytes()


def test_a_picture_of_no_kind_is_refused_before_the_work(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call(*FROM, "--to", END, "--plot", "a.mp4"), "--plot: found 'a.mp4'", ".png, .svg, .pdf, .html or .gif")
    assert not list(tmp_path.iterdir())


def test_a_pose_to_start_from_takes_the_best_branch(call):
    words = ["path", "puma560", "--from", "Trans(500,300,200) RPY(0,60,0)", "--to", "Trans(-300,500,200) RPY(0,60,60)"]
    document = call(*words, "--line", "--steps", "6", "--json").json
    assert document["complete"] and document["branches"][0]["chosen"]
    assert document["branches"][0]["start"] == pytest.approx(document["path"][0]["q"])
    assert document["branch"] == document["branches"][0]["branch"] == document["branch_at_end"]
    page = call(*words, "--line", "--steps", "6")
    assert "8 branches from this pose" in " ".join(page.text.split()) and max(map(len, page.lines)) <= 80
    # Formulas in joint values are no transform.
    assert call("path", "planar2r", "--from", "10*sqrt(4),10", "--to", "40,20", "-f", "csv").status == 0


def test_a_first_turn_is_told(call):
    answer = call("path", "puma560", "--from", "home", "--xyz", "-300,700,200", "--line", "--steps", "4", "--json")
    turn = answer.json["reorientation"]
    assert (turn["steps"], turn["joints"]) == (4, [4, 6])
    assert turn["end"] == pytest.approx(answer.json["path"][4]["q"])


def test_a_turn_in_the_middle_stands_in_the_document_and_among_the_notes(call):
    words = ["path", "puma560", "--from", "10,-2,65,0,67,0", "--to", "home"]
    words += ["--to", "Trans(-300,700,200) RPY(0,90,90)", "--line", "--steps", "4"]
    document = call(*words, "--json").json
    (turn,) = document["reorientations"]
    assert "reorientation" not in document and (turn["row"], turn["steps"], turn["joints"]) == (4, 4, [4, 6])
    assert turn["end"] == pytest.approx(document["path"][8]["q"], abs=1e-6)
    places = [row["position"] for row in document["path"][4:9]]
    assert all(place == pytest.approx(places[0]) for place in places)
    assert "at 0.333333 of the path: joints 4 and 6 turn, in 4 steps" in " ".join(call(*words).text.split())


def test_corners_are_rounded(call):
    """From the law: a right angle is passed at 3/16 √2 of the radius."""
    ends = ["--to", "Trans(-391.8,-133.3,487.8) RPY(90,0,-90)", "--to", "Trans(-391.8,-133.3,387.8) RPY(90,0,-90)"]
    path = ["path", "ur5e", "--from", "0,-90,90,0,90,0", *ends, "--duration", "2", "--steps", "4"]
    document = call(*path, "--line", "--blend-radius", "20", "--json").json
    (blend,) = document["blends"]
    assert blend["distance"] == pytest.approx(20 * 3 / 16 * 2**0.5, abs=1e-6) and blend["angle"] < 1e-9
    assert (blend["point"], document["steps"], document["complete"]) == (1, 8, True)
    assert blend["begins"] == pytest.approx(0.4) and blend["ends"] == pytest.approx(0.6)
    said = call(*path, "--line", "--blend-radius", "20", "-f", "csv")
    assert said.err == "robokin: passes point 1 at 5.303301 mm\n"
    part = call(*path, "--line", "--blend", "0.4", "--json").json
    assert part["blends"][0]["distance"] == pytest.approx(blend["distance"])
    mixed = call(*path, "--arc", "-441.8,-133.3,507.8", "--arc", "line", "--blend", "0.4", "--json").json
    assert (mixed["kind"], len(mixed["blends"])) == ("arc", 1)
    refused(
        call(*path, "--line", "--blend-radius", "120"), "a blend radius of 0.12 m does not fit between", "at most 0.1"
    )


def test_of_a_position_that_is_followed_no_turn_is_said(call):
    """Turns of the goals' poses are nothing that the tool does: it is turned as the joints have it."""
    straight = call("path", "planar2r", "--from", "0,90", "--to", "180,90", "--line", "--json")
    assert "half a turn" not in straight.err
    assert not straight.json.get("choices")
    path = ["path", "planar2r", "--from", "30,40", "--to", "60,30", "--to", "30,40", "--line", "--blend-radius", "0.1"]
    assert call(*path, "-f", "csv").err == "robokin: passes point 1 at 0.0375 m\n"
    assert call(*path, "--json").json["blends"][0]["angle"] == 0.0


def test_half_a_turn_is_said(call):
    document = call("path", "ur5e", "--from", "0,-90,90,0,90,0", "--pose", "Trans(-491.8,-133.3,487.8) RPY(90,0,90)",
                    "--line", "--json").json  # fmt: skip
    assert document["choices"] == ["to point 1 the tool turns by half a turn, which is as short the other way round"]


@pytest.mark.parametrize(
    ("words", "said"),
    [(["--line", "--blend-radius", "0"], "--blend-radius: found '0', expected a distance above 0 in mm"),
     (["--line", "--blend-radius", "20", "--blend", "0.2"], "--blend and --blend-radius exclude each other"),
     (["--blend-radius", "20"], "--blend-radius is of paths of the tool"),
     (["--arc", "1,2,3", "--arc", "line"], "--arc: found 2 places for 1 end, expected one --arc"),
     (["--to", END, "--arc", "1,2,3"], "--arc: found 1 place for 2 ends, expected an --arc for each --to"),
     (["--arc", "line"], "--arc: found 'line' alone"),
     (["--line", "--blend", "0.5"], "found no point between the start and the end")],
)  # fmt: skip
def test_slips_of_blends_are_told(call, words, said):
    refused(call(*FROM, "--to", END, *words), said)


HELD = ["path", "panda", "--from", "0,-30,0,-100,0,90,0", "--xyz", "400,100,500", "--line", "--steps", "4"]


def test_a_joint_is_held(call):
    table = call(*HELD, "--hold", "q3", "-f", "csv")
    assert (table.status, table.err) == (0, "") and not table.numbers[:, 3].any()
    document = call(*HELD, "--hold", "q3=0", "--json").json
    assert document["hold"] == {"q3": 0} and [row["q"] for row in document["path"]] == table.numbers[:, 1:8].tolist()
    assert "held" in call(*HELD, "--hold", "3").text


@pytest.mark.parametrize(
    ("words", "said"),
    [(["--hold", "q3=10"], "--from: q3 is 0, expected 10, at which --hold keeps it"),
     (["--hold", "q9=10"], "--hold: Franka Emika Panda has no joint 'q9'"),
     (["--hold", "q3="], "--hold: found 'q3=', expected JOINT=VALUE"),
     (["--hold", "q3", "--hold", "3"], "--hold: q3 is held twice")],
)  # fmt: skip
def test_slips_of_held_joints_are_told(call, words, said):
    refused(call(*HELD, *words), said)


@pytest.mark.parametrize("endless", ["inf", "inf,inf,inf,inf"])
def test_no_limit_of_one_kind_is_as_if_nothing_was_said_of_it(call, endless):
    words = ["path", "scara", "--from", "0,60,100,0", "--to", "40,30,50,90", "--steps", "5"]
    limited = [*words, "--max-acceleration", "30,30,300,30"]
    assert call(*limited, "--max-velocity", endless) == call(*limited)
    timed = [*words, "--duration", "2"]
    assert call(*timed, "--max-velocity", endless) == call(*timed)
