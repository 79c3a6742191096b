// The page: an editor, a picture, and forms that are command lines. Python answers in worker.js.
const $ = (id) => document.getElementById(id);
const make = (tag, parent, text = "", more = {}) => {
  const element = Object.assign(document.createElement(tag), more);
  element.textContent = text;
  parent.append(element);
  return element;
};
const FILE = "robot.yaml", FIRST = "puma560";

// Python: calls are numbered, and answered in order.
let worker, calls, number = 0;
function begin() {
  worker = new Worker("worker.js", {type: "module"});
  calls = new Map();
  worker.onmessage = ({data}) => {
    if ("progress" in data) return state(data.progress);
    if ("fault" in data) return state(`Python cannot be loaded: ${data.fault}`, true);
    const {resolve, reject} = calls.get(data.id);
    calls.delete(data.id);
    if ("error" in data) reject(new Error(data.error)); else resolve(data.result);
  };
  worker.onerror = (event) => state(`Python cannot be loaded: ${event.message || "its files are not served as scripts, or this browser has no module workers"}`, true);
}
const ask = (call, ...args) => new Promise((resolve, reject) => {
  calls.set(++number, {resolve, reject});
  worker.postMessage({id: number, call, args});
});
function state(text, fault = false) {
  $("state").textContent = text;
  $("state").classList.toggle("fault", fault);
}

// The description: its text, and the name that commands call it by.
let library = {entries: [], schema: {}}, kind = "", original = {id: "", text: ""}, valid = false;
const text = () => editor ? editor.getValue() : $("yaml").value;
function setText(value) { if (editor) { editor.setValue(value, -1); } else $("yaml").value = value; }
const robot = () => original.id && text() === original.text ? original.id : FILE;
const quoted = (word) => /^[\w.,:=+@%/-]+$/.test(word) ? word : `"${word.replace(/["\\$`]/g, "\\$&")}"`;

// Of a robot with several tips: of each, which of the robot's joint values its chain has; which is asked about.
let tips = new Map(), tip = "", count = 0;
const ofTip = (list, name) => tips.has(name) ? tips.get(name).map((place) => list[place]) : list;

let later = 0, saved = "", unread = false;  // saved: what robot.yaml holds; unread: the text is a newer one
function changed() { unread = true; aged(); clearTimeout(later); later = setTimeout(read, 350); }
async function read() {
  const given = saved = text();
  unread = true;
  aged();
  try {
    const found = await ask("written", FILE, given);
    if (given === text()) await understood(found);
  } finally {
    if (given === text()) unread = false;
    aged();
  }
}
async function understood(found) {
  valid = found.valid;
  $("mistakes").replaceChildren(...found.errors.map((mistake) => {
    const item = document.createElement("li"), place = mistake.line ? `line ${mistake.line}: ` : "";
    make("button", item, place + mistake.message, {type: "button"}).addEventListener("click", () => goTo(mistake));
    return item;
  }));
  marks(found.errors);
  aged();
  if (!valid) return;
  if (kind !== found.kind) pose = "";
  const others = kind !== found.kind || String([...tips.keys()]) !== String(found.tips.map(([name]) => name));
  [kind, tips, count] = [found.kind, new Map(found.tips), found.joints];
  if (!tips.has(tip)) tip = "";
  if (others) tabs();
  await picture();
  if (OWN_TIME.has(tab)) { await QUESTIONS[tab].before?.($("form")); shown(); } else await answer();
}

// The picture: the page that `robokin plot` writes, in a frame.
// pose: all joint values of the robot; fresh: another robot, whose sliders begin where its picture has them; alone: the
// tip whose chain the picture has without the rest.
let drawn = "", pose = "", fresh = true, alone = "";
async function picture(more = "", of = "") {
  if (kind === "wheeled") {
    drawn = "";
    $("picture").srcdoc = "<p style='font:15px system-ui'>A wheeled base has no picture.</p>";
    return;
  }
  const command = `plot ${robot()}${more} -o picture.html`, page = await ask("run", command, 80);
  if (!page.files["picture.html"]) return;
  drawn = new TextDecoder().decode(page.files["picture.html"]);
  // Its sliders give the pose of what is answered next.
  const before = fresh || more ? [] : pose.split(",").map(Number);
  const there = new Promise((done) => $("picture").addEventListener("load", () => { alone = of; done(); }, {once: true}));
  $("picture").srcdoc = drawn;
  await there;
  fresh = false;
  moveTo(before);
  taken();
}
function moveTo(q) {
  const arm = $("picture").contentWindow?.robokin;
  if (q.length === count) q = ofTip(q, alone);
  if (arm?.setQ && arm.n === q.length && q.every(Number.isFinite)) arm.setQ(q);
}
// The joint values that the sliders have, as a command line has them. Those of joints that have none in the picture stay
// as they were.
function sliders() {
  const arm = $("picture").contentWindow?.robokin;
  if (!arm?.q || !arm.n) return pose;
  const now = arm.q().map((v) => String(+v.toFixed(6)));
  if (!tips.size) return now.join(",");
  const all = pose.split(","), places = tips.get(alone) || now.map((_, place) => place);
  if (now.length !== places.length || (tips.has(alone) ? all : now).length !== count) return pose;  // another picture comes
  places.forEach((place, i) => { all[place] = now[i]; });
  return all.slice(0, count).join(",");
}
// The pose of the sliders into the form; whether it is another one for the question.
function taken() {
  const now = sliders();
  if (now === pose) return false;
  pose = now;
  return followed();
}
function followed() {
  const {q: field, tip: of} = $("form").elements, now = pose && ofTip(pose.split(","), of?.value).join(",");
  if (!field || field.dataset.own || !now || field.value === now) return false;
  field.value = now;
  shown();
  return true;
}
setInterval(() => { if (taken() && tab === "pose") soon(); }, 150);

// The questions: each is a form that makes a command line.
const numbers = ["robot", "tree"];
const q = {id: "q", label: "Joint values q (they follow the sliders until you type)"};
const target = {id: "target", label: "Target: an expression, X,Y,Z, or options such as --xy 0.5,0.2 --phi 30"};
const aim = (v) => {
  if (!v || /^\s*-{1,2}[a-z]/.test(v)) return v ? " " + v.trim() : "";
  const commas = v.replace(/\(.*?\)/g, "").split(",").length - 1;
  return commas && !v.includes("[") && !/^\s*[A-Z]/.test(v) ? ` --xy${commas > 1 ? "z" : ""}=${quoted(v.replace(/\s/g, ""))}` : ` --pose ${quoted(v.trim())}`;
};
const values = (v) => v ? ` --q=${quoted(v.replace(/\s/g, ""))}` : "";
// Of a robot with several tips the one that is asked about; a question of the whole has a name for that.
const tipField = {id: "tip", label: "Tip", short: true};
const about = (v) => `${robot()}${tips.has(v.tip) ? ` --tip=${quoted(v.tip)}` : ""}`;
const QUESTIONS = {
  pose: {title: "Pose", kinds: numbers, fields: [{...tipField, whole: "all tips"}, q],
    line: (v) => `fk ${about(v)}${values(v.q)}`},
  solutions: {title: "All solutions", kinds: numbers, fields: [tipField, target], before: fromSliders,
    says: "The picture shows every solution after Ask.",
    line: (v) => `ik ${about(v)}${aim(v.target)}`, drawn: (v) => aim(v.target)},
  jacobian: {title: "Jacobian", kinds: numbers, fields: [tipField, q, {id: "frame", label: "Frame", choices: ["base", "tool"], short: true}],
    line: (v) => `jacobian ${about(v)}${values(v.q)}${v.frame === "tool" ? " --frame tool" : ""}`},
  singular: {title: "Singularities", kinds: numbers, fields: [tipField], line: (v) => `singular ${about(v)}`},
  steps: {title: "Worked steps", kinds: numbers, fields: [tipField,
    {id: "what", label: "Of", choices: ["the pose, in symbols", "the pose, in symbols with these lengths", "the pose, frame after frame", "all solutions"]},
    {...q, of: ["the pose, frame after frame"]}, {...target, of: ["all solutions"]}],
    before: fromSliders,
    line: (v) => v.what === "all solutions" ? `ik ${about(v)}${aim(v.target)} --explain`
      : v.what === "the pose, frame after frame" ? `fk ${about(v)}${values(v.q)} --frames`
      : `fk ${about(v)} --symbolic${v.what === "the pose, in symbols" ? "" : " --numbers"}`},
  workspace: {title: "Workspace", kinds: numbers, fields: [tipField, {id: "page", label: "As", choices: ["text", "a turning picture"], short: true}],
    line: (v) => `workspace ${about(v)}${v.page === "text" ? "" : " --plot workspace.html"}`},
  freedoms: {title: "Freedoms", kinds: [...numbers, "mechanism", "wheeled"], fields: [{...tipField, whole: "the whole"}], line: (v) => `dof ${about(v)}`},
  table: {title: "Table", kinds: [...numbers, "mechanism", "wheeled"], fields: [{...tipField, whole: "the whole"}], line: (v) => `show ${about(v)}`},
  mark: {title: "Mark an answer", kinds: [...numbers, "mechanism"], fields: [
    {id: "what", label: "Question", choices: ["pose", "joint values", "Jacobian", "table", "freedoms"], short: true,
      mechanism: ["freedoms"]}, {...tipField, of: ["pose", "joint values", "Jacobian"]},
    {id: "tell", label: "Tell me", choices: ["what is right", "how far I am off", "what is wrong", "right or wrong"], short: true},
    {...q, of: ["pose", "Jacobian"]}, {...target, of: ["joint values"]},
    {id: "given", label: "Your answer: X,Y,Z, a matrix or an expression", of: ["pose"], wide: true},
    {id: "angles", label: "Your answer: joint values", of: ["joint values"], wide: true},
    {id: "rows", label: "Your answer: [[…], …], a row of each", of: ["Jacobian"], wide: true},
    {id: "count", label: "Your answer: a count", of: ["freedoms"], short: true},
    {id: "against", label: "Your answer is the description above; the robot that it should be", of: ["table"], wide: true}],
    before: fromSliders, line: mark},
  lectures: {title: "Lectures", kinds: null, fields: []},
  command: {title: "Command line", kinds: null, fields: [{id: "words", label: "A command of robokin; the description above is robot.yaml", wide: true}],
    line: (v) => v.words.replace(/^\s*robokin\s+/, "") || "--help"},
};
const TOLD = {"how far I am off": " --feedback distance", "what is wrong": " --feedback part", "right or wrong": " --feedback verdict"};
function mark(v) {
  const said = (words) => quoted((words || "").trim() || " "), told = TOLD[v.tell] || "";
  if (v.what === "joint values") return `check ik ${about(v)}${aim(v.target)} --q=${said(v.angles)}${told}`;
  if (v.what === "Jacobian") return `check jacobian ${about(v)}${values(v.q)} --expect=${said(v.rows)}${told}`;
  if (v.what === "table") return `check dh ${FILE} --against ${said(v.against)}${told}`;
  if (v.what === "freedoms") return `check dof ${robot()} --expect=${said(v.count)}${told}`;
  return `check fk ${about(v)}${values(v.q)} --expect=${said(v.given)}${told}`;
}
// Where a marked answer is worked out: another question, with what was typed.
const WORKED = {pose: ["steps", "the pose, frame after frame"], "joint values": ["steps", "all solutions"], Jacobian: ["jacobian"], freedoms: ["freedoms"]};
$("explain").addEventListener("click", async () => {
  const typed = given(), [name, what] = WORKED[typed.what];
  choose(name, false);
  for (const [id, value] of Object.entries({...typed, what})) {
    const field = $("form").elements[id];
    if (field && value) Object.assign(field, {value}).dataset.own = "1";
  }
  fitting();
  await answer();
  $(`tab-${name}`).focus();
});
const OWN_TIME = new Set(["solutions", "workspace", "singular", "mark", "lectures", "command", "steps"]);

// The pose of the sliders as a target, where nobody has typed one.
async function fromSliders(form) {
  const field = form.elements.target;
  if (!field || field.dataset.own || !valid) return;
  const asked = given(), found = await ask("run", `fk ${about(asked)}${values(ofTip(pose.split(","), asked.tip).join(","))} --json`, 80);
  if (found.status) return;
  const document = JSON.parse(found.text), at = document.pose;
  if (!at || field.dataset.own || given().tip !== asked.tip) return;
  const list = (v) => v.map((x) => String(+x.toFixed(9))).join(",");
  field.value = `--xyz=${list(at.position)} --rpy=${list(at.rpy)}`;
  shown();
}

let tab = "pose", asked = 0;
function tabs() {
  const open = Object.entries(QUESTIONS).filter(([, each]) => !kind || !each.kinds || each.kinds.includes(kind));
  if (!open.some(([name]) => name === tab)) tab = open[0][0];
  $("tabs").replaceChildren(...open.map(([name, each]) => {
    const button = document.createElement("button");
    button.textContent = each.title;
    button.id = `tab-${name}`;
    button.type = "button";
    button.setAttribute("role", "tab");
    button.setAttribute("aria-controls", "panel");
    button.addEventListener("click", () => choose(name));
    return button;
  }));
  choose(tab, false);
}
$("tabs").addEventListener("keydown", (event) => {
  const step = {ArrowRight: 1, ArrowLeft: -1}[event.key];
  if (!step) return;
  const all = [...$("tabs").children], next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
  next.focus(); next.click();
});
function choose(name, now = true) {
  tab = name;
  asked += 1;  // what is still worked out answers another question
  clearTimeout(waiting);
  waiting = 0;
  for (const button of $("tabs").children) {
    const on = button.id === `tab-${name}`;
    button.setAttribute("aria-selected", on);
    button.tabIndex = on ? 0 : -1;
  }
  $("panel").setAttribute("aria-labelledby", `tab-${name}`);
  const question = QUESTIONS[name], form = $("form");
  form.replaceChildren();
  for (const field of question.fields) {
    if (field.id === "tip" && !tips.size) continue;
    const label = make("label", form, field.label, {className: field.short ? "short" : field.wide ? "wide" : ""});
    if (field.id === "tip") {
      const select = make("select", label, "", {name: field.id});
      if (field.whole) make("option", select, field.whole, {value: ""});
      for (const name of tips.keys()) make("option", select, name, {value: name});
      if (tip) select.value = tip;
      select.addEventListener("change", () => toTip(select.value));
    } else if (field.choices) {
      const select = make("select", label, "", {name: field.id});
      (field[kind] || field.choices).forEach((choice) => make("option", select, choice));
      select.addEventListener("change", () => { fitting(); shown(); if (!OWN_TIME.has(tab)) soon(); });
    } else {
      const input = make("input", label, "", {name: field.id, spellcheck: false, autocomplete: "off", autocapitalize: "off"});
      input.addEventListener("input", () => { input.dataset.own = input.value ? "1" : ""; shown(); });
    }
  }
  followed();
  fitting();
  const isLecture = name === "lectures";
  $("lecture").hidden = !isLecture;
  $("line").hidden = $("answer").hidden = isLecture;
  $("explain").hidden = true;
  if (isLecture) return lectures(form);
  make("button", form, "Ask", {type: "submit"});
  if (question.says) make("p", form, question.says);
  $("answer").replaceChildren(); $("note").textContent = ""; $("files").replaceChildren();
  question.before?.(form).catch((error) => state(error.message, true));
  shown();
  if (now && !OWN_TIME.has(name)) answer();
  return undefined;
}
// Another tip: what was typed for the one before goes with it.
function toTip(name) {
  tip = name;
  for (const id of ["q", "target"]) if ($("form").elements[id]) $("form").elements[id].dataset.own = "";
  followed();
  QUESTIONS[tab].before?.($("form")).catch((error) => state(error.message, true));
  shown();
  if (!OWN_TIME.has(tab)) soon();
}
// Only the fields that belong to what is chosen are shown.
function fitting() {
  const what = $("form").elements.what?.value;
  for (const field of QUESTIONS[tab].fields)
    if (field.of && $("form").elements[field.id]) $("form").elements[field.id].parentElement.hidden = !field.of.includes(what);
}
const given = () => Object.fromEntries(new FormData($("form")));
const line = () => QUESTIONS[tab].line(given());
function shown() {
  if (tab === "lectures") return;
  $("command").textContent = `robokin ${line()}`;
  aged();
}
// An answer to another question or description than those that stand there now says so; a pose is answered anew by itself.
// What is about to be answered anew is dimmed.
let answered = {line: "", text: ""};
function aged() {
  if (tab === "lectures") return;
  const words = line(), other = answered.line !== words || (words.includes(FILE) && answered.text !== text());
  const comes = unread || Boolean(waiting) || running === asked;
  $("answer").classList.toggle("old", other && $("answer").textContent !== "" && (tab !== "pose" || !valid));
  $("answer").classList.toggle("busy", comes);
  $("answer").setAttribute("aria-busy", comes);
}
let waiting = 0, running = -1;  // an answer that comes soon; the one that is worked out
function soon() { clearTimeout(waiting); waiting = setTimeout(answer, 120); shown(); }
const columns = () => {
  const probe = make("span", $("answer"), "0".repeat(50)), wide = probe.getBoundingClientRect().width / 50;
  probe.remove();
  return Math.max(40, Math.min(120, Math.floor(($("answer").clientWidth - 18) / (wide || 8)))) || 80;
};
$("form").addEventListener("submit", (event) => { event.preventDefault(); answer(); });

async function answer() {
  if (tab === "lectures") return;
  clearTimeout(waiting);
  waiting = 0;
  const mine = running = ++asked, words = line(), asking = {line: words, text: saved}, view = QUESTIONS[tab].drawn?.(given());
  const {tip: of} = given();
  shown();
  const slow = setTimeout(() => { $("stop").hidden = false; }, 1500);
  try {
    const found = await ask("run", words, columns());
    if (mine !== asked) return;
    answered = asking;
    show(found, $("answer"));
    Object.assign($("answer").dataset, {of: `robokin ${words}`, status: found.status});
    $("note").textContent = found.note;
    $("explain").hidden = tab !== "mark" || found.status === 2 || !WORKED[given().what];
    files(found.files);
    if (view !== undefined && found.status !== 2) await picture(`${tips.has(of) ? ` --tip=${quoted(of)}` : ""}${view}`, of);
  } catch (error) {
    if (mine === asked) $("answer").replaceChildren(error.message);
  } finally {
    clearTimeout(slow);
    $("stop").hidden = true;
    if (mine === running) running = -1;
    aged();
  }
}
function show(found, place) {
  place.replaceChildren();
  if (found.said) make("span", place, found.said, {className: "said"});
  place.append(found.text);
}
function files(written) {
  $("files").replaceChildren(...Object.entries(written).map(([name, bytes]) => {
    const item = document.createElement("li"), page = name.endsWith(".html");
    const link = make("a", item, `${page ? "Open" : "Save"} ${name}`);
    link.href = URL.createObjectURL(new Blob([bytes], {type: page ? "text/html" : "application/octet-stream"}));
    if (page) link.target = "_blank"; else link.download = name;
    if (page) $("picture").srcdoc = new TextDecoder().decode(bytes);
    return item;
  }));
}
$("stop").addEventListener("click", async () => {
  worker.terminate();
  for (const {reject} of calls.values()) reject(new Error("stopped; Python starts again"));
  begin();
  await ask("written", FILE, text());
});

// The lectures: their pages, with each command to run where it stands.
let pages = null, page = "";
async function lectures(form) {
  pages ||= await (await fetch("lectures.json")).json();
  if (tab !== "lectures") return;
  form.replaceChildren();
  const label = make("label", form, "Lecture"), select = make("select", label, "", {name: "lecture"});
  pages.forEach((page) => make("option", select, page.title, {value: page.id}));
  select.addEventListener("change", () => lecture(select.value));
  if (!pages.some(({id}) => id === page)) page = pages[0].id;
  select.value = page;
  // What was run on a page stays there while its robots are looked at.
  if ($("lecture").dataset.page !== page) lecture(page);
}
function lecture(id) {
  const box = $("lecture"), robots = document.createElement("p");
  page = box.dataset.page = id;
  box.replaceChildren(robots);
  robots.textContent = "Its robots and mechanisms, to be changed and asked about: ";
  for (const name of pages.find((each) => each.id === id).robots)
    make("button", robots, name, {type: "button"}).addEventListener("click", async () => {
      await load(name);
      $("text-title").scrollIntoView();
    });
  for (const part of pages.find((page) => page.id === id).parts) {
    if (part.html) { make("div", box).innerHTML = part.html; continue; }
    const step = make("div", box, "", {className: "step"});
    make("code", step, part.command);
    const run = make("button", step, "Run", {type: "button"}), place = make("pre", box, "", {tabIndex: 0});
    run.setAttribute("aria-label", `Run ${part.command.split("\n")[0]}`);
    run.addEventListener("click", async () => {
      run.disabled = true;
      try {
        const found = await ask("run", part.command, 80);
        show(found, place);
        if (found.note) make("span", place, `\n${found.note}`, {className: "said"});
      } catch (error) { place.textContent = error.message; }
      run.disabled = false;
    });
  }
}

// The editor: words of the format as they are typed. Without it the page has a plain field.
let editor = null;
async function edit() {
  try {
    for (const name of ["ace", "mode-yaml", "ext-language_tools", "theme-github", "theme-github_dark"])
      await new Promise((resolve, reject) => {
        document.head.append(Object.assign(document.createElement("script"), {src: `editor/${name}.js`, onload: resolve, onerror: reject}));
      });
  } catch { return; }
  const value = $("yaml").value, box = make("div", $("editor"));
  $("yaml").remove();
  editor = window.ace.edit(box, {mode: "ace/mode/yaml", tabSize: 2, useWorker: false, showPrintMargin: false, wrap: false,
    enableBasicAutocompletion: true, enableLiveAutocompletion: true, enableKeyboardAccessibility: true});
  const dark = matchMedia("(prefers-color-scheme: dark)"), dress = () => editor.setTheme(`ace/theme/github${dark.matches ? "_dark" : ""}`);
  dark.addEventListener("change", dress);
  dress();
  editor.textInput.getElement().setAttribute("aria-label", "Description in YAML");
  editor.completers = [{getCompletions: (_, session, at, prefix, done) => done(null, completions(session.getLines(0, at.row), at.column, prefix))}];
  editor.setValue(value, -1);
  editor.on("change", changed);
}
function marks(mistakes) {
  editor?.session.setAnnotations(mistakes.map(({line, column, message}) =>
    ({row: (line || 1) - 1, column: (column || 1) - 1, text: message, type: "error"})));
}
function goTo({line, column}) {
  if (editor) { editor.gotoLine(line || 1, (column || 1) - 1); editor.focus(); return; }
  const before = $("yaml").value.split("\n").slice(0, (line || 1) - 1).join("\n").length + (line > 1 ? 1 : 0);
  $("yaml").focus();
  $("yaml").setSelectionRange(before, before);
}

// What the schema knows at a place: the keys of the mapping that it stands in, or the words of the key before it.
function reached(node, seen = new Set()) {
  if (!node || seen.has(node)) return [];
  seen.add(node);
  if (node.$ref) return reached(node.$ref.slice(2).split("/").reduce((at, key) => at?.[key], library.schema), seen);
  const parts = [node.items, node.additionalProperties === true ? null : node.additionalProperties,
    ...(node.anyOf || []), ...(node.oneOf || []), ...(node.allOf || []), ...(node.prefixItems || [])];
  return [node, ...parts.filter((part) => part && typeof part === "object").flatMap((part) => reached(part, seen))];
}
// What may stand under a key; several kinds of descriptions may have it.
const under = (nodes, key) => nodes.flatMap((node) => reached(node.properties?.[key]));
export function completions(lines, column, prefix) {
  const now = lines[lines.length - 1].slice(0, column - prefix.length);
  let depth = now.match(/^[\s-]*/)[0].length;
  const parents = [];
  for (let i = lines.length - 2; i >= 0 && depth > 0; i--) {
    const key = lines[i].match(/^([\s-]*)([\w-]+):/);
    if (key && key[1].length < depth) { parents.unshift(key[2]); depth = key[1].length; }
  }
  let nodes = reached(library.schema);
  for (const parent of parents) nodes = under(nodes, parent);
  const inside = now.match(/([\w-]+):\s*$/), brace = now.match(/([\w-]+):\s*\{[^{}]*$/);
  if (brace && !/^\s*-/.test(now)) nodes = under(nodes, brace[1]);
  const known = Object.assign({}, ...nodes.map((node) => node.properties || {}));
  if (inside) {
    const words = under(nodes, inside[1]).flatMap((node) => node.enum || (node.const !== undefined ? [node.const] : []));
    return [...new Set(words)].map((word) => ({value: String(word), meta: inside[1], score: 2}));
  }
  if (now.trim() && !/[-{,]\s*$/.test(now)) return [];
  return Object.entries(known).map(([key, node]) => ({value: `${key}: `, caption: key, meta: node.description || "", score: 1}));
}

// Links: the description, or the library's name, and the question.
const packed = async (value, Stream) => new Uint8Array(await new Response(new Blob([value]).stream().pipeThrough(new Stream("deflate-raw"))).arrayBuffer());
async function link() {
  const parts = new URLSearchParams();
  if (robot() === FILE) {
    const bytes = await packed(new TextEncoder().encode(text()), CompressionStream);
    parts.set("y", btoa(String.fromCharCode(...bytes)).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, ""));
  } else parts.set("r", original.id);
  if (pose) parts.set("q", pose);
  if (tip) parts.set("tip", tip);
  if (tab !== "pose") parts.set("t", tab);
  if (tab === "lectures") parts.set("l", page);
  return `${location.href.split("#")[0]}#${parts}`;
}
async function follow() {
  const parts = new URLSearchParams(location.hash.slice(1)), y = parts.get("y");
  page = parts.get("l") || page;
  if (QUESTIONS[parts.get("t")]) choose(parts.get("t"), false);
  let moved = "";
  try {
    if (y) {
      const bytes = Uint8Array.from(atob(y.replace(/-/g, "+").replace(/_/g, "/")), (c) => c.charCodeAt(0));
      setText(new TextDecoder().decode(await packed(bytes, DecompressionStream)));
      original = {id: "", text: ""};
      another();
    } else await load(parts.get("r") || FIRST, false);
  } catch {
    moved = "The link is damaged; a robot of the library is shown instead.";
    await load(FIRST, false);
  }
  tip = parts.get("tip") || "";
  await read();
  if (tip !== (parts.get("tip") || "")) moved ||= `The robot has no tip ${parts.get("tip")}.`;
  if (parts.get("q") && valid) moveTo(parts.get("q").split(",").map(Number));
  if (moved) state(moved, true);
  if (parts.get("t") === "lectures") $("ask").scrollIntoView();
}
function another() {
  fresh = true;
  pose = tip = "";
}
async function load(id, now = true) {
  const value = await ask("description", id);
  original = {id, text: value};
  another();
  $("pick").value = id;
  setText(value);
  // What was typed for another robot goes with it.
  if (tab !== "command") choose(tab, false);
  if (now) await read();
}
$("load").addEventListener("click", () => load($("pick").value.trim()).then(() => state(""), () => state(`There is no robot or mechanism ${$("pick").value} in the library.`, true)));
$("pick").addEventListener("keydown", (event) => { if (event.key === "Enter") $("load").click(); });
$("yaml").addEventListener("input", changed);
async function copied(button, value) {
  const before = button.textContent;
  try { await navigator.clipboard.writeText(value); button.textContent = "Copied"; } catch { prompt("Copy:", value); }
  setTimeout(() => { button.textContent = before; }, 1500);
}
$("copy").addEventListener("click", () => copied($("copy"), $("command").textContent));
$("share").addEventListener("click", async () => {
  const address = await link();
  history.replaceState(null, "", address);
  copied($("share"), address);
});
$("save").addEventListener("click", () => {
  const a = Object.assign(document.createElement("a"), {download: FILE, href: URL.createObjectURL(new Blob([text()], {type: "text/yaml"}))});
  a.click();
  URL.revokeObjectURL(a.href);
});
addEventListener("hashchange", follow);

begin();
tabs();
const listed = fetch("library.json").then((found) => found.json()).then((found) => {
  library = found;
  found.entries.forEach(([id, name]) => make("option", $("entries"), name, {value: id}));
});
await edit();
await follow();
await listed;
window.playground = {ask, text, setText, read, answer, link};
