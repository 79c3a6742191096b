// What pages of arms, of mechanisms and of frames say of poses: numbers, matrices, angles, commands.
const shown = (value, kind, more = 0) => {
  const text = value.toFixed(DECIMALS[kind] + more);
  return /^-[0.]*$/.test(text) ? text.slice(1) : text;
};
const ANGLE = data.angle === "deg" ? "°" : "rad";
$("note").textContent = data.note;
const UNIT = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
// R = Rz(yaw) Ry(pitch) Rx(roll), in the page's angle unit; roll is 0 where pitch is ±90°.
function rpy(T) {
  const cp = Math.hypot(T[9], T[10]), roll = cp > 1e-12 ? Math.atan2(T[9], T[10]) : 0, c = Math.cos(roll), s = Math.sin(roll);
  return [roll, Math.atan2(-T[8], cp), Math.atan2(s * T[2] - c * T[1], c * T[5] - s * T[6])].map((a) => a / data.radians);
}
const rows = (T) => [0, 4, 8, 12].map((i) => T.slice(i, i + 4));
// Numbers as a command takes them: to 12 digits, without the dust of sums.
const typed = (values) => values.map((value) => String(+(+value).toPrecision(12) || 0)).join(",");
const matrixText = (T) => `[${rows(T).map((row) => `[${typed(row)}]`).join(",")}]`;
// A command line in the element of that name, broken between its words and after commas.
function showCommand(text) {
  $("command").replaceChildren();
  text.split(" ").forEach((word, k) => {
    if (k) $("command").append(" ");
    const span = make("span", $("command"));
    word.split(/(?<=,)/).forEach((part, i) => { if (i) make("wbr", span); span.append(part); });
  });
}
// A table of a pose: position and roll, pitch, yaw; what is returned fills it.
function poseTable(body) {
  const cells = {};
  for (const [name, keys] of [["position", ["x", "y", "z"]], ["orientation", ["roll", "pitch", "yaw"]]]) {
    const names = make("tr", body);
    make("td", names, name === "position" ? data.length : data.angle);
    keys.forEach((key) => { make("td", names, key).style.color = "var(--dim)"; });
    const row = make("tr", body);
    make("td", row, name);
    keys.forEach((key) => { cells[key] = make("td", row, "", {id: key}); });
  }
  return (T) => {
    ["x", "y", "z"].forEach((key, k) => { cells[key].textContent = shown(T[4 * k + 3], data.length, 1); });
    rpy(T).forEach((value, k) => { cells[["roll", "pitch", "yaw"][k]].textContent = shown(value, data.angle); });
  };
}
