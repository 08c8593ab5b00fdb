/** @import { PageData } from "./types.js" */
import { make } from "./elements.js";
import { listen } from "./gestures.js";
import { Outlines } from "./outlines.js";
import { tr, trn } from "./say.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";

const NEAR_MM = 60;

/**
 * @typedef {object} Problem
 * @property {string} text
 * @property {string[]} contours
 * @property {[number, number] | null} at
 * @property {boolean} mends
 */

/**
 * A drawing that cannot be cut: each problem is a mark where it is, with its sentence, and a button where repair mends it.
 *
 * @param {{said: string, page: PageData, lines: Problem[]}} problems
 * @param {() => void} repair
 * @returns {HTMLElement}
 */
export function brokenDrawing(problems, repair) {
  const { page, lines } = problems, store = new Store();
  const stage = new Stage(page, 0, store, new Outlines(page.nest));
  const numbers = new Map(page.nest.contours.map((contour, k) => [contour.id, k]));
  const mending = (/** @type {Problem} */ one) => one.mends
    ? make("button", { type: "button", class: "repair", onclick: repair, title: tr("mends all that repair can mend, and opens the drawing") }, tr("repair")) : null;
  const marks = lines.map((one, k) => one.at && make("button", { type: "button", class: one.mends ? "mark mends" : "mark", "aria-label": tr("problem {k}: {text}", { k: k + 1, text: one.text }), onclick: () => choose(k) }, `${k + 1}`));
  const rows = lines.map((one, k) => make("li", {}, make("button", { type: "button", class: "link", onclick: () => choose(k, true) }, one.text), " ", mending(one)));
  const bubble = make("div", { class: "bubble", role: "status", hidden: true });
  let chosen = -1;
  const place = () => {
    marks.forEach((mark, k) => { if (mark) put(mark, stage.toScreen(.../** @type {[number, number]} */ (lines[k].at))); });
    const at = chosen >= 0 && lines[chosen].at;
    if (at) putBeside(bubble, stage.toScreen(...at), stage.size);
  };
  /** @type {(k: number, near?: boolean) => void} */
  const choose = (k, near = false) => {
    chosen = k;
    const one = lines[k];
    marks.forEach((mark, other) => mark?.classList.toggle("chosen", other === k));
    rows.forEach((row, other) => row.classList.toggle("chosen", other === k));
    bubble.hidden = !one.at;
    bubble.replaceChildren(make("p", {}, one.text), mending(one) ?? "");
    store.set({ marked: one.contours.map(id => numbers.get(id) ?? -1).filter(n => n >= 0) });
    if (near && one.at) {
      const [x, y] = one.at;
      stage.camera.fit([x - NEAR_MM, y - NEAR_MM, x + NEAR_MM, y + NEAR_MM], stage.size.wide, stage.size.high);
    }
    stage.draw();
  };
  stage.buttons = 0;
  stage.layers.push(place);
  stage.canvas.setAttribute("tabindex", "0");
  stage.canvas.setAttribute("role", "img");
  stage.canvas.setAttribute("aria-label", tr("The drawing with its problems; the list names them."));
  stage.canvas.addEventListener("keydown", event => {
    const by = /** @type {Record<string, number>} */ ({ "+": 1.3, "-": 1 / 1.3 })[event.key];
    if (by) stage.camera.zoom(by, stage.size.wide / 2, stage.size.high / 2);
    else if (event.key === "0") stage.fit(false);
    else return;
    stage.draw();
  });
  const figure = make("figure", {}, stage.canvas, ...marks, bubble);
  const whole = () => { stage.fit(false); stage.draw(); };
  new ResizeObserver(() => {
    if (!stage.resize()) return;
    if (stage.fits) stage.fit(stage.fitted.parts);
    stage.draw();
  }).observe(figure);
  listen(stage, {
    moved: () => stage.draw(),
    picked: contour => { const k = lines.findIndex(one => one.contours.includes(page.nest.contours[contour]?.id)); if (k >= 0) choose(k); },
    hovered: contour => { store.set({ hovered: contour }); stage.draw(); },
    taken: () => false,
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => stage.recolour());
  const mends = lines.filter(one => one.mends).length;
  return make("section", { id: "broken" },
    make("h2", {}, tr("This drawing cannot be cut as it is drawn")),
    make("p", {}, trn("{n} problem", "{n} problems", lines.length), mends ? ` — ${mends === lines.length ? tr("repair mends all of it at once.") : tr("repair mends {n} of {all}, all at once.", { n: mends, all: lines.length })}` : ""),
    figure,
    make("p", {}, make("button", { type: "button", onclick: whole }, tr("whole drawing"))),
    make("ol", {}, ...rows));
}

/** @type {(element: HTMLElement, at: [number, number]) => void} */
function put(element, [x, y]) {
  element.style.left = `${x}px`;
  element.style.top = `${y}px`;
}

/** Below the point, or above it where there is no room, and never over the edge. */
/** @type {(element: HTMLElement, at: [number, number], size: {wide: number, high: number}) => void} */
function putBeside(element, [x, y], { wide, high }) {
  const half = element.offsetWidth / 2, tall = element.offsetHeight;
  const below = y + 22 + tall < high;
  put(element, [Math.max(half + 4, Math.min(wide - half - 4, x)), below ? y + 18 : Math.max(4, y - 22 - tall)]);
}
