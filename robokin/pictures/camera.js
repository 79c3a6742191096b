// What the eye looks at, and from where: all of the picture, unless it is turned, moved or zoomed.
const size = data.size;
const centre = data.box[0].map((low, k) => (low + data.box[1][k]) / 2);
const radius = Math.max(norm(minus(data.box[1], data.box[0])) / 2, 0.42 * size);
let eye, azimuth, elevation, zoom, shift;
function view(a, e) { [azimuth, elevation] = [a, e]; later(); }
function reset() { zoom = 1; shift = [0, 0]; view(...data.view); }
