// The gallery's field: cards that have all of its words stay, groups without a card go.
const wanted = document.getElementById("wanted");
if (wanted) {
  const cards = [...document.querySelectorAll(".cards > li")];
  const look = () => {
    const words = wanted.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const card of cards) {
      card.hidden = !words.every((word) => card.dataset.words.includes(word));
      found += !card.hidden;
    }
    for (const list of document.querySelectorAll(".cards")) {
      list.closest("section").hidden = !list.querySelector("li:not([hidden])");
    }
    document.getElementById("found").textContent = words.length ? `${found} of ${cards.length}` : "";
  };
  wanted.addEventListener("input", look);
  look();
}
// What scrolls sideways can be reached by the keyboard, also when a window has become narrow.
const reach = () => {
  for (const block of document.querySelectorAll("div.highlight pre, .pst-scrollable-table-container")) {
    if (block.scrollWidth > block.clientWidth) block.tabIndex = 0;
    else block.removeAttribute("tabindex");
  }
};
window.addEventListener("resize", reach);
window.addEventListener("load", reach);
