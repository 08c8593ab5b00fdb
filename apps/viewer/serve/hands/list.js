/** The nests of the folder: with a picture, how far each is planned, its size and date; a drawing is opened or dropped. */
import { askServer, sendServer } from "./asking.js";
import { brokenDrawing } from "./broken.js";
import { byId, make } from "./elements.js";
import { takeLook } from "./look.js";
import { drawingQuestions } from "./questions.js";
import { figure, language, languageChoice, speak, tr, trn } from "./say.js";

/** @typedef {{name: string, size?: number, changed?: number, plans?: number, state?: string}} NestRow */
/** @typedef {Record<string, string>} Given answers by question */

const AGAIN_MS = 400, FILTER_MS = 200;

/** How the state of a nest's plan looks, and what it says. */
/** @type {Record<string, [string, () => string]>} */
const STATES = {
  broken: ["bad", () => tr("the check refuses its plan")],
  "kept but for": ["warn", () => tr("planned, places not kept")],
  unchecked: ["warn", () => tr("planned, program not checked yet")],
  kept: ["good", () => tr("planned, every hard rule holds")],
  "": ["", () => tr("not planned")],
};

/** Opens a nest, and shows what stands against it: `again` tries once more, `picture` how it would be understood. */
/** @type {(nest: string, repair?: boolean, answers?: Given) => Promise<void>} */
async function open(nest, repair = false, answers = {}) {
  const picture = async (/** @type {Given} */ all) => (await sendServer("/api/preview", { nest, repair, answers: all })).picture;
  try {
    go(await sendServer("/api/open", { nest, repair, answers }));
  } catch (error) {
    problems(error, answers, (mend, all) => open(nest, mend ?? repair, all), picture);
  }
}

/** @type {(file: File, repair?: boolean, answers?: Given) => Promise<void>} */
async function take(file, repair = false, answers = {}) {
  const query = (/** @type {Given} */ all, more = {}) => new URLSearchParams({ name: file.name, repair: repair ? "1" : "0", answers: JSON.stringify(all), ...more });
  const picture = async (/** @type {Given} */ all) => (await sendServer(`/api/drop?${query(all, { preview: "1" })}`, file)).picture;
  tell(tr("reading {name} …", { name: file.name }), "");
  try {
    go(await sendServer(`/api/drop?${query(answers)}`, file));
  } catch (error) {
    problems(error, answers, (mend, all) => take(file, mend ?? repair, all), picture);
  }
}

/** @param {{id: string}} state */
function go(state) {
  location.href = `/nest/${state.id}`;
}

/** @type {(error: any, answers: Given, again: (repair: boolean | undefined, answers: Given) => void, picture: (answers: Given) => Promise<string>) => void} */
function problems({ told, message }, answers, again, picture) {
  const box = told?.questions ? drawingQuestions(told.questions, answers, picture, all => again(undefined, all))
    : told?.problems ? brokenDrawing(told.problems, () => again(true, answers)) : null;
  byId("problem").replaceChildren(box ?? "");
  tell(box ? "" : `${tr("This cannot be opened")}: ${message}`, "bad");
  scrollTo(0, 0);
}

/** @type {(text: string, kind: string) => void} */
function tell(text, kind) {
  const place = byId("said");
  place.textContent = text;
  place.className = `said ${kind}`;
  place.setAttribute("role", kind === "bad" ? "alert" : "status");
}

/** @type {(row: NestRow) => HTMLElement} */
function card(row) {
  const [look, said] = STATES[row.state ?? ""] ?? STATES[""], parts = row.name.split("/"), name = parts.pop();
  const facts = [row.size === undefined ? "" : sizeText(row.size), row.changed ? dateText(row.changed) : "", row.plans ? trn("{n} plan kept", "{n} plans kept", row.plans) : ""];
  const picture = make("span", { class: "picture", "data-nest": row.name }, make("small", {}, "…"));
  pictures.observe(picture);
  return make("li", {}, make("button", { type: "button", "aria-label": row.name, onclick: () => open(row.name) }, picture,
    make("span", { class: "name" }, parts.length ? make("small", {}, `${parts.join("/")}/`) : null, make("b", {}, name)),
    make("span", { class: `chip ${look}` }, said()),
    make("small", { class: "facts" }, facts.filter(Boolean).join(" · "))));
}

/** @type {(bytes: number) => string} */
function sizeText(bytes) {
  return bytes < 1e6 ? `${figure(bytes / 1e3, bytes < 1e4 ? 1 : 0)} kB` : `${figure(bytes / 1e6, 1)} MB`;
}

/** @type {(changed_s: number) => string} */
function dateText(changed_s) {
  return new Date(1000 * changed_s).toLocaleString(language(), { dateStyle: "medium", timeStyle: "short" });
}

/** Pictures are made one after the other, of the nests that are seen. */
let turn = Promise.resolve();
const pictures = new IntersectionObserver(seen => {
  for (const { isIntersecting, target } of seen) {
    if (!isIntersecting) continue;
    pictures.unobserve(target);
    turn = turn.then(() => draw(/** @type {HTMLElement} */ (target)));
  }
}, { rootMargin: "100px" });

/** @type {(place: HTMLElement) => Promise<void>} */
async function draw(place) {
  if (!place.isConnected) return;
  const query = new URLSearchParams({ nest: place.dataset.nest ?? "" });
  const told = await askServer(`/api/thumbnail?${query}`).catch(() => null);
  place.replaceChildren(told?.picture ? make("img", { alt: "", src: told.picture }) : make("small", {}, tr("no picture: open it to see why")));
}

/** how often the list was asked for: what was asked before is of no use any more */
let asked = 0;

/** Some hundred nests from a place of the list on, as it is filtered and sorted now; null where something else is asked meanwhile. */
/** @type {(from: number) => Promise<any>} */
async function rowsFrom(from) {
  const mine = asked, find = filter.value.trim(), sort = /** @type {HTMLSelectElement} */ (byId("sort")).value;
  const told = await askServer(`/api/nests?${new URLSearchParams({ find, sort, from: String(from) })}`).catch(error => { if (mine === asked) tell(error.message, "bad"); return null; });
  if (!told || mine !== asked) return null;
  const left = [told.complete ? "" : tr("still looking …"), from || told.rows.length ? "" : find ? tr("no nest has this in its name") : tr("there is no nest in this folder yet"),
    told.unreadable.length ? tr("Not to be opened, for their names are no UTF-8 (give them other names): {names}", { names: told.unreadable.join(", ") }) : ""];
  const more = told.complete && told.left ? make("button", { type: "button", onclick: () => addRows(from + told.rows.length) }, trn("show more ({n} is left)", "show more ({n} are left)", told.left)) : "";
  byId("more").replaceChildren(left.filter(Boolean).join(" · "), more);
  return told;
}

/** Asks for the first nests, until all are found. */
/** @type {() => Promise<any>} */
async function look() {
  const mine = ++asked;
  for (;;) {
    const told = await rowsFrom(0);
    if (!told) return null;
    byId("nests").replaceChildren(...told.rows.map(card));
    if (told.complete) return told;
    await new Promise(done => setTimeout(done, AGAIN_MS));
    if (mine !== asked) return null;
  }
}

/** @type {(from: number) => Promise<void>} */
async function addRows(from) {
  byId("more").querySelector("button")?.toggleAttribute("disabled", true);
  const told = await rowsFrom(from);
  if (!told) {
    byId("more").querySelector("button")?.toggleAttribute("disabled", false);
    return;
  }
  const cards = /** @type {HTMLElement[]} */ (told.rows.map(card));
  byId("nests").append(...cards);
  cards[0]?.querySelector("button")?.focus();
}

takeLook();
speak(JSON.parse(byId("texts").textContent || "{}"));
languageChoice(/** @type {HTMLSelectElement} */ (byId("language")));
addEventListener("dragover", event => { event.preventDefault(); document.body.classList.add("dropping"); });
addEventListener("dragleave", event => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
addEventListener("drop", event => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  const file = event.dataTransfer?.files[0];
  if (file) void take(file);
});
const file = /** @type {HTMLInputElement} */ (byId("file")), filter = /** @type {HTMLInputElement} */ (byId("filter"));
file.addEventListener("change", () => { if (file.files?.[0]) void take(file.files[0]); file.value = ""; });
let waits = 0;
filter.addEventListener("input", () => {
  clearTimeout(waits);
  asked += 1; // no row of the list of before is added any more
  byId("more").querySelector("button")?.toggleAttribute("disabled", true);
  waits = setTimeout(() => void look(), FILTER_MS);
});
byId("sort").addEventListener("change", () => void look());
const first = await look();
if (first?.first && location.search !== "?list") void open(first.first);
