/** @import { Work } from "./work.js" */
import { onCanvas } from "./gestures.js";
import { lockAndPlan, quoted } from "./locking.js";
import { nearestOn, placeAlong } from "./nearest.js";
import { tr } from "./say.js";

const STEP_PX = 6, FAR_STEP_PX = 60, REACH_PX = 40, MARK_PX = 14, MARK_WIDE_PX = 5;

/** @type {Record<string, number>} */
const SLIDES = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 };

/** @typedef {{contour: number, x: number, y: number}} TabPlace a place of an outline, mm */

/**
 * A tab is drawn: with the pointer on the drawing it slides along an outline, and where it is let go it is locked.
 * On a chosen part the arrow keys slide it, and Enter locks it.
 *
 * @param {any} app
 * @param {Work} work
 * @returns {(contour: number) => void} begins to draw one on a contour, or with -1 on the outline that is nearest
 */
export function tabDrawing(app, work) {
  let drawing = false, on = -1, along = 0;
  /** @type {number | null} the pointer that is down */
  let down = null;
  /** @type {TabPlace | null} */
  let at = null;
  const show = () => {
    document.body.classList.toggle("drawing-tab", drawing);
    app.stages[0].draw();
  };
  const end = () => {
    drawing = false;
    down = at = null;
    show();
  };
  /** @param {number} contour */
  const begin = contour => {
    if (drawing || work.compared) return end();
    drawing = true;
    on = contour;
    along = 0;
    const where = on < 0 ? tr("draw a tab: press on an outline, slide along it, and let go where the tab is to be (Escape: none)")
      : tr("draw a tab: press on the outline of {id}, slide along it, and let go where the tab is to be; or slide it by the arrow keys, and press Enter (Escape: none)", { id: app.data.nest.contours[on].id });
    work.say(where);
    show();
  };
  /** @param {TabPlace} place */
  const lock = place => {
    const name = quoted(app.data.nest.contours[place.contour].id);
    void lockAndPlan(work, [{ lock: `${name} tab (${place.x.toFixed(2)}, ${place.y.toFixed(2)})` }], work.state.shown);
  };
  /** @param {number} px */
  const slide = px => {
    const [stage] = app.stages;
    along += px / stage.camera.scale;
    at = { contour: on, ...placeAlong(stage.scenery.outlines.points(on, 0), along) };
    work.say(tr("a tab at ({x}, {y})", { x: at.x.toFixed(1), y: at.y.toFixed(1) }));
    stage.draw();
  };
  app.key("T", () => begin(outerOf(app, app.state.selected)), tr("draw a tab on the chosen part, or on any"));
  app.gesture((/** @type {PointerEvent} */ event, /** @type {any} */ stage) => {
    if (!drawing || (down !== null && event.pointerId !== down)) return false;
    if (down !== null && event.type === "pointermove" && !event.buttons) { // let go where nobody saw it
      end();
      return true;
    }
    at = placeUnder(app, stage, on, event) ?? (down === null ? null : at);
    stage.draw();
    if (event.type === "pointermove") return down !== null;
    if (event.type === "pointerdown") {
      if (!at || event.button) return false;
      down = event.pointerId;
      stage.canvas.setPointerCapture(event.pointerId);
      return true;
    }
    if (down === null) return false;
    const place = at;
    end();
    if (event.type === "pointerup" && place) lock(place);
    return true;
  });
  addEventListener("keydown", event => {
    const typed = /^(INPUT|SELECT|TEXTAREA)$/.test(/** @type {HTMLElement} */ (event.target).tagName) && event.key !== "Escape";
    if (!drawing || typed) return;
    const step = on < 0 ? undefined : SLIDES[event.key];
    if (step) slide(step * (event.shiftKey ? FAR_STEP_PX : STEP_PX));
    else if (event.key === "Enter" && at && on >= 0) {
      const place = at;
      end();
      lock(place);
    } else if (event.key === "Escape") {
      end();
      work.say(tr("no tab is drawn"));
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }, { capture: true });
  work.on((_, what) => { if (drawing && what === "drawn") end(); });
  app.layer((/** @type {CanvasRenderingContext2D} */ context, /** @type {any} */ stage) => {
    if (!drawing || !at) return;
    const [x, y] = stage.toScreen(at.x, at.y);
    context.setLineDash([]);
    context.lineWidth = MARK_WIDE_PX + 3;
    context.strokeStyle = stage.palette.ink.halo;
    for (let k = 0; k < 2; k++) {
      context.beginPath();
      context.arc(x, y, MARK_PX, 0, 7);
      context.moveTo(x - MARK_PX, y);
      context.lineTo(x + MARK_PX, y);
      context.moveTo(x, y - MARK_PX);
      context.lineTo(x, y + MARK_PX);
      context.stroke();
      context.lineWidth = MARK_WIDE_PX / 2;
      context.strokeStyle = stage.palette.ink.tab;
    }
  });
  return begin;
}

/** The outline of the part that a contour is of; -1 for none. */
/** @type {(app: any, contour: number) => number} */
function outerOf(app, contour) {
  const { contours } = app.data.nest, part = contours[contour]?.part ?? -1;
  return part < 0 ? -1 : contours.findIndex((/** @type {any} */ one) => one.part === part && one.kind === "outer");
}

/** The place of an outline that the pointer is at; null where it is at none. */
/** @type {(app: any, stage: any, on: number, event: PointerEvent) => TabPlace | null} */
function placeUnder(app, stage, on, event) {
  const [x, y] = stage.toSheet(...onCanvas(event, stage)), reach = REACH_PX / stage.camera.scale, { outlines } = stage.scenery;
  const { contours } = app.data.nest;
  const near = on >= 0 ? [on] : outlines.grid.within(x - reach, y - reach, x + reach, y + reach).filter((/** @type {number} */ k) => contours[k].kind === "outer");
  /** @type {TabPlace | null} */
  let best = null;
  let least = reach;
  for (const contour of near) {
    const place = nearestOn(outlines.points(contour, 0), true, x, y);
    if (place.away <= least) {
      least = place.away;
      best = { contour, x: place.x, y: place.y };
    }
  }
  return best;
}
