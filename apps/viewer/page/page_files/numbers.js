/** @import { Camera } from "./camera.js" */
/** @import { Palette } from "./palette.js" */
/** @import { Scenery } from "./scenery.js" */
import { write } from "./brush.js";
import { startOf } from "./timeline.js";

export const NUMBER_FONT_PX = 11;
const ROOM_FOR_NUMBER = 2, MOST_NUMBERS = 1500, SQUARE_PX = 40;

/** @typedef {[number, number, number, number]} Box x0, y0, x1, y1 in pixels */

/**
 * The number of each cut where its torch begins, or without a plan the name of each part, where there is room.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {number[]} seen contours
 * @param {number} font pixels
 */
export function paintNumbers(context, camera, palette, scenery, seen, font) {
  const { contours, parts } = scenery.data.nest, { side } = scenery;
  context.font = `600 ${font}px system-ui, 'DejaVu Sans', sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  /** @type {Map<string, Box[]>} */
  const taken = new Map();
  let written = 0;
  for (const k of seen) {
    const [x0, y0, x1, y1] = scenery.outlines.bounds[k], size = Math.max(x1 - x0, y1 - y0) * camera.scale;
    if (size < ROOM_FOR_NUMBER * font || written >= MOST_NUMBERS) continue;
    const cut = scenery.cutOf.get(k), { kind, part } = contours[k];
    if (cut === undefined && (side || kind !== "outer")) continue;
    const text = cut === undefined ? parts[part] ?? "" : String((side?.made ?? 0) + cut + 1);
    const at = cut === undefined ? [(x0 + x1) / 2, (y0 + y1) / 2] : startOf(scenery.cuts[cut]);
    const [x, y] = camera.toScreen(at[0], at[1]);
    const half = (text.length * 0.31 + 0.1) * font, box = /** @type {Box} */ ([x - half, y - 0.5 * font, x + half, y + 0.5 * font]);
    if (!free(taken, box)) continue;
    write(context, text, x, y, palette.ink[kind === "outer" ? "text" : kind], palette.ink.halo);
    written++;
  }
}

/** Whether a box meets no earlier one; it is kept then. */
/** @type {(taken: Map<string, Box[]>, box: Box) => boolean} */
function free(taken, box) {
  const [x0, y0, x1, y1] = box, squares = [];
  for (let i = Math.floor(x0 / SQUARE_PX); i <= Math.floor(x1 / SQUARE_PX); i++) {
    for (let j = Math.floor(y0 / SQUARE_PX); j <= Math.floor(y1 / SQUARE_PX); j++) squares.push(`${i},${j}`);
  }
  const meets = squares.some(key => taken.get(key)?.some(other => other[0] < x1 && other[2] > x0 && other[1] < y1 && other[3] > y0));
  if (!meets) for (const key of squares) taken.set(key, [...(taken.get(key) ?? []), box]);
  return !meets;
}

/**
 * The writing that marks are strokes of, once each, below its strokes.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {number[]} seen contours
 */
export function paintTexts(context, camera, palette, scenery, seen) {
  /** @type {Map<string, [number, number]>} */
  const places = new Map();
  for (const k of seen) {
    const { text, part } = scenery.data.nest.contours[k], [x, y] = scenery.outlines.bounds[k], name = `${part} ${text}`;
    const before = places.get(name) ?? [Infinity, Infinity];
    if (text) places.set(name, [Math.min(before[0], x), Math.min(before[1], y)]);
  }
  context.font = "600 11px system-ui, 'DejaVu Sans', sans-serif";
  context.textAlign = "left";
  context.textBaseline = "top";
  for (const [name, [x, y]] of places) {
    const [px, py] = camera.toScreen(x, y);
    write(context, name.slice(name.indexOf(" ") + 1), px, py + 2, palette.ink.text, palette.ink.halo);
  }
}
