// The sheet: cleared, turned to the eye, with a floor of round steps below what is drawn; where points of the world are.
function roundStep(wanted) {
  const power = Math.pow(10, Math.floor(Math.log10(wanted)));
  return [1, 2, 5, 10].map((f) => f * power).find((step) => step >= wanted * 0.999);
}
function stage() {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight, style = getComputedStyle(document.documentElement);
  if (!w || !h) return null;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
  const css = (name) => style.getPropertyValue(name).trim(), full = (c) => c.length === 4 ? "#" + [1, 2, 3].map((i) => c[i] + c[i]).join("") : c;
  const ink = css("--ink"), paperName = full(css("--paper")), paper = rgb(paperName);
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.fillStyle = paperName; ctx.fillRect(0, 0, w, h);
  const [ca, sa, ce, se] = [azimuth, elevation].flatMap((a) => [Math.cos(a * Math.PI / 180), Math.sin(a * Math.PI / 180)]);
  eye = [[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]];
  const scale = 0.46 * Math.min(w, h) / radius * zoom;
  const place = (p) => { const o = minus(p, centre); return [w / 2 + shift[0] + dot(o, eye[0]) * scale, h / 2 + shift[1] - dot(o, eye[1]) * scale]; };
  // The floor: a grid of round steps below the arm, where it does not hang far down; a tree stands on it.
  const step = roundStep(size / 8), floor = Math.min(0, data.box[0][2] < -0.3 * size && !data.forked ? 0 : data.box[0][2]);
  const lines = [0, 1].map((k) => [Math.floor(Math.min(data.box[0][k], -0.2 * size) / step), Math.ceil(Math.max(data.box[1][k], 0.2 * size) / step)]);
  ctx.lineWidth = 1; ctx.strokeStyle = css("--grid"); ctx.beginPath();
  for (const k of [0, 1]) for (let i = lines[k][0]; i <= lines[k][1]; i++) for (const end of [0, 1]) {
    const p = [0, 0, floor];
    p[k] = i * step; p[1 - k] = lines[1 - k][end] * step;
    ctx[end ? "lineTo" : "moveTo"](...place(p));
  }
  ctx.stroke();
  ctx.fillStyle = css("--dim"); ctx.font = "12px system-ui, sans-serif"; ctx.textAlign = "center"; ctx.textBaseline = "middle";
  for (const k of [0, 1]) {
    const p = [0, 0, floor];
    p[k] = (lines[k][1] + 0.35) * step;
    ctx.fillText("xy"[k], ...place(p));
  }
  ctx.textAlign = "left"; ctx.textBaseline = "alphabetic";
  ctx.fillText(`grid ${plain(step)} ${data.length}`, 10, h - 10);
  return {w, h, ink, paperName, paper, place};
}
// All faces, from the farthest to the nearest.
function paint(faces, place) {
  ctx.lineJoin = "round"; ctx.lineWidth = 0.7;
  for (const {corners, colour} of faces) {
    ctx.beginPath();
    corners.forEach((p, i) => ctx[i ? "lineTo" : "moveTo"](...place(p)));
    ctx.closePath(); ctx.fillStyle = ctx.strokeStyle = colour; ctx.fill(); ctx.stroke();
  }
}
function viewButtons() {
  for (const [name, a, e] of [["isometric", -58, 22], ["top", -90, 90], ["front", -90, 0], ["side", 0, 0]]) {
    make("button", $("views"), name).addEventListener("click", () => { zoom = 1; shift = [0, 0]; view(a, e); });
    $("views").append(" ");
  }
}
