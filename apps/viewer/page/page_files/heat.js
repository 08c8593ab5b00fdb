/** @import { Camera } from "./camera.js" */
/** @import { HeatData } from "./types.js" */
import { countUpTo } from "./timeline.js";

/** Black, violet, orange, yellow, white: the share of the scale, then red, green, blue. */
const WARM = [[0, 40, 20, 90], [0.25, 120, 30, 110], [0.5, 226, 90, 40], [0.75, 250, 190, 40], [1, 255, 250, 220]];

/** Frames of temperatures, laid over a drawing. */
export class HeatFrames {
  /**
   * @param {HeatData} data
   * @param {Uint8Array} bytes
   */
  constructor(data, bytes) {
    this.data = data;
    this.bytes = bytes;
    this.canvas = document.createElement("canvas");
    this.canvas.width = data.wide;
    this.canvas.height = data.high;
    this.shown = -1;
  }

  /**
   * @param {HeatData} data
   * @returns {Promise<HeatFrames>}
   */
  static async of(data) {
    const packed = Uint8Array.from(atob(data.frames), letter => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new HeatFrames(data, new Uint8Array(await new Response(stream).arrayBuffer()));
  }

  /** The number of the frame of a time; -1 before the first. */
  /** @type {(time_s: number) => number} */
  frame(time_s) {
    return countUpTo(this.data.at_s, time_s) - 1;
  }

  /**
   * The temperature at a place, °C; null outside of the frames.
   *
   * @param {number} time_s
   * @param {number} x mm
   * @param {number} y
   * @returns {number | null}
   */
  at(time_s, x, y) {
    const { wide, high, left_mm, bottom_mm, square_mm, ambient_c, top_c } = this.data, frame = this.frame(time_s);
    const i = Math.floor((x - left_mm) / square_mm), j = Math.floor((y - bottom_mm) / square_mm);
    if (i < 0 || j < 0 || i >= wide || j >= high) return null;
    if (frame < 0) return ambient_c;
    return ambient_c + (this.bytes[(frame * high + j) * wide + i] / 255) * (top_c - ambient_c);
  }

  /** The hottest square of a moment, °C. */
  /** @type {(time_s: number) => number} */
  hottest(time_s) {
    const { wide, high, ambient_c, top_c } = this.data, frame = this.frame(time_s);
    if (frame < 0) return ambient_c;
    let most = 0;
    for (let k = frame * wide * high; k < (frame + 1) * wide * high; k++) most = Math.max(most, this.bytes[k]);
    return ambient_c + (most / 255) * (top_c - ambient_c);
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {Camera} camera
   * @param {number} time_s
   */
  paint(context, camera, time_s) {
    const frame = this.frame(time_s), { left_mm, bottom_mm, square_mm, wide, high } = this.data;
    if (frame < 0) return;
    if (frame !== this.shown) this.#fill(frame);
    const [x, y] = camera.toScreen(left_mm, bottom_mm + high * square_mm);
    context.imageSmoothingEnabled = true;
    context.drawImage(this.canvas, x, y, wide * square_mm * camera.scale, high * square_mm * camera.scale);
  }

  /** @param {number} frame */
  #fill(frame) {
    const { wide, high } = this.data, context = this.canvas.getContext("2d");
    if (!context) return;
    const image = context.createImageData(wide, high);
    for (let j = 0; j < high; j++) {
      for (let i = 0; i < wide; i++) {
        const value = this.bytes[(frame * high + (high - 1 - j)) * wide + i], at = 4 * (j * wide + i);
        const [red, green, blue] = warm(value / 255);
        image.data.set([red, green, blue, value < 3 ? 0 : Math.min(235, 60 + 2 * value)], at);
      }
    }
    context.putImageData(image, 0, 0);
    this.shown = frame;
  }
}

/**
 * The colour of a share of the scale.
 *
 * @param {number} share 0 … 1
 * @returns {number[]}
 */
export function warm(share) {
  const above = WARM.findIndex(step => step[0] >= share), high = WARM[Math.max(1, above)], low = WARM[Math.max(1, above) - 1];
  const part = (share - low[0]) / (high[0] - low[0]);
  return [1, 2, 3].map(k => Math.round(low[k] + part * (high[k] - low[k])));
}
