import { make } from "./elements.js";
import { tr } from "./say.js";
import { metres, provenShort } from "./words.js";

/**
 * Figures of two plans side by side: as the profile is, and with what is changed.
 *
 * @param {{before: any, after: any, text: string}} told
 * @param {{rule: string, key: string, to: string}[]} changes
 * @returns {HTMLElement}
 */
export function effectTable({ before, after, text }, changes) {
  const rows = [
    [tr("idle travel"), travelled(before, "idle_mm"), travelled(after, "idle_mm")],
    [tr("cost"), travelled(before, "objective_mm"), travelled(after, "objective_mm")],
    [tr("not kept"), countOf(before?.excuses), countOf(after?.excuses)],
    [tr("dropped orders"), countOf(before?.dropped), countOf(after?.dropped)],
    [tr("time"), lasting(before), lasting(after)],
    [tr("proven"), provenOf(before), provenOf(after)],
    ...brokenRules(before, after).map(rule => [tr("breaches of {rule}", { rule }), countOf(before && (before.breaches[rule] ?? 0)), countOf(after && (after.breaches[rule] ?? 0))]),
  ];
  return make("div", {},
    make("table", {},
      make("caption", {}, changes.map(one => `${one.rule}.${one.key}: ${one.to}`).join(", ")),
      make("tr", {}, make("td", {}), make("th", {}, tr("now")), make("th", {}, tr("then"))),
      ...rows.map(([name, a, b]) => make("tr", { class: a === b ? null : "differs" }, make("th", {}, name), make("td", {}, a), make("td", {}, b)))),
    text ? make("p", {}, text) : null,
    make("p", { class: "hint" }, tr("Two first plans of equal work; breaches are counted by the rules as they are now.")));
}

/** @type {(figures: any, key: string) => string} */
function travelled(figures, key) { return figures ? metres(figures[key]) : tr("no plan"); }

/** @type {(count: number | undefined | null) => string} */
function countOf(count) { return count === undefined || count === null ? "–" : String(count); }

/** @type {(figures: any) => string} */
function lasting(figures) { return figures ? `${Math.round(figures.time_s)} s` : "–"; }

/** @type {(figures: any) => string} */
function provenOf(figures) {
  if (!figures) return "–";
  return figures.status === "optimal" ? tr("yes") : provenShort(figures);
}

/** @type {(before: any, after: any) => string[]} */
function brokenRules(before, after) {
  return [...new Set([...Object.keys(before?.breaches ?? {}), ...Object.keys(after?.breaches ?? {})])].sort();
}
