// What every page begins with: its data, its elements, its title, numbers as text.
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const make = (tag, parent, text = "", more = {}) => {
  const element = Object.assign(document.createElement(tag), more);
  if (text) element.textContent = text;
  return parent.appendChild(element);
};
const plain = (value) => String(+value.toPrecision(6));
const DECIMALS = {m: 4, cm: 2, mm: 1, in: 3, deg: 2, rad: 4};
document.title = $("title").textContent = data.title;
