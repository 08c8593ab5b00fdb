/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { comparePlans } from "./views.js";
import { provenShort } from "./words.js";

/**
 * A panel of the plans that were made: a click goes back to one, and to what it was made of; two can be compared.
 *
 * @param {any} app
 * @param {Work} work
 */
export function plansPanel(app, work) {
  const panel = app.panel("plans", "Plans");
  const list = make("ol", { id: "hands-plans" });
  panel.append(make("p", { class: "hint" }, "Click a plan to go back to it, with its locks, or compare it with the one that is shown."), list);
  work.on((_, what) => {
    if (what !== "state") return;
    const best = Math.min(...work.state.alternatives.map((/** @type {any} */ one) => one.figures.light_mm));
    list.replaceChildren(...work.state.alternatives.map((/** @type {any} */ one) => planRow(work, one, best)));
  });
}

/** @type {(work: Work, one: any, best: number) => HTMLElement} */
function planRow(work, one, best) {
  const { light_mm, idle_mm, time_s, excuses } = one.figures, { shown } = work.state;
  const more = light_mm > best + 0.5 ? `, costs ${((light_mm - best) / 1000).toFixed(3)} m more than the least` : ", costs the least";
  const keep = make("button", { type: "button", class: "compare", "aria-pressed": String(one.kept), title: "a plan that is kept is never thrown away",
    onclick: () => work.change("keep", { number: one.number, kept: !one.kept }) }, one.kept ? "kept" : "keep");
  const flags = [stageText(one), !one.of_now && "of the drawing before it was changed", one.stopped && "cancelled", !one.ok && `refused: ${one.broken.join(", ")}`, excuses && `${excuses} excused`, one.upto && `after cut ${one.upto}`];
  const text = `idle ${(idle_mm / 1000).toFixed(3)} m, ${provenShort(one.figures)}, ${Math.round(time_s)} s${more}`;
  const compared = work.compared?.[1] === one.number;
  const compare = one.number === shown ? null : make("button", { type: "button", class: "compare", "aria-pressed": String(compared),
    "aria-label": `compare plan ${one.number} with plan ${shown}`, onclick: () => comparePlans(work, compared ? null : [shown, one.number]) }, "compare");
  return make("li", { value: one.number, class: one.number === shown ? "shown" : "", "aria-current": one.number === shown ? "true" : null },
    make("button", { type: "button", title: one.summary, onclick: () => work.change("back", { to: one.number }) }, text), compare, keep,
    make("small", {}, [...flags.filter(Boolean), ...one.locked].join(" · ")));
}

/** How a plan came, in a planner's words: "first plan", "better by 0.4 m", "proven". */
/** @type {(one: any) => string} */
function stageText({ stage, gained_mm, proven }) {
  const better = gained_mm > 0.5 ? `better by ${(gained_mm / 1000).toFixed(1)} m` : "";
  return stage === "first" ? "first plan" : [better, proven ? "proven" : stage === "better" ? "on the way" : ""].filter(Boolean).join(", ");
}
