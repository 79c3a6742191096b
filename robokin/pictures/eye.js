// The eye: turned, moved and zoomed by mouse, fingers and keys; drawn once a frame.
let waiting = false;
function later() { if (!waiting) { waiting = true; requestAnimationFrame(() => { waiting = false; draw(); }); } }

// One finger or the mouse turns; two fingers zoom and move; shift or the right button moves.
const fingers = new Map();
function turn(dx, dy) {
  // What is flat is moved instead.
  if (data.flat) { shift = [shift[0] + dx, shift[1] + dy]; later(); return; }
  azimuth -= dx * 0.5; elevation = Math.min(Math.max(elevation + dy * 0.5, -90), 90); later();
}
function nearer(factor, x, y) {
  const before = zoom;
  zoom = Math.min(Math.max(zoom * factor, 0.2), 20);
  const box = canvas.getBoundingClientRect(), c = [x - box.left - box.width / 2, y - box.top - box.height / 2];
  shift = shift.map((s, k) => c[k] + (s - c[k]) * zoom / before);
  later();
}
canvas.addEventListener("pointerdown", (event) => {
  fingers.set(event.pointerId, [event.clientX, event.clientY]);
  try { canvas.setPointerCapture(event.pointerId); } catch (error) { /* a pointer that is gone already */ }
});
canvas.addEventListener("pointermove", (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const now = [event.clientX, event.clientY], [dx, dy] = [now[0] - before[0], now[1] - before[1]];
  if (fingers.size === 2) {
    const [, other] = [...fingers].find(([id]) => id !== event.pointerId);
    const spread = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
    shift = [shift[0] + dx / 2, shift[1] + dy / 2];
    nearer(spread(now) / Math.max(spread(before), 1), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  } else if (event.shiftKey || event.buttons & 2) { shift = [shift[0] + dx, shift[1] + dy]; later(); } else turn(dx, dy);
  fingers.set(event.pointerId, now);
});
for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("dblclick", reset);
canvas.addEventListener("wheel", (event) => { event.preventDefault(); nearer(Math.exp(-event.deltaY / 600), event.clientX, event.clientY); }, {passive: false});
canvas.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const move = {ArrowLeft: [10, 0], ArrowRight: [-10, 0], ArrowUp: [0, 10], ArrowDown: [0, -10]}[event.key];
  const factor = {"+": 1.2, "=": 1.2, "-": 1 / 1.2}[event.key], box = canvas.getBoundingClientRect();
  if (move || factor || event.key === "0") event.preventDefault();
  if (move) turn(...move);
  else if (factor) nearer(factor, box.left + box.width / 2 + shift[0], box.top + box.height / 2 + shift[1]);
  else if (event.key === "0") reset();
});
