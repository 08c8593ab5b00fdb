/** @import { StateData } from "./types.js" */
/** Numbers for people. */
import { figure, language, tr, trn } from "./say.js";

/** @type {(s: number) => string} */
export function clock(s) {
  const whole = Math.max(0, Math.floor(s + 1e-6));
  const h = Math.floor(whole / 3600), m = Math.floor(whole / 60) % 60, rest = String(whole % 60).padStart(2, "0");
  return h ? `${h}:${String(m).padStart(2, "0")}:${rest}` : `${m}:${rest}`;
}

/** @type {(mm: number) => string} */
export function metres(mm) {
  return `${figure(mm / 1000, 3)} m`;
}

/** @type {(mm: number) => string} */
export function millimetres(mm) {
  return mm >= 1000 ? metres(mm) : `${figure(mm, mm < 100 ? 1 : 0)} mm`;
}

/** @type {(share: number) => string} */
export function percent(share) {
  return `${figure(100 * share, 1)} %`;
}

/**
 * The proof of a plan, in the words of a planner; what excused places weigh is left out.
 *
 * @param {{status: string, gap: number | null, light_gap: number | null}} figures
 * @returns {string}
 */
export function proven({ status, gap, light_gap }) {
  if (status === "optimal") return tr("proven best");
  if (gap === null) return tr("nothing proven");
  const most = tr("at most {share} from the best", { share: percent(light_gap ?? gap) });
  return light_gap === null ? most : tr("{most} (places that are not kept aside)", { most });
}

/**
 * The same in few words, for a list: excuses are counted apart there.
 *
 * @param {{status: string, gap: number | null, light_gap: number | null}} figures
 * @returns {string}
 */
export function provenShort({ status, gap, light_gap }) {
  return status === "optimal" ? tr("proven") : gap === null ? tr("nothing proven") : tr("gap {share}", { share: percent(light_gap ?? gap) });
}

/**
 * What a planning has come to: the plan that is shown, and that it stays where the one made anew at the end is dearer.
 *
 * @type {(alternatives: any[], shown: number) => string}
 */
export function reachedPlan(alternatives, shown) {
  const plan = alternatives.find(one => one.number === shown), last = alternatives.at(-1);
  if (!plan) return "";
  const text = tr("plan {number}: idle {idle}, {proof}", { number: shown, idle: metres(plan.figures.idle_mm), proof: provenShort(plan.figures) });
  const dearer = last.run === plan.run && last.stage === "final" && last.number > shown;
  return dearer ? `${text}; ${tr("it stays: plan {other}, made anew, is dearer", { other: last.number })}` : text;
}

/** @type {(place: readonly number[]) => string} */
export function placeText(place) {
  return `(${figure(place[0], 1)}; ${figure(place[1], 1)})`.replace("; ", language() === "en" ? ", " : "; ");
}

/** What the chip says of a plan's hard rules; of one that is unchecked the plan alone was judged, and no program. */
/** @type {(state: StateData, unchecked?: boolean) => string} */
export function stateText(state, unchecked = false) {
  if (unchecked && state.kind !== "broken") return tr("program not checked yet");
  if (state.kind === "kept but for") return trn("{n} place not kept", "{n} places not kept", state.count ?? 0);
  return state.kind === "kept" ? tr("every hard rule holds") : tr("a hard rule is broken");
}

/** What a contour is. */
/** @type {(kind: import("./types.js").Kind) => string} */
export function kindText(kind) {
  return { outer: tr("outer contour"), hole: tr("hole"), mark: tr("mark"), slit: tr("slit"), scrap: tr("scrap line") }[kind];
}

/** Which way round a contour is cut. */
/** @type {(direction: string) => string} */
export function wayText(direction) {
  return { cw: tr("cw"), ccw: tr("ccw") }[direction] ?? direction;
}

/** How strong a rule is. */
/** @type {(strength: string) => string} */
export function strengthText(strength) {
  return { hard: tr("hard"), soft: tr("soft"), off: tr("off") }[strength] ?? strength;
}

/** Green over a plan that keeps them all, amber where some places are not kept or it is unchecked, red where it is broken. */
/** @type {(state: StateData, unchecked?: boolean) => string} */
export function stateClass(state, unchecked = false) {
  return { kept: unchecked ? "warn" : "good", "kept but for": "warn", broken: "bad" }[state.kind];
}
