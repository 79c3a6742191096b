// The address of this page with what it shows: `stated()` gives its parts. What an address asks for is read by `asked`: by
// a part's key a function of its text, which gives a function that does it, or throws an error that says what is wrong.
function link() { return `${location.href.split("#")[0]}#${stated().join("&")}`; }
// A page that stands within another one has no address of its own.
const linkButton = location.protocol === "about:" ? [] : [["link", link]];
// Whether the address asks for something that is done; where a part of it is wrong nothing is, with a word.
function opened() {
  if (location.hash.length < 2) return false;
  try { follow(location.hash.slice(1)); $("said").textContent = ""; return true; } catch (error) {
    $("said").textContent = `The link is not followed: ${error.message}.`;
    return false;
  }
}
addEventListener("hashchange", opened);
function follow(hash) {
  const found = {};
  for (const part of hash.split("&")) {
    const key = part.split("=")[0];
    if (!Object.hasOwn(asked, key) || key in found) throw new Error(`found “${brief(part)}”, expected ${Object.keys(asked).map((name) => name + "=…").join(", ")}`);
    found[key] = asked[key](unescaped(part.slice(key.length + 1)));
  }
  for (const key of Object.keys(asked)) if (found[key]) found[key]();
  later();
}
const zooms = (value) => Math.min(Math.max(value, 0.2), 20);
function asksView(text) {
  const parts = numbers("view", text);
  if (parts.length !== 2 && parts.length !== 3) throw new Error("view: expected azimuth and elevation, and zoom if wanted");
  return () => {
    if (parts.length === 3) zoom = zooms(parts[2]);
    view(parts[0] % 360, Math.min(Math.max(parts[1], -90), 90));
  };
}
function unescaped(part) { try { return decodeURIComponent(part); } catch (error) { return part; } }
const brief = (part) => unescaped(part).slice(0, 60);
function numbers(key, text, count = null) {
  const parts = text.split(",");
  for (const part of parts)
    if (!/^\s*[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?\s*$/i.test(part) || !isFinite(+part)) throw new Error(`${key}: found “${part.slice(0, 20)}”, expected a number`);
  if (count && parts.length !== count) throw new Error(`${key}: found ${parts.length} numbers, expected ${count}`);
  return parts.map(Number);
}
