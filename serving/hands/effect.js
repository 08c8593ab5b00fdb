import { make } from "./elements.js";

const METRE_MM = 1000;

/** @type {(mm: number | undefined) => string} */
const metres = mm => mm === undefined ? "no plan" : `${(mm / METRE_MM).toFixed(3)} m`;

/**
 * Figures of two plans side by side: as the profile is, and with what is changed.
 *
 * @param {{before: any, after: any, text: string}} told
 * @param {{rule: string, key: string, to: string}[]} changes
 * @returns {HTMLElement}
 */
export function effectTable({ before, after, text }, changes) {
  const rows = [
    ["idle travel", metres(before?.idle_mm), metres(after?.idle_mm)],
    ["cost", metres(before?.objective_mm), metres(after?.objective_mm)],
    ["excused", told(before?.excuses), told(after?.excuses)],
    ["dropped orders", told(before?.dropped), told(after?.dropped)],
    ["time", seconds(before), seconds(after)],
    ["proven", proven(before), proven(after)],
    ...broken(before, after).map(rule => [`breaches of ${rule}`, told(before && (before.breaches[rule] ?? 0)), told(after && (after.breaches[rule] ?? 0))]),
  ];
  return make("div", {},
    make("table", {},
      make("caption", {}, changes.map(one => `${one.rule}.${one.key}: ${one.to}`).join(", ")),
      make("tr", {}, make("th", {}, ""), make("th", {}, "now"), make("th", {}, "then")),
      ...rows.map(([name, a, b]) => make("tr", { class: a === b ? null : "differs" }, make("th", {}, name), make("td", {}, a), make("td", {}, b)))),
    text ? make("p", {}, text) : null,
    make("p", { class: "hint" }, "Two first plans of equal work; breaches are counted by the rules as they are now."));
}

/** @type {(count: number | undefined | null) => string} */
function told(count) { return count === undefined || count === null ? "–" : String(count); }

/** @type {(figures: any) => string} */
function seconds(figures) { return figures ? `${Math.round(figures.time_s)} s` : "–"; }

/** @type {(figures: any) => string} */
function proven(figures) {
  if (!figures) return "–";
  return figures.status === "optimal" ? "yes" : figures.gap === null ? "no bound" : `gap ${(figures.gap * 100).toFixed(1)} %`;
}

/** @type {(before: any, after: any) => string[]} */
function broken(before, after) {
  return [...new Set([...Object.keys(before?.breaches ?? {}), ...Object.keys(after?.breaches ?? {})])].sort();
}
