/** @import { Camera } from "./camera.js" */

/**
 * Adds points to the path of a context, in pixels.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {ArrayLike<number>} points mm
 * @param {boolean} closed
 * @param {number} [count] of the points, from the first
 */
export function trace(context, camera, points, closed, count = points.length / 2) {
  if (count < 1) return;
  const { scale, x, y } = camera;
  context.moveTo(x + points[0] * scale, y - points[1] * scale);
  for (let k = 2; k < 2 * count; k += 2) context.lineTo(x + points[k] * scale, y - points[k + 1] * scale);
  if (closed) context.closePath();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {string} colour
 * @param {number} width pixels
 * @param {number[]} [dash]
 */
export function pen(context, colour, width, dash = []) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.lineJoin = "round";
  context.lineCap = dash.length ? "butt" : "round";
}

/**
 * A text with a rim that keeps it legible on every ground.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {string} text
 * @param {number} x pixels
 * @param {number} y
 * @param {string} colour
 * @param {string} rim
 */
export function write(context, text, x, y, colour, rim) {
  context.lineJoin = "round";
  context.setLineDash([]);
  context.strokeStyle = rim;
  context.lineWidth = 3;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}
