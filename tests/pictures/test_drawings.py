"""Stills and pages: what they are made of, that they are whole, and the same every time."""

from __future__ import annotations

import base64
import json
import re
import struct
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from pictures.page_tables import unpacked

from robokin.errors import InputError
from robokin.pictures.outline import trace
from robokin.pictures.picture import Cloud, OrientationDegrees, Panel, Picture
from robokin.pictures.workspace_page import STEPS, page
from robokin.pictures.workspace_stills import still
from robokin.units import Units

BOX = np.array([-1.0, -1.0]), np.array([1.0, 1.0])


@pytest.fixture(scope="module")
def picture():
    rng = np.random.default_rng(560)
    disc = trace(lambda p: np.hypot(*p.T) < 0.9, *BOX, cells=40)
    part = trace(lambda p: (np.hypot(*p.T) < 0.9) & (p[:, 0] > 0.0), *BOX, cells=40)
    arm = np.array([[0.0, 0.0], [0.5, 0.3], [0.8, 0.2]])
    places = 0.1 * np.argwhere(np.ones((13, 13)))[rng.permutation(169)[:50]] - 0.6
    degrees = OrientationDegrees(places, np.hypot(*places.T), 0.1, "part of the angles that can be reached")
    panels = [
        Panel("section", ("r", "z"), part, disc, [arm], "home", radial=True),
        Panel("slice at z = 0 mm", ("x", "y"), disc, degrees=degrees),
    ]
    points = rng.uniform(-1.0, 1.0, (300, 3))
    cloud = Cloud(points, points[:, 2], arms=[np.pad(arm, ((0, 0), (0, 1)))])
    return Picture("An <arm> & more", "volume 1 mm³", Units("mm", "deg"), panels, cloud, [("volume", "1 mm³")])


@pytest.fixture(scope="module")
def matplotlib():
    return pytest.importorskip("matplotlib")


@pytest.fixture(scope="module")
def svg(picture, matplotlib):
    return still(picture, "svg")


def data_of(document):
    (text,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', document.decode(), re.DOTALL)
    return json.loads(text)


def test_a_png_is_a_png_of_some_size(picture, matplotlib):
    data = still(picture, "png")
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", data[16:24])
    assert 1500 < width < 4000
    assert 800 < height < 2000


def test_an_svg_names_its_axes_with_units(svg):
    words = "".join(ElementTree.fromstring(svg.decode()).itertext())
    for word in ("An <arm> & more", "r [mm]", "z [mm]", "x [mm]", "without joint limits", "the arm at home",
                 "part of the angles that can be reached"):  # fmt: skip
        assert word in words


def test_a_pdf_is_a_pdf_and_always_the_same(picture, matplotlib):
    data = still(picture, "pdf")
    assert data.startswith(b"%PDF-")
    assert still(picture, "pdf") == data


def test_a_picture_does_not_take_on_the_users_settings(picture, svg, matplotlib):
    with matplotlib.rc_context({"lines.linewidth": 9.0, "axes.grid": False, "font.size": 30.0}):
        assert still(picture, "svg") == svg
        assert matplotlib.rcParams["font.size"] == 30.0


def test_without_matplotlib_the_sentence_says_how_to_get_it(picture, monkeypatch):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    with pytest.raises(InputError, match="`pip install matplotlib`"):
        still(picture, "png")


def test_a_page_needs_no_network_and_no_matplotlib(picture, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    text = page(picture).decode().replace("http://www.w3.org/2000/svg", "")
    assert not re.search(r"https?://|<link|<img|src=|@import|url\((?!#)", text)
    assert "<title>An &lt;arm&gt; &amp; more</title>" in text
    assert "<arm>" not in text


def test_a_page_holds_the_points_to_a_sixty_thousandth(picture):
    cloud = data_of(page(picture))["cloud"]
    packed = np.frombuffer(base64.b64decode(cloud["points"]), dtype="<u2").reshape(-1, 3)
    low, high = np.array(cloud["low"]), np.array(cloud["high"])
    points = low + packed / STEPS * (high - low)
    assert np.allclose(points, 1000.0 * picture.cloud.points, atol=1.1 * np.max(high - low) / STEPS)


def test_a_page_holds_the_outlines_in_the_units(picture):
    plates = data_of(page(picture))["plates"]
    assert [plate["labels"] for plate in plates] == [["r", "z"], ["x", "y"]]
    assert np.allclose(plates[1]["loops"][0], 1000.0 * picture.panels[1].outline.loops[0], atol=0.1)
    assert plates[0]["cells"] is None
    table = plates[1]["cells"]
    values = unpacked(table)
    assert np.sum(values < 255) == 50
    index = np.round((1000.0 * picture.panels[1].degrees.points - table["low"]) / table["step"]).astype(int)
    assert np.allclose(values[tuple(index.T)] / 254.0, picture.panels[1].degrees.fraction, atol=0.5 / 254.0)


def test_a_flat_cloud_has_a_page(picture, rng):
    points = np.column_stack([rng.uniform(size=(20, 2)), np.zeros(20)])
    assert data_of(page(Picture("", "", Units(), cloud=Cloud(points, points[:, 2]))))["cloud"]["high"][2] > 0.0


def test_a_cloud_of_one_point_has_a_page_and_a_still(matplotlib):
    point = np.array([[0.1, 0.2, 0.3]])
    alone = Picture("", "", Units(), cloud=Cloud(point, point[:, 2], "", [point]))
    cloud = data_of(page(alone))["cloud"]
    assert np.allclose(cloud["low"], point[0])
    assert still(alone, "png").startswith(b"\x89PNG")
