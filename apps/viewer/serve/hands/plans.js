/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { figure, tr, trn } from "./say.js";
import { comparePlans } from "./views.js";
import { clock, metres, provenShort } from "./words.js";

/**
 * A panel of the plans that were made: a click goes back to one, and to what it was made of; two can be compared.
 *
 * @param {any} app
 * @param {Work} work
 */
export function plansPanel(app, work) {
  const panel = app.panel("plans", tr("Plans"));
  const list = make("ol", { id: "hands-plans" });
  panel.append(make("p", { class: "hint" }, tr("Click a plan to go back to it, with its locks, or compare it with the one that is shown.")), list);
  work.on((_, what) => {
    if (what !== "state") return;
    const best = Math.min(...work.state.alternatives.map((/** @type {any} */ one) => one.figures.light_mm));
    list.replaceChildren(...work.state.alternatives.map((/** @type {any} */ one) => planRow(work, one, best)));
  });
}

/** @type {(work: Work, one: any, best: number) => HTMLElement} */
function planRow(work, one, best) {
  const { light_mm, idle_mm, time_s, excuses, unkept = excuses } = one.figures, { shown } = work.state;
  const keep = make("button", { type: "button", class: "keep", "aria-pressed": String(one.kept), title: tr("a plan that is kept is never thrown away"),
    onclick: () => work.change("keep", { number: one.number, kept: !one.kept }) }, one.kept ? tr("kept") : tr("keep"));
  const more = light_mm > best + 0.5 ? tr("costs {more} more than the least", { more: metres(light_mm - best) }) : tr("costs the least");
  const flags = [stageText(one), one.unpriced && tr("overheats are not counted"), !one.of_now && tr("of the drawing before it was changed"), one.stopped && tr("cancelled"), one.upto && tr("after cut {upto}", { upto: one.upto })];
  const text = [tr("idle {idle}", { idle: metres(idle_mm) }), provenShort(one.figures), clock(time_s), more].join(", ");
  const state = one.ok && !one.checked ? ["warn", tr("program not checked yet")] : !one.ok ? ["bad", tr("refused: {rules}", { rules: one.broken.join(", ") })] : unkept ? ["warn", trn("{n} place not kept", "{n} places not kept", unkept)] : ["good", tr("every hard rule holds")];
  const compared = work.compared?.[1] === one.number;
  const compare = one.number === shown ? null : make("button", { type: "button", class: "compare", "aria-pressed": String(compared),
    "aria-label": tr("compare plan {number} with plan {shown}", { number: one.number, shown }), onclick: () => comparePlans(work, compared ? null : [shown, one.number]) }, tr("compare"));
  return make("li", { value: one.number, class: one.number === shown ? "shown" : "", "aria-current": one.number === shown ? "true" : null },
    make("button", { type: "button", title: one.summary, onclick: () => work.change("back", { to: one.number }) }, text), compare, keep, " ", make("span", { class: `chip ${state[0]}` }, state[1]),
    make("small", {}, [...flags.filter(Boolean), ...one.locked].join(" · ")));
}

/** How a plan came, in a planner's words: "first plan", "better by 0.4 m". */
/** @type {(one: any) => string} */
function stageText({ stage, gained_mm, proven }) {
  const better = gained_mm > 0.5 ? tr("better by {mm} m", { mm: figure(gained_mm / 1000, 1) }) : "";
  return stage === "first" ? tr("first plan") : [better, stage === "better" && !proven ? tr("on the way") : ""].filter(Boolean).join(", ");
}
