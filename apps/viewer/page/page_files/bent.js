/** @import { Camera } from "./camera.js" */
/** @import { Palette } from "./palette.js" */
/** @import { Scenery } from "./scenery.js" */
/** @import { BentData, BentLine } from "./types.js" */
import { pen, write } from "./brush.js";
import { figure } from "./say.js";
import { countUpTo } from "./timeline.js";

const UM = 1000, LEAST_LABEL_PX = 34, LARGE = 0.6;

/** The sheet as it moves while it is cut, many times as far; and how far each part is off by the cuts that are made. */
export class BentFrames {
  /**
   * @param {BentData} data
   * @param {Map<string, number>} numbers of contours
   */
  constructor(data, numbers) {
    this.data = data;
    this.contours = data.lines.map(line => numbers.get(line.name) ?? -1);
    /** How far each line is off at its worst place when all is cold, mm. */
    this.off = data.lines.map(line => worst(line.cold ?? []));
    this.end_s = Math.max(0, ...data.lines.map(line => line.cut_s ?? 0));
  }

  /** How far each part is off by what is cut up to a time, mm, by its number. */
  /** @type {(scenery: Scenery, time_s: number) => Map<number, number>} */
  errors(scenery, time_s) {
    const found = new Map();
    this.data.lines.forEach(({ cut_s, cold }, k) => {
      const part = scenery.data.nest.contours[this.contours[k]]?.part ?? -1;
      if (part >= 0 && cold && cut_s !== null && cut_s <= time_s) found.set(part, Math.max(found.get(part) ?? 0, this.off[k]));
    });
    return found;
  }

  /** So many times as far as it is the metal is drawn away at a time. */
  /** @type {(time_s: number) => number} */
  times(time_s) { return time_s > this.end_s ? this.data.times_cold : this.data.times; }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, scenery: Scenery, time_s: number) => void} */
  paint(context, camera, palette, scenery, time_s) {
    const { ink } = palette, cold = time_s > this.end_s, frame = Math.max(0, countUpTo(this.data.at_s, time_s) - 1);
    /** @type {[string, (line: BentLine) => boolean][]} */
    const kinds = [[ink.text, line => line.kind === "sheet"], [ink.select, line => line.cut_s !== null && line.cut_s <= time_s],
      [ink.torch, line => line.kind !== "sheet" && (line.cut_s === null || line.cut_s > time_s)]];
    for (const [colour, wanted] of kinds) {
      context.beginPath();
      for (const line of this.data.lines) if (wanted(line)) bentLine(context, camera, line.xy, cold ? line.cold : line.moved[frame], this.times(time_s) / UM);
      pen(context, colour, 1.6);
      context.stroke();
    }
    const most = Math.max(...this.off, 1e-9), { bounds } = scenery.outlines;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.font = "700 12px system-ui, 'DejaVu Sans', sans-serif";
    for (const [part, mm] of this.errors(scenery, time_s)) {
      const [x0, y0, x1, y1] = bounds[scenery.data.nest.contours.findIndex(one => one.part === part && one.kind === "outer")];
      if ((x1 - x0) * camera.scale < LEAST_LABEL_PX) continue;
      const [x, y] = camera.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
      write(context, figure(mm, 2), x, y, mm > LARGE * most ? ink.alert : ink.text, ink.halo);
    }
    context.textAlign = "left";
  }
}

/** @type {(context: CanvasRenderingContext2D, camera: Camera, xy: number[], moved: number[] | null, by: number) => void} */
function bentLine(context, camera, xy, moved, by) {
  for (let k = 0; k < xy.length; k += 2) {
    const at = camera.toScreen(xy[k] + (moved ? moved[k] * by : 0), xy[k + 1] + (moved ? moved[k + 1] * by : 0));
    if (k) context.lineTo(...at);
    else context.moveTo(...at);
  }
}

/** @type {(moved: number[]) => number} the longest of movements, mm */
function worst(moved) {
  let most = 0;
  for (let k = 0; k < moved.length; k += 2) most = Math.max(most, Math.hypot(moved[k], moved[k + 1]));
  return most / UM;
}
