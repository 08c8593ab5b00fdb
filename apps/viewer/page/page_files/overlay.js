/** @import { Camera } from "./camera.js" */
/** @import { Palette } from "./palette.js" */
/** @import { Scenery } from "./scenery.js" */
/** @import { State } from "./store.js" */
/** @import { Timeline } from "./timeline.js" */
import { pen, trace, write } from "./brush.js";
import { Outlines } from "./outlines.js";
import { countUpTo, endOf, momentAt, startOf, withFirst } from "./timeline.js";
import { placeOn } from "./way.js";

const TAIL = 12, MANY = 40;

/**
 * What moves: the torch, its way in this cut, its last moves, and what is selected.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Palette} palette
 * @param {Scenery} scenery
 * @param {Timeline} timeline
 * @param {State} state
 */
export function paintOver(context, camera, palette, scenery, timeline, state) {
  const { ink } = palette;
  paintMarks(context, camera, palette, scenery, state);
  if (!scenery.side) return;
  const { moment, share, done } = momentAt(timeline, state.time_s);
  const [hx, hy] = camera.toScreen(...scenery.side.home);
  pen(context, ink.text, 1.2);
  context.beginPath();
  context.arc(hx, hy, 5, 0, 7);
  context.moveTo(hx - 8, hy);
  context.lineTo(hx + 8, hy);
  context.moveTo(hx, hy - 8);
  context.lineTo(hx, hy + 8);
  context.stroke();
  const { firsts } = timeline, next = countUpTo(firsts, done - 1);
  for (let n = Math.max(1, next - TAIL); n <= next && n < firsts.length && state.travel; n++) {
    if (!scenery.cuts[firsts[n]].linked) arrow(context, camera, palette, endOf(scenery.cuts[firsts[n - 1]]), startOf(scenery.cuts[firsts[n]]));
  }
  if (!moment) return;
  if (moment.does === "travel" || moment.does === "home") {
    const [[ax, ay], [bx, by]] = [moment.from, moment.to];
    arrow(context, camera, palette, moment.from, moment.to);
    torch(context, camera.toScreen(ax + share * (bx - ax), ay + share * (by - ay)), ink, moment.does);
    return;
  }
  if (moment.does !== "cut") torch(context, camera.toScreen(...moment.to), ink, moment.does);
  for (let cut = moment.cut; cut === moment.cut || withFirst(scenery.cuts[cut]); cut++) { // each torch on its own way
    if (moment.does !== "cut") {
      if (cut !== moment.cut) torch(context, camera.toScreen(...startOf(scenery.cuts[cut])), ink, moment.does);
      continue;
    }
    const way = scenery.way(cut), { x, y, passed } = placeOn(way, share);
    context.beginPath();
    trace(context, camera, way.points, false, passed + 1);
    context.lineTo(...camera.toScreen(x, y));
    pen(context, ink.torch, Math.max(2, scenery.side.kerf_mm * camera.scale));
    context.stroke();
    torch(context, camera.toScreen(x, y), ink, moment.does);
  }
}

/** @type {(context: CanvasRenderingContext2D, at: [number, number], ink: Record<string, string>, does: string) => void} */
function torch(context, [x, y], ink, does) {
  const on = does === "cut" || does === "pierce";
  context.beginPath();
  context.arc(x, y, on ? 6 : 5, 0, 7);
  context.fillStyle = on ? ink.torch : ink.ground;
  context.fill();
  pen(context, on ? ink.ground : ink.text, 2, []);
  context.stroke();
  if (does !== "pierce" && does !== "wait") return;
  context.beginPath();
  context.arc(x, y, 10, 0, 7);
  pen(context, does === "wait" ? ink.travel : ink.torch, 1.5, [3, 3]);
  context.stroke();
}

/** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, from: readonly number[], to: readonly number[]) => void} */
function arrow(context, camera, palette, from, to) {
  const [ax, ay] = camera.toScreen(from[0], from[1]), [bx, by] = camera.toScreen(to[0], to[1]);
  const long = Math.hypot(bx - ax, by - ay);
  if (long < 6) return;
  const dx = (bx - ax) / long, dy = (by - ay) / long, mx = ax + 0.6 * (bx - ax), my = ay + 0.6 * (by - ay);
  pen(context, palette.ink.travel, 1.3);
  context.beginPath();
  context.moveTo(ax, ay);
  context.lineTo(bx, by);
  context.moveTo(mx - 6 * dx + 3 * dy, my - 6 * dy - 3 * dx);
  context.lineTo(mx, my);
  context.lineTo(mx - 6 * dx - 3 * dy, my - 6 * dy + 3 * dx);
  context.stroke();
}

/** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, scenery: Scenery, state: State) => void} */
function paintMarks(context, camera, palette, scenery, state) {
  const { ink } = palette, { contours } = scenery.data.nest, level = Outlines.level(camera.scale);
  /** @type {(contour: number, colour: string, width: number) => void} */
  const line = (contour, colour, width) => {
    if (contour < 0 || contour >= contours.length) return;
    context.beginPath();
    trace(context, camera, scenery.outlines.points(contour, level), contours[contour].closed);
    pen(context, colour, width);
    context.stroke();
  };
  scenery.unkept.forEach(contour => line(contour, ink.unkept, 2.6));
  state.marked.forEach(contour => line(contour, ink.alert, state.marked.length > MANY ? 1.8 : 3));
  line(state.hovered, ink.select, 1.5);
  line(state.selected, ink.halo, 5.5);
  line(state.selected, ink.select, 3);
  const cut = scenery.cutOf.get(state.selected);
  if (cut === undefined) return;
  const chosen = scenery.cuts[cut], [x, y] = camera.toScreen(...startOf(chosen));
  context.beginPath();
  trace(context, camera, scenery.way(cut).points, false);
  pen(context, ink.pierce, 1);
  context.stroke();
  context.beginPath();
  context.arc(x, y, 4, 0, 7);
  context.fillStyle = ink.pierce;
  context.fill();
  for (const [tx, ty] of chosen.tabs) {
    const [px, py] = camera.toScreen(tx, ty);
    context.fillStyle = ink.tab;
    context.fillRect(px - 4, py - 4, 8, 8);
  }
  context.font = "700 12px system-ui, 'DejaVu Sans', sans-serif";
  context.textAlign = "left";
  context.textBaseline = "bottom";
  write(context, `${scenery.side ? scenery.side.made + cut + 1 : ""}`, x + 6, y - 4, ink.select, ink.halo);
}
