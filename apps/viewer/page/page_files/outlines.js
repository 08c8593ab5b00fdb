/** @import { NestData } from "./types.js" */
import { boundsOf, distanceTo, flattened, inside, simplified } from "./geometry.js";

const FINEST_MM = 0.02, LEVELS = 8, COARSER = 4, SEEN_PX = 0.4;

/**
 * The contours of a nest, each at as many levels of detail as are looked at, and a grid to find them by place.
 */
export class Outlines {
  /** @param {NestData} nest */
  constructor(nest) {
    this.nest = nest;
    /** @type {(Float64Array | undefined)[][]} */
    this.levels = Array.from({ length: LEVELS }, () => []);
    this.bounds = nest.contours.map((_, k) => boundsOf(this.points(k, 1)));
    this.sheet = nest.sheet.map(rows => flattened(rows, true, 0.05));
    this.leftOut = nest.left_out.map(rows => flattened(rows, true, 0.05));
    this.grid = new Grid(this.bounds, nest.bounds);
  }

  /**
   * The level at which nothing is seen to be missing.
   *
   * @param {number} scale pixels a mm
   * @returns {number}
   */
  static level(scale) {
    const level = Math.floor(Math.log(SEEN_PX / scale / FINEST_MM) / Math.log(COARSER));
    return Math.max(0, Math.min(LEVELS - 1, level));
  }

  /**
   * @param {number} contour
   * @param {number} level
   * @returns {Float64Array}
   */
  points(contour, level) {
    const kept = this.levels[level][contour];
    if (kept) return kept;
    const { rows, closed } = this.nest.contours[contour];
    const tolerance = FINEST_MM * COARSER ** level;
    const fine = level > 1 ? this.points(contour, 1) : flattened(rows, closed, tolerance);
    const made = level > 1 ? simplified(fine, tolerance) : fine;
    this.levels[level][contour] = made;
    return made;
  }

  /**
   * The contour at a place: one whose line is near, else the smallest that the place lies in; -1 for none.
   *
   * @param {number} x
   * @param {number} y
   * @param {number} near mm
   * @returns {number}
   */
  at(x, y, near) {
    let best = -1, nearest = near, around = -1, least = Infinity;
    for (const k of this.grid.within(x - near, y - near, x + near, y + near)) {
      const { kind, closed } = this.nest.contours[k], points = this.points(k, 1);
      const away = distanceTo(points, closed, x, y);
      if (away < nearest) { nearest = away; best = k; }
      const [x0, y0, x1, y1] = this.bounds[k], size = (x1 - x0) * (y1 - y0);
      const encloses = closed && kind !== "mark";
      if (encloses && size < least && inside(points, x, y)) { least = size; around = k; }
    }
    return best >= 0 ? best : around;
  }
}

/** Boxes in squares of a grid. */
class Grid {
  /**
   * @param {number[][]} boxes
   * @param {number[]} bounds
   */
  constructor(boxes, bounds) {
    this.boxes = boxes;
    const area = Math.max(1, (bounds[2] - bounds[0]) * (bounds[3] - bounds[1]));
    this.size = Math.sqrt(area / Math.max(1, boxes.length / 2)) || 1;
    /** @type {Map<string, number[]>} */
    this.squares = new Map();
    boxes.forEach((box, k) => this.each(box[0], box[1], box[2], box[3], key => {
      const here = this.squares.get(key);
      if (here) here.push(k);
      else this.squares.set(key, [k]);
    }));
  }

  /** @type {(x0: number, y0: number, x1: number, y1: number, fn: (key: string) => void) => void} */
  each(x0, y0, x1, y1, fn) {
    for (let i = Math.floor(x0 / this.size); i <= Math.floor(x1 / this.size); i++) {
      for (let j = Math.floor(y0 / this.size); j <= Math.floor(y1 / this.size); j++) fn(`${i},${j}`);
    }
  }

  /**
   * The numbers of the boxes that meet a rectangle, rising.
   *
   * @param {number} x0
   * @param {number} y0
   * @param {number} x1
   * @param {number} y1
   * @returns {number[]}
   */
  within(x0, y0, x1, y1) {
    const meets = (/** @type {number} */ k) => {
      const box = this.boxes[k];
      return box[0] <= x1 && box[2] >= x0 && box[1] <= y1 && box[3] >= y0;
    };
    const squares = ((x1 - x0) / this.size + 1) * ((y1 - y0) / this.size + 1);
    if (squares > this.squares.size) return this.boxes.map((_, k) => k).filter(meets);
    /** @type {Set<number>} */
    const found = new Set();
    this.each(x0, y0, x1, y1, key => this.squares.get(key)?.forEach(k => { if (meets(k)) found.add(k); }));
    return [...found].sort((a, b) => a - b);
  }
}
