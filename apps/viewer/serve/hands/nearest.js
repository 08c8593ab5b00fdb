/**
 * The place of a line that is nearest to a point.
 *
 * @param {ArrayLike<number>} points x, y, x, y, … mm
 * @param {boolean} closed
 * @param {number} x
 * @param {number} y
 * @returns {{x: number, y: number, away: number}} mm
 */
export function nearestOn(points, closed, x, y) {
  const count = points.length / 2;
  let best = { x: points[0], y: points[1], away: Math.hypot(x - points[0], y - points[1]) };
  for (let k = closed ? 0 : 1; k < count; k++) {
    const before = (k + count - 1) % count, ax = points[2 * before], ay = points[2 * before + 1];
    const dx = points[2 * k] - ax, dy = points[2 * k + 1] - ay, length2 = dx * dx + dy * dy;
    const share = length2 > 0 ? Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / length2)) : 0;
    const px = ax + share * dx, py = ay + share * dy, away = Math.hypot(x - px, y - py);
    if (away < best.away) best = { x: px, y: py, away };
  }
  return best;
}

/**
 * The place that is so far along a closed line from its first point, round and round.
 *
 * @param {ArrayLike<number>} points x, y, x, y, … mm
 * @param {number} along mm, less than 0 for the other way round
 * @returns {{x: number, y: number}} mm
 */
export function placeAlong(points, along) {
  const count = points.length / 2;
  const sides = Array.from({ length: count }, (_, k) => {
    const next = (k + 1) % count;
    return Math.hypot(points[2 * next] - points[2 * k], points[2 * next + 1] - points[2 * k + 1]);
  });
  const all = sides.reduce((sum, side) => sum + side, 0);
  let left = all > 0 ? ((along % all) + all) % all : 0, k = 0;
  while (k < count - 1 && left > sides[k]) left -= sides[k++];
  const next = (k + 1) % count, share = sides[k] > 0 ? left / sides[k] : 0;
  return { x: points[2 * k] + share * (points[2 * next] - points[2 * k]), y: points[2 * k + 1] + share * (points[2 * next + 1] - points[2 * k + 1]) };
}
