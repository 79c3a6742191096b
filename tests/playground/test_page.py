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
  const end = performance.now() + 45000;  // before the browser's own patience ends, so that it is said what is missing
  while (performance.now() < end) { const found = ready(); if (found) return found; await frame(); }
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
        # To its end: the command is the same for both texts, so that the answer to the first would do for settled().
        "await playground.read()"
    )
    shown = run("await settled(); return [text('mistakes'), text('command'), text('answer')]")
    command = "fk robot.yaml --q=90,0,90,0,0,0"
    assert shown == ["", f"robokin {command}", engine.run(command, 120)["text"]]


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


def test_every_question_of_every_kind_has_an_answer(address):
    run = opened(address)
    answered = 0
    for robot, q in (("planar2r", "10,20"), ("scara", "10,20,30,40"), ("four-bar", ""), ("car", "")):
        run(f"$('pick').value = '{robot}'; $('load').click();"
            f"await until(() => text('command').includes('{robot}')); await settled();")  # fmt: skip
        for tab in run("return [...$('tabs').children].map((one) => one.id.slice(4))"):
            if tab in ("mark", "lectures", "command"):
                continue
            run(f"await choose('{tab}');")
            wanted = "const one = $('form').elements.target; await until(() => !one || one.value);"
            choices = run("return [...($('form').elements.what?.options ?? [{value: ''}])].map((one) => one.value)")
            for choice in choices:
                said = run(f"if ({json.dumps(choice)}) fill('what', {json.dumps(choice)});"
                           f"if (!$('form').elements.q?.parentElement.hidden && $('form').elements.q) fill('q', '{q}');"
                           f"{wanted} await send(); return [$('answer').dataset.status, text('answer')]")  # fmt: skip
                assert said[0] == "0" and said[1], (robot, tab, choice, said)
                answered += 1
    assert answered >= 2 * 10 + 2 * 2


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
    assert found["shadow-hand"] == found["planar2r"] and found["planar2r"][0] == "Pose"
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


def test_an_answer_is_dimmed_from_the_change_on(address):
    run = opened(address, "#r=planar2r&t=table")
    run("await until(() => text('command').includes('show')); await settled();")
    looks = "[$('answer').className, $('answer').getAttribute('aria-busy')]"
    edit = (
        "await settled(); const field = $('yaml'); field.value = field.value.replace('NEW', 'OLD');"
        "field.dispatchEvent(new Event('input'));"
    )
    if BUILT:
        edit = "await settled(); playground.setText(playground.text().replace('NEW', 'OLD'));"
    first = edit.replace("NEW", "a1: 1").replace("OLD", "a1: 2")
    # At once, before anything is read; what comes then is the answer to what stands there.
    assert run(f"{first} return {looks}") == ["old busy", "true"]
    assert run(f"await settled(); return [text('command'), ...{looks}]") == ["robokin show robot.yaml", "", "false"]
    assert run("return text('answer')") == engine.run("show robot.yaml", 120)["text"]
    run("await choose('pose'); await settled();")
    wrong = edit.replace("NEW", "a1: 2").replace("OLD", "a1: two")
    assert run(f"{wrong} return {looks}") == ["busy", "true"]
    assert run(f"await until(() => text('mistakes')); await settled(); return {looks}") == ["old", "false"]
    assert run(f"{edit.replace('NEW', 'a1: two').replace('OLD', 'a1: 3')} return {looks}") == ["old busy", "true"]
    assert run(f"await settled(); return [text('mistakes'), ...{looks}]") == ["", "", "false"]
    assert run("return text('answer')") == engine.run("fk robot.yaml --q=0,0", 120)["text"]


def test_of_a_robot_with_several_tips_one_is_asked_about(address):
    run = opened(address, "#r=human-hand")
    run("await until(() => text('command').includes('human-hand')); await settled();")
    tips = "return [...$('form').elements.tip.options].map((one) => one.textContent)"
    names = ["thumb", "index", "middle", "ring", "little"]
    assert run(tips) == ["all tips", *names]
    q = [float(place) for place in range(1, 22)]
    # The sliders are those of the whole hand; the question has the values of the tip's chain.
    run(f"arm().setQ({q}); await until(() => $('form').elements.q.value.startsWith('1,2,3,')); await settled();")
    assert run("fill('tip', 'index'); await settled(); return text('command')") == (
        "robokin fk human-hand --tip=index --q=6,7,8,9"
    )
    assert run("return text('answer')") == engine.run("fk human-hand --tip=index --q=6,7,8,9", 120)["text"]
    run("await choose('jacobian'); await settled();")
    assert run(tips) == names
    assert run("return text('command')") == "robokin jacobian human-hand --tip=index --q=6,7,8,9"
    # What was typed for one tip is not taken for another's.
    assert run(
        "fill('q', '1,2,3,4'); await send(); fill('tip', 'thumb'); await settled(); return text('command')"
    ) == "robokin jacobian human-hand --tip=thumb --q=1,2,3,4,5"  # fmt: skip
    for tab in ("pose", "solutions", "jacobian", "singular", "steps", "freedoms", "table"):
        run(f"await choose('{tab}'); fill('tip', 'ring');")
        run("const one = $('form').elements.target; await until(() => !one || one.value);")
        assert run("await send(); return [$('answer').dataset.status, text('command').includes(' --tip=ring')]") == [
            "0", True,
        ], tab  # fmt: skip
    # The solutions stand alone in the picture: its sliders are the chain's, the others' values are kept.
    run("await choose('solutions'); await until(() => $('form').elements.target.value); await send();")
    run("await until(() => arm().n === 4);")
    run("arm().setQ([20, 30, 40, 50]); await choose('pose');")
    run("await until(() => text('command').includes('=20,30,')); await settled();")
    assert run("return text('command')") == "robokin fk human-hand --tip=ring --q=20,30,40,50"
    link = run("return await playground.link()")
    assert "&tip=ring" in link
    run(f"await choose('mark'); fill('given', '{engine_place('--tip=ring --q=20,30,40,50')}');")
    assert "1 of 1 answer right" in run("return await send()")
    assert "0 of 1 answer right" in run("fill('tip', 'index'); return await send()")
    assert "1 of 1 answer right" in run("fill('what', 'freedoms'); fill('count', '21'); return await send()")
    assert run("return [$('form').elements.tip.parentElement.hidden, text('command').includes('--tip')]") == [
        True, False,
    ]  # fmt: skip
    again = opened(address, link.removeprefix(address))
    again("await until(() => text('command').includes('--tip=ring')); await settled();")
    again("await until(() => text('command').includes('=20,30,')); await settled();")
    assert again("return [text('command'), arm().n]") == ["robokin fk human-hand --tip=ring --q=20,30,40,50", 21]
    assert again("return arm().q().slice(0, 3)") == [1, 2, 3]
    lost = opened(address, "#r=human-hand&tip=toe")
    assert lost("await until(() => text('state')); return text('state')") == "The robot has no tip toe."
    # A robot of one tip has no such field.
    lost("$('pick').value = 'planar2r'; $('load').click(); await until(() => text('command').includes('planar2r'));")
    assert lost("await settled(); return [Boolean($('form').elements.tip), text('command')]") == [
        False, "robokin fk planar2r --q=0,0",
    ]  # fmt: skip


def engine_place(words):
    """Where the human hand's tip is, as an answer is typed."""
    at = json.loads(engine.run(f"fk human-hand {words} --json")["text"])["pose"]["position"]
    return ",".join(f"{value:.4f}" for value in at)


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


WALKS = {
    # Of each lecture: a robot, what is changed in its description, a place of the sliders, an answer that is right
    # before the change, and one that is right after it: sums of lengths; three hinges in a row.
    "lucia": ("planar3r", ("a3: 0.35", "a3: 0.5"), [0, 90, 0], "1,0.95,0", "1,1.1,0"),
    "yim": ("four-bar", ("  - {name: D, type: revolute, links: [rocker, ground],  at: [4, 0]}", ""), [], "1", "3"),
    "transforms": ("puma560-craig", ("433.07", "400"), [0] * 6, "452.12,149.09,-433.07", "452.12,149.09,-400"),
    "laschi": ("anthropomorphic", ("a3: 0.4", "a3: 0.3"), [0, 90, 0], "0,0,0.9", "0,0,0.8"),
    "ahmed": ("planar3r-brac", ("a3: 10", "a3: 12"), [90, 0, 0], "0,62,0", "0,64,0"),
}


@pytest.mark.parametrize("lecture", WALKS)
def test_from_a_lecture_to_its_robot_changed_asked_about_marked_and_explained(address, lecture):
    name, (old, new), q, before, after = WALKS[lecture]
    run = opened(address, f"#r=car&t=lectures&l={lecture}")
    run("await until(() => document.querySelector('.step button')); const s = document.querySelector('.step');"
        "s.querySelector('button').click(); await until(() => s.nextElementSibling.textContent);")  # fmt: skip
    assert run("return $('form').elements.lecture.value") == lecture
    # The robot by its button; what was run on the page stays there.
    run(f"[...document.querySelectorAll('#lecture p button')].find((one) => one.textContent === '{name}').click();"
        f"await until(() => playground.text().includes({json.dumps(old)}));")  # fmt: skip
    still = "$('form').elements.lecture.value, document.querySelector('.step + pre').textContent !== ''"
    assert run(f"return [{still}]") == [lecture, True]
    change = f"playground.setText(playground.text().replace({json.dumps(old)}, {json.dumps(new)}))"
    run(f"{change}; await playground.read();")
    assert run("return text('mistakes')") == ""
    run("await choose('mark');")
    if q:
        run(f"arm().setQ({q}); await until(() => $('form').elements.q.value === '{','.join(map(str, q))}');")
    kind, field = ("fk", "given") if q else ("dof", "count")
    told = run(f"fill('{field}', '{before}'); return await send()")
    assert "0 of 1 answer right" in told and "expected" in told
    assert run("return text('command')").startswith(f"robokin check {kind} robot.yaml ")
    less = run("fill('tell', 'what is wrong'); return await send()")
    assert "0 of 1 answer right" in less and "expected" not in less
    assert "1 of 1 answer right" in run(f"fill('{field}', '{after}'); return await send()")
    worked = run("$('explain').click(); await until(() => !text('command').includes('check')); await settled();"
                 "return [$('answer').dataset.status, text('command'), text('answer')]")  # fmt: skip
    given = f"fk robot.yaml --q={','.join(map(str, q))} --frames" if q else "dof robot.yaml"
    assert worked[:2] == ["0", f"robokin {given}"]
    assert browser().errors == [] or not BUILT


def test_another_robot_is_asked_about_with_its_own_values(address):
    run = opened(address, "#r=puma560&t=jacobian")
    run("await settled(); fill('q', '1,2,3,4,5,6'); await send();")
    run("$('pick').value = 'planar2r'; $('load').click();")
    run("await until(() => text('command').includes('planar2r')); await settled();")
    assert run("return [text('command'), $('answer').dataset.status]") == ["robokin jacobian planar2r --q=0,0", "0"]
    # A change of the description leaves the sliders where they are; those of another robot begin anew.
    run(
        "arm().setQ([30, 40]); await until(() => $('form').elements.q.value === '30,40');"
        "playground.setText(playground.text().replace('a1: 1', 'a1: 2')); await playground.read(); await settled();"
    )
    assert run("return text('command')") == "robokin jacobian robot.yaml --q=30,40"
    run("$('pick').value = 'planar2r'; $('load').click();")
    run("await until(() => text('command') === 'robokin jacobian planar2r --q=0,0'); await settled();")
    # An address that differs in its question alone is followed too.
    run(
        "location.hash = '#r=planar2r&t=freedoms'; await until(() => text('command').includes('dof')); await settled();"
    )
    assert run("return text('command')") == "robokin dof planar2r"


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
