/** @import { Work } from "./work.js" */
/** @import { Judge, Move } from "./judge.js" */
import { onCanvas } from "./gestures.js";
import { dropThere } from "./judge.js";
import { tr } from "./say.js";

const HELD_MS = 450, HELD_STILL_PX = 8;

/**
 * @typedef {object} PartDrag
 * @property {number} pointer
 * @property {string[]} names
 * @property {number} contour the one that it was taken by
 * @property {number} over another part's contour under the pointer, -1 for none
 * @property {number} x pixels of the canvas
 * @property {number} y
 */

/**
 * A part that is dragged onto another one is cut before it. A mouse holds Shift, a finger stays on the part until it is
 * held, for dragging alone moves the view.
 *
 * @param {any} app
 * @param {Work} work
 * @param {Judge} judge
 */
export function partDrags(app, work, judge) {
  /** @type {PartDrag | null} */
  let drag = null;
  /** @type {{pointer: number, x: number, y: number, timer: number} | null} a finger that may come to hold a part */
  let finger = null;
  /** @type {(event: PointerEvent, stage: any) => boolean} */
  const take = (event, stage) => {
    const [x, y] = onCanvas(event, stage), k = app.data.sides[0] ? stage.pick(x, y) : -1;
    if (k < 0) return false;
    if (work.whyNot) {
      work.say(work.whyNot, "warn");
      return false;
    }
    drag = { pointer: event.pointerId, names: partOf(app, app.data.nest.contours[k]), contour: k, over: -1, x, y };
    if (!stage.canvas.hasPointerCapture(event.pointerId)) stage.canvas.setPointerCapture(event.pointerId);
    stage.draw();
    return true;
  };
  const release = () => {
    if (finger) clearTimeout(finger.timer);
    finger = null;
  };
  const end = () => {
    drag = null;
    judge.hide();
    app.stages[0].draw();
  };
  /** @type {(event: PointerEvent, stage: any) => boolean} */
  const begin = (event, stage) => {
    if (event.pointerType === "mouse") return event.shiftKey && !event.button && take(event, stage);
    if (finger) { // a second one: they pinch
      release();
      return false;
    }
    const timer = setTimeout(() => {
      finger = null;
      if (take(event, stage)) judge.say(tr("{name} is held: drag it onto the part that it is to be cut before", { name: drag?.names.at(-1) }), event);
    }, HELD_MS);
    finger = { pointer: event.pointerId, x: event.clientX, y: event.clientY, timer };
    return false;
  };
  app.gesture((/** @type {PointerEvent} */ event, /** @type {any} */ stage) => {
    if (event.type === "pointerdown") return drag ? true : begin(event, stage);
    if (finger?.pointer === event.pointerId
      && (event.type !== "pointermove" || Math.hypot(event.clientX - finger.x, event.clientY - finger.y) > HELD_STILL_PX)) release();
    if (drag?.pointer !== event.pointerId) return Boolean(drag);
    if (event.type === "pointermove" && !event.buttons) { // let go where nobody saw it
      end();
      return true;
    }
    if (event.type === "pointermove") {
      [drag.x, drag.y] = onCanvas(event, stage);
      const k = stage.pick(drag.x, drag.y), { contours } = app.data.nest;
      drag.over = k >= 0 && k !== drag.contour && (contours[k].part !== contours[drag.contour].part || contours[k].part < 0) ? k : -1;
      if (drag.over < 0) judge.hide();
      else judge.show(moveBefore(app, work, drag.names, drag.over), event);
      stage.draw();
      return true;
    }
    const { names, over } = drag;
    end();
    if (event.type === "pointerup" && over >= 0 && work.free) void dropThere(work, moveBefore(app, work, names, over));
    return true;
  });
  addEventListener("keydown", event => {
    if (event.key !== "Escape" || !drag) return;
    event.stopPropagation();
    end();
  }, { capture: true });
  work.on(() => { if (drag && !work.free) end(); });
  document.addEventListener("contextmenu", event => { if (drag) event.preventDefault(); });
  app.layer((/** @type {CanvasRenderingContext2D} */ context, /** @type {any} */ stage) => {
    if (!drag) return;
    const [x0, y0, x1, y1] = stage.scenery.outlines.bounds[drag.contour];
    const [fromX, fromY] = stage.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
    context.strokeStyle = stage.palette.ink.select;
    context.lineWidth = 2;
    context.setLineDash([]);
    context.beginPath();
    context.moveTo(fromX, fromY);
    context.lineTo(drag.x, drag.y);
    context.stroke();
  });
}

/** Contours of a part, in the order in which they are cut. */
/** @type {(app: any, contour: any) => string[]} */
function partOf(app, contour) {
  if (contour.part < 0) return [contour.id];
  const { contours } = app.data.nest;
  return app.data.sides[0].cuts.map((/** @type {any} */ cut) => contours[cut.contour]).filter((/** @type {any} */ one) => one.part === contour.part).map((/** @type {any} */ one) => one.id);
}

/** A part goes before another: its place is that of the other's first cut, once the part is taken out. */
/** @type {(app: any, work: Work, names: string[], over: number) => Move} */
function moveBefore(app, work, names, over) {
  const side = app.data.sides[0], all = app.data.nest.contours;
  const left = side.cuts.map((/** @type {any} */ cut) => all[cut.contour]).filter((/** @type {any} */ one) => !names.includes(one.id));
  const first = left.findIndex((/** @type {any} */ one) => one.id === all[over].id || (one.part >= 0 && one.part === all[over].part));
  return { names, to: side.made + Math.max(0, first) + 1, plan: work.state.shown };
}
