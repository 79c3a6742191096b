// Copies a text, and says so for a while; where the browser does not let a page copy, the text stands there to be taken.
async function copied(text, what) {
  let done = false;
  try { await navigator.clipboard.writeText(text); done = true; } catch (error) {
    const area = make("textarea", document.body, text, {readOnly: true, className: "away"});
    area.select();
    try { done = document.execCommand("copy"); } catch (error) { done = false; }
    area.remove();
  }
  $("said").textContent = done ? `${what} copied` : `This browser does not let a page copy: ${text}`;
  clearTimeout(copied.timer);
  if (done) copied.timer = setTimeout(() => { $("said").textContent = ""; }, 2500);
}
// A row of buttons, each with what it copies.
function copyButtons(parts) {
  const row = $("copy");
  make("span", row, "copy");
  for (const [what, text] of parts) make("button", row, what, {id: "copy-" + what}).addEventListener("click", () => copied(text(), what));
}
