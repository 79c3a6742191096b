// The address of this page with the configuration, or the time of the path, and the eye where it was turned.
function link() {
  const parts = onPath() ? [`t=${typed([data.path.t[motion.row()]])}`] : [`q=${typed(q)}`, `units=${data.length},${data.angle}`];
  if (azimuth !== data.view[0] || elevation !== data.view[1]) parts.push(`view=${typed([azimuth, elevation])}`);
  return `${location.href.split("#")[0]}#${parts.join("&")}`;
}
// What the address asks for; what it does not say right is left out, with a word.
function opened() {
  if (location.hash.length < 2) return false;
  try { follow(location.hash.slice(1)); $("said").textContent = ""; return true; } catch (error) {
    $("said").textContent = `The link is not followed: ${error.message}.`;
    return false;
  }
}
function follow(hash) {
  const asked = new Map();
  for (const part of hash.split("&")) {
    const [key, value] = [part.split("=")[0], part.slice(part.indexOf("=") + 1)];
    if (!["q", "t", "units", "view"].includes(key) || asked.has(key)) throw new Error(`found “${decoded(part)}”, expected q=…, t=… or view=…`);
    asked.set(key, key === "units" ? decoded(value) : numbers(key, decoded(value)));
  }
  const units = `${data.length},${data.angle}`;
  if (asked.has("units") && asked.get("units") !== units) throw new Error(`it is in ${asked.get("units")}, expected ${units} of this page`);
  const [wanted, time, eye] = [asked.get("q"), asked.get("t"), asked.get("view")];
  if (wanted && wanted.length !== n) throw new Error(`found ${wanted.length} joint values, expected ${n}`);
  if (time && (!motion || time.length !== 1)) throw new Error("found a time, expected a page with a path, and one time");
  if (eye && eye.length !== 2) throw new Error("view: expected azimuth and elevation");
  if (eye) view(eye[0] % 360, Math.min(Math.max(eye[1], -90), 90));
  if (time) {
    const gaps = data.path.t.map((t) => Math.abs(t - time[0]));
    motion.pause(); motion.seek(gaps.indexOf(Math.min(...gaps)));
  }
  if (wanted) setQ(wanted);
}
function decoded(text) { try { return decodeURIComponent(text).slice(0, 60); } catch (error) { return text.slice(0, 60); } }
function numbers(key, text) {
  const parts = text.split(",");
  for (const part of parts)
    if (!/^\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*$/i.test(part) || !isFinite(+part)) throw new Error(`${key}: found “${part.slice(0, 20)}”, expected a number`);
  return parts.map(Number);
}
