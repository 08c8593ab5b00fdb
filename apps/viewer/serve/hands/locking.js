/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { tr } from "./say.js";

/**
 * A panel of what is locked, and under *Why* the buttons that lock the chosen contour.
 *
 * @param {any} app
 * @param {Work} work
 * @param {(contour: number) => void} drawTab begins to draw a tab on a contour
 */
export function lockPanel(app, work, drawTab) {
  const panel = app.panel("locks", tr("Locks"));
  const list = make("ul", { id: "hands-locks" });
  const line = /** @type {HTMLInputElement} */ (make("input", { id: "hands-lock-line", placeholder: "P2 before P3", "aria-label": tr("a lock in words") }));
  const form = make("form", { onsubmit: (/** @type {Event} */ event) => { event.preventDefault(); addLine(); } }, line, " ", make("button", {}, tr("Lock")));
  const values = make("ul", { id: "hands-values" }), none = make("p", { id: "hands-no-locks" }, tr("Nothing is locked yet."));
  panel.append(make("p", { class: "hint" }, tr("Drag a row or a part to lock its place. Click × to unlock.")), none, list, form, values);
  const addLine = async () => {
    const said = line.value;
    if (!said) return;
    line.value = ""; // at once: the next lock may be typed while this one is on its way
    if (!await work.edit([{ lock: said }]) && !line.value) line.value = said;
  };
  const drawLocks = () => {
    const { locked, settings } = work.state;
    none.hidden = locked.length > 0;
    list.replaceChildren(...locked.map((/** @type {string} */ said) => make("li", {}, said,
      make("button", { type: "button", "aria-label": tr("unlock {lock}", { lock: said }), title: tr("unlock"), onclick: () => work.edit([{ unlock: said }]) }, "×"))));
    values.replaceChildren(...Object.entries(settings).map(([key, value]) => make("li", {}, `${key}: ${value}`,
      make("button", { type: "button", "aria-label": tr("as the profile has {key}", { key }), onclick: () => work.edit([{ unset: key }]) }, "×"))));
  };
  work.on((_, what) => { if (what === "state") drawLocks(); });
  const place = make("div", { id: "hands-chosen", hidden: true });
  app.slots.why.append(place);
  const drawChosen = () => chosenButtons(app, work, place, drawTab);
  app.on((/** @type {any} */ _, /** @type {any} */ changes) => { if (changes.selected !== undefined) drawChosen(); });
  work.on((_, what) => { if (what === "state" || what === "drawn") drawChosen(); });
}

/** @type {(app: any, work: Work, place: HTMLElement, drawTab: (contour: number) => void) => void} */
function chosenButtons(app, work, place, drawTab) {
  const contour = app.data.nest.contours[app.state.selected], side = app.data.sides[0];
  place.hidden = !contour || Boolean(work.compared) || !work.isDrawn;
  if (place.hidden) return;
  const k = side?.cuts.findIndex((/** @type {any} */ cut) => cut.contour === app.state.selected) ?? -1;
  const part = app.data.nest.parts[contour.part] ?? contour.id, name = quoted(contour.id);
  const cut = side?.cuts[k], number = k < 0 ? 0 : side.made + k + 1;
  const locks = work.state.locked.filter((/** @type {string} */ said) => said.includes(contour.id) || said.includes(part));
  const both = (/** @type {string} */ said) => lockAndPlan(work, [{ lock: said }], work.state.shown);
  const buttons = [
    make("b", {}, contour.id),
    make("button", { type: "button", onclick: () => both(`${quoted(part)} first`) }, tr("start here")),
    make("button", { type: "button", onclick: () => both(`${quoted(part)} last`) }, tr("end here")),
    number && !work.severalTorches ? make("button", { type: "button", onclick: () => both(`${name} position ${number}`) }, tr("pin as {number}", { number })) : null,
    cut ? make("button", { type: "button", onclick: () => both(`${name} entry (${cut.entry.join(", ")})`) }, tr("pin the entry")) : null,
    cut ? make("button", { type: "button", onclick: () => both(`${name} ${cut.direction === "cw" ? "ccw" : "cw"}`) }, tr("other way round")) : null,
    make("button", { type: "button", onclick: () => both(`no link ${name}`) }, tr("no link")),
    contour.kind === "outer" ? make("button", { type: "button", onclick: () => drawTab(app.state.selected) }, tr("draw a tab")) : null,
    contour.kind === "outer" ? make("button", { type: "button", onclick: () => both(`no tab ${name}`) }, tr("no tab")) : null,
    number && !work.severalTorches ? make("button", { type: "button", onclick: () => work.change("cut", { upto: number }) }, tr("cut up to here ({number})", { number })) : null,
    work.state.upto ? make("button", { type: "button", onclick: () => work.change("cut", { upto: 0 }) }, tr("nothing is cut yet")) : null,
    ...locks.map((/** @type {string} */ said) => make("button", { type: "button", onclick: () => lockAndPlan(work, [{ unlock: said }]) }, tr("unlock: {lock}", { lock: said }))),
  ];
  place.replaceChildren(...buttons.filter(one => one !== null));
}

/** A name as a lock says it: in double quotes, and one that it holds is written twice. */
/** @param {string} id */
export function quoted(id) {
  return `"${id.replaceAll('"', '""')}"`;
}

/** Changes the job file and plans at once, in one request: what is being planned gives way. */
/** @type {(work: Work, changes: object[], plan?: number) => Promise<void>} */
export async function lockAndPlan(work, changes, plan) {
  await work.edit(changes, plan, true);
}
