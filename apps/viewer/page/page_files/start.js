/** @import { Source } from "./types.js" */
import { App } from "./app.js";
import { comparedPanel } from "./compared.js";
import { byId, make } from "./elements.js";
import { factsPanel } from "./facts.js";
import { wordsDialog } from "./glossary.js";
import { listen } from "./gestures.js";
import { keyboard } from "./keys.js";
import { takeLook } from "./look.js";
import { orderList } from "./orders.js";
import { workSheet } from "./paper.js";
import { player } from "./player.js";
import { programPanel } from "./program.js";
import { rulesPanel } from "./rules.js";
import { timeRuler } from "./ruler.js";
import { languageChoice, speak, tr } from "./say.js";
import { searchField } from "./search.js";
import { tabsOf } from "./tabs.js";
import { toggles } from "./toggles.js";
import { whyPanel } from "./why.js";

/** Drawings of sheets that are so many times wider than high stand under each other. */
const FLAT = 1.6, OVER_PX = 8;

/**
 * Puts the page together; `hands`, where there are any, are called last.
 *
 * @param {Source} source
 * @param {(app: object) => void} [hands]
 * @returns {Promise<App>}
 */
export async function start(source, hands) {
  takeLook();
  const data = await source.page();
  speak(catalogues(), data.language);
  const app = new App(source, data);
  languageChoice(/** @type {HTMLSelectElement} */ (byId("language")));
  wordsDialog();
  document.body.classList.toggle("planless", !app.side);
  hang(app);
  app.renewed(() => hang(app));
  new ResizeObserver(() => roomForButtons(app)).observe(byId("over"));
  app.stages.forEach(stage => stage.now());
  document.documentElement.dataset.painted = performance.now().toFixed(0);
  searchField(app);
  factsPanel(app);
  orderList(app);
  whyPanel(app);
  rulesPanel(app);
  programPanel(app);
  comparedPanel(app);
  timeRuler(app);
  player(app);
  workSheet(app);
  const tabs = tabsOf(app);
  keyboard(app, { tab: tabs.step, look: toggles(app).look });
  app.on((_, changes) => { if (changes.playing === undefined || Object.keys(changes).length > 1) app.draw(); });
  app.renewed(() => document.body.classList.toggle("planless", !app.side));
  if (hands) hands(handle(app, tabs));
  Object.assign(window, { kerfwise: app }); // for the console, and for tests
  document.documentElement.dataset.ready = "yes";
  return app;
}

/** The message catalogues that stand in the page. */
/** @returns {Record<string, Record<string, string | string[]>>} */
function catalogues() {
  return JSON.parse(document.getElementById("texts")?.textContent || "{}");
}

/** Hangs the drawings into the page. */
/** @param {App} app */
function hang(app) {
  const place = byId("stages");
  const [x0, y0, x1, y1] = app.data.nest.bounds;
  place.className = app.stages.length < 2 ? "" : x1 - x0 > FLAT * (y1 - y0) ? "two flat" : "two";
  document.body.dataset.sides = String(app.stages.length);
  place.replaceChildren(...app.stages.map(stage => {
    const name = app.data.sides.length > 1 ? make("figcaption", {}, app.data.sides[stage.side].name) : null;
    stage.canvas.setAttribute("role", "img");
    stage.canvas.setAttribute("tabindex", "0");
    stage.canvas.setAttribute("aria-label", tr("Drawing of {title}. The order list names every cut; press ? for the keys.", { title: app.data.title }));
    const figure = make("figure", { "data-side": stage.side }, stage.canvas, name);
    new ResizeObserver(() => {
      if (!stage.resize()) return;
      if (stage.fits) stage.fit(stage.fitted.parts);
      app.moved(app.stages[0]);
      stage.now();
    }).observe(figure);
    listen(stage, {
      moved: by => app.moved(by),
      picked: (contour, by) => { app.set({ side: by.plan ? by.side : app.state.side }); app.choose(contour, false); },
      hovered: (contour, at) => hover(app, contour, at),
      taken: (event, by) => app.gestures.some(fn => fn(event, by)),
    });
    return figure;
  }));
  for (const stage of app.stages) { stage.resize(); if (stage.fits) stage.fit(stage.fitted.parts); }
  roomForButtons(app);
}

/** The buttons over the drawing stand in one row or in two: what is fitted stays clear of them; on a phone they stand below it. */
/** @param {App} app */
function roomForButtons(app) {
  const over = byId("over"), high = getComputedStyle(over).position === "absolute" ? over.offsetHeight + OVER_PX : 0;
  for (const stage of app.stages) {
    const { fits, buttons } = stage;
    stage.buttons = high;
    if (fits && stage.buttons !== buttons) stage.fit(stage.fitted.parts);
  }
  app.draw();
}

/** @type {(app: App, contour: number, at: [number, number] | null) => void} */
function hover(app, contour, at) {
  if (app.stages.length > 1) for (const stage of app.stages) stage.cross = at;
  app.set({ hovered: contour });
  const heat = app.state.heat && at ? app.stages[app.state.side].heat?.at(app.state.time_s, ...at) : null;
  const cut = contour >= 0 ? app.cutOf(contour) : undefined, id = app.data.nest.contours[contour]?.id ?? "";
  byId("under").textContent = at ? [`x ${at[0].toFixed(1)}  y ${at[1].toFixed(1)} mm`, id, cut === undefined ? "" : tr("cut {number}", { number: app.side.made + cut + 1 }), app.data.nest.contours[contour]?.text ?? "",
    heat === null || heat === undefined ? "" : `${heat.toFixed(0)} °C`].filter(Boolean).join("  ·  ") : "";
  if (app.stages.length > 1) app.draw();
}

/** What hands are given. */
/** @type {(app: App, tabs: {add: (name: string, title: string) => HTMLElement}) => object} */
function handle(app, tabs) {
  return {
    source: app.source,
    get data() { return app.data; },
    get state() { return app.state; },
    get stages() { return app.stages; },
    app,
    slots: app.slots,
    set: app.set.bind(app),
    on: app.on.bind(app),
    replace: app.replace.bind(app),
    tell: app.tell.bind(app),
    choose: app.choose.bind(app),
    panel: tabs.add,
    layer: (/** @type {any} */ fn) => { for (const stage of app.stages) stage.layers = [...stage.layers, fn]; app.draw(); },
    gesture: (/** @type {any} */ fn) => { app.gestures.push(fn); },
    key: (/** @type {string} */ name, /** @type {() => void} */ fn, /** @type {string} */ text) => { app.keys.push({ name, fn, text }); },
    row: (/** @type {any} */ fn) => { app.rowMakers.push(fn); app.rowsAnew(); },
  };
}
