"""Pages that move, in a real browser: played, stopped, sought, linked to and copied from."""

from __future__ import annotations

import io
import json
import re

import numpy as np
import pytest

import robokin
from robokin.inverse.frame_motions import frame_motion
from robokin.pictures.drawn_arm import arm_picture, scene_of, solved_postures
from robokin.pictures.drawn_frames import frames_picture
from robokin.pictures.drawn_mechanism import motion_to_draw, picture_of
from robokin.pictures.drawn_path import path_picture
from robokin.spatial import rotation_from_rpy, transform
from robokin.units import Units

from .browser import evaluate, needs_browser

MOST = 60_000
"""Bytes of the page of an arm."""

PUMA = robokin.load("puma560")
ENDS = np.radians([[90, -30, 60, 0, 40, 0], [60, -20, 70, 10, 30, 0]])
PATH = robokin.trajectory(PUMA, ENDS, duration=2.0, steps=50)
UNITS = Units("mm", "deg")


def page(path=PATH, notes=()):
    return path_picture(path, UNITS, "html", notes, words="puma560")


def data_of(text):
    (found,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', text.decode(), re.DOTALL)
    return json.loads(found)


def test_the_page_holds_the_rows_of_the_path():
    path = data_of(page())["path"]
    assert np.allclose(path["q"], np.degrees(PATH.q), rtol=1e-8, atol=1e-12)
    assert path["q"][0] == [90, -30, 60, 0, 40, 0], "the ends are what was typed"
    assert path["q"][-1] == [60, -20, 70, 10, 30, 0]
    assert np.allclose(path["t"], PATH.t)
    assert np.allclose(path["rates"], np.degrees(PATH.velocity), rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("name", ["puma560", "iiwa14", "scara", "planar3r", "ur5e"])
def test_a_page_is_small_whatever_the_number_of_rows(name):
    robot = robokin.load(name)
    low, high = np.clip(robot.limits, -2.0, 2.0).T
    path = robokin.trajectory(robot, [low + 0.3 * (high - low), low + 0.6 * (high - low)], duration=3.0, steps=5000)
    assert len(path_picture(path, robot.units, "html")) < MOST


@needs_browser
def test_a_path_is_played_stopped_and_sought(tmp_path):
    script = """
    const r = window.robokin, m = r.motion, $ = (id) => document.getElementById(id);
    const wait = (ms) => new Promise((d) => setTimeout(d, ms));
    const found = {started: m.running(), count: m.count};
    m.pause(); m.seek(0);
    $("play").click(); found.word = $("play").textContent; await wait(600); found.during = m.row();
    $("play").click(); await frame(); found.held = m.row(); await wait(300);
    found.still = m.row(); found.label = $("play").textContent;
    const key = (on) => on.dispatchEvent(new KeyboardEvent("keydown", {key: " ", bubbles: true, cancelable: true}));
    key(document.body); found.space = m.running(); key($("canvas")); found.again = m.running();
    key($("play")); found.button = m.running();
    $("seek").value = 25; $("seek").dispatchEvent(new Event("input"));
    found.q = r.q(); found.clock = $("clock").textContent;
    found.rate = document.querySelector(".rate").textContent;
    found.aria = $("seek").getAttribute("aria-valuetext");
    $("speed").value = 5; m.play(); await wait(900); found.end = [m.row(), m.running()];
    m.play(); await wait(60); found.restart = m.row(); m.pause();
    $("loop").checked = true; m.seek(48); m.play(); await wait(200); found.loop = [m.row(), m.running()]; m.pause();
    const slider = $("slider1"); m.play(); slider.value = 70.123456; slider.dispatchEvent(new Event("input"));
    found.moved = [m.running(), r.q()[0], document.querySelector(".rate").textContent];
    return found;
    """
    found = evaluate(page(), script, tmp_path)
    assert isinstance(found, dict), found
    assert (found["started"], found["count"], found["word"], found["label"]) == (True, 51, "pause", "play")
    assert 2 < found["during"] < 40
    assert found["held"] == found["still"]
    assert (found["space"], found["again"], found["button"]) == (True, False, False)
    assert np.allclose(found["q"], np.degrees(PATH.q[25]), atol=1e-6)
    assert found["clock"] == found["aria"] == "t = 1 s"
    assert found["rate"] == f"{np.degrees(PATH.velocity[25, 0]):.2f} °/s"
    assert found["end"] == [50, False]
    assert found["restart"] < 25
    assert found["loop"][0] < 48
    assert found["loop"][1]
    assert found["moved"] == [False, 70.1235, ""], "who moves a joint stops the path, which says no velocity then"


@needs_browser
def test_a_finger_turns_the_arm_while_it_plays(tmp_path):
    script = """
    const c = document.getElementById("canvas"), r = window.robokin;
    const image = () => [...c.toDataURL()].reduce((sum, x) => (31 * sum + x.charCodeAt(0)) | 0, 7);
    r.motion.seek(10); r.motion.pause(); await frame(); await frame();
    const before = image();
    const finger = (kind, x) => c.dispatchEvent(
      new PointerEvent(kind, {pointerId: 3, pointerType: "touch", clientX: x, clientY: 200, bubbles: true}));
    finger("pointerdown", 100); finger("pointermove", 190); finger("pointerup", 190);
    await frame(); await frame();
    return {turned: image() !== before, row: r.motion.row(), touch: getComputedStyle(c).touchAction};
    """
    assert evaluate(page(), script, tmp_path) == {"turned": True, "row": 10, "touch": "none"}


@needs_browser
def test_less_motion_is_respected(tmp_path):
    calm = (
        b"<head><script>window.matchMedia = (text) => ({matches: /reduce/.test(text), addEventListener() {}});</script>"
    )
    script = "const m = robokin.motion; const first = m.running(); m.play(); return [first, m.running()];"
    found = evaluate(page().replace(b"<head>", calm), script, tmp_path)
    assert found == [False, True]


@needs_browser
def test_events_are_marked_and_sought(tmp_path):
    path = robokin.trajectory(PUMA, np.radians([[90, -30, 60, 0, 40, 0], [60, -20, 70, 10, 400, 0]]), duration=2.0)
    assert path.events
    words = [f"told {k}" for k, _ in enumerate(path.events)]
    script = """
    const marks = [...document.querySelectorAll("#marks button")]; marks[marks.length - 1].click();
    const ticks = document.querySelectorAll(".ticks i").length;
    return {words: marks.map((m) => m.textContent), row: robokin.motion.row(), ticks};
    """
    found = evaluate(page(path, words), script, tmp_path)
    assert found["words"] == words
    assert found["ticks"] == len(words)
    assert found["row"] == int(np.argmin(np.abs(path.s - path.events[-1].fraction)))


LINKS = [
    ("#q=10,20,30,40,50,60", [10, 20, 30, 40, 50, 60], ""),
    ("#q=1e1,-2.5,30,40,50,60&units=mm,deg&view=30,40", [10, -2.5, 30, 40, 50, 60], ""),
    ("#q=" + ",".join(["10.1234567891"] * 6), [10.1234567891] * 6, ""),
    ("#view=30,40,2", None, ""),
    ("#t=1", [*np.degrees(PATH.q[25])], ""),
    ("#q=1,2,3", None, "found 3 joint values, expected 6"),
    ("#q=1,2,3,4,5,x", None, "q: found “x”, expected a number"),
    ("#q=1,2,3,4,5,Infinity", None, "expected a number"),
    ("#q=1,2,3,4,5,1e999", None, "expected a number"),
    ("#q=1,2,3,4,5,6&units=m,rad", None, "it is in m,rad, expected mm,deg"),
    ("#q=1,2,3,4,5,6&q=1,2,3,4,5,6", None, "expected q=…"),
    ("#%E0%A4%A", None, "expected q=…"),
    ("#<img src=x onerror=alert(1)>", None, "expected q=…"),
    ("#view=1", None, "azimuth and elevation"),
    ("#t=1,2", None, "one time"),
]


@needs_browser
def test_a_link_restores_what_it_carries_and_another_is_left_with_a_word(tmp_path):
    script = f"""
    const found = [];
    for (const hash of {json.dumps([link for link, _, _ in LINKS])}) {{
      robokin.motion.pause(); robokin.motion.seek(0); location.hash = hash; await frame(); await frame();
      const said = document.getElementById("said");
      found.push([robokin.q(), said.textContent, said.children.length]);
    }}
    robokin.setQ([10, 20, 30, 40, 50, 60.5]);
    const link = robokin.link(), before = robokin.q();
    robokin.motion.seek(0); location.hash = link.split("#")[1]; await frame(); await frame();
    return {{found, link: link.split("#")[1], same: JSON.stringify(robokin.q()) === JSON.stringify(before)}};
    """
    answer = evaluate(page(), script, tmp_path)
    assert isinstance(answer, dict), answer
    for (link, q, word), (shown, said, inside) in zip(LINKS, answer["found"], strict=True):
        assert np.allclose(shown, np.degrees(ENDS[0]) if q is None else q, atol=1e-6), link
        assert (word in said) if word else not said, link
        assert said.startswith("The link is not followed: ") or not word
        assert inside == 0, "what a link says is text"
    assert answer["link"].startswith("q=10,20,30,40,50,60.5&units=mm,deg")
    assert answer["same"]


@needs_browser
def test_what_is_copied_gives_the_same(tmp_path):
    script = """
    let taken = null; const $ = (id) => document.getElementById(id);
    const board = {writeText: async (text) => { taken = text; }};
    Object.defineProperty(navigator, "clipboard", {configurable: true, value: board});
    robokin.setQ([10.125, -20, 33.3333333333, 40, 50, 60]);
    const found = {}; await frame();
    for (const what of ["joints", "pose", "command", "link"]) {
      $("copy-" + what).click(); await frame(); found[what] = taken; found[what + " said"] = $("said").textContent;
    }
    found.shown = $("command").textContent.trim();
    navigator.clipboard.writeText = async () => { throw new Error("no"); };
    document.execCommand = (name) => { taken = document.activeElement.value; return name === "copy"; };
    taken = null; $("copy-joints").click(); await frame(); found.older = taken;
    document.execCommand = () => false; $("copy-joints").click(); await frame(); found.none = $("said").textContent;
    return found;
    """
    found = evaluate(page(), script, tmp_path)
    assert isinstance(found, dict), found
    q = [float(value) for value in found["joints"].split(",")]
    assert q == [10.125, -20, 33.3333333333, 40, 50, 60]
    T = robokin.forward_kinematics(PUMA, np.radians(q))
    T[:3, 3] *= 1000.0
    assert np.allclose(json.loads(found["pose"]), T, rtol=1e-10, atol=1e-9)
    assert found["command"] == found["shown"] == f"robokin fk puma560 --q={found['joints']} --length mm --angle deg"
    assert found["link"].endswith("#q=10.125,-20,33.3333333333,40,50,60&units=mm,deg")
    assert found["joints said"] == "joints copied"
    assert found["older"] == found["joints"]
    assert found["none"] == f"This browser does not let a page copy: {found['joints']}"


@needs_browser
def test_the_colour_of_a_solution_is_one(tmp_path):
    target = transform(rotation_from_rpy(np.radians([0.0, 90.0, 0.0])), np.array([0.5, 0.149, 0.2]))
    result = robokin.solve_ik(PUMA, target)
    wanted = solved_postures(result.question, PUMA.units, [])
    scene = scene_of(PUMA, PUMA.units, wanted, "", None, False)
    colours = scene.colours()
    assert len(set(colours)) == len(wanted.postures) == len(result.solutions)
    data = arm_picture(scene, "html")
    assert [ghost["colour"] for ghost in data_of(data)["ghosts"]] == colours
    script = "return [...document.querySelectorAll('#list i')].map((i) => i.style.background);"
    swatches = evaluate(data, script, tmp_path)
    assert swatches == ["rgb({}, {}, {})".format(*(int(c[k : k + 2], 16) for k in (1, 3, 5))) for c in colours]
    pytest.importorskip("matplotlib")
    still = arm_picture(scene, "svg").decode()
    assert all(f"fill: {c}" in still for c in colours), "the still's key has them"
    pillow = pytest.importorskip("PIL.Image")
    seen = {c for _, c in pillow.open(io.BytesIO(arm_picture(scene, "png"))).convert("RGB").getcolors(1 << 24)}
    assert {tuple(int(c[k : k + 2], 16) for k in (1, 3, 5)) for c in colours} <= seen


@needs_browser
def test_a_mechanism_goes_round_by_its_drive(tmp_path):
    mechanism = robokin.load_mechanism("four-bar")
    moved, _ = motion_to_draw(mechanism)
    data = picture_of(mechanism, moved, None, mechanism.units, ".html")
    script = """
    const m = robokin.motion, found = {running: m.running(), count: m.count};
    const wait = (ms) => new Promise((d) => setTimeout(d, ms));
    robokin.move(60); found.clock = document.getElementById("clock").textContent; found.stopped = !m.running();
    m.seek(m.count - 2); m.play(); await wait(400); found.round = m.row(); m.pause();
    robokin.move(-1); found.last = robokin.step();
    return found;
    """
    found = evaluate(data, script, tmp_path)
    assert (found["running"], found["count"], found["clock"], found["stopped"]) == (True, 240, "90.00 °", True)
    assert found["round"] < 100
    assert found["last"] == 239


@needs_browser
def test_a_frame_goes_to_the_other(tmp_path):
    last = transform(rotation_from_rpy([0.3, 0.2, 1.0]), np.array([1.0, 2.0, 3.0]))
    motion = frame_motion(np.eye(4), last, "screw", 4)
    script = """
    const m = robokin.motion; m.pause();
    return [0, 15, 60].map((k) => { m.seek(k); return robokin.pose(); });
    """
    found = evaluate(frames_picture(motion, ("", "last"), Units("m", "deg"), "html"), script, tmp_path)
    assert np.allclose(found, motion.screw.at(np.array([0.0, 0.25, 1.0])), atol=1e-9)


LAYOUT = """
const inside = async (wide) => {
  const view = document.body.appendChild(document.createElement("iframe"));
  Object.assign(view.style, {width: wide + "px", height: "800px", position: "absolute", left: 0, top: 0, border: 0});
  view.srcdoc = window.source;
  await new Promise((done) => { view.onload = done; });
  await frame(); await frame();
  const page = view.contentDocument, faults = [];
  if (page.documentElement.scrollWidth > wide) faults.push(`wider than ${wide}: ${page.documentElement.scrollWidth}`);
  const all = page.querySelectorAll("h1, h2, #view, button, select, label, input, .joint span, td, code, output, p");
  const shown = [...all].filter((e) => e.getClientRects().length && e.textContent + e.id + e.type);
  const name = (e) => e.id || e.className || e.textContent;
  for (const a of shown) for (const b of shown) {
    if (a === b || a.contains(b) || b.contains(a)) continue;
    if (a.compareDocumentPosition(b) & 2) continue;
    const [r, s] = [a.getBoundingClientRect(), b.getBoundingClientRect()];
    const w = Math.min(r.right, s.right) - Math.max(r.left, s.left);
    const h = Math.min(r.bottom, s.bottom) - Math.max(r.top, s.top);
    if (w > 1.5 && h > 1.5) faults.push(`${wide}: ${name(a)} over ${name(b)}`);
  }
  view.remove();
  return faults;
};
const faults = [];
for (const wide of [390, 768, 1280]) faults.push(...await inside(wide));
return faults;
"""


@needs_browser
@pytest.mark.parametrize("what", ["path", "solutions", "mechanism", "frame"])
def test_nothing_covers_another(what, tmp_path):
    if what == "path":
        data = page(notes=["at 0.5 of the path: a note that is long enough to need more than a line on a telephone"])
    elif what == "solutions":
        result = robokin.solve_ik(PUMA, robokin.forward_kinematics(PUMA, ENDS[0]))
        data = arm_picture(
            scene_of(PUMA, PUMA.units, solved_postures(result.question, PUMA.units, []), "", None, True), "html"
        )
    elif what == "mechanism":
        mechanism = robokin.load_mechanism("sarrus")
        data = picture_of(mechanism, motion_to_draw(mechanism)[0], None, mechanism.units, ".html")
    else:
        data = frames_picture(
            frame_motion(np.eye(4), PATH.T[0]), ("", "Trans(1, 2, 3) RPY(1, 2, 3)"), Units("m", "deg"), "html"
        )
    source = json.dumps(data.decode()).replace("<", "\\u003c")
    host = f"<!DOCTYPE html><html><head></head><body><script>window.source = {source};</script></body></html>"
    assert evaluate(host.encode(), LAYOUT, tmp_path) == []
