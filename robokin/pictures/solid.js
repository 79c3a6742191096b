// Vectors, and pieces as the flat faces that the eye sees of them.
const at = (T, p) => [0, 4, 8].map((i) => T[i] * p[0] + T[i + 1] * p[1] + T[i + 2] * p[2] + T[i + 3]);
const along = (T, p) => [0, 4, 8].map((i) => T[i] * p[0] + T[i + 1] * p[1] + T[i + 2] * p[2]);
const minus = (a, b) => a.map((v, i) => v - b[i]), plus = (a, b, t) => a.map((v, i) => v + t * b[i]);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], norm = (a) => Math.sqrt(dot(a, a));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const rgb = (name) => [1, 3, 5].map((i) => parseInt(name.slice(i, i + 2), 16));
const LIGHT = [-0.42, 0.62, 0.66], BRIGHT = norm(LIGHT);
let faces, parts;
function prism(a, b, across, wa, wb, sides, paint, inside) {
  const step = minus(b, a), long = norm(step);
  if (long < 1e-3 * Math.max(wa, wb)) return;
  const d = step.map((v) => v / long);
  let u = plus(across, d, -dot(across, d));
  if (norm(u) < 1e-6) u = cross(d, Math.abs(d[0]) < 0.8 ? [1, 0, 0] : [0, 1, 0]);
  u = u.map((v) => v / norm(u));
  const v = cross(d, u), square = sides === 4 ? Math.SQRT2 : 1, ring = [];
  for (let k = 0; k <= sides; k++) {
    const t = 2 * Math.PI * (k + 0.5) / sides;
    ring.push(plus(u.map((x) => x * Math.cos(t)), v, Math.sin(t)));
  }
  const count = Math.min(Math.max(Math.ceil(long / (2.5 * Math.max(wa, wb))), 1), 20);
  const rings = [];
  for (let i = 0; i <= count; i++) {
    const p = plus(a, step, i / count), w = square * (wa + (wb - wa) * i / count);
    rings.push(ring.map((r) => plus(p, r, w)));
  }
  for (let k = 0; k < sides; k++) {
    const m = plus(ring[k], ring[k + 1], 1), out = plus(m.map((x) => x / norm(m)), d, square * (wa - wb) / long);
    if (dot(out, eye[2]) <= 0) continue;
    const colour = shaded(paint, out);
    for (let i = 0; i < count; i++) face([rings[i][k], rings[i][k + 1], rings[i + 1][k + 1], rings[i + 1][k]], colour, inside);
  }
  if (dot(d, eye[2]) < 0) face(rings[0].slice(0, -1), shaded(paint, d.map((x) => -x)), inside);
  else face(rings[count].slice(0, -1), shaded(paint, d), inside);
}
function shaded(paint, out) {
  const light = eye.reduce((sum, row, k) => sum + dot(row, out) * LIGHT[k], 0) / (norm(out) * BRIGHT);
  return `rgb(${paint.map((c) => Math.round(Math.min(c * (0.66 + 0.42 * Math.max(light, 0)), 255)))})`;
}
function face(corners, colour, inside) {
  const middle = [0, 1, 2].map((k) => corners.reduce((sum, p) => sum + p[k], 0) / corners.length);
  // What is within a joint cannot be seen, but its order would be in doubt.
  if (inside && inside.some(([a, d, long, width]) => {
    const t = dot(minus(middle, a), d);
    return t > 0 && t < long && norm(minus(middle, plus(a, d, t))) < 0.98 * width;
  })) return;
  faces.push({depth: dot(middle, eye[2]), corners, colour});
}
