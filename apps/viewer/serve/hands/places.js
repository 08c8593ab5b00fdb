/** Where a row is dropped, and how its list scrolls meanwhile. Nothing here knows a screen. */
const EDGE_PX = 40;

/**
 * How fast a list scrolls under a pointer: -1 … 1, 0 where the pointer is not near its ends.
 *
 * @param {{top: number, bottom: number}} box
 * @param {number} y
 * @returns {number}
 */
export function scrolledBy({ top, bottom }, y) {
  if (y < top + EDGE_PX) return Math.max(-1, (y - top - EDGE_PX) / EDGE_PX);
  return y > bottom - EDGE_PX ? Math.min(1, (y - bottom + EDGE_PX) / EDGE_PX) : 0;
}

/**
 * Where the first of a run is cut, from 1, that is dropped on a row: the row's place, or the run ends there.
 *
 * @param {{names: string[], from: number, to: number}} drag
 * @returns {number}
 */
export function placeOf({ names, from, to }) {
  return Math.max(1, to > from ? to + 2 - names.length : to + 1);
}
