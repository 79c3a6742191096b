"""Work says which stage it has come to, and costs nothing where nobody listens."""

from __future__ import annotations

import robokin
from robokin.jobs.ordered_map import ordered_map
from robokin.jobs.stages import about, followed, stage


def double(x):
    return 2 * x


def test_stages_follow_one_another():
    with followed() as work:
        assert (work.done, work.now) == ([], "")
        stage("bounds")
        assert list(ordered_map(double, [1, 2, 3], 1)) == [2, 4, 6]
        assert work.part == (3, 3)
        about("Arm")
        stage("volume")
        assert (work.done, work.now, work.part) == (["bounds"], "Arm: volume", None)
        about("")
        stage("picture")
        assert work.done == ["bounds", "Arm: volume"]
    stage("nobody listens")
    assert work.now == "picture"


def test_a_workspace_says_its_stages():
    with followed() as work:
        robokin.analyse_workspace(robokin.load("planar3r"), samples=1000, cores=1, dextrous=True)
    assert work.done[:3] == ["bounds", "area", "map of the orientations"]
    assert "search 3 of 3" in " ".join([*work.done, work.now])


def test_a_part_is_counted_while_it_is_made():
    with followed() as work:
        stage("parts")
        for number, _ in enumerate(ordered_map(double, range(4), 1), start=1):
            assert work.part == (number, 4)
