/** @import { CutData } from "./types.js" */
import { flattened } from "./geometry.js";

const WAY_CHORD_MM = 0.05;

/**
 * The way of the torch in one cut: points, and the share of its moving time that has passed at each.
 *
 * @typedef {object} Way
 * @property {Float64Array} points
 * @property {Float64Array} along mm from the start, at each point
 * @property {Float64Array} share 0 … 1, at each point
 */

/**
 * @param {CutData} cut
 * @returns {Way}
 */
export function wayOf(cut) {
  const slow = cut.slow.length ? stretches(cut) : null;
  const points = slow ? slow.points : flattened(cut.path, false, WAY_CHORD_MM);
  const count = points.length / 2;
  const along = new Float64Array(count), share = new Float64Array(count);
  for (let k = 1; k < count; k++) {
    const step = Math.hypot(points[2 * k] - points[2 * k - 2], points[2 * k + 1] - points[2 * k - 1]);
    along[k] = along[k - 1] + step;
    share[k] = share[k - 1] + step * (slow ? slow.slower[k] : 1);
  }
  const all = share[count - 1];
  for (let k = 0; k < count; k++) share[k] = all > 0 ? share[k] / all : 1;
  return { points, along, share };
}

/**
 * The points of a way whose lines and arcs are not all as fast, and how many times slower each point is reached.
 *
 * @param {CutData} cut
 * @returns {{points: Float64Array, slower: number[]}}
 */
function stretches(cut) {
  const all = [cut.path[0], cut.path[1]], slower = [1];
  for (let k = 0; 3 * (k + 1) < cut.path.length; k++) {
    const piece = flattened(cut.path.slice(3 * k, 3 * k + 6), false, WAY_CHORD_MM);
    for (let j = 2; j < piece.length; j += 2) {
      all.push(piece[j], piece[j + 1]);
      slower.push(cut.slow[k] ?? 1);
    }
  }
  return { points: Float64Array.from(all), slower };
}

/**
 * Where the torch is when a share of its moving time has passed: the place, the last point passed, and mm so far.
 *
 * @param {Way} way
 * @param {number} share 0 … 1
 * @returns {{x: number, y: number, passed: number, along: number}}
 */
export function placeOn(way, share) {
  const last = way.share.length - 1;
  let low = 0, high = last;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (way.share[middle] <= share) low = middle;
    else high = middle - 1;
  }
  const at = 2 * low;
  if (low === last) return { x: way.points[at], y: way.points[at + 1], passed: low, along: way.along[low] };
  const step = way.share[low + 1] - way.share[low];
  const part = step > 0 ? (share - way.share[low]) / step : 0;
  return {
    x: way.points[at] + part * (way.points[at + 2] - way.points[at]),
    y: way.points[at + 1] + part * (way.points[at + 3] - way.points[at + 1]),
    passed: low,
    along: way.along[low] + part * (way.along[low + 1] - way.along[low]),
  };
}
