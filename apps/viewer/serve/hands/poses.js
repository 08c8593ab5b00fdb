/** How parts lie once they are moved, and how near to each other: nothing here knows a screen or a server. */
import { boundsOf, distanceTo, inside } from "./geometry.js";

/**
 * How a part lies against where it was drawn: mirrored left to right about its middle, turned about it, then moved.
 *
 * @typedef {object} Lying
 * @property {number} turn_deg counter-clockwise
 * @property {boolean} mirrored
 * @property {number} dx mm
 * @property {number} dy mm
 */

/**
 * A part where it lies: rings of points, x, y, x, y, … mm.
 *
 * @typedef {{outer: ArrayLike<number>, holes: ArrayLike<number>[]}} Outline
 */

/**
 * How near two things come: mm, less than 0 where they overlap, and the two places that are nearest.
 *
 * @typedef {{mm: number, from: [number, number], to: [number, number]}} Gap
 */

/** @type {Lying} */
export const AS_DRAWN = { turn_deg: 0, mirrored: false, dx: 0, dy: 0 };

/** Turned further, counter-clockwise. */
/** @type {(lying: Lying, by_deg: number) => Lying} */
export function turnedBy(lying, by_deg) {
  return { ...lying, turn_deg: (((lying.turn_deg + by_deg) % 360) + 360) % 360 };
}

/** Turned over, left to right: what was turned counter-clockwise is turned clockwise then. */
/** @type {(lying: Lying) => Lying} */
export function turnedOver(lying) {
  return { ...lying, turn_deg: (360 - lying.turn_deg) % 360, mirrored: !lying.mirrored };
}

/** @type {(lying: Lying, dx: number, dy: number) => Lying} */
export function movedBy(lying, dx, dy) {
  return { ...lying, dx: lying.dx + dx, dy: lying.dy + dy };
}

/**
 * Points of a part where it lies.
 *
 * @param {ArrayLike<number>} points as drawn
 * @param {Lying} lying
 * @param {[number, number]} middle of the part as drawn
 * @returns {Float64Array}
 */
export function placed(points, lying, middle) {
  const turn = (lying.turn_deg * Math.PI) / 180, cos = Math.cos(turn), sin = Math.sin(turn), made = new Float64Array(points.length);
  for (let k = 0; k < points.length; k += 2) {
    const x = (points[k] - middle[0]) * (lying.mirrored ? -1 : 1), y = points[k + 1] - middle[1];
    made[k] = middle[0] + lying.dx + cos * x - sin * y;
    made[k + 1] = middle[1] + lying.dy + sin * x + cos * y;
  }
  return made;
}

/**
 * How near the metal of two parts comes.
 *
 * @type {(a: Outline, b: Outline) => Gap}
 */
export function gapBetween(a, b) {
  const hole = holeAround(a, b) ?? holeAround(b, a);
  const [one, other] = hole ? [hole.part.outer, hole.ring] : [a.outer, b.outer];
  const gap = ringsApart(one, other);
  const within = !hole && (inside(b.outer, a.outer[0], a.outer[1]) || inside(a.outer, b.outer[0], b.outer[1]));
  return within ? { ...gap, mm: -Math.max(gap.mm, 1e-6) } : gap;
}

/** The hole of one part that another lies in. */
/** @type {(part: Outline, host: Outline) => {part: Outline, ring: ArrayLike<number>} | null} */
function holeAround(part, host) {
  const [x, y] = [part.outer[0], part.outer[1]];
  const ring = inside(host.outer, x, y) ? host.holes.find(one => inside(one, x, y)) : undefined;
  return ring ? { part, ring } : null;
}

/**
 * How far a part keeps from the edge of the sheet, and from its holes; less than 0 where it reaches over it.
 *
 * @type {(part: Outline, sheet: ArrayLike<number>[]) => Gap}
 */
export function gapToEdge(part, [outline, ...holes]) {
  const gaps = [outline, ...holes].map((ring, k) => {
    const gap = ringsApart(part.outer, ring), on = inside(ring, part.outer[0], part.outer[1]) === (k === 0);
    return on ? gap : { ...gap, mm: -Math.max(gap.mm, 1e-6) };
  });
  return gaps.reduce((least, gap) => (gap.mm < least.mm ? gap : least));
}

/** Two rings: how far apart, less than 0 where they cross, and where. */
/** @type {(a: ArrayLike<number>, b: ArrayLike<number>) => Gap} */
export function ringsApart(a, b) {
  /** @type {Gap} */
  let best = { mm: Infinity, from: [0, 0], to: [0, 0] };
  for (const [points, ring, turned] of /** @type {[ArrayLike<number>, ArrayLike<number>, boolean][]} */ ([[a, b, false], [b, a, true]])) {
    for (let k = 0; k < points.length; k += 2) {
      const x = points[k], y = points[k + 1], count = ring.length;
      for (let j = 0, i = count - 2; j < count; i = j, j += 2) {
        const dx = ring[j] - ring[i], dy = ring[j + 1] - ring[i + 1], length2 = dx * dx + dy * dy;
        const share = length2 > 0 ? Math.max(0, Math.min(1, ((x - ring[i]) * dx + (y - ring[i + 1]) * dy) / length2)) : 0;
        const px = ring[i] + share * dx, py = ring[i + 1] + share * dy, mm = Math.hypot(x - px, y - py);
        if (mm < best.mm) best = turned ? { mm, from: [px, py], to: [x, y] } : { mm, from: [x, y], to: [px, py] };
      }
    }
  }
  const at = crossing(a, b);
  return at ? { mm: -1e-6, from: at, to: at } : best;
}

/** A place where two rings cross; null for none. */
/** @type {(a: ArrayLike<number>, b: ArrayLike<number>) => [number, number] | null} */
function crossing(a, b) {
  const [x0, y0, x1, y1] = boundsOf(b);
  for (let k = 0, i = a.length - 2; k < a.length; i = k, k += 2) {
    const ax = a[i], ay = a[i + 1], ux = a[k] - ax, uy = a[k + 1] - ay;
    if (Math.max(ax, a[k]) < x0 || Math.min(ax, a[k]) > x1 || Math.max(ay, a[k + 1]) < y0 || Math.min(ay, a[k + 1]) > y1) continue;
    for (let j = 0, h = b.length - 2; j < b.length; h = j, j += 2) {
      const vx = b[j] - b[h], vy = b[j + 1] - b[h + 1], cross = ux * vy - uy * vx;
      if (cross === 0) continue;
      const s = ((b[h] - ax) * vy - (b[h + 1] - ay) * vx) / cross, t = ((b[h] - ax) * uy - (b[h + 1] - ay) * ux) / cross;
      if (s > 0 && s < 1 && t > 0 && t < 1) return [ax + s * ux, ay + s * uy];
    }
  }
  return null;
}

/** Whether two boxes come so near to each other. */
/** @type {(a: number[], b: number[], mm: number) => boolean} */
export function boxesNear(a, b, mm) {
  return a[0] <= b[2] + mm && b[0] <= a[2] + mm && a[1] <= b[3] + mm && b[1] <= a[3] + mm;
}

/** Whether a place lies in the metal of a part. */
/** @type {(part: Outline, x: number, y: number) => boolean} */
export function inMetal(part, x, y) {
  return inside(part.outer, x, y) && !part.holes.some(hole => inside(hole, x, y));
}

/** How far a place lies from the outline of a part. */
/** @type {(part: Outline, x: number, y: number) => number} */
export function fromOutline(part, x, y) {
  return distanceTo(part.outer, true, x, y);
}

/**
 * What was done to the parts of a nest, each change a line that `kerfwise edit` takes; undone changes can be done again.
 */
export class PartChanges {
  constructor() {
    /** @type {string[]} */
    this.lines = [];
    /** @type {string[]} */
    this.undone = [];
  }

  /** @param {string} line */
  add(line) {
    this.lines = [...this.lines, line];
    this.undone = [];
  }

  /** The last change is undone; false where there is none. */
  undo() {
    if (!this.lines.length) return false;
    this.undone = [this.lines[this.lines.length - 1], ...this.undone];
    this.lines = this.lines.slice(0, -1);
    return true;
  }

  /** The change that was undone last is done again; false where none was. */
  redo() {
    if (!this.undone.length) return false;
    this.lines = [...this.lines, this.undone[0]];
    this.undone = this.undone.slice(1);
    return true;
  }

  /**
   * How a part lies after all changes, and whether it is left out.
   *
   * @param {string} part
   * @returns {Lying & {dropped: boolean}}
   */
  of(part) {
    let lying = { ...AS_DRAWN }, dropped = false;
    for (const line of this.lines) {
      const [verb, name, ...amounts] = wordsOf(line);
      if (name !== part) continue;
      const [a, b] = amounts.map(Number);
      if (verb === "move") lying = movedBy(lying, a, b);
      else if (verb === "turn") lying = turnedBy(lying, a);
      else if (verb === "mirror") lying = turnedOver(lying);
      else if (verb === "drop") dropped = true;
    }
    return { ...lying, dropped };
  }
}

/** A name as a line of changes says it. */
/** @type {(name: string) => string} */
export function inLine(name) {
  return /^[\w.#-]+$/.test(name) ? name : `"${name.replace(/["\\]/g, "\\$&")}"`;
}

/** @type {(line: string) => string[]} the words of a line; those in quotes may hold blanks */
function wordsOf(line) {
  return [...line.matchAll(/"((?:[^"\\]|\\.)*)"|(\S+)/g)].map(([, quotedWord, word]) => word ?? quotedWord.replace(/\\(.)/g, "$1"));
}
