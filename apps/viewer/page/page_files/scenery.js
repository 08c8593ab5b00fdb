/** @import { Camera } from "./camera.js" */
/** @import { PageData, SideData } from "./types.js" */
/** @import { Palette } from "./palette.js" */
import { pen, trace } from "./brush.js";
import { NUMBER_FONT_PX, paintNumbers, paintTexts } from "./numbers.js";
import { Outlines } from "./outlines.js";
import { PAPER_COLOURS } from "./palette.js";
import { paintRemoved } from "./removed.js";
import { paintRoute, paintStarts, paintZones } from "./route.js";
import { notHeld } from "./unkept.js";
import { wayOf } from "./way.js";
import { zoneAreas } from "./zones.js";

const AT_ONCE = 80, MANY_AT_ONCE = 400, MANY_SEEN = 600, TINY_PX = 14;

/** What stands still: the sheet after so many cuts. It is painted in small steps: a large nest never holds the page up. */
export class Scenery {
  /**
   * @param {PageData} data
   * @param {SideData | null} side
   * @param {Outlines} outlines
   */
  constructor(data, side, outlines) {
    this.data = data;
    this.side = side;
    this.outlines = outlines;
    this.cuts = side ? side.cuts : [];
    this.out = new Set(side ? side.already : []);
    this.cutOf = /** @type {Map<number, number>} */ (new Map());
    this.cuts.forEach((cut, k) => this.cutOf.set(cut.contour, k));
    this.zoneOfPart = /** @type {number[]} */ ([]);
    for (const cut of this.cuts) {
      const part = data.nest.contours[cut.contour].part;
      if (part >= 0) this.zoneOfPart[part] = cut.zone;
    }
    /** @type {number[][]} */
    this.holesOf = data.nest.parts.map(() => []);
    data.nest.contours.forEach((contour, k) => {
      if (contour.kind === "hole" && contour.part >= 0) this.holesOf[contour.part].push(k);
    });
    this.ways = /** @type {import("./way.js").Way[]} */ ([]);
    this.alert = new Set(data.alert);
    const numbers = new Map(data.nest.contours.map((contour, k) => [contour.id, k]));
    /** Contours where a hard rule is not kept. */
    this.unkept = side ? [...new Set(notHeld(side).flatMap(place => place.contours))].map(id => numbers.get(id) ?? -1) : [];
    /** @type {import("./zones.js").ZoneArea[] | null} */
    this.areas = null;
    this.size = outlines.bounds.map(([x0, y0, x1, y1]) => (x1 - x0) * (y1 - y0));
  }

  /** The zones as areas of the sheet, in the order in which they are cut. */
  get zones() {
    return (this.areas ??= zoneAreas(this.cuts, this.outlines.bounds));
  }

  /** Whether what is seen is too much and too small to be told apart: then zones are drawn in place of contours. */
  /** @type {(seen: number[], scale: number) => boolean} */
  dense(seen, scale) {
    if (seen.length < MANY_SEEN || this.zones.length < 2) return false;
    const tiny = seen.filter(k => Math.sqrt(this.size[k]) * scale < TINY_PX).length;
    return tiny > 0.5 * seen.length;
  }

  /** @type {(cut: number) => import("./way.js").Way} */
  way(cut) {
    return (this.ways[cut] ??= wayOf(this.cuts[cut]));
  }

  /**
   * Paints all, a step at a time.
   *
   * @param {CanvasRenderingContext2D} context
   * @param {Camera} camera
   * @param {Palette} palette
   * @param {{done: number, travel: boolean, numbers: boolean, drawn: boolean, wide: number, high: number, font?: number}} look
   * @returns {Generator<void, void, void>}
   */
  *paint(context, camera, palette, look) {
    const { ink } = palette, { nest } = this.data;
    context.fillStyle = ink.ground;
    context.fillRect(0, 0, look.wide, look.high);
    this.#shapes(context, camera, this.outlines.sheet, ink.sheet, ink.edge);
    const [x0, y1] = camera.toSheet(0, 0), [x1, y0] = camera.toSheet(look.wide, look.high);
    const seen = this.outlines.grid.within(x0, y0, x1, y1), level = Outlines.level(camera.scale);
    if (this.dense(seen, camera.scale)) {
      for (let k = 0; k < seen.length; k += MANY_AT_ONCE) {
        this.#quickLines(context, camera, palette, seen.slice(k, k + MANY_AT_ONCE), level, look.done);
        yield;
      }
      paintZones(context, camera, palette, this, look.done);
      return;
    }
    const outers = seen.filter(k => nest.contours[k].kind === "outer").sort((a, b) => this.size[b] - this.size[a]);
    yield;
    for (let k = 0; k < outers.length; k += AT_ONCE) {
      this.#parts(context, camera, palette, outers.slice(k, k + AT_ONCE), level);
      yield;
    }
    for (let k = 0; k < seen.length; k += AT_ONCE) {
      this.#lines(context, camera, palette, seen.slice(k, k + AT_ONCE), level, look);
      yield;
    }
    if (look.drawn) paintTexts(context, camera, palette, this, seen);
    this.#shapes(context, camera, this.outlines.leftOut, "", ink.edge);
    const cuts = this.#inOrder(seen, look.done);
    for (let k = 0; k < cuts.length; k += AT_ONCE) {
      paintRemoved(context, camera, palette, this, cuts.slice(k, k + AT_ONCE));
      yield;
    }
    if (look.travel && this.side) {
      yield* paintRoute(context, camera, palette, this.side, look.done, look);
      yield* paintStarts(context, camera, palette, this, seen);
    }
    yield;
    if (look.numbers) paintNumbers(context, camera, palette, this, seen, look.font ?? NUMBER_FONT_PX);
  }

  /** Outlines alone, those that are cut in the colour of what is gone. */
  /** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, seen: number[], level: number, done: number) => void} */
  #quickLines(context, camera, palette, seen, level, done) {
    for (const [cut, colour] of /** @type {[boolean, string][]} */ ([[false, palette.ink.edge], [true, palette.ink.loose]])) {
      context.beginPath();
      for (const k of seen) {
        const { kind, closed } = this.data.nest.contours[k];
        if (kind === "outer" && ((this.cutOf.get(k) ?? Infinity) < done) === cut) trace(context, camera, this.outlines.points(k, level), closed);
      }
      context.fillStyle = colour;
      context.fill();
    }
  }

  /** @type {(seen: number[], done: number) => number[]} */
  #inOrder(seen, done) {
    const cuts = seen.map(k => this.cutOf.get(k) ?? Infinity).filter(cut => cut < done);
    return cuts.sort((a, b) => a - b);
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, rings: Float64Array[], fill: string, line: string) => void} */
  #shapes(context, camera, rings, fill, line) {
    context.beginPath();
    for (const ring of rings) trace(context, camera, ring, true);
    if (fill) {
      context.fillStyle = fill;
      context.fill("evenodd");
    }
    pen(context, line, 1, fill ? [] : [3, 3]);
    context.stroke();
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, outers: number[], level: number) => void} */
  #parts(context, camera, palette, outers, level) {
    /** @type {Map<string, number[]>} */
    const byColour = new Map();
    for (const k of outers) {
      const { part } = this.data.nest.contours[k], zone = this.zoneOfPart[part] || 0;
      const colour = this.out.has(k) ? palette.ink.gap : zone ? palette.zones[(zone - 1) % 8] : palette.ink.part;
      const same = byColour.get(colour);
      if (same) same.push(k);
      else byColour.set(colour, [k]);
    }
    for (const [colour, of] of byColour) {
      context.beginPath();
      for (const k of of) this.metal(context, camera, k, level);
      context.fillStyle = colour;
      context.fill("evenodd");
    }
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, outer: number, level: number) => void} */
  metal(context, camera, outer, level) {
    trace(context, camera, this.outlines.points(outer, level), true);
    for (const hole of this.holesOf[this.data.nest.contours[outer].part] ?? []) {
      trace(context, camera, this.outlines.points(hole, level), true);
    }
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, seen: number[], level: number, look: {done: number, drawn: boolean}) => void} */
  #lines(context, camera, palette, seen, level, { done, drawn }) {
    const { contours } = this.data.nest;
    for (const kind of ["outer", "hole", "slit", "scrap", "mark"]) {
      const left = seen.filter(k => contours[k].kind === kind && (this.cutOf.get(k) ?? Infinity) >= done && !this.out.has(k));
      for (const colour of drawn ? new Set(left.map(k => contours[k].colour)) : [undefined]) {
        context.beginPath();
        for (const k of left) if (!drawn || contours[k].colour === colour) trace(context, camera, this.outlines.points(k, level), contours[k].closed);
        pen(context, palette.ink[kind], kind === "mark" ? 1 : 1.2);
        if (colour && !PAPER_COLOURS.has(colour)) context.strokeStyle = colour;
        context.stroke();
      }
    }
    const loud = seen.filter(k => this.alert.has(k));
    if (!loud.length) return;
    context.beginPath();
    for (const k of loud) trace(context, camera, this.outlines.points(k, level), contours[k].closed);
    pen(context, palette.ink.alert, 3);
    context.stroke();
  }
}
