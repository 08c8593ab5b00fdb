/** @import { Work } from "./work.js" */
import { sendServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan } from "./locking.js";
import { tr, trn } from "./say.js";
import { inWords } from "./sentences.js";

/**
 * Where the rules contradict each other: the few that do, and what each way out would bring.
 *
 * @param {any} app
 * @param {Work} work
 */
export function conflictPanel(app, work) {
  const place = make("section", { id: "hands-conflict", hidden: true, "aria-label": tr("rules that contradict each other") });
  app.slots.side.append(place);
  let drawn = "null", trying = new AbortController();
  work.on(() => {
    const { conflict, solving } = work.state, now = JSON.stringify(conflict);
    if (solving) trying.abort();
    if (now === drawn) return;
    drawn = now;
    trying.abort();
    place.hidden = !conflict;
    if (!conflict) return;
    trying = new AbortController();
    void tryWays(work, drawConflict(app, work, place, conflict), trying.signal);
  });
}

/** Draws it, and gives the ways out: where to say what each would bring, and what it changes. */
/** @type {(app: any, work: Work, place: HTMLElement, conflict: any) => [HTMLElement, object][]} */
function drawConflict(app, work, place, conflict) {
  /** @type {[HTMLElement, object][]} */
  const ways = [];
  /** @type {(title: string, changes: object[], relax?: boolean) => HTMLElement} */
  const way = (title, changes, relax = false) => {
    const bring = make("small", {}, "…");
    ways.push([bring, { changes, relax }]);
    const take = () => relax ? work.solve({ relax }) : lockAndPlan(work, changes);
    return make("p", {}, make("button", { type: "button", onclick: take }, title), " ", bring);
  };
  const rows = conflict.clash.map((/** @type {any} */ one) => make("li", {},
    make("button", { type: "button", class: "said", onclick: () => { app.set({ marked: numbersOf(app, one.contours) }); } }, `${one.rule}: ${inWords(one.text)}`),
    one.undo.length ? way(tr("undo: {locks}", { locks: one.undo.map((/** @type {any} */ change) => change.unlock).join(", ") }), one.undo) : null,
    one.soften.length ? way(tr("make {rule} soft for this nest", { rule: one.rule }), one.soften) : null));
  place.replaceChildren(
    make("h2", {}, conflict.clash.length ? tr("These cannot all hold") : tr("There is no plan")),
    conflict.clash.length ? make("p", {}, saidOf(conflict)) : "",
    conflict.clash.length ? make("ul", {}, ...rows) : make("pre", {}, conflict.text),
    conflict.relax ? way(conflict.compared ? trn("relax {n} statement, the cheapest way out", "relax {n} statements, the cheapest way out", conflict.relax.length) : trn("relax {n} statement, a way out", "relax {n} statements, a way out", conflict.relax.length), [], true) : conflict.stuck || "");
  app.set({ marked: numbersOf(app, conflict.clash.flatMap((/** @type {any} */ one) => one.contours)) });
  return ways;
}

/** @type {(conflict: any) => string} what a planner is to make of the sentences */
function saidOf(conflict) {
  const { alone, minimal, more } = conflict, rest = more ? ` ${tr("({n} more are not listed)", { n: more })}` : "", marked = tr("They are marked in the drawing.");
  return alone ? `${tr("No plan can keep any of these.")}${rest} ${marked}`
    : minimal ? `${tr("Without any one of these the others can hold.")}${rest} ${marked} ${tr("Take one of the ways out:")}`
    : `${tr("Some of these may have no part in it: that was not shown in the time.")}${rest} ${marked}`;
}

/** Asks what each way would bring, one after the other, where somebody looks: tabs in the back would ask the same. */
/** @type {(work: Work, ways: [HTMLElement, object][], signal: AbortSignal) => Promise<void>} */
async function tryWays(work, ways, signal) {
  for (const [place, said] of ways) {
    await inSight();
    if (signal.aborted) return;
    try {
      const told = await sendServer(work.path("try"), said, signal);
      place.textContent = told.works ? tr("brings {text}", { text: inWords(told.text) }) : inWords(told.text);
      place.className = `said ${told.works ? "good" : "bad"}`;
    } catch (error) {
      place.textContent = signal.aborted ? "" : /** @type {Error} */ (error).message;
    }
  }
}

/** @type {() => Promise<void>} comes back once this tab is seen */
function inSight() {
  return new Promise(seen => {
    const look = () => {
      if (document.visibilityState !== "visible") return;
      document.removeEventListener("visibilitychange", look);
      seen();
    };
    document.addEventListener("visibilitychange", look);
    look();
  });
}

/** @type {(app: any, ids: string[]) => number[]} */
function numbersOf(app, ids) {
  const wanted = new Set(ids);
  return app.data.nest.contours.flatMap((/** @type {any} */ contour, /** @type {number} */ k) => wanted.has(contour.id) ? [k] : []);
}
