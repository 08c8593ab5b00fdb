/** @import { PageData } from "./types.js" */
/** @import { Store } from "./store.js" */
/** @import { BentFrames } from "./bent.js" */
/** @import { HeatFrames } from "./heat.js" */
import { Camera } from "./camera.js";
import { Ground } from "./ground.js";
import { Outlines } from "./outlines.js";
import { paintOver } from "./overlay.js";
import { palette } from "./palette.js";
import { Scenery } from "./scenery.js";
import { momentAt, timelineOf } from "./timeline.js";

const NEAR_PX = 7, LEAST_ZOOM = 0.4, LEAST_SEEN_PX = 12, BUTTONS_PX = 40;
/** Parts that can be shown so many times as large as on the whole sheet are what the page opens with. */
const PARTS_FIRST = 1.6;

/** @type {(values: number[]) => number} */
const least = values => values.reduce((a, b) => Math.min(a, b));
/** @type {(values: number[]) => number} */
const most = values => values.reduce((a, b) => Math.max(a, b));

/** One drawing of the nest on a canvas, with the plan of one side. */
export class Stage {
  /**
   * @param {PageData} data
   * @param {number} side
   * @param {Store} store
   * @param {Outlines} outlines
   */
  constructor(data, side, store, outlines) {
    this.data = data;
    this.side = side;
    this.store = store;
    this.canvas = document.createElement("canvas");
    this.context = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d", { alpha: false }));
    this.camera = new Camera();
    /** What the window was fitted to last: all parts, or the whole sheet. */
    this.fitted = { parts: /** @type {boolean | undefined} */ (undefined), camera: new Camera() };
    this.plan = data.sides[side] ?? null;
    this.timeline = this.plan ? timelineOf(this.plan) : { moments: [], begins_s: [], ends_s: [], firsts: [], end_s: 0, timed: false };
    this.scenery = new Scenery(data, this.plan, outlines);
    this.ground = new Ground(this.scenery);
    this.palette = palette();
    /** @type {HeatFrames | null} */
    this.heat = null;
    /** @type {BentFrames | null} */
    this.bent = null;
    /** @type {((context: CanvasRenderingContext2D, stage: Stage) => void)[]} */
    this.layers = [];
    /** @type {[number, number] | null} */
    this.cross = null;
    this.size = { wide: 0, high: 0, ratio: 1 };
    /** Height of the buttons that lie over the drawing, pixels. */
    this.buttons = BUTTONS_PX;
    this.asked = 0;
    this.frames = 0;
    this.sharp = false;
    this.draw = this.draw.bind(this);
  }

  /** Takes the size of its place on the page; true where that is another than before. */
  resize() {
    const box = this.canvas.parentElement?.getBoundingClientRect();
    const wide = Math.max(1, Math.round(box?.width ?? 1)), high = Math.max(1, Math.round(box?.height ?? 1));
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (wide === this.size.wide && high === this.size.high && ratio === this.size.ratio) return false;
    this.size = { wide, high, ratio };
    this.canvas.width = Math.round(wide * ratio);
    this.canvas.height = Math.round(high * ratio);
    return true;
  }

  /** Whether the view is as it was fitted, as when the page was opened. */
  get fits() {
    return !this.camera.least || this.camera.same(this.fitted.camera);
  }

  /** Height that the buttons over the drawing leave free. */
  get #free() { return this.size.high > 5 * BUTTONS_PX ? this.size.high - this.buttons : this.size.high; }

  /** @type {(bounds: number[]) => Camera} */
  #around(bounds) {
    const camera = new Camera();
    camera.fit(bounds, this.size.wide, this.#free);
    return camera;
  }

  /** All parts in the window, whatever is free around them, or the whole sheet; where nobody says, as the page opens. */
  /** @param {boolean} [parts] */
  fit(parts) {
    const [x0, y0, x1, y1] = this.data.nest.bounds, home = this.plan ? this.plan.home : [x0, y0], boxes = this.scenery.outlines.bounds;
    const whole = this.#around([Math.min(x0, home[0]), Math.min(y0, home[1]), Math.max(x1, home[0]), Math.max(y1, home[1])]);
    const near = boxes.length ? this.#around([0, 1, 2, 3].map(k => (k < 2 ? least : most)(boxes.map(box => box[k])))) : whole;
    parts ??= near.scale > PARTS_FIRST * whole.scale;
    this.camera.like(parts ? near : whole);
    this.camera.least = whole.scale * LEAST_ZOOM;
    this.fitted = { parts, camera: new Camera() };
    this.fitted.camera.like(this.camera);
  }

  /** Brings a contour into view, nearer if it is tiny. */
  /** @param {number} contour */
  show(contour) {
    const [x0, y0, x1, y1] = this.scenery.outlines.bounds[contour], { wide, high } = this.size;
    const size = Math.max(x1 - x0, y1 - y0, 1);
    if (size * this.camera.scale < LEAST_SEEN_PX) this.camera.zoom((2 * LEAST_SEEN_PX) / (size * this.camera.scale), wide / 2, high / 2);
    const [x, y] = this.camera.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
    const seen = x > 20 && x < wide - 20 && y > 20 && y < high - 20;
    if (!seen) this.camera.pan(wide / 2 - x, high / 2 - y);
  }

  /** @type {(px: number, py: number) => number} */
  pick(px, py) {
    const [x, y] = this.camera.toSheet(px, py);
    return this.scenery.outlines.at(x, y, NEAR_PX / this.camera.scale);
  }

  /** @type {(px: number, py: number) => [number, number]} */
  toSheet(px, py) {
    return this.camera.toSheet(px, py);
  }

  /** @type {(x: number, y: number) => [number, number]} */
  toScreen(x, y) {
    return this.camera.toScreen(x, y);
  }

  /** Draws with the next frame. */
  draw() {
    if (!this.asked) this.asked = requestAnimationFrame(() => this.now());
  }

  /** Draws now, and goes on until the picture is sharp. */
  now() {
    this.asked = 0;
    if (!this.size.wide) return;
    const { context, camera, size } = this, { state } = this.store;
    context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    const { done } = momentAt(this.timeline, state.time_s);
    const bent = state.bent && this.bent; // what is drawn many times as far away needs the room of numbers and ways
    const look = { done, travel: state.travel && !bent, numbers: state.numbers && !bent, drawn: state.drawn };
    this.sharp = this.ground.draw(context, camera, this.palette, look, size);
    if (state.heat && this.heat) this.heat.paint(context, camera, state.time_s);
    paintOver(context, camera, this.palette, this.scenery, this.timeline, state);
    if (bent) bent.paint(context, camera, this.palette, this.scenery, state.time_s);
    if (this.cross) this.#crosshair(this.cross);
    for (const fn of this.layers) fn(context, this);
    this.frames++;
    this.canvas.dataset.sharp = String(this.sharp);
    if (!this.sharp) this.draw();
  }

  /** The colours have changed. */
  recolour() {
    this.palette = palette();
    this.ground.forget();
    this.draw();
  }

  /** @param {[number, number]} at mm */
  #crosshair(at) {
    const [x, y] = this.camera.toScreen(...at), { context } = this;
    context.strokeStyle = this.palette.ink.select;
    context.lineWidth = 1;
    context.setLineDash([2, 3]);
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, this.size.high);
    context.moveTo(0, y);
    context.lineTo(this.size.wide, y);
    context.stroke();
    context.setLineDash([]);
  }
}
