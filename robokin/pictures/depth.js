// Pictures with depth: triangles, the face of a cut and points, each pixel with how near it is. A second sheet holds the arm,
// which shines through what is before it.
const sheetCanvas = document.createElement("canvas"), sheetCtx = sheetCanvas.getContext("2d");
const layer = () => ({near: null, ink: null});
let wide = 0, high = 0, image = null;
const solidLayer = layer(), armLayer = layer();
function cleared(w, h) {
  if (w !== wide || h !== high) {
    [wide, high] = [sheetCanvas.width, sheetCanvas.height] = [w, h];
    image = sheetCtx.createImageData(w, h);
    for (const one of [solidLayer, armLayer]) { one.near = new Float32Array(w * h); one.ink = new Uint32Array(w * h); }
  }
  for (const one of [solidLayer, armLayer]) { one.near.fill(-Infinity); one.ink.fill(0); }
}
const packed = (r, g, b) => (255 << 24 | b << 16 | g << 8 | r) >>> 0;
// A triangle of corners (x, y, nearness) with a brightness each; `inks` are 256 colours by brightness. What lies beyond
// the cut, given as a sum over x, y and nearness, is left out where `halved`.
function triangle(to, a, b, c, la, lb, lc, inks, cut, halved) {
  const [ax, ay, az] = a, ux = b[0] - ax, uy = b[1] - ay, vx = c[0] - ax, vy = c[1] - ay, area = ux * vy - uy * vx;
  if (Math.abs(area) < 1e-9) return;
  const zu = b[2] - az, zv = c[2] - az, lu = lb - la, lv = lc - la;
  const zx = (zu * vy - zv * uy) / area, zy = (zv * ux - zu * vx) / area, lx = (lu * vy - lv * uy) / area, ly = (lv * ux - lu * vx) / area;
  const top = Math.max(Math.ceil(Math.min(ay, b[1], c[1]) - 0.5), 0), bottom = Math.min(Math.floor(Math.max(ay, b[1], c[1]) - 0.5), high - 1);
  for (let y = top; y <= bottom; y++) {
    const yc = y + 0.5;
    let left = Infinity, right = -Infinity;
    for (let e = 0; e < 3; e++) {
      const p = e === 0 ? a : e === 1 ? b : c, q = e === 0 ? b : e === 1 ? c : a;
      if ((p[1] <= yc) === (q[1] <= yc)) continue;
      const x = p[0] + (yc - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
      if (x < left) left = x;
      if (x > right) right = x;
    }
    const first = Math.max(Math.ceil(left - 0.5), 0), last = Math.min(Math.floor(right - 0.5), wide - 1);
    for (let x = first; x <= last; x++) {
      const dx = x + 0.5 - ax, dy = yc - ay, z = az + zx * dx + zy * dy, at = y * wide + x;
      if (z <= to.near[at]) continue;
      if (halved && cut[0] + cut[1] * (x + 0.5) + cut[2] * yc + cut[3] * z > 0) continue;
      to.near[at] = z;
      to.ink[at] = inks[Math.min(Math.max(la + lx * dx + ly * dy, 0), 255) | 0];
    }
  }
}
// 256 brightnesses of a colour.
const brightnesses = (paint) => Uint32Array.from({length: 256}, (_, i) => {
  const f = i / 215;
  return packed(...paint.map((c) => Math.min(Math.round(c * f), 255)));
});
// Both sheets into the picture's canvas, over what is there; the edges of what stands before something are a little darker.
function settle(w, h, ink) {
  const out = new Uint32Array(image.data.buffer), {near, ink: colours} = solidLayer, step = 0.02 * data.size;
  for (let y = 0; y < high; y++) for (let x = 0; x < wide; x++) {
    const at = y * wide + x, d = near[at];
    let colour = colours[at];
    if (colour) {
      const before = Math.max(x ? near[at - 1] : d, y ? near[at - wide] : d, x < wide - 1 ? near[at + 1] : d, y < high - 1 ? near[at + wide] : d);
      if (before - d > step) colour = mixed(colour, ink, 0.72);
    } else if ((x && colours[at - 1]) || (y && colours[at - wide]) || (x < wide - 1 && colours[at + 1]) || (y < high - 1 && colours[at + wide])) colour = ink & 0xffffff | 0x70000000;
    const arm = armLayer.ink[at];
    if (arm) colour = armLayer.near[at] > d ? arm : mixed(colour, arm, 0.5);
    out[at] = colour;
  }
  sheetCtx.putImageData(image, 0, 0);
  ctx.imageSmoothingEnabled = true;
  ctx.drawImage(sheetCanvas, 0, 0, w, h);
}
function mixed(a, b, share) {
  let out = 255 << 24;
  for (const s of [0, 8, 16]) out |= Math.round((a >>> s & 255) * share + (b >>> s & 255) * (1 - share)) << s;
  return out >>> 0;
}
