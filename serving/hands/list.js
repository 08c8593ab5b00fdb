// The nests of the folder: one is opened by a click, a drawing by dropping it.
import { askServer, sendServer } from "./asking.js";
import { brokenDrawing } from "./broken.js";

const main = document.getElementById("main");

function element(name, text = "") {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

function go(state) {
  location.href = `/nest/${state.id}`;
}

function problems({ told, message }, again) {
  main.querySelector("section")?.remove();
  const box = told?.problems ? brokenDrawing(told.problems, again) : element("section");
  if (!told?.problems) box.append(element("h2", "This cannot be opened"), element("p", message));
  main.prepend(box);
  scrollTo(0, 0);
}

async function open(nest, repair = false) {
  try {
    go(await sendServer("/api/open", { nest, repair }));
  } catch (error) {
    problems(error, () => open(nest, true));
  }
}

async function drop(file, repair = false) {
  const query = new URLSearchParams({ name: file.name, repair: repair ? "1" : "0" });
  try {
    go(await sendServer(`/api/drop?${query}`, file));
  } catch (error) {
    problems(error, () => drop(file, true));
  }
}

addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) drop(file);
});

const told = await askServer("/api/nests");
if (told.first && location.search !== "?list") await open(told.first);
main.append(element("h1", "Nests"), element("p", "Click a nest to open it, or drop a drawing here."));
const list = element("ul");
for (const nest of told.nests) {
  const button = element("button", nest);
  button.addEventListener("click", () => open(nest));
  const item = element("li");
  item.append(button);
  list.append(item);
}
main.append(list);
if (told.unreadable.length) main.append(element("p", `Not to be opened, for their names are no UTF-8 (give them other names): ${told.unreadable.join(", ")}`));
