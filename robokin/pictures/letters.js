// Names beside their places on the sheet: those at one place stand together, one that would cover another moves aside.
function letters(marks, {ink, paperName}) {
  const places = [], boxes = [];
  for (const [text, p] of marks) {
    const near = places.find((other) => Math.hypot(p[0] - other.p[0], p[1] - other.p[1]) < 9);
    if (near) near.names.push(text); else places.push({p, names: [text]});
  }
  ctx.font = "bold 12px system-ui, sans-serif"; ctx.lineWidth = 3; ctx.strokeStyle = paperName; ctx.fillStyle = ink;
  for (const {p, names} of places) {
    const text = names.join(", "), wide = ctx.measureText(text).width;
    let best = null;
    for (const [x, y] of [[9, 15], [9, -8], [-9 - wide, 15], [-9 - wide, -8], [14, 30], [14, -22]]) {
      const box = [p[0] + x, p[1] + y - 11, p[0] + x + wide, p[1] + y + 2];
      const cover = boxes.reduce((sum, o) => sum + Math.max(Math.min(box[2], o[2]) - Math.max(box[0], o[0]), 0) * Math.max(Math.min(box[3], o[3]) - Math.max(box[1], o[1]), 0), 0);
      if (!best || cover < best.cover) best = {cover, box};
    }
    boxes.push(best.box);
    ctx.strokeText(text, best.box[0], best.box[1] + 11); ctx.fillText(text, best.box[0], best.box[1] + 11);
  }
}
// A line through places on the sheet, and a dot.
function stroke(points, colour, width, dash = [], closed = false) {
  if (points.length < 2) return;
  ctx.strokeStyle = colour; ctx.lineWidth = width; ctx.setLineDash(dash); ctx.beginPath();
  points.forEach((p, i) => ctx[i ? "lineTo" : "moveTo"](...p));
  if (closed) ctx.closePath();
  ctx.stroke(); ctx.setLineDash([]);
}
function spot(p, colour, radius = 4) {
  ctx.fillStyle = colour; ctx.beginPath(); ctx.arc(...p, radius, 0, 2 * Math.PI); ctx.fill();
}
// A way that is being gone: what lies behind boldly, the rest faintly, and where it is now.
function trace(points, k, colour, closed = false) {
  stroke(points, colour + "66", 1.2, [5, 4], closed);
  stroke(points.slice(0, k + 1), colour, 2.2);
  spot(points[k], colour);
}
