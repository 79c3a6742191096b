// Plane pictures: a set with its boundary on round axes, as it is printed; each as wide and high as its box, and what is at
// a place of it. A large one is moved and zoomed with the page's `shift` and `zoom`.
function steps(low, high, most) {
  const power = Math.pow(10, Math.floor(Math.log10((high - low) / most)));
  for (const factor of [1, 2, 5, 10, 20, 50]) {
    const step = power * factor, first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    if (last - first < most) return Array.from({length: Math.max(last - first + 1, 0)}, (_, i) => (first + i) * step);
  }
  return [];
}
const minusSign = (text) => text.replace("-", "−");
const tick = (v) => minusSign(plain(v));
let plateNumber = 0;
function plateIn(parent, plate, large) {
  const name = `clip${plateNumber++}`, box = make("figure", parent);
  make("figcaption", box, plate.title);
  const svg = box.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "svg"));
  svg.setAttribute("role", "img"); svg.setAttribute("aria-label", plate.title);
  const counts = plate.counts && unpacked(plate.counts), cells = plate.cells && unpacked(plate.cells), tiles = cells && tiled(cells);
  let X, Y, back;
  function drawPlate() {
    const [x0, y0, x1, y1] = plate.box, w = svg.clientWidth, left = 58, right = 12, top = 10, foot = 44;
    if (!w) return;
    const wish = (w - left - right) * (y1 - y0) / (x1 - x0);
    if (!large) svg.style.height = `${Math.round(Math.min(Math.max(wish, 60), 380) + top + foot)}px`;
    const h = svg.clientHeight, inner = [w - left - right, h - top - foot];
    if (inner[0] < 20 || inner[1] < 20) return;
    const scale = Math.min(inner[0] / (x1 - x0), inner[1] / (y1 - y0)) * (large ? zoom : 1), move = large ? shift : [0, 0];
    const middle = [left + inner[0] / 2 + move[0], top + inner[1] / 2 + move[1]], at = [(x0 + x1) / 2, (y0 + y1) / 2];
    X = (x) => middle[0] + (x - at[0]) * scale; Y = (y) => middle[1] - (y - at[1]) * scale;
    back = (x, y) => [at[0] + (x - middle[0]) / scale, at[1] - (y - middle[1]) / scale];
    // A small picture is as wide as its set; a large one fills its place.
    const sides = large ? [left, top, w - right, h - foot] : [X(x0), Y(y1), X(x1), Y(y0)];
    const low = back(sides[0], sides[3]), up = back(sides[2], sides[1]), f = (v) => v.toFixed(1);
    const path = (lines, close) => lines.map((line) => "M" + line.map(([x, y]) => f(X(x)) + " " + f(Y(y))).join("L") + (close ? "Z" : "")).join("");
    let s = `<clipPath id="${name}w"><rect x="${f(sides[0])}" y="${f(sides[1])}" width="${f(sides[2] - sides[0])}" height="${f(sides[3] - sides[1])}"/></clipPath>`;
    let before = -Infinity;
    for (const x of steps(low[0], up[0], Math.max(2, Math.floor((sides[2] - sides[0]) / 64)))) {
      s += `<path class="grid" d="M${f(X(x))} ${f(sides[1])}V${f(sides[3])}"/>`;
      if (X(x) - before < 34) continue;
      before = X(x);
      s += `<text x="${f(Math.min(X(x), w - 4 - 3 * tick(x).length))}" y="${f(sides[3] + 16)}" text-anchor="middle">${tick(x)}</text>`;
    }
    for (const y of steps(low[1], up[1], Math.max(2, Math.floor((sides[3] - sides[1]) / 44))))
      s += `<path class="grid" d="M${f(sides[0])} ${f(Y(y))}H${f(sides[2])}"/><text x="${f(sides[0] - 6)}" y="${f(Y(y) + 4)}" text-anchor="end">${tick(y)}</text>`;
    s += `<path class="axis" d="M${f(sides[0])} ${f(sides[1])}V${f(sides[3])}H${f(sides[2])}"/>`;
    s += `<text x="${f((sides[0] + sides[2]) / 2)}" y="${f(sides[3] + 34)}" text-anchor="middle">${plate.labels[0]} [${data.length}]</text>`;
    const aside = Math.max(sides[0] - 46, 11);
    s += `<text transform="translate(${f(aside)} ${f((sides[1] + sides[3]) / 2)}) rotate(-90)" text-anchor="middle">${plate.labels[1]} [${data.length}]</text>`;
    s += `<g clip-path="url(#${name}w)"><clipPath id="${name}"><path clip-rule="evenodd" d="${path(plate.loops, true)}"/></clipPath>`;
    if (tiles) {
      const a = [cells.low[0] - cells.step[0] / 2, cells.low[1] + (cells.shape[1] - 0.5) * cells.step[1]];
      s += `<image href="${tiles}" x="${f(X(a[0]))}" y="${f(Y(a[1]))}" width="${f(cells.shape[0] * cells.step[0] * scale)}" height="${f(cells.shape[1] * cells.step[1] * scale)}" preserveAspectRatio="none"${plate.loops.length ? ` clip-path="url(#${name})"` : ""}/>`;
    }
    if (plate.free.length) s += `<path class="free" d="${path(plate.free, true)}"/>`;
    if (!tiles) s += `<path class="set" fill-rule="evenodd" d="${path(plate.loops, true)}"/>`;
    s += `<path class="edge" d="${path(plate.edges, false)}"/>`;
    if ($("arm").checked) for (const arm of plate.arms)
      s += `<path class="arm" d="${path([arm], false)}"/>` + arm.slice(0, -1).map(([x, y]) => `<circle cx="${f(X(x))}" cy="${f(Y(y))}" r="3.4"/>`).join("");
    svg.innerHTML = s + "</g>";
  }
  // What is at a point of the screen: coordinates by the axes' names, solutions, part of the orientations.
  function told(event) {
    if (!back) return "";
    const frame = svg.getBoundingClientRect(), u = back(event.clientX - frame.left, event.clientY - frame.top), [x0, y0, x1, y1] = plate.box;
    if (!large && (u[0] < x0 || u[0] > x1 || u[1] < y0 || u[1] > y1)) return "";
    const inside = within(plate.loops, u), digits = DECIMALS[data.length];
    const parts = [`${plate.labels.map((label, k) => `${label} ${minusSign(u[k].toFixed(digits))}`).join("  ")} ${data.length}`, inside ? "reachable" : "out of reach"];
    if (inside) parts.push(...known(counts, cells, u, u));
    return parts.filter(Boolean).join(" · ");
  }
  svg.addEventListener("pointermove", (event) => { if (!event.buttons) $("here").textContent = told(event); });
  svg.addEventListener("pointerdown", (event) => { $("here").textContent = told(event); });
  svg.addEventListener("pointerleave", () => { $("here").textContent = HINT; });
  new ResizeObserver(drawPlate).observe(svg);
  return {draw: drawPlate, told, plate};
}
// What tables say of a place, the counts and the orientations each in its own coordinates.
function known(counts, freedom, u, v) {
  const parts = [], number = counts && spread(counts, u), at = freedom ? nearest(freedom, v) : -1;
  if (number) parts.push(number[0] === number[1] ? `${number[0]} solution${number[0] > 1 ? "s" : ""}` : `${number[0]} to ${number[1]} solutions`);
  if (at >= 0 && freedom.values[at] < 255) parts.push(`about ${Math.round(freedom.values[at] / 2.54)} % of the ${ORIENTATIONS}`);
  return parts;
}
function within(loops, [x, y]) {
  let inside = false;
  for (const loop of loops) for (let i = 0, j = loop.length - 1; i < loop.length; j = i++) {
    const [a, b] = [loop[i], loop[j]];
    if ((a[1] > y) !== (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
  }
  return inside;
}
// A table of fractions as a picture: a pixel a node.
function tiled(table) {
  const [w, h] = table.shape, sheet = document.createElement("canvas"), c = sheet.getContext("2d");
  [sheet.width, sheet.height] = [w, h];
  const pixels = c.createImageData(w, h);
  for (let i = 0; i < w; i++) for (let j = 0; j < h; j++) {
    const value = table.values[i * h + j];
    if (value < 255) pixels.data.set([...brightness(value / 254), 255], 4 * ((h - 1 - j) * w + i));
  }
  c.putImageData(pixels, 0, 0);
  return sheet.toDataURL();
}
// Colours from dark to bright, even to the eye (viridis).
const MAP = ["440154", "472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"].map((c) => rgb("#" + c));
function brightness(t) {
  const at = Math.min(Math.max(t, 0), 1) * (MAP.length - 1), i = Math.min(Math.floor(at), MAP.length - 2);
  return MAP[i].map((a, k) => Math.round(a + (MAP[i + 1][k] - a) * (at - i)));
}
