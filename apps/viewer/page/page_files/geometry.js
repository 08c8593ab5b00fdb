/** Curves as flat lists of points: x, y, x, y, … mm. Nothing here knows a screen. */

/**
 * The points of a curve, chords no farther from it than the tolerance. A closed one does not repeat its first point.
 *
 * @param {ArrayLike<number>} rows x, y, bulge of each vertex
 * @param {boolean} closed
 * @param {number} tolerance mm
 * @returns {Float64Array}
 */
export function flattened(rows, closed, tolerance) {
  const points = [];
  const count = rows.length / 3;
  for (let k = 0; k < count; k++) {
    const x = rows[3 * k], y = rows[3 * k + 1], bulge = rows[3 * k + 2];
    points.push(x, y);
    const last = k === count - 1;
    if (bulge === 0 || (last && !closed)) continue;
    const after = last ? 0 : 3 * (k + 1);
    pushArc(points, x, y, rows[after], rows[after + 1], bulge, tolerance);
  }
  return Float64Array.from(points);
}

/**
 * The points of an arc between its ends, both left out; bulge = tan(sweep / 4).
 *
 * @param {number[]} points
 * @param {number} x0
 * @param {number} y0
 * @param {number} x1
 * @param {number} y1
 * @param {number} bulge
 * @param {number} tolerance mm
 */
function pushArc(points, x0, y0, x1, y1, bulge, tolerance) {
  const chord = Math.hypot(x1 - x0, y1 - y0);
  if (chord === 0) return;
  const sweep = 4 * Math.atan(bulge), radius = chord / 2 / Math.sin(sweep / 2);
  const size = Math.abs(radius);
  const step = 2 * Math.acos(Math.max(-1, Math.min(1, 1 - tolerance / size)));
  const pieces = Math.min(256, Math.max(1, Math.ceil(Math.abs(sweep) / Math.max(step, 1e-3))));
  const towards = Math.atan2(y1 - y0, x1 - x0) + Math.PI / 2 - sweep / 2;
  const cx = x0 + radius * Math.cos(towards), cy = y0 + radius * Math.sin(towards);
  const from = Math.atan2(y0 - cy, x0 - cx);
  for (let k = 1; k < pieces; k++) {
    const angle = from + (sweep * k) / pieces;
    points.push(cx + size * Math.cos(angle), cy + size * Math.sin(angle));
  }
}

/**
 * Fewer points, none of those left out farther from the line than the tolerance (Douglas and Peucker).
 *
 * @param {Float64Array} points
 * @param {number} tolerance mm
 * @returns {Float64Array}
 */
export function simplified(points, tolerance) {
  const count = points.length / 2;
  if (count < 3) return points;
  const keep = new Uint8Array(count);
  keep[0] = keep[count - 1] = 1;
  const open = [[0, count - 1]];
  for (let pair = open.pop(); pair; pair = open.pop()) {
    const [a, b] = pair;
    let far = tolerance, at = -1;
    for (let k = a + 1; k < b; k++) {
      const away = distanceToSegment(points[2 * k], points[2 * k + 1],
        points[2 * a], points[2 * a + 1], points[2 * b], points[2 * b + 1]);
      if (away > far) { far = away; at = k; }
    }
    if (at > 0) { keep[at] = 1; open.push([a, at], [at, b]); }
  }
  const left = [];
  for (let k = 0; k < count; k++) if (keep[k]) left.push(points[2 * k], points[2 * k + 1]);
  return Float64Array.from(left);
}

/**
 * @param {number} x
 * @param {number} y
 * @param {number} ax
 * @param {number} ay
 * @param {number} bx
 * @param {number} by
 * @returns {number}
 */
export function distanceToSegment(x, y, ax, ay, bx, by) {
  const dx = bx - ax, dy = by - ay, length2 = dx * dx + dy * dy;
  const share = length2 > 0 ? Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / length2)) : 0;
  return Math.hypot(x - ax - share * dx, y - ay - share * dy);
}

/**
 * How far a place lies from a line.
 *
 * @param {ArrayLike<number>} points
 * @param {boolean} closed
 * @param {number} x
 * @param {number} y
 * @returns {number}
 */
export function distanceTo(points, closed, x, y) {
  const count = points.length / 2;
  let least = count === 1 ? Math.hypot(x - points[0], y - points[1]) : Infinity;
  for (let k = closed ? 0 : 1; k < count; k++) {
    const before = (k + count - 1) % count;
    least = Math.min(least, distanceToSegment(x, y,
      points[2 * before], points[2 * before + 1], points[2 * k], points[2 * k + 1]));
  }
  return least;
}

/**
 * Whether a place lies inside a ring.
 *
 * @param {ArrayLike<number>} points
 * @param {number} x
 * @param {number} y
 * @returns {boolean}
 */
export function inside(points, x, y) {
  let within = false;
  for (let k = 0, before = points.length - 2; k < points.length; before = k, k += 2) {
    const ay = points[before + 1], by = points[k + 1];
    if (ay > y !== by > y && x < ((points[before] - points[k]) * (y - by)) / (ay - by) + points[k]) within = !within;
  }
  return within;
}

/**
 * xmin, ymin, xmax, ymax of points.
 *
 * @param {ArrayLike<number>} points
 * @returns {[number, number, number, number]}
 */
export function boundsOf(points) {
  let x0 = Infinity, y0 = Infinity, x1 = -Infinity, y1 = -Infinity;
  for (let k = 0; k < points.length; k += 2) {
    x0 = Math.min(x0, points[k]);
    x1 = Math.max(x1, points[k]);
    y0 = Math.min(y0, points[k + 1]);
    y1 = Math.max(y1, points[k + 1]);
  }
  return [x0, y0, x1, y1];
}
