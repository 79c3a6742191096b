"""`robokin workspace` of arms that are hardly any: every option answers, with a status of its own and no warning.

The tool's point on an axis, joints that do not move it, limits of one value, one joint, sets that are a point.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from sweeps import sweep

from .conftest import invoke

ARMS = 100

FEW = ("--samples", "128", "--cores", "1")

OPTIONS = (
    ("--at", "0,0,0"),
    ("--at", "0.5,0,0", "--at", "1,2,3", "--json"),
    ("--at", "0,0,0", "-f", "csv"),
    (*FEW, "-f", "csv"),
    (*FEW, "-f", "jsonl"),
    (*FEW, "--dextrous"),
    (*FEW, "--dextrous", "--json"),
    (*FEW, "--dextrous", "-f", "csv"),
    (*FEW, "--plot", "FOLDER/o.svg"),
    (*FEW, "--plot", "FOLDER/o.html"),
    (*FEW, "--dextrous", "--plot", "FOLDER/o.html"),
    (*FEW, "--compare", "planar2r"),
    (*FEW, "--compare", "planar2r", "--plot", "FOLDER/o.svg"),
    (*FEW, "--output", "FOLDER/o.csv", "--with", "joints,poses"),
    (*FEW, "--output", "FOLDER/o.ply", "--resume"),
    (*FEW, "--output", "FOLDER/o.npy", "--sampling", "grid"),
    (*FEW, "--slice", "z=0"),
    (*FEW, "--section"),
)

HAS_NOT = ("reaches no solid", "does not turn it", "no areas and no solids")
"""What a sentence may say that an arm has not."""

LIMITS = {
    "R": (None, "[0, 0]", "[30, 30]", "[-90, 90]", "[0, 1e-13]", "[10, 60]", "[-180, 180]"),
    "P": ("[0, 0]", "[0.2, 0.2]", "[0, 0.5]", "[-0.1, 0.1]", "[0, 1e-15]"),
}


def written(path, number):
    """A file of one to three joints, most of whose lengths are zero and most of whose limits leave little."""
    rng = np.random.default_rng([11, number])
    joints = []
    for _ in range(rng.choice([1, 1, 2, 2, 3])):
        letter = "R" if rng.random() < 0.7 else "P"
        cells = [f"type: {letter}", f"a: {rng.choice([0, 0, 0, 0.5])}", f"alpha: {rng.choice([0, 0, 90, -90, 180])}"]
        limits = LIMITS[letter][rng.integers(len(LIMITS[letter]))]
        joints.append(", ".join(cells + ([f"limits: {limits}"] if limits else [])))
    lines = "".join(f"  - {{{joint}}}\n" for joint in joints)
    path.write_text(f"robokin: 1\nname: Arm\nunits: {{length: m, angle: deg}}\njoints:\n{lines}")
    return str(path)


def answered(path, arguments, folder):
    """A command line's answer: numbers or a no, or a sentence about what such an arm has not."""
    answer = invoke("workspace", path, *(str(part).replace("FOLDER", str(folder)) for part in arguments))
    where = f"{arguments} {answer.err}"
    assert answer.status in (0, 3) or (answer.status == 2 and any(words in answer.err for words in HAS_NOT)), where
    if "-f" not in arguments and "--json" in arguments and answer.status != 2:
        assert answer.json
    assert not re.search(r"\bnan\b|\binf\b", answer.text), where
    return answer


@pytest.mark.parametrize("part", sweep(range(10), 5))
def test_every_option_answers_for_arms_by_the_hundred(tmp_path, part):
    for number in range(part, ARMS, 10):
        path = written(tmp_path / "arm.yaml", number)
        document = answered(path, (*FEW, "--json"), tmp_path).json
        assert document["dimension"] <= 3
        # All options come round, another one for each arm.
        answered(path, OPTIONS[number * 7 % len(OPTIONS)], tmp_path)


def test_a_wrist_without_a_hand_turns_in_its_place(call):
    for arguments in (("--at", "0,0,0"), ("--dextrous", *FEW)):
        answer = call("workspace", "spherical-wrist", "--set", "d6=0", *arguments)
        assert (answer.status, answer.err) == (0, "")
        assert "100.0 %" in answer.text
    document = call("workspace", "spherical-wrist", "--set", "d6=0", "--dextrous", *FEW, "--json").json
    assert (document["dimension"], document["dexterity"]["mean"]) == (0, 1.0)
    sets = document["dexterity"]["sets"]
    assert [sets[name]["holds"] for name in ("reachable", "several", "every")] == [True, True, True]
    place = call("workspace", "spherical-wrist", "--set", "d6=0", "--at", "0,0,0.1", "--json")
    assert (place.status, place.json["reachable"], place.json["solutions"]) == (3, False, 0)


def test_a_joint_that_nothing_is_left_of_is_one_place(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\n"
                    "joints:\n  - {type: R, a: 0, limits: [0, 0]}\n")  # fmt: skip
    place = call("workspace", path, "--at", "0,0,0", "--json").json
    assert (place["reachable"], place["solutions"], place["reached"]) == (True, 1, 1)
    assert "a point" in call("workspace", path).text
    sets = call("workspace", path, "--dextrous", "--json").json["dexterity"]["sets"]
    assert [sets[name]["holds"] for name in ("reachable", "several", "every")] == [True, False, False]
    answer = call("workspace", path, "--dextrous", "-f", "csv")
    row = dict(zip(answer.columns, answer.csv[1], strict=True))
    assert (row["reachable"], row["several"], row["every"]) == ("true", "false", "false")
    for name in ("o.svg", "o.png", "o.html"):
        assert call("workspace", path, "--dextrous", "--plot", tmp_path / name).status == 0
    refused = call("workspace", path, "--slice", "z=0")
    assert (refused.status, "reaches no solid" in refused.err) == (2, True)
