// The nests of the folder: one is opened by a click, a drawing by dropping it.
import { askServer, sendServer } from "./asking.js";
import { brokenDrawing } from "./broken.js";
import { drawingQuestions } from "./questions.js";

const main = document.getElementById("main");

function element(name, text = "") {
  const made = document.createElement(name);
  made.textContent = text;
  return made;
}

function go(state) {
  location.href = `/nest/${state.id}`;
}

// What stands above the list, where something could not be opened: `again` tries once more, `picture` shows how it would
// be understood with some answers.
function problems({ told, message }, answers, again, picture) {
  main.querySelector("section")?.remove();
  let box = element("section");
  if (told?.questions) box = drawingQuestions(told.questions, answers, picture, (all) => again(undefined, all));
  else if (told?.problems) box = brokenDrawing(told.problems, () => again(true, answers));
  else box.append(element("h2", "This cannot be opened"), element("p", message));
  main.prepend(box);
  scrollTo(0, 0);
}

async function open(nest, repair = false, answers = {}) {
  const picture = async (all) => (await sendServer("/api/preview", { nest, repair, answers: all })).picture;
  try {
    go(await sendServer("/api/open", { nest, repair, answers }));
  } catch (error) {
    problems(error, answers, (mend, all) => open(nest, mend ?? repair, all), picture);
  }
}

async function drop(file, repair = false, answers = {}) {
  const query = (all, more = {}) => new URLSearchParams({ name: file.name, repair: repair ? "1" : "0", answers: JSON.stringify(all), ...more });
  const picture = async (all) => (await sendServer(`/api/drop?${query(all, { preview: "1" })}`, file)).picture;
  try {
    go(await sendServer(`/api/drop?${query(answers)}`, file));
  } catch (error) {
    problems(error, answers, (mend, all) => drop(file, mend ?? repair, all), picture);
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
