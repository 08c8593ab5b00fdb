/** @import { Work } from "./work.js" */
/** @import { Judge } from "./judge.js" */
import { byId, make } from "./elements.js";
import { dropThere } from "./judge.js";
import { ROW_PX } from "./orders.js";
import { placeOf, scrolledBy } from "./places.js";
import { tr } from "./say.js";

const FAR_PX = 6, SCROLLED_PX_S = 700;

/**
 * @typedef {object} RowDrag
 * @property {string[]} names
 * @property {number} from row, from 0
 * @property {number} to
 * @property {PointerEvent} begun
 * @property {PointerEvent} last
 * @property {boolean} far whether it has left its place
 */

/**
 * Rows of the order are dragged: by the mouse anywhere, by a finger at their grip, for the list scrolls under a finger.
 *
 * @param {any} app
 * @param {Work} work
 * @param {Judge} judge
 */
export function rowDrags(app, work, judge) {
  const holder = byId("orders"), line = make("i", { class: "drop-line", hidden: true });
  /** @type {RowDrag | null} */
  let drag = null;
  /** @type {{x: number, y: number, pointer: number} | null} a press that may become a drag that is not taken: then it is told why */
  let refused = null;
  app.row((/** @type {HTMLElement} */ row) => row.querySelector(".no")?.classList.add("grip"));
  const side = () => app.data.sides[0];
  const follow = () => {
    if (!drag) return;
    const { names, from, last } = drag;
    drag.to = rowUnder(holder, last.clientY, side().cuts.length);
    line.style.top = `${(drag.to > from ? drag.to + 1 : drag.to) * ROW_PX}px`;
    judge.show({ names, to: side().made + placeOf(drag), plan: work.state.shown }, last);
  };
  const end = () => {
    drag = null;
    line.hidden = true;
    judge.hide();
    document.body.classList.remove("dragging");
  };
  /** Near its upper or lower end the list goes on under the pointer. */
  /** @param {number} before */
  const scroll = before => requestAnimationFrame(now => {
    if (!drag) return;
    const by = scrolledBy(holder.getBoundingClientRect(), drag.last.clientY), top = holder.scrollTop;
    if (by) holder.scrollTop += (by * SCROLLED_PX_S * Math.min(100, now - before)) / 1000;
    if (holder.scrollTop !== top) follow();
    scroll(now);
  });
  holder.addEventListener("pointerdown", event => {
    const target = /** @type {HTMLElement} */ (event.target), row = target.closest(".row");
    if (drag || !row || event.button || !side()) return;
    if (event.pointerType === "touch" && !target.closest(".grip")) return;
    if (work.whyNot) {
      refused = { x: event.clientX, y: event.clientY, pointer: event.pointerId };
      return;
    }
    const from = Number(row.id.slice(4)), contour = app.data.nest.contours[side().cuts[from].contour];
    drag = { names: event.shiftKey ? [contour.id] : runOf(app, contour), from, to: from, begun: event, last: event, far: false };
  });
  addEventListener("pointermove", event => {
    if (refused?.pointer === event.pointerId && event.buttons && Math.hypot(event.clientX - refused.x, event.clientY - refused.y) > FAR_PX) {
      refused = null;
      work.say(work.whyNot, "warn");
    }
    if (drag?.begun.pointerId !== event.pointerId) return;
    if (!event.buttons) return end(); // it was let go where nobody saw it: outside the window
    drag.last = event;
    if (!drag.far) {
      if (Math.hypot(event.clientX - drag.begun.clientX, event.clientY - drag.begun.clientY) < FAR_PX) return;
      drag.far = true;
      holder.setPointerCapture(event.pointerId);
      holder.firstElementChild?.append(line);
      line.hidden = false;
      document.body.classList.add("dragging");
      scroll(performance.now());
    }
    follow();
  });
  addEventListener("pointerup", event => {
    if (drag?.begun.pointerId !== event.pointerId) return;
    const { far, from, to, names } = drag, place = side().made + placeOf(drag);
    end();
    if (far && to !== from && work.free) void dropThere(work, { names, to: place, plan: work.state.shown });
  });
  addEventListener("pointercancel", event => { if (drag?.begun.pointerId === event.pointerId) end(); });
  work.on((_, what) => {
    if (!drag || (what !== "drawn" && work.free)) return;
    end();
    work.say(tr("the plan has changed meanwhile: look at what is there now, and do it again"), "warn");
  });
  addEventListener("keydown", event => {
    if (event.key !== "Escape" || !drag) return;
    event.stopPropagation();
    end();
  }, { capture: true });
}

/**
 * The row at a height of the window, the first or the last one beyond the list.
 *
 * @type {(holder: HTMLElement, y: number, count: number) => number}
 */
function rowUnder(holder, y, count) {
  const box = holder.getBoundingClientRect(), within = Math.max(box.top, Math.min(box.bottom - 1, y));
  return Math.max(0, Math.min(count - 1, Math.floor((within - box.top + holder.scrollTop) / ROW_PX)));
}

/** An outer contour moves with what is cut in one go with it, its part's holes; any other moves alone. */
/** @type {(app: any, contour: any) => string[]} */
function runOf(app, contour) {
  const { contours } = app.data.nest, order = app.data.sides[0].cuts.map((/** @type {any} */ cut) => contours[cut.contour]);
  const end = order.indexOf(contour);
  let begin = end;
  while (contour.kind === "outer" && begin > 0 && contour.part >= 0 && order[begin - 1].part === contour.part) begin -= 1;
  return order.slice(begin, end + 1).map((/** @type {any} */ one) => one.id);
}
