// What is looked at in every page, whatever it shows. Each check gives a list of sentences, empty where all is well.
const shownElements = () => [...document.body.querySelectorAll("*")].filter((element) => {
  if (["SCRIPT", "STYLE", "OPTION"].includes(element.tagName) || element.closest("defs, clipPath") || element.closest(".away")) return false;
  return element.getClientRects().length && element.checkVisibility({opacityProperty: true, visibilityProperty: true});
});
const ownText = (element) => [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent.trim()).join(" ").trim();
const named = (element) => `${element.tagName.toLowerCase()}${element.id ? "#" + element.id : ""} “${(ownText(element) || element.getAttribute("aria-label") || "").slice(0, 40)}”`;
// Where an element's own words are, or the element itself.
function boxesOf(element) {
  if (["INPUT", "BUTTON", "SELECT", "CANVAS", "TEXTAREA", "VIDEO"].includes(element.tagName) || element.tagName === "text") return [element.getBoundingClientRect()];
  const boxes = [];
  for (const node of element.childNodes) if (node.nodeType === 3 && node.textContent.trim()) {
    const range = document.createRange();
    range.selectNodeContents(node);
    boxes.push(...range.getClientRects());
  }
  return boxes;
}
const scroller = (element) => {
  for (let one = element.parentElement; one && one !== document.body; one = one.parentElement)
    if (["auto", "scroll", "hidden"].includes(getComputedStyle(one).overflowY)) return one;
  return document.body;
};
// Things that are to be read or pressed and lie over one another.
function overlaps() {
  const things = [];
  for (const element of shownElements()) for (const box of boxesOf(element)) if (box.width > 0 && box.height > 0) things.push({element, box, home: scroller(element)});
  const wrong = [];
  things.forEach((a, i) => {
    for (const b of things.slice(i + 1)) {
      if (a.element === b.element || a.home !== b.home || a.element.contains(b.element) || b.element.contains(a.element)) continue;
      const w = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left), h = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
      // Lines of one text stand so near that their boxes touch.
      if (w > 1.5 && h > 3) wrong.push(`${named(a.element)} lies over ${named(b.element)} by ${w.toFixed(0)} × ${h.toFixed(0)}`);
    }
  });
  return wrong;
}
// What sticks out of the window, or out of its own box.
function overflows() {
  const wide = document.documentElement.clientWidth, wrong = [];
  if (document.documentElement.scrollWidth > wide) wrong.push(`the page is ${document.documentElement.scrollWidth} wide in a window of ${wide}`);
  for (const element of shownElements()) {
    for (const box of boxesOf(element)) if (box.right > wide + 1 || box.left < -1) wrong.push(`${named(element)} sticks out of the window: ${box.left.toFixed(0)} to ${box.right.toFixed(0)}`);
    if (["BUTTON", "TD", "TH", "CODE", "LABEL", "H1", "H2", "P"].includes(element.tagName) && element.scrollWidth > element.clientWidth + 1 && element.clientWidth) wrong.push(`${named(element)} is wider than its box`);
  }
  return wrong;
}
// Contrast of words with what is behind them (WCAG 2.1, 1.4.3: 4.5 to 1).
const numbersOf = (colour) => (colour.match(/[\d.]+/g) || []).map(Number);
const luminance = ([r, g, b]) => [r, g, b].map((c) => c / 255).map((c) => c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
  .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
function behind(element) {
  for (let one = element; one; one = one.parentElement) {
    const [r, g, b, a = 1] = numbersOf(getComputedStyle(one).backgroundColor);
    if (a > 0.5) return [r, g, b];
  }
  return [255, 255, 255];
}
function contrasts() {
  const wrong = [];
  for (const element of shownElements()) {
    if (!ownText(element) && !["INPUT", "SELECT"].includes(element.tagName)) continue;
    if (element.disabled || ["range", "checkbox", "radio", "color"].includes(element.type)) continue;
    const style = getComputedStyle(element), colour = numbersOf(element instanceof SVGElement ? style.fill : style.color);
    const [a, b] = [luminance(colour), luminance(behind(element))].sort((x, y) => y - x), ratio = (a + 0.05) / (b + 0.05);
    if (ratio < 4.5) wrong.push(`${named(element)} has contrast ${ratio.toFixed(2)}`);
  }
  return wrong;
}
// Controls and pictures that have no name, and a page without a language or a heading.
function unnamed() {
  const wrong = [];
  if (!document.documentElement.lang) wrong.push("the page has no language");
  if (document.querySelectorAll("h1").length !== 1) wrong.push("the page has not one heading");
  if (!document.title) wrong.push("the page has no title");
  if (!document.querySelector("main")) wrong.push("the page has no main part");
  for (const element of shownElements()) {
    const role = element.getAttribute("role");
    if (!["INPUT", "BUTTON", "SELECT", "TEXTAREA", "CANVAS"].includes(element.tagName) && role !== "img" && element.tabIndex < 0) continue;
    if (element.tagName === "SUMMARY" && ownText(element)) continue;
    const label = element.getAttribute("aria-label") || (element.labels && [...element.labels].map((one) => one.textContent.trim()).join(" ")) || element.textContent.trim();
    if (!label) wrong.push(`${named(element)} has no name`);
  }
  const ids = [...document.querySelectorAll("[id]")].map((element) => element.id);
  for (const id of new Set(ids)) if (ids.filter((one) => one === id).length > 1) wrong.push(`two elements are called ${id}`);
  return wrong;
}
const look = () => ({overlap: overlaps(), overflow: overflows(), contrast: contrasts(), name: unnamed()});
// What the keys can come to, in the order of the page.
const stops = () => shownElements().filter((element) => element.tabIndex >= 0 && !element.disabled && (element.tagName !== "INPUT" || element.type !== "radio" || element.checked));
const focused = () => {
  const element = document.activeElement, style = getComputedStyle(element);
  return {index: stops().indexOf(element), name: named(element), seen: (style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0) || style.boxShadow !== "none"};
};
// A number for what a canvas, or a drawing, shows.
const hash = (text) => { let sum = 7; for (let i = 0; i < text.length; i++) sum = (31 * sum + text.charCodeAt(i)) | 0; return sum; };
const drawn = () => {
  const canvas = document.querySelector("main canvas");
  return hash(canvas ? canvas.toDataURL() : document.querySelector("main svg").outerHTML);
};
