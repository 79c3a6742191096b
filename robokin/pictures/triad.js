// The arrows of a frame T: x, y, z, each in its colour.
function triad(T, scale) {
  const p = [T[3], T[7], T[11]], w = 0.0042 * size * Math.min(scale, 1);
  ["x", "y", "z"].forEach((name, k) => {
    const axis = [T[k], T[k + 4], T[k + 8]], j = (k + 1) % 3, aside = [T[j], T[j + 4], T[j + 8]];
    const neck = plus(p, axis, 0.086 * size * scale), tip = plus(p, axis, 0.11 * size * scale), paint = rgb(data.colours[name]);
    prism(p, neck, aside, w, w, 8, paint);
    prism(neck, tip, aside, 2.8 * w, 0, 10, paint);
  });
}
