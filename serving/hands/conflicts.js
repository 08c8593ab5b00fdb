/** @import { Work } from "./work.js" */
import { sendServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan } from "./locking.js";

/**
 * Where the rules contradict each other: the smallest set, and what each way out would bring.
 *
 * @param {any} app
 * @param {Work} work
 */
export function conflictPanel(app, work) {
  const place = make("section", { id: "hands-conflict", hidden: true, "aria-label": "rules that contradict each other" });
  app.slots.side.append(place);
  /** @type {any} */
  let drawn = null;
  work.on(() => {
    const { conflict } = work.state;
    if (conflict === drawn) return;
    drawn = conflict;
    place.hidden = !conflict;
    if (conflict) drawConflict(app, work, place, conflict, () => work.state.conflict === conflict);
  });
}

/** @type {(app: any, work: Work, place: HTMLElement, conflict: any, stands: () => boolean) => void} */
function drawConflict(app, work, place, conflict, stands) {
  /** @type {[HTMLElement, object][]} */
  const ways = [];
  /** @type {(title: string, changes: object[], relax?: boolean) => HTMLElement} */
  const way = (title, changes, relax = false) => {
    const bring = make("small", {}, "…");
    ways.push([bring, { changes, relax }]);
    const take = () => relax ? work.change("solve", { relax }) : lockAndPlan(work, changes);
    return make("p", {}, make("button", { type: "button", onclick: take }, title), " ", bring);
  };
  const rows = conflict.clash.map((/** @type {any} */ one) => make("li", {},
    make("button", { type: "button", class: "said", onclick: () => { app.set({ marked: numbersOf(app, one.contours) }); } }, `${one.rule}: ${one.text}`),
    one.undo.length ? way(`undo: ${one.undo.map((/** @type {any} */ change) => change.unlock).join(", ")}`, one.undo) : null,
    one.soften.length ? way(`make ${one.rule} soft for this nest`, one.soften) : null));
  place.replaceChildren(
    make("h2", {}, conflict.clash.length ? "These cannot all hold" : "There is no plan"),
    conflict.clash.length ? make("ul", {}, ...rows) : make("pre", {}, conflict.text),
    conflict.relax ? way(`relax ${conflict.relax.length} statement${conflict.relax.length > 1 ? "s" : ""}, the cheapest way out`, [], true) : conflict.stuck || "");
  app.set({ marked: numbersOf(app, conflict.clash.flatMap((/** @type {any} */ one) => one.contours)) });
  tryWays(work, ways, stands);
}

/** Asks what each way would bring, one after the other, as long as the conflict stands. */
/** @type {(work: Work, ways: [HTMLElement, object][], stands: () => boolean) => Promise<void>} */
async function tryWays(work, ways, stands) {
  for (const [place, said] of ways) {
    if (!stands() || work.state.solving) return;
    try {
      const told = await sendServer(work.path("try"), said);
      place.textContent = `${told.works ? "brings " : ""}${told.text}`;
      place.className = told.works ? "good" : "bad";
    } catch (error) {
      place.textContent = /** @type {Error} */ (error).message;
    }
  }
}

/** @type {(app: any, ids: string[]) => number[]} */
function numbersOf(app, ids) {
  const wanted = new Set(ids);
  return app.data.nest.contours.flatMap((/** @type {any} */ contour, /** @type {number} */ k) => wanted.has(contour.id) ? [k] : []);
}
