/** @import { Stage } from "./stage.js" */

const CLICK_PX = 5;

/**
 * Wheel, drag, pinch, click and the pointer's way over a drawing.
 *
 * @param {Stage} stage
 * @param {object} does
 * @param {(stage: Stage) => void} does.moved the view has moved
 * @param {(contour: number, stage: Stage) => void} does.picked
 * @param {(contour: number, at: [number, number] | null, stage: Stage) => void} does.hovered
 * @param {(event: PointerEvent, stage: Stage) => boolean} does.taken whether somebody else has taken the event
 */
export function listen(stage, does) {
  const { canvas, camera } = stage;
  /** @type {Map<number, [number, number]>} */
  const down = new Map();
  let far = 0;
  /** @type {(event: MouseEvent) => [number, number]} */
  const at = event => onCanvas(event, stage);
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 30 : 1;
    camera.zoom(Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0016)), ...at(event));
    does.moved(stage);
  }, { passive: false });
  canvas.addEventListener("pointerdown", event => {
    if (does.taken(event, stage) || event.button > 1) return;
    canvas.setPointerCapture(event.pointerId);
    down.set(event.pointerId, at(event));
    far = down.size > 1 ? CLICK_PX : 0;
  });
  canvas.addEventListener("pointermove", event => {
    if (does.taken(event, stage)) return;
    const [x, y] = at(event), last = down.get(event.pointerId);
    if (!last) {
      does.hovered(stage.pick(x, y), stage.toSheet(x, y), stage);
      return;
    }
    far += Math.hypot(x - last[0], y - last[1]);
    down.set(event.pointerId, [x, y]);
    const others = [...down].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    if (others.length) pinch(stage, others[0], last, [x, y]);
    else if (far > CLICK_PX) camera.pan(x - last[0], y - last[1]);
    does.moved(stage);
  });
  /** @param {PointerEvent} event */
  const up = event => {
    const was = down.get(event.pointerId);
    down.delete(event.pointerId); // whoever takes its end: a finger that is gone is no second finger of the next pinch
    if (does.taken(event, stage)) return;
    if (was && event.type === "pointerup" && far < CLICK_PX && !down.size) does.picked(stage.pick(...was), stage);
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => does.hovered(-1, null, stage));
  canvas.addEventListener("dblclick", event => {
    camera.zoom(2, ...at(event));
    does.moved(stage);
  });
}

/**
 * One of two fingers has moved from one place to another: the view goes with both.
 *
 * @type {(stage: Stage, other: [number, number], from: [number, number], to: [number, number]) => void}
 */
function pinch(stage, other, from, to) {
  const before = Math.hypot(from[0] - other[0], from[1] - other[1]);
  const after = Math.hypot(to[0] - other[0], to[1] - other[1]);
  stage.camera.pan((to[0] - from[0]) / 2, (to[1] - from[1]) / 2);
  if (before > 10) stage.camera.zoom(after / before, (to[0] + other[0]) / 2, (to[1] + other[1]) / 2);
}

/**
 * Where a pointer is on a drawing, pixels of its canvas.
 *
 * @type {(event: MouseEvent, stage: Stage) => [number, number]}
 */
export function onCanvas(event, { canvas }) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}
