/** @import { CutData } from "./types.js" */
/** Zones as areas of the sheet. Nothing here knows a screen. */

/**
 * @typedef {object} ZoneArea
 * @property {number} zone
 * @property {number} cuts how many
 * @property {number} last number of its last cut, from 0
 * @property {[number, number]} middle mm
 * @property {number[]} hull x, y, … mm: the least convex ring around its contours
 */

/**
 * The zones of an order, first to last.
 *
 * @param {CutData[]} cuts
 * @param {[number, number, number, number][]} bounds of all contours
 * @returns {ZoneArea[]}
 */
export function zoneAreas(cuts, bounds) {
  /** @type {Map<number, {points: [number, number][], cuts: number, last: number}>} */
  const found = new Map();
  cuts.forEach((cut, k) => {
    const of = found.get(cut.zone) ?? { points: [], cuts: 0, last: 0 }, [x0, y0, x1, y1] = bounds[cut.contour];
    of.points.push([x0, y0], [x1, y0], [x1, y1], [x0, y1]);
    of.cuts += 1;
    of.last = k;
    found.set(cut.zone, of);
  });
  return [...found].map(([zone, of]) => {
    const hull = hullOf(of.points), count = hull.length / 2;
    const sum = (/** @type {number} */ by) => hull.filter((_, k) => k % 2 === by).reduce((a, b) => a + b, 0);
    return { zone, cuts: of.cuts, last: of.last, hull, middle: [sum(0) / count, sum(1) / count] };
  });
}

/**
 * The least convex ring around points, counter-clockwise (Andrew's monotone chain).
 *
 * @param {[number, number][]} points
 * @returns {number[]} x, y, …
 */
export function hullOf(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  /** @type {(way: [number, number][]) => [number, number][]} */
  const half = way => {
    /** @type {[number, number][]} */
    const ring = [];
    for (const p of way) {
      while (ring.length > 1 && turn(ring[ring.length - 2], ring[ring.length - 1], p) <= 0) ring.pop();
      ring.push(p);
    }
    ring.pop();
    return ring;
  };
  if (sorted.length < 3) return sorted.flat();
  return [...half(sorted), ...half(sorted.reverse())].flat();
}

/** @type {(a: [number, number], b: [number, number], c: [number, number]) => number} over 0 where b to c turns left */
function turn(a, b, c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
