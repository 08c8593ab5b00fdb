/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { SPEEDS } from "./player.js";

const PAN_PX = 60, ZOOM = 1.3;

/**
 * All that the keyboard does, and the list of it.
 *
 * @param {App} app
 * @param {{tab: (by: number) => void, look: () => void}} does
 */
export function keyboard(app, does) {
  /** @type {(name: string, fn: () => void, text: string) => void} */
  const add = (name, fn, text) => { app.keys.push({ name, fn, text }); };
  /** @type {(by: number) => void} */
  const speed = by => app.set({ speed: SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, SPEEDS.indexOf(app.state.speed) + by))] });
  /** @type {(dx: number, dy: number) => void} */
  const pan = (dx, dy) => { app.stages[0].camera.pan(dx, dy); app.moved(); };
  /** @type {(by: number) => void} */
  const zoom = by => { const { camera, size } = app.stages[0]; camera.zoom(by, size.wide / 2, size.high / 2); app.moved(); };
  const fit = () => { app.stages[0].fit(); app.moved(); };
  add(" ", () => app.toggle(), "play or pause");
  add("ArrowRight", () => app.step(1), "one cut on");
  add("ArrowLeft", () => app.step(-1), "one cut back");
  add("Home", () => app.seek(0), "the start of the program");
  add("End", () => app.seek(app.end()), "its end");
  add("]", () => speed(1), "play faster");
  add("[", () => speed(-1), "play slower");
  add("n", () => chooseNext(app, 1), "choose the next cut");
  add("p", () => chooseNext(app, -1), "choose the cut before");
  add("+", () => zoom(ZOOM), "nearer");
  add("-", () => zoom(1 / ZOOM), "farther");
  add("0", fit, "the whole sheet");
  add("Shift+ArrowLeft", () => pan(PAN_PX, 0), "move the view");
  add("Shift+ArrowRight", () => pan(-PAN_PX, 0), "");
  add("Shift+ArrowUp", () => pan(0, PAN_PX), "");
  add("Shift+ArrowDown", () => pan(0, -PAN_PX), "");
  add("/", () => byId("search").focus(), "search");
  add("h", () => void app.showHeat(!app.state.heat), "heat on or off");
  add("t", () => app.set({ travel: !app.state.travel }), "travel on or off");
  add("l", () => app.set({ numbers: !app.state.numbers }), "numbers on or off");
  add("d", does.look, "light or dark");
  add(".", () => does.tab(1), "the next panel");
  add(",", () => does.tab(-1), "the panel before");
  add("s", () => app.set({ side: (app.state.side + 1) % app.stages.length }), "the other plan, where two are compared");
  add("Escape", () => { app.set({ selected: -1, marked: [] }); app.draw(); }, "choose nothing");
  add("?", () => showKeys(app), "this list");
  byId("keys-button").addEventListener("click", () => showKeys(app));
  byId("fit").addEventListener("click", fit);
  byId("nearer").addEventListener("click", () => zoom(ZOOM));
  byId("farther").addEventListener("click", () => zoom(1 / ZOOM));
  document.addEventListener("keydown", event => {
    const target = /** @type {HTMLElement} */ (event.target), { key } = event;
    if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName)) return;
    if ((key === " " || key === "Enter") && /^(BUTTON|SUMMARY|A)$/.test(target.tagName)) return;
    const name = event.shiftKey && key.startsWith("Arrow") ? `Shift+${key}` : key;
    const known = app.keys.find(one => one.name === name);
    if (!known || target.closest("dialog[open]")) return;
    event.preventDefault();
    known.fn();
  });
}

/** @type {(app: App, by: number) => void} */
function chooseNext(app, by) {
  if (!app.side?.cuts.length) return;
  const at = app.cutOf(app.state.selected), last = app.side.cuts.length - 1;
  const to = at === undefined ? Math.max(0, app.cutNow()) : Math.max(0, Math.min(last, at + by));
  app.choose(app.side.cuts[to].contour);
}

/** @type {(app: App) => void} */
function showKeys(app) {
  const dialog = /** @type {HTMLDialogElement} */ (byId("keys"));
  byId("keys-said").replaceChildren(...app.keys.filter(one => one.text).map(one => make("li", {},
    make("kbd", {}, one.name === " " ? "Space" : one.name), one.text)));
  dialog.showModal();
}
