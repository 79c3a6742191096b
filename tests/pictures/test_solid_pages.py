"""The solid of a workspace's page: the field that it is drawn from is the set, cut and place are what the page says."""

from __future__ import annotations

import json

import numpy as np
import pytest

import robokin
from robokin.pictures.compose import counts_in
from robokin.pictures.solid_set import solid_set
from robokin.pictures.views import section_view
from robokin.reports.workspace_pictures import workspace_picture
from robokin.workspace.analyse import analyse_workspace
from robokin.workspace.membership import drawn_reachable, reachable, solution_count

from .browser import browser, evaluate, needs_browser

NEAR = 0.025
"""How far from the boundary a page's solid may be wrong, in parts of the arm's size: two steps of its grid."""


@pytest.fixture(scope="module")
def found():
    known = {}

    def find(name):
        if name not in known:
            known[name] = analyse_workspace(robokin.load(name), samples=1024, cores=1)
        return known[name]

    return find


def page_of(workspace):
    return workspace_picture([workspace], [[]], [[]], workspace.space.robot.units, ".html", cores=1)


@needs_browser
@pytest.mark.parametrize("name", ["scara", "anthropomorphic", "adept-one", "cobra-s350", "cartesian"])
def test_the_field_of_a_page_is_the_reachable_set(name, found, rng, tmp_path):
    space = found(name).space
    low, high = found(name).extent.low, found(name).extent.high
    points = rng.uniform(low - 0.05, high + 0.05, (600, 3))
    points /= space.robot.units.metres
    script = f"return {json.dumps(points.tolist())}.map(robokin.value);"
    values = np.array(evaluate(page_of(found(name)), script, tmp_path))
    points *= space.robot.units.metres
    inside = reachable(space, points)
    # Places from which a step in some direction leads across the boundary are not asked about.
    near = np.zeros(len(points), dtype=bool)
    for step in NEAR * space.size * np.concatenate([np.eye(3), -np.eye(3)]):
        near |= drawn_reachable(space, points + step) != inside
    assert np.mean(near) < 0.7
    assert np.all((values > 0.0)[~near] == inside[~near])


@needs_browser
def test_cut_keys_place_link_and_command(found, tmp_path):
    page = page_of(found("scara"))
    script = """
    const press = async (key) => {
      canvas.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true})); await frame(); await frame();
    };
    const cut = () => $("cutvalue").textContent;
    const seen = [cut()];
    for (const key of ["x", "z", "f", "e", "0"]) { await press(key); seen.push(cut()); }
    const box = canvas.getBoundingClientRect(), places = [];
    for (let x = box.left + 5; x < box.right; x += 25) for (let y = box.top + 5; y < box.bottom; y += 25) {
      const p = robokin.placeAt({clientX: x, clientY: y});
      if (p) places.push([p, robokin.told(p)]);
    }
    pin(places[0][0]);
    await press("c");
    const address = link();
    return {seen, places, command: $("command").textContent, address, cut: cut()};
    """
    seen = evaluate(page, script, tmp_path)
    assert isinstance(seen, dict), seen
    first, x, z, other, towards, again = seen["seen"]
    assert first == again == "kept: y ≥ 0 mm"
    assert x.startswith("kept: x ≤")
    assert z.startswith("kept: z ≤")
    assert other.startswith("kept: z ≥")
    assert "before the middle" in towards
    # What the page says of the places that are seen is so, on the cut's face and just inside of the surface.
    space = found("scara").space
    for place, told in seen["places"][:: max(len(seen["places"]) // 40, 1)]:
        numbers = [int(word) for word in told.split(" · ")[2].split()[::2] if word.isdigit()]
        beside = 1e-3 * np.array(place) + 0.02 * np.stack(np.meshgrid(*[[-1, 0, 1]] * 3), axis=-1).reshape(-1, 3)
        assert set(numbers) <= {*solution_count(space, beside).tolist(), 1}, told
    assert seen["command"].startswith("robokin workspace scara --at=")
    tab = browser()
    tab.open(tmp_path / "page.html", fragment="#" + seen["address"].partition("#")[2])
    assert tab.run("await frame(); return $('cutvalue').textContent;") == seen["cut"] != first
    assert tab.run("return $('command').textContent;") == seen["command"]
    tab.open(tmp_path / "page.html", fragment="#view=10,20&cut=w,3")
    said, view = tab.run("await frame(); return [$('said').textContent, robokin.view()];")
    assert said.startswith("The link is not followed: cut: found “w,3”, expected ")
    assert view == [-58, 22, 1], "nothing of it is followed"
    assert tab.errors == []


def test_counts_of_a_plane_are_those_of_its_places(found):
    space = found("anthropomorphic").space
    table = counts_in(section_view(space), space)
    index = np.argwhere(table.values > 0)[::97]
    places = section_view(space).points(table.low + table.step * index)
    assert np.array_equal(table.values[tuple(index.T)], solution_count(space, places))


def test_a_place_that_a_picture_denies_or_not_is_as_the_set_has_it(found, rng):
    """Next to the boundary too, where pictures look for it by bisection."""
    for name in ("anthropomorphic", "adept-one", "planar2r"):
        space = found(name).space
        points = rng.uniform(-1.0, 1.0, (200, 3)) * space.size
        points[:100] = np.round(points[:100] * 10 / space.size) * space.size / 10
        if space.dimension == 2:
            points[:, 2] = space.centre[2]
        assert np.array_equal(drawn_reachable(space, points), reachable(space, points))


def test_a_whole_solid_has_no_gaps_and_one_with_limits_has(found):
    assert solid_set(found("scara"), None).gaps is None
    gaps = solid_set(found("adept-one"), None).gaps
    # The first joint turns by 300°: it leaves at most 60° out.
    assert gaps is not None
    assert np.max(gaps[..., 1]) <= np.radians(30.0) + 1e-9
