"""The playground's page in a real browser.

Python answers the page from a server here, in the words that the page's own worker uses. With ROBOKIN_PLAYGROUND, a
folder that `make playground` has built, the page has its own Python, which not every machine can build.
"""

from __future__ import annotations

import base64
import json
import os
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from pictures.browser import browser, needs_browser
from playground.test_engine import engine, module

pytestmark = needs_browser
BUILT = os.environ.get("ROBOKIN_PLAYGROUND")

STAND_IN = """
const reviver = (key, value) => value && value.bytes !== undefined
  ? Uint8Array.from(atob(value.bytes), (c) => c.charCodeAt(0)) : value;
let before = Promise.resolve();
onmessage = ({data: {id, call, args}}) => {
  before = before.then(async () => {
    const answer = await fetch("call", {method: "POST", body: JSON.stringify([call, args])});
    postMessage({id, ...JSON.parse(await answer.text(), reviver)});
  });
};
postMessage({progress: ""});
"""


ASKED = threading.Lock()


class Served(SimpleHTTPRequestHandler):
    """The page's files, and answers to its calls."""

    def do_POST(self):
        call, args = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        try:
            # One after the other, as the page's own worker: a page that was left may still be asking.
            with ASKED:
                answer = {"result": getattr(engine, call)(*args)}
        except Exception as error:
            answer = {"error": str(error)}
        body = json.dumps(answer, default=lambda held: {"bytes": base64.b64encode(held).decode()}).encode()
        self.send_response(200)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *words):
        pass


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """Where the page is served."""
    folder = Path(BUILT or tmp_path_factory.mktemp("page")).resolve()
    if not BUILT:
        module("build").pages(folder)
        (folder / "worker.js").write_text(STAND_IN)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Served, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


WAIT = """
const until = async (ready) => {
  for (let i = 0; i < 2000; i++) { const found = ready(); if (found) return found; await frame(); }
  throw new Error(`nothing came: ${ready}`); };
const $ = (id) => document.getElementById(id), text = (id) => $(id).textContent;
const settled = () => until(() => $("answer").dataset.of === text("command")
  && !$("answer").classList.contains("busy"));
const choose = async (name) => { (await until(() => $(`tab-${name}`))).click(); };
const send = async () => { $("form").requestSubmit(); await settled(); return text("answer"); };
const fill = (name, value) => { const field = $("form").elements[name]; field.value = value;
  field.dispatchEvent(new Event(field.tagName === "SELECT" ? "change" : "input", {bubbles: true})); };
const arm = () => $("picture").contentWindow.robokin;
"""


def opened(address, fragment=""):
    """The page, when its first answer is there."""
    tab = browser()
    tab.open(address, 1280, 900, fragment=fragment)
    tab.run(WAIT + "await until(() => window.playground && $('picture').srcdoc);")
    return lambda script: tab.run(WAIT + script)


def test_the_first_answer_is_that_of_the_command_line(address):
    run = opened(address)
    assert run("await settled(); return text('command')") == "robokin fk puma560 --q=90,0,90,0,0,0"
    shown = run("return text('answer')")
    assert shown == engine.run("fk puma560 --q=90,0,90,0,0,0", 120)["text"]
    # Without the editor's files a plain field is there; that they are missing is the one thing that is said.
    assert [error for error in browser().errors if BUILT or "404" not in error] == []
    assert {url for url in browser().asked if not url.startswith(address)} == set()


def test_sliders_move_the_question(address):
    run = opened(address)
    script = (
        "await settled(); arm().setQ([0, -30, 90, 0, 45, 0]);"
        "await until(() => text('command').includes('=0,-30,')); await settled();"
    )
    assert run(f"{script} return text('answer')") == engine.run("fk puma560 --q=0,-30,90,0,45,0", 120)["text"]
    assert run("return text('command')") == "robokin fk puma560 --q=0,-30,90,0,45,0"
    # What is typed stays.
    assert run(
        "fill('q', '1,2,3,4,5,6'); arm().setQ([0, 0, 0, 0, 0, 0]); await frame(); await send(); return text('command')"
    ) == ("robokin fk puma560 --q=1,2,3,4,5,6")


def test_a_mistake_is_shown_with_its_line_and_mended(address):
    run = opened(address)
    run("await settled(); playground.setText(playground.text().replace('revolute', 'revolut')); playground.read()")
    assert run("await until(() => text('mistakes')); return text('mistakes')").startswith(
        "line 11: found 'revolut' as the type"
    )
    run(
        "playground.setText(playground.text().replace('revolut,', 'revolute,').replace('149.09', '249.09'));"
        "playground.read()"
    )
    assert (
        run(
            "await until(() => !text('mistakes') && text('command').includes('robot.yaml')); await settled();"
            "return text('answer')"
        )
        == (engine.run("fk robot.yaml --q=90,0,90,0,0,0", 120)["text"])
    )


def test_a_link_brings_the_same_robot_back(address):
    run = opened(address)
    link = run(
        "playground.setText(playground.text().replace('149.09', '249.09')); await playground.read();"
        "await choose('freedoms'); return await playground.link()"
    )
    assert link.startswith(f"{address}#y=") and len(link) < 1000
    again = opened(address, link.removeprefix(address))
    assert again("await settled(); return [text('command'), playground.text().includes('249.09')]") == [
        "robokin dof robot.yaml",
        True,
    ]
    plain = opened(address, "#r=planar2r&q=10,20")
    assert (
        plain("await until(() => text('command').includes('10,20')); return text('command')")
        == "robokin fk planar2r --q=10,20"
    )


@pytest.mark.parametrize("fragment", ["#y=%%%", "#y=AAAA", "#r=../../etc", "#r=nothing&t=nothing&q=a,b"])
def test_a_damaged_link_is_said(address, fragment):
    run = opened(address, fragment)
    assert "damaged" in run("await settled(); return text('state')")
    assert run("return text('command')").startswith("robokin fk puma560")


def test_each_kind_has_its_questions(address):
    run = opened(address)
    found = {}
    for name in ("four-bar", "car", "shadow-hand", "planar2r"):
        run(
            f"$('pick').value = '{name}'; $('load').click();"
            f"await until(() => text('command').includes('{name}')); await settled();"
        )
        found[name] = run("return [...$('tabs').children].map((tab) => tab.textContent)")
        assert run("return $('answer').dataset.status") == "0"
    assert found["four-bar"][:2] == found["car"][:2] == ["Freedoms", "Table"]
    assert (
        found["shadow-hand"][0] == "Pose"
        and "Workspace" not in found["shadow-hand"]
        and "Workspace" in found["planar2r"]
    )
    run("$('pick').value = 'nothing'; $('load').click(); await until(() => text('state'))")
    assert run("return text('state')") == "There is no robot or mechanism nothing in the library."


def test_questions_are_answered_and_marked(address):
    run = opened(address, "#r=planar2r&q=10,20")
    run("await until(() => text('command').includes('10,20'));")
    run("await choose('solutions'); await until(() => $('form').elements.target.value);")
    assert "1 solution, these are all" in run("return await send()")
    assert "2 solutions, these are all" in run("fill('target', '--xy 1,0.5'); return await send()")
    assert run(
        "await until(() => $('picture').contentDocument.querySelectorAll('#list button').length === 2); return true"
    )
    run("await choose('mark'); fill('q', '0,0'); fill('given', '1.6,0,0')")
    assert "1 of 1 answer right" in run("return await send()")
    assert "0 of 1 answer right" in run("fill('given', '1,0,0'); return await send()")
    run("fill('what', 'freedoms'); fill('count', '2')")
    assert (
        "1 of 1" in run("return await send()")
        and run("return text('command')") == "robokin check dof planar2r --expect=2"
    )
    assert (
        "FRAME" in run("await choose('command'); fill('words', 'robokin jacobian --help'); return await send()").upper()
    )
    assert run("fill('words', 'ls'); await send(); return $('answer').dataset.status") == "2"


def test_an_answer_to_what_stood_there_before_says_so(address):
    run = opened(address, "#r=planar2r&q=10,20")
    old = "$('answer').classList.contains('old')"
    run("await until(() => text('command').includes('10,20')); await settled();")
    assert run(f"return {old}") is False
    run("await choose('solutions'); fill('target', '1,0.5'); await send();")
    assert run(f"return [text('command'), {old}]") == ["robokin ik planar2r --xy=1,0.5", False]
    assert run(f"fill('target', '1,0.6'); return {old}") is True
    assert run(f"fill('target', '1,0.5'); return {old}") is False
    edit = "playground.setText(playground.text().replace('a1: 1', 'a1: 2')); await playground.read(); "
    assert run(f"{edit} return [text('command'), {old}]") == ["robokin ik robot.yaml --xy=1,0.5", True]
    assert run(f"await send(); return {old}") is False


def test_a_place_is_a_target_as_its_label_says(address):
    run = opened(address)
    run("await choose('solutions');")
    said = "return text('command')"
    assert run(f"fill('target', '500, 100, 300'); {said}") == "robokin ik puma560 --xyz=500,100,300"
    assert run(f"fill('target', '-500,2*pi,sqrt(2)'); {said}") == 'robokin ik puma560 --xyz="-500,2*pi,sqrt(2)"'
    for whole in ("Trans(500,100,300) RPY(0,0,90)", "Matrix([[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])"):
        assert run(f"fill('target', '{whole}'); {said}") == f'robokin ik puma560 --pose "{whole}"'


def test_a_lecture_runs_where_it_stands(address):
    run = opened(address)
    run("await choose('lectures'); await until(() => document.querySelector('.step button'));")
    assert run("return [...$('form').elements.lecture.options].map((one) => one.value)") == [
        "lucia",
        "yim",
        "transforms",
        "laschi",
        "ahmed",
    ]
    command, shown = run(
        "const step = document.querySelector('.step'), place = step.nextElementSibling;"
        "step.querySelector('button').click();"
        "await until(() => place.textContent); return [step.querySelector('code').textContent, place.textContent]"
    )
    assert command == "robokin list lucia" and shown == engine.run(command)["text"]


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 768, 1280])
def test_nothing_stands_out_of_the_window(address, width, theme):
    run = opened(address)
    browser().shape(width, 900, theme)
    assert run("await settled(); await frame(); return document.documentElement.scrollWidth") == width
    out = run(
        "return [...document.querySelectorAll('button, input, select, h1, h2, section, header > *')].filter((one) => {"
        "const box = one.getBoundingClientRect();"
        f"return box.width && (box.left < -0.5 || box.right > {width} + 0.5); }}).map((one) => one.id || one.outerHTML)"
    )
    assert out == []


def test_words_of_the_format_are_offered(address):
    run = opened(address)

    def offered(lines, prefix):
        place = f"{json.dumps(lines)}, {len(lines[-1])}, {json.dumps(prefix)}"
        script = "const {completions} = await import('./play.js'); "
        return set(run(f"{script} return completions({place}).map((one) => one.caption ?? one.value)"))

    assert {"convention", "joints", "branches", "parameters"} <= offered(["robokin: 1", "conv"], "conv")
    assert {"a", "alpha", "limits"} <= offered(["joints:", "  - {type: revolute, a"], "a")
    assert {"revolute", "prismatic"} <= offered(["joints:", "  - {type: "], "")
    assert {"deg", "rad"} <= offered(["units: {length: mm, angle: "], "")
