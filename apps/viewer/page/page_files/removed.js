/** @import { Camera } from "./camera.js" */
/** @import { Palette } from "./palette.js" */
/** @import { Scenery } from "./scenery.js" */
import { pen, trace } from "./brush.js";
import { Outlines } from "./outlines.js";

const KERF_SEEN_PX = 1.2, KERF_WIDE_PX = 3;

/**
 * What cuts have done to the sheet: slugs have fallen out of holes, parts have come loose, kerfs are open.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {number[]} cuts in order
 */
export function paintRemoved(context, camera, palette, scenery, cuts) {
  const { contours } = scenery.data.nest, { ink } = palette, level = Outlines.level(camera.scale);
  const cutOf = (/** @type {string} */ kind) => cuts.map(cut => scenery.cuts[cut].contour).filter(k => contours[k].kind === kind);
  const holes = cutOf("hole"), loose = new Set(cutOf("outer"));
  for (const hole of holes) looseWithin(scenery, hole).forEach(k => loose.add(k));
  context.beginPath();
  for (const k of holes) trace(context, camera, scenery.outlines.points(k, level), true);
  context.fillStyle = ink.gap;
  context.fill();
  context.beginPath();
  for (const k of loose) scenery.metal(context, camera, k, level);
  context.fillStyle = ink.loose;
  context.fill("evenodd");
  const kerf = (scenery.side?.kerf_mm ?? 0) * camera.scale;
  if (kerf > KERF_SEEN_PX) {
    context.beginPath();
    for (const cut of cuts) {
      if (contours[scenery.cuts[cut].contour].kind !== "mark") trace(context, camera, scenery.way(cut).points, false);
    }
    pen(context, ink.gap, kerf);
    context.stroke();
  }
  for (const [colour, marks] of /** @type {[string, boolean][]} */ ([[ink.done, false], [ink.mark, true]])) {
    if (kerf > KERF_WIDE_PX && !marks) continue;
    context.beginPath();
    for (const cut of cuts) {
      const { contour } = scenery.cuts[cut], { kind, closed } = contours[contour];
      if ((kind === "mark") === marks) trace(context, camera, scenery.outlines.points(contour, level), closed);
    }
    pen(context, colour, 1);
    context.stroke();
  }
}

/** @type {(scenery: Scenery, hole: number) => number[]} outer contours in a hole, cut before it: they are seen in its gap */
function looseWithin(scenery, hole) {
  const { bounds, grid } = scenery.outlines, [x0, y0, x1, y1] = bounds[hole], now = scenery.cutOf.get(hole) ?? 0;
  return grid.within(x0, y0, x1, y1).filter(k => {
    const [a, b, c, d] = bounds[k];
    const inIt = a > x0 && b > y0 && c < x1 && d < y1 && scenery.data.nest.contours[k].kind === "outer";
    return inIt && (scenery.cutOf.get(k) ?? Infinity) < now;
  });
}
