/** @import { Work } from "./work.js" */
import { askServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan, quoted } from "./locking.js";

const FAR_PX = 6, LOOK_MS = 150;

/**
 * A row of the order, or a part on the drawing, dragged to another place: the verdict is there before it is dropped.
 *
 * @param {any} app
 * @param {Work} work
 */
export function dragging(app, work) {
  const verdict = make("div", { id: "hands-verdict", role: "status", hidden: true });
  document.body.append(verdict);
  const judge = new Judge(work, verdict);
  rowDrags(app, work, judge);
  partDrags(app, work, judge);
}

/** Asks what a move would do, the last place only, and shows it by the pointer. */
class Judge {
  /**
   * @param {Work} work
   * @param {HTMLElement} place
   */
  constructor(work, place) {
    this.work = work;
    this.place = place;
    this.asked = "";
    /** @type {any} */
    this.told = null;
    /** @type {AbortController | null} */
    this.going = null;
    this.later = 0;
  }

  /** @type {(names: string[], to: number, x: number, y: number) => void} */
  show(names, to, x, y) {
    this.place.hidden = false;
    this.place.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - this.place.offsetWidth - 8))}px`;
    this.place.style.top = `${Math.max(4, Math.min(y + 18, innerHeight - this.place.offsetHeight - 8))}px`;
    const wanted = `${names.join("\n")}\n${to}`;
    if (wanted === this.asked) return;
    this.asked = wanted;
    this.told = null;
    clearTimeout(this.later);
    this.#ask(names, to, false).then(told => {
      if (told?.lawful && this.asked === wanted) this.later = setTimeout(() => this.#ask(names, to, true), LOOK_MS);
    });
  }

  /** @type {(names: string[], to: number, look: boolean) => Promise<any>} */
  async #ask(names, to, look) {
    this.going?.abort();
    this.going = new AbortController();
    const query = new URLSearchParams([...names.map(name => ["contours", name]), ["place", String(to)], ["look", look ? "1" : "0"]]);
    try {
      const told = await askServer(`${this.work.path("move")}?${query}`, this.going.signal);
      this.told = told;
      const gives = told.gives_way.length ? `locked there, ${told.gives_way.join(" and ")} gives way` : "";
      this.place.className = told.lawful ? "good" : gives ? "gives" : "bad";
      this.place.replaceChildren(told.text, gives ? make("small", {}, ` ${gives}`) : "");
      return told;
    } catch (error) {
      if (/** @type {Error} */ (error).name !== "AbortError") this.place.textContent = /** @type {Error} */ (error).message;
      return null;
    }
  }

  /** Shows nothing any more. */
  hide() {
    clearTimeout(this.later);
    this.going?.abort();
    this.place.hidden = true;
    this.asked = "";
    this.told = null;
  }
}

/** @type {(app: any, work: Work, judge: Judge) => void} */
function rowDrags(app, work, judge) {
  const holder = /** @type {HTMLElement} */ (document.getElementById("orders"));
  /** @type {{names: string[], from: number, x: number, y: number, far: boolean, to: number} | null} */
  let drag = null;
  app.row((/** @type {HTMLElement} */ row) => { row.style.touchAction = "pan-y"; });
  const side = () => app.data.sides[0];
  /** The row under the pointer, as a place from 0. */
  /** @param {PointerEvent} event */
  const under = event => {
    const row = document.elementsFromPoint(Math.max(1, Math.min(event.clientX, holder.getBoundingClientRect().right - 4)), event.clientY).find(one => one.closest?.("#orders .row"));
    const found = row?.closest(".row");
    return found ? Number(found.id.slice(4)) : -1;
  };
  holder.addEventListener("pointerdown", event => {
    const row = /** @type {HTMLElement} */ (event.target).closest(".row");
    if (!row || event.button || !side() || !work.state.fits) return;
    if (event.pointerType === "touch" && !/** @type {HTMLElement} */ (event.target).closest(".no, .kind")) return;
    const k = Number(row.id.slice(4)), contour = app.data.nest.contours[side().cuts[k].contour];
    const names = event.shiftKey ? [contour.id] : runOf(app, contour);
    drag = { names, from: k, x: event.clientX, y: event.clientY, far: false, to: k };
  });
  addEventListener("pointermove", event => {
    if (!drag) return;
    if (!drag.far && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < FAR_PX) return;
    drag.far = true;
    const k = under(event);
    if (k >= 0) drag.to = k;
    document.body.classList.add("dragging");
    judge.show(drag.names, side().made + placeOf(drag), event.clientX, event.clientY);
  });
  const end = (/** @type {PointerEvent} */ event) => {
    if (!drag) return;
    const { far, to, from, names } = drag, place = placeOf(drag);
    drag = null;
    document.body.classList.remove("dragging");
    if (far) {
      judge.hide();
      addEventListener("click", stopOnce, { capture: true, once: true });
      setTimeout(() => removeEventListener("click", stopOnce, { capture: true }), 50);
      if (event.type === "pointerup" && to !== from) drop(work, names, side().made + place);
    }
  };
  addEventListener("pointerup", end);
  addEventListener("pointercancel", end);
  addEventListener("keydown", event => { if (event.key === "Escape" && drag) { drag = null; judge.hide(); document.body.classList.remove("dragging"); } });
  app.key("<", () => byKey(app, work, -1), "move the chosen cut one place earlier");
  app.key(">", () => byKey(app, work, 1), "move the chosen cut one place later");
}

/** Where the first of a run is cut, from 1, that is dropped on a row: the row's place, or the run ends there. */
/** @type {(drag: {names: string[], from: number, to: number}) => number} */
function placeOf({ names, from, to }) {
  return Math.max(1, to > from ? to + 2 - names.length : to + 1);
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

/** @param {Event} event */
function stopOnce(event) {
  event.stopPropagation();
  event.preventDefault();
}

/** Contours of a part, in the order in which they are cut. */
/** @type {(app: any, contour: any) => string[]} */
function partOf(app, contour) {
  if (contour.part < 0) return [contour.id];
  const { contours } = app.data.nest;
  return app.data.sides[0].cuts.map((/** @type {any} */ cut) => contours[cut.contour]).filter((/** @type {any} */ one) => one.part === contour.part).map((/** @type {any} */ one) => one.id);
}

/** The chosen contour one place on or back, by the keyboard. */
/** @type {(app: any, work: Work, by: number) => void} */
function byKey(app, work, by) {
  const side = app.data.sides[0], k = side?.cuts.findIndex((/** @type {any} */ cut) => cut.contour === app.state.selected) ?? -1;
  const to = k + by;
  if (k < 0 || to < 0 || to >= side.cuts.length || !work.state.fits) return;
  drop(work, [app.data.nest.contours[app.state.selected].id], side.made + to + 1);
}

/** @type {(work: Work, names: string[], to: number) => Promise<void>} */
async function drop(work, names, to) {
  const query = new URLSearchParams([...names.map(name => ["contours", name]), ["place", String(to)]]);
  const told = await askServer(`${work.path("move")}?${query}`).catch(error => { work.say(error.message); return null; });
  if (!told) return;
  work.say(told.text);
  await lockAndPlan(work, [...told.undone.map((/** @type {string} */ line) => ({ unlock: line })), ...told.locked.map((/** @type {string} */ line) => ({ lock: line }))]);
}

/** A part that is dragged onto another one goes before it; held with Shift, so that dragging alone moves the view. */
/** @type {(app: any, work: Work, judge: Judge) => void} */
function partDrags(app, work, judge) {
  /** @type {{names: string[], part: number, over: number, x: number, y: number} | null} */
  let drag = null;
  /** @type {(event: PointerEvent, stage: any) => [number, number]} */
  const at = (event, stage) => {
    const box = stage.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  app.gesture((/** @type {PointerEvent} */ event, /** @type {any} */ stage) => {
    const [x, y] = at(event, stage);
    if (event.type === "pointerdown" && work.tabFor) {
      const [mx, my] = stage.toSheet(x, y);
      const id = work.tabFor;
      work.tabFor = "";
      lockAndPlan(work, [{ lock: `${quoted(id)} tab (${mx.toFixed(2)}, ${my.toFixed(2)})` }]);
      return true;
    }
    if (event.type === "pointerdown" && event.shiftKey && work.state.fits && app.data.sides[0]) {
      const k = stage.pick(x, y);
      if (k < 0) return false;
      drag = { names: partOf(app, app.data.nest.contours[k]), part: app.data.nest.contours[k].part, over: -1, x, y };
      stage.canvas.setPointerCapture(event.pointerId);
      return true;
    }
    if (!drag) return false;
    if (event.type === "pointermove") {
      drag.x = x;
      drag.y = y;
      const k = stage.pick(x, y);
      if (k >= 0 && app.data.nest.contours[k].part !== drag.part) {
        drag.over = k;
        judge.show(drag.names, placeBefore(app, drag, k), event.clientX, event.clientY);
      }
      stage.draw();
      return true;
    }
    const { names, over } = drag, to = over < 0 ? 0 : placeBefore(app, drag, over);
    drag = null;
    judge.hide();
    stage.draw();
    if (event.type === "pointerup" && to) drop(work, names, to);
    return true;
  });
  app.layer((/** @type {CanvasRenderingContext2D} */ context, /** @type {any} */ stage) => {
    if (!drag) return;
    const k = app.data.nest.contours.findIndex((/** @type {any} */ one) => one.id === drag?.names.at(-1));
    const [x0, y0, x1, y1] = stage.scenery.outlines.bounds[k];
    const [fromX, fromY] = stage.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
    context.strokeStyle = stage.palette.ink.select;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(fromX, fromY);
    context.lineTo(drag.x, drag.y);
    context.stroke();
  });
}

/** The place of a part that goes before another: that of the other's first cut, once the part is taken out. */
/** @type {(app: any, drag: {names: string[]}, over: number) => number} */
function placeBefore(app, drag, over) {
  const side = app.data.sides[0], all = app.data.nest.contours;
  const left = side.cuts.map((/** @type {any} */ cut) => all[cut.contour]).filter((/** @type {any} */ one) => !drag.names.includes(one.id));
  const first = left.findIndex((/** @type {any} */ one) => one.part === all[over].part);
  return side.made + Math.max(0, first) + 1;
}
