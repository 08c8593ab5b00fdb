/** @import { App } from "./app.js" */
import { Camera } from "./camera.js";
import { byId, make } from "./elements.js";
import { palette } from "./palette.js";
import { tr, trn } from "./say.js";
import { inWords } from "./sentences.js";
import { notHeld } from "./unkept.js";
import { clock, metres, millimetres, placeText, wayText } from "./words.js";

const PAPER_PX = 2200, MOST_HIGH = 1700, PAPER_FONT_PX = 22;

/**
 * The page on paper: a work sheet with the drawing, what was excused, and every cut with a box to tick.
 *
 * @param {App} app
 */
export function workSheet(app) {
  const paper = byId("paper");
  const lay = () => {
    const { nest, title } = app.data, { side } = app, [x0, y0, x1, y1] = nest.bounds;
    const figures = side ? [side.profile, clock(app.stages[app.state.side].timeline.end_s), tr("cut {cut}, idle {idle}", { cut: metres(side.figures.cut_mm),
      idle: metres(side.figures.idle_mm) }), trn("{n} pierce", "{n} pierces", side.figures.pierces)].join(" · ") : tr("no plan");
    paper.replaceChildren(
      make("h1", {}, title, side?.name ? ` – ${side.name}` : ""),
      make("p", {}, `${(x1 - x0).toFixed(0)} × ${(y1 - y0).toFixed(0)} mm · ${trn("{n} part", "{n} parts", nest.parts.length)} · ${figures}`),
      make("p", {}, `${tr("nest")} sha256 ${nest.sha256.slice(0, 16)} · ${side ? side.unchecked ? tr("program not checked yet") : side.state.for_operator : ""}`),
      drawing(app), ...(side ? [...notKept(app), table(app)] : []));
  };
  addEventListener("beforeprint", lay);
  addEventListener("afterprint", () => paper.replaceChildren());
  byId("print").addEventListener("click", () => { print(); });
}

/** @type {(app: App) => HTMLElement} */
function drawing(app) {
  const { bounds } = app.data.nest, canvas = document.createElement("canvas"), camera = new Camera();
  canvas.width = PAPER_PX;
  canvas.height = Math.min(MOST_HIGH, Math.round((PAPER_PX * (bounds[3] - bounds[1])) / Math.max(1, bounds[2] - bounds[0])) + 40);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
  camera.fit(bounds, canvas.width, canvas.height, 20);
  const root = document.documentElement, look = root.dataset.look ?? "";
  root.dataset.look = "light";
  const light = palette();
  root.dataset.look = look;
  if (!look) delete root.dataset.look;
  const { scenery } = app.stages[app.state.side];
  for (const _ of scenery.paint(context, camera, light, { done: 0, travel: true, numbers: true, drawn: false, wide: canvas.width, high: canvas.height, font: PAPER_FONT_PX }));
  return canvas;
}

/** @type {(app: App) => HTMLElement[]} */
function notKept(app) {
  const lines = [
    ...notHeld(app.side).map(one => `${one.text} – ${inWords(one.why ?? "")}`),
    ...app.side.rules.filter(rule => rule.breaches.length).map(rule => `${rule.id} (${rule.strength}): ${trn("{n} place where it does not hold", "{n} places where it does not hold", rule.breaches.length)}`),
  ];
  return lines.length ? [make("h2", {}, tr("Not kept")), make("ul", {}, ...lines.map(text => make("li", {}, text)))] : [];
}

/** @type {(app: App) => HTMLElement} */
function table(app) {
  const { side } = app, { timeline } = app.stages[app.state.side];
  const head = ["", tr("no."), tr("contour"), tr("zone"), tr("pierce at, mm"), tr("way"), tr("length"), tr("begins"), ""];
  return make("table", {}, make("thead", {}, make("tr", {}, ...head.map(text => make("th", {}, text)))),
    make("tbody", {}, ...side.cuts.map((cut, k) => make("tr", {}, make("td", {}, "☐"), make("td", {}, String(side.made + k + 1)),
      make("td", {}, app.data.nest.contours[cut.contour].id), make("td", {}, String(cut.zone || "")), make("td", {}, placeText(cut.path)),
      make("td", {}, wayText(cut.direction)), make("td", {}, millimetres(cut.length_mm)), make("td", {}, clock(timeline.begins_s[k])),
      make("td", {}, [cut.wait_s ? tr("wait {s} s", { s: cut.wait_s }) : "", cut.linked ? tr("linked") : "", cut.excused.length ? tr("not kept here") : "",
        cut.tabs.length ? trn("{n} tab", "{n} tabs", cut.tabs.length) : ""].filter(Boolean).join(", "))))));
}
