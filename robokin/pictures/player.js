// A motion: rows in order of time, which are played, stopped and sought. The space bar plays and stops, the slider takes
// the arrow keys, Home and End. times: of the rows; seconds: what one unit of time lasts at speed 1; closed: whether the
// first row comes after the last one; swing: whether a motion that is repeated goes to and fro; show(k): draws row k;
// clock(k): what stands beside the slider; marks: [row, words] of what happens on the way.
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];
const still = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
function player({times, seconds, closed = false, swing = false, loop = false, show, clock, marks = []}) {
  const last = times.length - 1, at = (k) => (times[k] - times[0]) * seconds;
  const whole = at(last) * (closed ? (last + 1) / last : 1), box = $("player");
  const button = make("button", box, "play", {id: "play"});
  const way = make("span", box, "", {className: "way"});
  const slider = make("input", way, "", {type: "range", id: "seek", min: 0, max: last, step: 1, value: 0});
  const ticks = make("span", way, "", {className: "ticks"});
  const shown = make("output", box, "", {id: "clock"});
  const speed = make("select", make("label", box, "speed "), "", {id: "speed"});
  for (const value of SPEEDS) make("option", speed, "×" + value, {value});
  // What is very long or very short starts at a speed that can be watched.
  if (whole > 20) speed.value = SPEEDS.find((value) => whole / value <= 20) ?? 10;
  else speed.value = SPEEDS.findLast((value) => value <= 1 && whole / value >= 1) ?? 0.1;
  const again = make("input", make("label", box), "", {type: "checkbox", id: "loop", checked: loop});
  again.after(" loop");
  slider.setAttribute("aria-label", "time"); button.setAttribute("aria-keyshortcuts", "Space");
  marks.forEach(([row, words]) => {
    make("i", ticks, "", {title: words}).style.left = 100 * row / last + "%";
    const mark = make("button", $("marks"), words);
    mark.addEventListener("click", () => { pause(); seek(row); });
  });
  let row = 0, now = 0, before = 0, running = false, direction = 1;
  function to(k) {
    row = k; slider.value = k;
    show(k);
    shown.textContent = clock(k); slider.setAttribute("aria-valuetext", clock(k));
  }
  function seek(k) { k = Math.min(Math.max(Math.round(+k) || 0, 0), last); now = at(k); to(k); }
  function say() { button.textContent = running ? "pause" : "play"; }
  function pause() { running = false; say(); }
  function play() {
    if (running) return;
    if (row === last && !again.checked) seek(0);
    if (!swing) direction = 1;
    running = true; before = performance.now(); say();
    requestAnimationFrame(tick);
  }
  function tick() {
    if (!running) return;
    const time = performance.now();
    now += direction * Math.min(time - before, 100) / 1000 * speed.value;
    before = time;
    if (now >= whole || now < 0) {
      if (!again.checked) { pause(); seek(now < 0 || closed ? 0 : last); return; }
      if (swing) direction = now < 0 ? 1 : -1;
      now = swing ? Math.min(Math.max(now, 0), whole) : now % whole;
    }
    let k = row;
    while (k < last && at(k + 1) <= now + 1e-9) k++;
    while (k > 0 && at(k) > now + 1e-9) k--;
    if (k !== row) to(k);
    requestAnimationFrame(tick);
  }
  const toggle = () => running ? pause() : play();
  button.addEventListener("click", toggle);
  slider.addEventListener("input", () => { pause(); seek(slider.value); });
  addEventListener("keydown", (event) => {
    const on = event.target;
    if (event.key !== " " || event.ctrlKey || event.metaKey || event.altKey) return;
    if (on !== slider && on.matches && on.matches("button, select, summary, input:not([type=range])")) return;
    event.preventDefault(); toggle();
  });
  box.hidden = false; say(); to(0);
  return {play, pause, seek, row: () => row, running: () => running, count: last + 1};
}
