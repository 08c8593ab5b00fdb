/** @import { CutData, Point, SideData } from "./types.js" */

/**
 * One stretch of the program. `cut` is the number of the cut, from 0, that it belongs to; the way home has that of the
 * last.
 *
 * @typedef {object} Moment
 * @property {"travel" | "wait" | "pierce" | "cut" | "home"} does
 * @property {number} from_s
 * @property {number} to_s
 * @property {number} cut
 * @property {Point} from
 * @property {Point} to
 */

/**
 * The program from its start to its end, without a gap.
 *
 * @typedef {object} Timeline
 * @property {Moment[]} moments
 * @property {number[]} ends_s when each cut is done
 * @property {number[]} begins_s when the torch begins each
 * @property {number[]} firsts the cuts that the first torch makes
 * @property {number} end_s
 * @property {boolean} timed whether the plan says its times; else they are guessed
 */

const GUESSED_CUT_MM_S = 50, GUESSED_TRAVEL_MM_S = 300;

/**
 * @param {SideData} side
 * @returns {Timeline}
 */
export function timelineOf(side) {
  const timed = side.cuts.some(cut => cut.to_s > 0);
  /** @type {Moment[]} */
  const moments = [];
  const begins_s = /** @type {number[]} */ ([]), ends_s = /** @type {number[]} */ ([]), firsts = /** @type {number[]} */ ([]);
  let now = 0, at = side.home;
  /** @type {(does: Moment["does"], to_s: number, cut: number, to: Point) => void} */
  const add = (does, to_s, cut, to) => {
    if (to_s > now || does === "cut") moments.push({ does, from_s: now, to_s: Math.max(now, to_s), cut, from: at, to });
    now = Math.max(now, to_s);
    at = to;
  };
  side.cuts.forEach((cut, k) => {
    if (withFirst(cut)) {
      begins_s.push(begins_s[k - 1]);
      ends_s.push(ends_s[k - 1]);
      return;
    }
    firsts.push(k);
    for (const hole of side.pierces.filter(pierce => pierce.before === side.made + k + 1)) {
      add("travel", hole.from_s, k, hole.at);
      add("pierce", hole.to_s, k, hole.at);
    }
    const begin = startOf(cut), times = timed ? cut : guessed(cut, now, at, begin);
    if (!cut.linked) add("travel", times.from_s - cut.wait_s, k, begin);
    add("wait", times.from_s, k, begin);
    begins_s.push(now);
    add("pierce", Math.min(times.from_s + cut.stand_s, times.to_s), k, begin);
    add("cut", times.to_s, k, endOf(cut));
    ends_s.push(now);
  });
  const homing_s = timed ? side.end_s : now + distance(at, side.home) / GUESSED_TRAVEL_MM_S;
  add("home", homing_s, firsts.at(-1) ?? -1, side.home);
  return { moments, begins_s, ends_s, firsts, end_s: now, timed };
}

/** Whether a further torch makes a cut, with the first one and by its motion. */
/** @type {(cut: CutData | undefined) => boolean} */
export function withFirst(cut) {
  return (cut?.torch ?? 1) > 1;
}

/**
 * @param {CutData} cut
 * @param {number} now
 * @param {Point} at
 * @param {Point} begin
 * @returns {{from_s: number, to_s: number}}
 */
function guessed(cut, now, at, begin) {
  const from_s = now + (cut.linked ? 0 : distance(at, begin) / GUESSED_TRAVEL_MM_S);
  return { from_s, to_s: from_s + cut.length_mm / GUESSED_CUT_MM_S };
}

/** @type {(a: Point, b: Point) => number} */
function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** @type {(cut: CutData) => Point} */
export function startOf(cut) {
  return [cut.path[0], cut.path[1]];
}

/** @type {(cut: CutData) => Point} */
export function endOf(cut) {
  return [cut.path[cut.path.length - 3], cut.path[cut.path.length - 2]];
}

/**
 * What happens at a time: the moment, how much of it has passed, and how many cuts are done.
 *
 * @param {Timeline} timeline
 * @param {number} time_s
 * @returns {{moment: Moment | null, share: number, done: number}}
 */
export function momentAt(timeline, time_s) {
  const done = countUpTo(timeline.ends_s, time_s);
  const k = firstAfter(timeline.moments, time_s);
  if (k < 0) return { moment: null, share: 1, done };
  const moment = timeline.moments[k];
  const long = moment.to_s - moment.from_s;
  return { moment, share: long > 0 ? (time_s - moment.from_s) / long : 1, done };
}

/**
 * The first moment that ends after a time; -1 at the end.
 *
 * @param {Moment[]} moments
 * @param {number} time_s
 * @returns {number}
 */
function firstAfter(moments, time_s) {
  let low = 0, high = moments.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (moments[middle].to_s > time_s) high = middle;
    else low = middle + 1;
  }
  return low < moments.length ? low : -1;
}

/**
 * How many of the numbers, which rise, are no greater than a limit.
 *
 * @param {ArrayLike<number>} rising
 * @param {number} limit
 * @returns {number}
 */
export function countUpTo(rising, limit) {
  let low = 0, high = rising.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (rising[middle] <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

/**
 * The zones in the order in which they are cut: each with its first and last second.
 *
 * @param {SideData} side
 * @param {Timeline} timeline
 * @returns {{zone: number, from_s: number, to_s: number}[]}
 */
export function zonesOf(side, timeline) {
  /** @type {{zone: number, from_s: number, to_s: number}[]} */
  const zones = [];
  side.cuts.forEach((cut, k) => {
    const last = zones[zones.length - 1];
    if (last && last.zone === cut.zone) last.to_s = timeline.ends_s[k];
    else zones.push({ zone: cut.zone, from_s: last ? last.to_s : 0, to_s: timeline.ends_s[k] });
  });
  return zones;
}
