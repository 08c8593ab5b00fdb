/** @import { Scenery } from "./scenery.js" */
/** @import { Palette } from "./palette.js" */
import { Camera } from "./camera.js";
import { paintRemoved } from "./removed.js";

const BUDGET_MS = 7, MARGIN = 0.15;

/**
 * @typedef {{done: number, travel: boolean, numbers: boolean, drawn: boolean}} Look
 */

/**
 * A picture of the scenery, kept between frames. While the view moves, the last picture is moved with it and a new one
 * is painted a few milliseconds a frame; it takes the old one's place when it is whole.
 */
export class Ground {
  /** @param {Scenery} scenery */
  constructor(scenery) {
    this.scenery = scenery;
    this.front = new Sheet();
    this.back = new Sheet();
    /** @type {Generator<void, void, void> | null} */
    this.job = null;
  }

  /** All has to be painted again. */
  forget() {
    this.front.valid = false;
    this.job = null;
  }

  /**
   * Draws what there is, and goes on with what is better.
   *
   * @param {CanvasRenderingContext2D} context
   * @param {Camera} camera
   * @param {Palette} palette
   * @param {Look} look
   * @param {{wide: number, high: number, ratio: number}} size
   * @returns {boolean} whether the picture is the one asked for
   */
  draw(context, camera, palette, look, size) {
    this.#catchUp(camera, palette, look, size);
    if (!this.front.shows(camera, look, size)) {
      if (!this.job) this.#begin(camera, palette, look, size);
      const until = performance.now() + BUDGET_MS;
      while (this.job && performance.now() < until) {
        const { done } = this.job.next();
        this.back.context.getImageData(0, 0, 1, 1); // what was asked for is painted now, not all of it in one frame later
        if (!done) continue;
        [this.front, this.back] = [this.back, this.front];
        this.front.valid = true;
        this.job = null;
        if (!this.front.shows(camera, look, size)) this.#begin(camera, palette, look, size);
      }
    } else this.job = null;
    this.#put(context, camera, palette, size);
    return this.front.shows(camera, look, size);
  }

  /** A few more cuts are painted onto the picture that there is. */
  /** @type {(camera: Camera, palette: Palette, look: Look, size: {wide: number, high: number, ratio: number}) => void} */
  #catchUp(camera, palette, look, size) {
    const more = look.done - this.front.look.done;
    if (more <= 0 || more > 40 || look.travel || !this.front.shows(camera, { ...look, done: this.front.look.done }, size)) return;
    const cuts = Array.from({ length: more }, (_, k) => this.front.look.done + k);
    paintRemoved(this.front.context, this.front.camera, palette, this.scenery, cuts);
    this.front.look = { ...look };
  }

  /** @type {(camera: Camera, palette: Palette, look: Look, size: {wide: number, high: number, ratio: number}) => void} */
  #begin(camera, palette, look, size) {
    const { context } = this.back.ready(camera, look, size);
    const [wide, high] = [this.back.wide, this.back.high];
    this.job = this.scenery.paint(context, this.back.camera, palette, { ...look, wide, high });
  }

  /** @type {(context: CanvasRenderingContext2D, camera: Camera, palette: Palette, size: {wide: number, high: number}) => void} */
  #put(context, camera, palette, size) {
    context.fillStyle = palette.ink.ground;
    context.fillRect(0, 0, size.wide, size.high);
    if (!this.front.valid) return;
    const { front } = this, real = camera.scale / front.camera.scale;
    const x = camera.x - front.camera.x * real, y = camera.y - front.camera.y * real;
    context.imageSmoothingEnabled = real !== 1;
    context.drawImage(front.canvas, x, y, front.wide * real, front.high * real);
  }
}

/** One picture, larger than the window, and what it shows. */
class Sheet {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d", { alpha: false, willReadFrequently: true }));
    this.camera = new Camera();
    /** @type {Look} */
    this.look = { done: 0, travel: false, numbers: false, drawn: false };
    this.wide = this.high = this.ratio = 0;
    this.inner = { wide: 0, high: 0 };
    this.valid = false;
  }

  /** @type {(camera: Camera, look: Look, size: {wide: number, high: number, ratio: number}) => Sheet} */
  ready(camera, look, size) {
    const left = Math.round(size.wide * MARGIN), top = Math.round(size.high * MARGIN);
    this.wide = size.wide + 2 * left;
    this.high = size.high + 2 * top;
    this.ratio = size.ratio;
    this.inner = { wide: size.wide, high: size.high };
    const wide = Math.round(this.wide * size.ratio), high = Math.round(this.high * size.ratio);
    if (this.canvas.width !== wide || this.canvas.height !== high) {
      this.canvas.width = wide;
      this.canvas.height = high;
    }
    this.context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    this.camera.like(camera);
    this.camera.pan(left, top);
    this.look = { ...look };
    this.valid = false;
    return this;
  }

  /** Whether it is sharp, and reaches over the whole window. */
  /** @type {(camera: Camera, look: Look, size: {wide: number, high: number, ratio: number}) => boolean} */
  shows(camera, look, size) {
    const mine = this.look, x = camera.x - this.camera.x, y = camera.y - this.camera.y;
    return this.valid && camera.scale === this.camera.scale && size.ratio === this.ratio
      && mine.done === look.done && mine.travel === look.travel && mine.numbers === look.numbers && mine.drawn === look.drawn
      && x <= 0 && y <= 0 && x + this.wide >= size.wide && y + this.high >= size.high;
  }
}
