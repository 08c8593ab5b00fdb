/** @import { StateData } from "./types.js" */
/** Numbers for people. */

/** @type {(s: number) => string} */
export function clock(s) {
  const whole = Math.max(0, Math.floor(s + 1e-6));
  const h = Math.floor(whole / 3600), m = Math.floor(whole / 60) % 60, rest = String(whole % 60).padStart(2, "0");
  return h ? `${h}:${String(m).padStart(2, "0")}:${rest}` : `${m}:${rest}`;
}

/** @type {(mm: number) => string} */
export function metres(mm) {
  return `${(mm / 1000).toFixed(3)} m`;
}

/** @type {(mm: number) => string} */
export function millimetres(mm) {
  return mm >= 1000 ? metres(mm) : `${mm.toFixed(mm < 100 ? 1 : 0)} mm`;
}

/** @type {(count: number, word: string) => string} */
export function counted(count, word) {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

/** @type {(share: number) => string} */
export function percent(share) {
  return `${(100 * share).toFixed(1)} %`;
}

/**
 * The proof of a plan: its gap, with and without the weight of excuses.
 *
 * @param {{status: string, gap: number | null, light_gap: number | null}} figures
 * @returns {string}
 */
export function proven({ status, gap, light_gap }) {
  if (status === "optimal") return "proven best";
  if (gap === null) return "no bound";
  return `gap ${percent(gap)}${light_gap === null ? "" : `, ${percent(light_gap)} without the weight of excuses`}`;
}

/**
 * The same in few words, for a list: excuses are counted apart there.
 *
 * @param {{status: string, gap: number | null, light_gap: number | null}} figures
 * @returns {string}
 */
export function provenShort({ status, gap, light_gap }) {
  return status === "optimal" ? "proven" : gap === null ? "no bound" : `gap ${percent(light_gap ?? gap)}`;
}

/** @type {(place: readonly number[]) => string} */
export function placeText(place) {
  return `(${place[0].toFixed(1)}, ${place[1].toFixed(1)})`;
}

/** What the chip says of a plan's hard rules. */
/** @type {(state: StateData) => string} */
export function stateText(state) {
  return { kept: "every hard rule holds", "kept but for": state.short, broken: "a hard rule is broken" }[state.kind];
}

/** Green over a plan that keeps them all, amber where some places are not kept, red where it is broken. */
/** @type {(state: StateData) => string} */
export function stateClass(state) {
  return { kept: "good", "kept but for": "warn", broken: "bad" }[state.kind];
}
