/** @import { Camera } from "./camera.js" */
/** @import { Palette } from "./palette.js" */
/** @import { Scenery } from "./scenery.js" */
/** @import { SideData } from "./types.js" */
import { pen, trace, write } from "./brush.js";
import { endOf, startOf, withFirst } from "./timeline.js";
import { placeOn } from "./way.js";

const MOST_DASHED = 500;
const ARROW_SQUARE_PX = 46, DOT_SQUARE_PX = 11, LEAST_ARROW_PX = 18, LEAST_TURN_PX = 26, AHEAD_PX = 14, PIERCE_PX = 1.9, AT_ENTRY_MM = 0.1, STARTS_AT_ONCE = 100;

/**
 * All travel: pale where it is to come, dark where it has been made; an arrow on each move that has room for one.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {SideData} side
 * @param {number} done cuts
 * @param {{wide: number, high: number}} size pixels
 * @returns {Generator<void, void, void>}
 */
export function* paintRoute(context, camera, palette, side, done, size) {
  const { home } = side, squares = new Squares(ARROW_SQUARE_PX), cuts = side.cuts.filter(cut => !withFirst(cut));
  const made = cuts.length - side.cuts.slice(done).filter(cut => !withFirst(cut)).length;
  /** @type {[number, number, string, number][]} */
  const stretches = [[made + 1, cuts.length, palette.ink.done, 0.8], [0, made, palette.ink.travel, 1.1]];
  for (const [from, to, colour, width] of stretches) {
    context.beginPath();
    const heads = new Path2D();
    for (let k = from; k <= to && k <= cuts.length; k++) {
      if (k < cuts.length && cuts[k].linked) continue;
      const a = camera.toScreen(...(k ? endOf(cuts[k - 1]) : home)), b = camera.toScreen(...(k < cuts.length ? startOf(cuts[k]) : home));
      context.moveTo(...a);
      context.lineTo(...b);
      const long = Math.hypot(b[0] - a[0], b[1] - a[1]), x = a[0] + 0.55 * (b[0] - a[0]), y = a[1] + 0.55 * (b[1] - a[1]);
      const seen = x > 0 && y > 0 && x < size.wide && y < size.high;
      if (long > LEAST_ARROW_PX && seen && squares.take(x, y)) head(heads, x, y, (b[0] - a[0]) / long, (b[1] - a[1]) / long, 5);
    }
    pen(context, colour, width, cuts.length < MOST_DASHED ? [5, 4] : []);
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1.4;
    context.stroke(heads);
    yield;
  }
}

/**
 * Where each cut is pierced, the lead from there, and which way it goes round: where cuts lie dense, some of them.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {number[]} seen contours
 * @returns {Generator<void, void, void>}
 */
export function* paintStarts(context, camera, palette, scenery, seen) {
  const dots = new Squares(DOT_SQUARE_PX), arrows = new Squares(ARROW_SQUARE_PX), leads = new Path2D(), pierces = new Path2D(), ways = new Path2D();
  for (const [place, k] of seen.entries()) {
    if (place % STARTS_AT_ONCE === STARTS_AT_ONCE - 1) yield;
    const number = scenery.cutOf.get(k);
    if (number === undefined) continue;
    const cut = scenery.cuts[number], [x, y] = camera.toScreen(...startOf(cut));
    if (!dots.take(x, y)) continue;
    if (!cut.linked) {
      pierces.moveTo(x + PIERCE_PX, y);
      pierces.arc(x, y, PIERCE_PX, 0, 7);
    }
    const [ex, ey] = camera.toScreen(...cut.entry);
    if (Math.hypot(ex - x, ey - y) > 1) {
      leads.moveTo(x, y);
      const { points } = scenery.way(number), near = (scenery.side?.kerf_mm ?? 0) / 2 + AT_ENTRY_MM;
      const joins = joinOf(points, cut.entry, near);
      for (let n = 1; n <= joins; n++) leads.lineTo(...camera.toScreen(points[2 * n], points[2 * n + 1]));
    }
    const [x0, y0, x1, y1] = scenery.outlines.bounds[k];
    if (Math.max(x1 - x0, y1 - y0) * camera.scale < LEAST_TURN_PX || !arrows.take(ex, ey)) continue;
    const way = scenery.way(number), ahead = placeOn(way, Math.min(0.6, AHEAD_PX / camera.scale / Math.max(1, way.along[way.along.length - 1])));
    const more = placeOn(way, Math.min(0.65, (AHEAD_PX + 4) / camera.scale / Math.max(1, way.along[way.along.length - 1])));
    const [ax, ay] = camera.toScreen(ahead.x, ahead.y), [bx, by] = camera.toScreen(more.x, more.y), long = Math.hypot(bx - ax, by - ay);
    if (long > 0.5) head(ways, ax, ay, (bx - ax) / long, (by - ay) / long, 6);
  }
  pen(context, palette.ink.pierce, 1.1);
  context.stroke(leads);
  context.lineWidth = 1.6;
  context.stroke(ways);
  context.fillStyle = palette.ink.pierce;
  context.fill(pierces);
}

/** The point of a way at which its lead joins the contour, half a kerf from the entry; 0 where it has no lead. */
/** @type {(points: ArrayLike<number>, entry: readonly number[], near: number) => number} */
export function joinOf(points, entry, near) {
  for (let n = 0; n < points.length / 2; n++) {
    if (Math.hypot(points[2 * n] - entry[0], points[2 * n + 1] - entry[1]) <= near) return n;
  }
  return 0;
}

/** @type {(path: Path2D, x: number, y: number, dx: number, dy: number, size: number) => void} the head of an arrow, its direction of length 1 */
function head(path, x, y, dx, dy, size) {
  path.moveTo(x - size * dx + 0.55 * size * dy, y - size * dy - 0.55 * size * dx);
  path.lineTo(x, y);
  path.lineTo(x - size * dx - 0.55 * size * dy, y - size * dy + 0.55 * size * dx);
}

/** Squares of the drawing, each of which holds one thing: so that what lies dense is thinned out. */
class Squares {
  /** @param {number} size pixels */
  constructor(size) {
    this.size = size;
    /** @type {Set<number>} */
    this.taken = new Set();
  }

  /** Whether the square of a place is free; it is taken then. */
  /** @type {(x: number, y: number) => boolean} */
  take(x, y) {
    const key = Math.floor(x / this.size) * 100003 + Math.floor(y / this.size);
    if (this.taken.has(key)) return false;
    this.taken.add(key);
    return true;
  }
}

/**
 * Zones as areas, with their numbers and how they follow each other: of a nest whose contours are too small to be told apart.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {number} done cuts
 */
export function paintZones(context, camera, palette, scenery, done) {
  const { zones } = scenery, { ink } = palette;
  zones.forEach(({ zone, hull, last }) => {
    context.beginPath();
    trace(context, camera, Float64Array.from(hull), true);
    context.globalAlpha = last < done ? 0.25 : 0.6;
    context.fillStyle = zone ? palette.zones[(zone - 1) % 8] : ink.part;
    context.fill();
    context.globalAlpha = 1;
    pen(context, ink.outer, 1.2);
    context.stroke();
  });
  context.beginPath();
  const heads = new Path2D();
  zones.forEach(({ middle }, k) => {
    if (!k) return;
    const a = camera.toScreen(...zones[k - 1].middle), b = camera.toScreen(...middle), long = Math.hypot(b[0] - a[0], b[1] - a[1]);
    context.moveTo(...a);
    context.lineTo(...b);
    if (long > LEAST_ARROW_PX) head(heads, a[0] + 0.55 * (b[0] - a[0]), a[1] + 0.55 * (b[1] - a[1]), (b[0] - a[0]) / long, (b[1] - a[1]) / long, 7);
  });
  pen(context, ink.travel, 1.4);
  context.stroke();
  context.stroke(heads);
  context.font = "700 13px system-ui, 'DejaVu Sans', sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  const free = new Squares(30);
  for (const { zone, middle, cuts } of zones) {
    const [x, y] = camera.toScreen(...middle);
    if (free.take(x, y)) write(context, zones.length > 40 ? `${zone}` : `Z${zone} · ${cuts}`, x, y, ink.text, ink.halo);
  }
}
