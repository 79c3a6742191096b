// The set as a field: positive inside, negative outside, a length from the boundary; tables of what is known at places.
const decode = (text, Kind) => new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
// A table's bytes from its runs, what its coordinates are, and what stands at the nodes about a place.
function unpacked(table) {
  const runs = decode(table.runs, Uint8Array), values = new Uint8Array(table.shape.reduce((a, b) => a * b, 1));
  let at = 0;
  for (let i = 0; i < runs.length; i += 2) { values.fill(runs[i], at, at + runs[i + 1]); at += runs[i + 1]; }
  return {...table, values};
}
// The index of the nearest node of coordinates; -1 outside. The angle goes round.
function nearest(table, u) {
  let at = 0;
  for (let i = 0; i < u.length; i++) {
    let k = Math.round((u[i] - table.low[i]) / table.step[i]);
    if (table.kind === "rza" && i === 2) k = (k % table.shape[2] + table.shape[2]) % table.shape[2];
    if (k < 0 || k >= table.shape[i]) return -1;
    at = at * table.shape[i] + k;
  }
  return at;
}
// The least and the greatest value at the nodes about a place, without its own boundary's zeros.
function spread(table, u) {
  let low = Infinity, high = -Infinity;
  for (let i = 0; i < 3 ** u.length; i++) {
    const beside = u.map((v, k) => v + (Math.floor(i / 3 ** k) % 3 - 1) * table.step[k]), at = nearest(table, beside);
    const value = at < 0 ? 0 : table.values[at];
    if (value) { low = Math.min(low, value); high = Math.max(high, value); }
  }
  return high < 0 ? null : [low, high];
}

// Nearer to the axis than this part of a step a section has a boundary that is none.
const AXIAL = 0.36;
// A section's signed distances at the nodes of its grid.
function distances(solid) {
  const [ni, nj] = solid.shape, S = new Float32Array(ni * nj), segments = [];
  for (const line of solid.edges) for (let i = 1; i < line.length; i++)
    if (Math.max(line[i - 1][0], line[i][0]) > AXIAL * solid.step) segments.push([...line[i - 1], ...line[i]]);
  const flat = new Float64Array(segments.flat());
  for (let i = 0; i < ni; i++) {
    const r = Math.max(Math.abs(solid.low[0] + i * solid.step), AXIAL * solid.step);
    // Where the line r goes through the boundary: below the first it is outside, then inside, and so on.
    const heights = [];
    for (const loop of solid.loops) for (let k = 0; k < loop.length; k++) {
      const a = loop[k], b = loop[(k + 1) % loop.length], x = r + 1e-9 * solid.step;
      if ((a[0] > x) !== (b[0] > x)) heights.push(a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]));
    }
    heights.sort((a, b) => a - b);
    for (let j = 0; j < nj; j++) {
      const z = solid.low[1] + j * solid.step;
      let least = Infinity;
      for (let k = 0; k < flat.length; k += 4) {
        const ax = r - flat[k], az = z - flat[k + 1], bx = flat[k + 2] - flat[k], bz = flat[k + 3] - flat[k + 1];
        const t = Math.min(Math.max((ax * bx + az * bz) / (bx * bx + bz * bz || 1), 0), 1), x = ax - t * bx, y = az - t * bz;
        const d = x * x + y * y;
        if (d < least) least = d;
      }
      const inside = heights.reduce((sum, h) => sum + (h < z), 0) % 2 === 1;
      S[i * nj + j] = (inside ? 1 : -1) * Math.min(Math.sqrt(least), 1e6);
    }
  }
  return S;
}
const TURN = 2 * Math.PI;
// All that is asked of a solid: nodes n of its grid with their values V, the world's point of an index, the field anywhere.
function fieldOf(solid) {
  if (!solid.axis) {
    const block = unpacked(solid.block), n = block.shape, unit = Math.min(...block.step);
    const V = Float32Array.from(block.values, (v) => (v ? 0.5 : -0.5) * unit);
    const index = (p) => p.map((v, k) => (v - block.low[k]) / block.step[k]);
    return {n, V, around: false, point: (u) => u.map((v, k) => block.low[k] + v * block.step[k]), value: between(n, V, false, index), section: null};
  }
  const [ni, nj] = solid.shape, S = distances(solid), A = solid.axis, nk = solid.gaps ? 96 : 72;
  const place = (u) => {
    const r = solid.low[0] + u[0] * solid.step, z = solid.low[1] + u[1] * solid.step, a = u[2] / nk * TURN, x = r * Math.cos(a), y = r * Math.sin(a);
    return [0, 4, 8].map((i) => A[i] * x + A[i + 1] * y + A[i + 2] * z + A[i + 3]);
  };
  const section = (p) => {
    const d = [p[0] - A[3], p[1] - A[7], p[2] - A[11]], [x, y, z] = [0, 1, 2].map((k) => A[k] * d[0] + A[4 + k] * d[1] + A[8 + k] * d[2]);
    return [Math.hypot(x, y), z, Math.atan2(y, x)];
  };
  let V = S, n = [ni, nj, 1];
  if (solid.gaps) {
    const gaps = decode(solid.gaps, Uint16Array), most = solid.most, scale = (Math.PI - solid.closed) / 65535;
    n = [ni, nj, nk]; V = new Float32Array(ni * nj * nk);
    for (let at = 0; at < ni * nj; at++) {
      const r = Math.max(Math.abs(solid.low[0] + Math.floor(at / nj) * solid.step), 0.5 * solid.step);
      for (let k = 0; k < nk; k++) {
        let value = S[at];
        for (let g = 0; g < most; g++) {
          const middle = gaps[2 * (at * most + g)] / 65535 * TURN, half = gaps[2 * (at * most + g) + 1] * scale + solid.closed;
          let away = Math.abs(k / nk * TURN - middle) % TURN;
          if (away > Math.PI) away = TURN - away;
          value = Math.min(value, (away - half) * (half < 0 ? Math.max(r, 4 * solid.step) : r));
        }
        V[at * nk + k] = value;
      }
    }
  }
  const index = (p) => {
    const [r, z, a] = section(p);
    return [(r - solid.low[0]) / solid.step, (z - solid.low[1]) / solid.step, (a < 0 ? a + TURN : a) / TURN * nk];
  };
  return {n: [ni, nj, nk], V, around: true, flat: !solid.gaps, point: place, value: between(n, V, true, index), section};
}
// The field between its nodes, linearly along each coordinate; far outside of the grid where there is none.
function between(n, V, around, index) {
  const [ni, nj, nk] = n;
  return (p) => {
    const [u, v, w] = index(p), i = Math.floor(u), j = Math.floor(v);
    if (i < 0 || j < 0 || i >= ni - 1 || j >= nj - 1) return -1e6;
    const x = u - i, y = v - j, at = (k) => {
      const b = (i * nj + j) * nk + k, c = nk, d = nj * nk;
      return (V[b] * (1 - y) + V[b + c] * y) * (1 - x) + (V[b + d] * (1 - y) + V[b + d + c] * y) * x;
    };
    if (nk === 1) return at(0);
    const k = Math.floor(w), z = w - k;
    if (!around) return k < 0 || k >= nk - 1 ? -1e6 : at(k) * (1 - z) + at(k + 1) * z;
    return at((k % nk + nk) % nk) * (1 - z) + at((k + 1) % nk) * z;
  };
}
// The surface where the field is nought, as squares (S. F. Gibson, Constrained elastic surface nets, 1998): a corner in each
// cell that it goes through, in the middle of where it crosses the cell's edges, and a square about each edge that it crosses.
function skinOf(field) {
  const [ni, nj, nk] = field.n, {V, around, flat, point} = field, cells = around ? nk : nk - 1;
  const value = (i, j, k) => V[flat ? i * nj + j : (i * nj + j) * nk + (k === nk ? 0 : k)];
  const corner = new Int32Array(ni * nj * nk).fill(-1), P = [], squares = [];
  const eight = new Float64Array(8);
  for (let i = 0; i < ni - 1; i++) for (let j = 0; j < nj - 1; j++) for (let k = 0; k < cells; k++) {
    let inside = 0;
    for (let c = 0; c < 8; c++) inside += (eight[c] = value(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))) > 0;
    if (inside === 0 || inside === 8) continue;
    let x = 0, y = 0, z = 0, count = 0;
    for (let c = 0; c < 8; c++) for (const bit of [1, 2, 4]) {
      const d = c | bit;
      if (d === c || (eight[c] > 0) === (eight[d] > 0)) continue;
      const t = eight[c] / (eight[c] - eight[d]);
      x += (c & 1) + (bit === 1 ? t : 0); y += (c >> 1 & 1) + (bit === 2 ? t : 0); z += (c >> 2) + (bit === 4 ? t : 0); count++;
    }
    corner[(i * nj + j) * nk + k] = P.length / 3;
    P.push(...point([i + x / count, j + y / count, k + z / count]));
  }
  const at = (i, j, k) => i < 0 || j < 0 || (k < 0 && !around) ? -1 : corner[(i * nj + j) * nk + (k < 0 ? nk - 1 : k)];
  for (let i = 0; i < ni - 1; i++) for (let j = 0; j < nj - 1; j++) for (let k = 0; k < cells; k++) {
    const here = value(i, j, k) > 0;
    for (const [there, four] of [
      [value(i + 1, j, k) > 0, [at(i, j, k), at(i, j - 1, k), at(i, j - 1, k - 1), at(i, j, k - 1)]],
      [value(i, j + 1, k) > 0, [at(i, j, k), at(i, j, k - 1), at(i - 1, j, k - 1), at(i - 1, j, k)]],
      [value(i, j, k + 1) > 0, [at(i, j, k), at(i - 1, j, k), at(i - 1, j - 1, k), at(i, j - 1, k)]]])
      if (here !== there && four.every((c) => c >= 0)) squares.push(...four);
  }
  const normals = new Float32Array(P.length), step = 0.4 * Math.min(...(data.solid.axis ? [data.solid.step] : data.solid.block.step));
  for (let c = 0; c < P.length; c += 3) {
    const p = [P[c], P[c + 1], P[c + 2]], out = [0, 1, 2].map((k) => {
      const [a, b] = [p.slice(), p.slice()];
      a[k] += step; b[k] -= step;
      const [va, vb] = [field.value(a), field.value(b)];
      return va < -1e5 || vb < -1e5 ? 0 : vb - va;
    }), long = norm(out) || 1;
    for (let k = 0; k < 3; k++) normals[c + k] = out[k] / long;
  }
  return {points: Float32Array.from(P), normals, squares: Int32Array.from(squares)};
}
