"""Pictures of mechanisms: what their shapes are made of, stills and pages of all kinds, a page that moves."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.mobility.gear_wheels import belt_lines, wheels_of
from robokin.mobility.trace import trace
from robokin.pictures.drawn_mechanism import motion_to_draw, picture_of
from robokin.pictures.mechanism_page import mechanism_page
from robokin.pictures.mechanism_scene import mechanism_scene
from robokin.pictures.mechanism_shape import shape_of

from .browser import evaluate, needs_browser

DRAWN = ["four-bar", "slider-crank", "planetary", "belt-drive", "geared-five-bar", "bennett", "sarrus", "6-ups", "rssr",
         "bricard-line-symmetric", "spherical-four-bar", "bevel-differential", "rccc", "screw-jack", "shaky-triangle",
         "cam-roller", "puma560-mechanism"]  # fmt: skip


@pytest.mark.parametrize("name", DRAWN)
def test_links_run_between_the_places_of_their_joints(name):
    mechanism = robokin.load_mechanism(name)
    shape = shape_of(mechanism)
    ends = {(piece.bodies, tuple(np.round(p, 9))) for piece in shape.pieces for p in (piece.a, piece.b)}
    assert shape.size > 0.0
    if mechanism.space != "spatial":
        return
    for i, joint in enumerate(mechanism.joints):
        for link in joint.links:
            body = mechanism.links.index(link)
            count = sum(link in other.links and not other.gearing for other in mechanism.joints)
            if count == 2 and not joint.gearing and not any(plate.body == body for plate in shape.plates):
                assert ((body, body), tuple(np.round(shape.places[i], 9))) in ends


def test_a_shape_grows_with_the_mechanism():
    bennett = robokin.load_mechanism("bennett")
    small = shape_of(bennett)
    joints = tuple(replace(joint, at=1e3 * joint.at) for joint in bennett.joints)
    large = shape_of(replace(bennett, joints=joints))
    assert large.size == pytest.approx(1e3 * small.size)
    for a, b in zip(small.pieces, large.pieces, strict=True):
        assert np.allclose(1e3 * a.a, b.a)
        assert np.allclose(1e3 * np.array(a.widths), b.widths)


def test_axes_that_meet_stand_on_a_sphere():
    shape = shape_of(robokin.load_mechanism("spherical-four-bar"))
    distances = np.linalg.norm(shape.places, axis=1)
    assert np.allclose(distances, distances[0])
    assert distances[0] > 0.0


def test_wheels_touch_and_belts_run_along_their_pulleys():
    for name in ("gear-pair", "planetary", "geared-five-bar", "bevel-pair"):
        wheels = wheels_of(robokin.load_mechanism(name))
        assert len(wheels) >= 2
        assert all(wheel.radius > 0.0 for wheel in wheels)
    a, b = wheels_of(robokin.load_mechanism("geared-five-bar"))
    assert a.radius + b.radius == pytest.approx(np.linalg.norm(a.centre - b.centre))
    assert [w.ring for w in wheels_of(robokin.load_mechanism("planetary")) if w.link == "ring"] == [True]
    pulleys = wheels_of(robokin.load_mechanism("belt-drive"))
    assert [round(w.radius, 9) for w in pulleys] == [0.02, 0.04, 0.03]
    for line in belt_lines(pulleys):
        along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
        apart = [np.linalg.norm(np.cross(w.centre - line[0], along)) for w in pulleys]
        assert sorted(abs(d - w.radius) < 1e-12 for d, w in zip(apart, pulleys, strict=True)) == [False, True, True]


@pytest.mark.parametrize(
    ("name", "ending"),
    sweep([
        ("bennett", ".png"), ("belt-drive", ".png"), ("belt-drive", ".html"), ("bevel-pair", ".svg"),
        ("sarrus", ".html"), ("shaky-triangle", ".svg"), ("shaky-triangle", ".html"),
    ], 3),
)  # fmt: skip
def test_all_kinds_of_files(name, ending):
    if ending != ".html":
        pytest.importorskip("matplotlib")
    mechanism = robokin.load_mechanism(name)
    moved, note = motion_to_draw(mechanism)
    data = picture_of(mechanism, moved, None, mechanism.units, ending, note=note)
    assert data.startswith({".png": b"\x89PNG", ".svg": b"<?xml", ".html": b"<!DOCTYPE html>"}[ending])
    assert data == picture_of(mechanism, moved, None, mechanism.units, ending, note=note)
    if ending == ".html":
        assert b"@INCLUDE" not in data
        assert b"http" not in data.replace(b"http://www.w3.org", b"")


def page_data(page):
    (text,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page.decode(), re.DOTALL)
    return json.loads(text)


def test_the_page_holds_the_motion():
    mechanism = robokin.load_mechanism("sarrus")
    moved = trace(mechanism, 500)
    data = page_data(mechanism_page(mechanism_scene(mechanism, moved, None, mechanism.units)))
    assert len(data["poses"]) == 360
    assert data["poses"][0] == [10**6, 0, 0, 0, 0, 0, 0] * 5
    assert data["labels"] == list(moved.labels)
    assert data["closed"] == moved.closed
    assert np.allclose(np.array(data["values"][-1]), np.degrees(moved.values[-1]), rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("name", sweep(["delta-with-bars", "orthoglide", "6-sps", "dixon-second", "miura-ori"], 4))
def test_a_page_of_many_links_stays_small(name):
    mechanism = robokin.load_mechanism(name)
    moved, note = motion_to_draw(mechanism)
    assert len(picture_of(mechanism, moved, None, mechanism.units, ".html", note=note)) < 400_000


@needs_browser
def test_the_page_moves_in_a_browser(tmp_path):
    mechanism = robokin.load_mechanism("bennett")
    moved = trace(mechanism, 40)
    page = mechanism_page(mechanism_scene(mechanism, moved, None, mechanism.units))
    script = (
        "const r = window.robokin; r.move(13); await frame(); const shown = r.pose('coupler'); const at = r.step();"
        "document.getElementById('play').click(); for (let i = 0; i < 8; i++) await frame();"
        "const later = r.step(); document.getElementById('play').click();"
        "const c = document.getElementById('canvas');"
        "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let ink = 0; for (let i = 0; i < d.length; i += 4) if (d[i] + d[i + 1] + d[i + 2] < 600) ink++;"
        "return {count: r.count, at, shown, later, ink};"
    )
    found = evaluate(page, script, tmp_path)
    assert (found["count"], found["at"]) == (40, 13)
    assert np.allclose(np.reshape(found["shown"], (3, 4)), moved.poses[13, 2, :3], atol=1e-5)
    assert found["later"] != 13
    assert found["ink"] > 500
