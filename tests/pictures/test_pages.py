"""Every kind of page in a real browser: nothing overlaps at any width in either theme, keys and fingers work.

A new kind of page is a line in PAGES.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import robokin
from robokin.formats.library import load_any
from robokin.inverse.frame_motions import frame_motion
from robokin.pictures.drawn_frames import frames_picture
from robokin.reports.workspace_pictures import workspace_picture
from robokin.spatial import rotation_from_rpy, transform
from robokin.units import Units
from robokin.workspace.analyse import analyse_workspace

from .browser import Browser, browser, needs_browser

CHECKS = (Path(__file__).parent / "page_checks.js").read_text(encoding="utf-8")

WIDTHS = {390: 844, 768: 1024, 1280: 800}
"""Widths and heights of a telephone, a tablet and a laptop [px]."""

THEMES = ("light", "dark")


def plot(name: str, **options: object) -> bytes:
    return robokin.draw(load_any(name, {}), kind="html", **options).data  # type: ignore[arg-type]


def path(name: str, *stops: tuple[float, ...]) -> bytes:
    moved = robokin.trajectory(robokin.load(name), np.radians(stops), duration=2.0)
    return robokin.draw(moved, kind="html").data


def frames(rpy: tuple[float, ...], place: tuple[float, ...]) -> bytes:
    last = transform(rotation_from_rpy(np.array(rpy)), np.array(place))
    return frames_picture(frame_motion(np.eye(4), last, "screw"), ("", "last"), Units("m", "deg"), "html")


def workspace(*names: str, samples: int = 1024, dextrous: bool = False) -> bytes:
    robots = [robokin.load(name) for name in names]
    found = [analyse_workspace(robot, samples=samples, dextrous=dextrous, cores=1) for robot in robots]
    none: list[list] = [[] for _ in robots]
    return workspace_picture(found, none, none, robots[0].units, ".html", cores=1)


PAGES: dict[str, Callable[[], bytes]] = {
    "arm": lambda: plot("puma560"),
    "sliding arm": lambda: plot("stanford"),
    "tree": lambda: plot("human-hand"),
    "path": lambda: path("puma560", (0, 0, 90, 0, 0, 0), (60, -20, 70, 10, 400, 0)),
    "frames": lambda: frames((0.5, 1.0, 1.5), (1.0, 2.0, 0.0)),
    "mechanism": lambda: plot("four-bar"),
    "planar workspace": lambda: workspace("planar2r"),
    "two workspaces": lambda: workspace("planar2r", "planar2r"),
    "planar dexterity": lambda: workspace("planar3r", dextrous=True),
    "solid": lambda: workspace("anthropomorphic"),
    "open solid": lambda: workspace("cobra-s350"),
    "solid dexterity": lambda: workspace("scara", dextrous=True),
    "box": lambda: workspace("cartesian"),
    "surface": lambda: workspace("spherical-wrist"),
}


SAMPLE = ("path", "frames", "tree", "mechanism", "planar workspace", "open solid", "solid dexterity", "surface")
"""Kinds that are looked at each time; the others are like one of them."""

KINDS = [kind if kind in SAMPLE else pytest.param(kind, marks=pytest.mark.slow) for kind in PAGES]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The file of a page by its kind, made when it is first asked for."""
    folder = tmp_path_factory.mktemp("pages")

    def page(kind: str) -> Path:
        path = folder / f"{kind.replace(' ', '-')}.html"
        if not path.exists():
            path.write_bytes(PAGES[kind]())
        return path

    return page


def opened(path: Path, width: int = 1280, theme: str = "light", fragment: str = "") -> Browser:
    tab = browser()
    tab.open(path, width, WIDTHS[width], theme, fragment)
    tab.call(
        "Runtime.evaluate", expression=f"(() => {{ {CHECKS}\n window.checks = {{look, stops, focused, drawn}}; }})()"
    )
    tab.run("await frame(); await frame(); if (window.robokin.motion) robokin.motion.pause();")
    return tab


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_overlaps_and_all_can_be_read_at_every_width_in_both_themes(kind, pages):
    tab = opened(pages(kind))
    wrong = []
    for width, height in WIDTHS.items():
        for theme in THEMES:
            tab.shape(width, height, theme)
            seen = tab.run("await frame(); await frame(); return checks.look();")
            assert isinstance(seen, dict), seen
            wrong += [f"{width} {theme}: {sentence}" for sentences in seen.values() for sentence in sentences]
    assert not wrong, "\n".join(wrong)
    assert not tab.errors
    assert not tab.asked, "a page needs no network"


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_small_and_asks_for_nothing(kind, pages):
    size = pages(kind).stat().st_size
    assert size < (500_000 if "workspace" in PAGES[kind].__code__.co_names else 200_000)


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_the_tab_key_comes_to_every_control_in_order_and_is_seen(kind, pages):
    tab = opened(pages(kind))
    count = tab.run("document.activeElement.blur(); return checks.stops().length;")
    found = []
    for _ in range(count):
        tab.press("Tab")
        found.append(tab.run("return checks.focused();"))
    assert [stop["index"] for stop in found] == list(range(count)), found
    assert not [stop["name"] for stop in found if not stop["seen"]]


# A slow machine draws coarsely what moves, and finely what stands.
MOVED = (
    "do await frame(); while (waiting || (typeof coarse !== 'undefined' && coarse));"
    "return [checks.drawn(), [azimuth, elevation], zoom, shift];"
)


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_keys_turn_and_zoom_and_begin_again(kind, pages):
    tab = opened(pages(kind))
    # What plays would look otherwise at the end.
    tab.run("window.robokin.motion?.pause(); canvas.focus();")
    first = tab.run(MOVED)
    seen = [first]
    for key in ("ArrowLeft", "ArrowDown", "+", "-", "0"):
        tab.press(key)
        seen.append(tab.run(MOVED))
    pictures = [state[0] for state in seen]
    assert len(set(pictures[:4])) == 4, "each of these keys changes the picture"
    assert seen[3][2] == pytest.approx(1.2 * seen[2][2])
    assert seen[-1] == first
    assert not tab.errors


@needs_browser
@pytest.mark.parametrize("kind", KINDS)
def test_one_finger_turns_and_two_zoom(kind, pages):
    tab = opened(pages(kind), 390)
    tab.shape(390, WIDTHS[390], touch=True)
    left, top, width, height = tab.run(
        "canvas.scrollIntoView({block: 'center'}); const box = canvas.getBoundingClientRect();"
        "await frame(); return [box.left, box.top, box.width, box.height];"
    )
    x, y = left + 0.5 * width, top + 0.5 * height
    first = tab.run(MOVED)
    tab.touch([(x + 8 * i, y + 3 * i) for i in range(6)])
    turned = tab.run(MOVED)
    assert turned[0] != first[0]
    assert turned[1] != first[1] or turned[3] != first[3]
    assert turned[2] == first[2]
    tab.touch([(x - 20 - 6 * i, y) for i in range(6)], [(x + 20 + 6 * i, y) for i in range(6)])
    near = tab.run(MOVED)
    assert near[2] > 1.5 * first[2]
    assert near[0] != turned[0]
    assert not tab.errors
