// One nest, its plan, and a button that plans it.
import { ask, send } from "./server.js";

const id = location.pathname.split("/").pop();
const main = document.getElementById("main");
main.innerHTML = "";
const solve = Object.assign(document.createElement("button"), { textContent: "Plan" });
const line = document.createElement("p");
const drawing = Object.assign(document.createElement("iframe"), { title: "the plan" });
main.append(solve, line, drawing);
let state = await ask(`/api/${id}/state`);
let drawn = null;

function show(told) {
  state = told;
  const plan = told.alternatives.find((one) => one.number === told.shown);
  line.textContent = told.problem || told.conflict?.text || plan?.summary || "not planned yet";
  if (drawn !== told.shown) drawing.src = `/nest/${id}/drawing?v=${(drawn = told.shown)}`;
}

solve.addEventListener("click", () => send(`/api/${id}/solve`, { version: state.version }));
const news = new EventSource(`/api/${id}/events`);
news.addEventListener("state", (event) => show(JSON.parse(event.data)));
show(state);
