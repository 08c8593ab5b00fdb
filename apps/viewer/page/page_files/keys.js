/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { toNotice } from "./notices.js";
import { SPEEDS } from "./player.js";
import { remember, remembered, tr } from "./say.js";

const PAN_PX = 60, ZOOM = 1.3, SINGLE = "kerfwise-single-keys";

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
  const fit = () => { app.stages[0].fit(false); app.moved(); };
  const fitParts = () => { app.stages[0].fit(true); app.moved(); };
  add(" ", () => app.toggle(), tr("play or pause"));
  add("ArrowRight", () => app.step(1), tr("one cut on"));
  add("ArrowLeft", () => app.step(-1), tr("one cut back"));
  add("Home", () => app.seek(0), tr("the start of the program"));
  add("End", () => app.seek(app.end()), tr("its end"));
  add("]", () => speed(1), tr("play faster"));
  add("[", () => speed(-1), tr("play slower"));
  add("}", () => toNotice(app, 1), tr("to the next notice on the time line"));
  add("{", () => toNotice(app, -1), tr("to the notice before"));
  add("n", () => chooseNext(app, 1), tr("choose the next cut"));
  add("p", () => chooseNext(app, -1), tr("choose the cut before"));
  add("+", () => zoom(ZOOM), tr("nearer"));
  add("-", () => zoom(1 / ZOOM), tr("farther"));
  add("0", fit, tr("the whole sheet"));
  add("9", fitParts, tr("all parts"));
  add("Shift+ArrowLeft", () => pan(PAN_PX, 0), tr("move the view"));
  add("Shift+ArrowRight", () => pan(-PAN_PX, 0), "");
  add("Shift+ArrowUp", () => pan(0, PAN_PX), "");
  add("Shift+ArrowDown", () => pan(0, -PAN_PX), "");
  add("/", () => byId("search").focus(), tr("search"));
  add("b", () => void app.showBent(!app.state.bent), tr("the sheet as it moves, on or off"));
  add("h", () => void app.showHeat(!app.state.heat), tr("heat on or off"));
  add("t", () => app.set({ travel: !app.state.travel }), tr("travel on or off"));
  add("l", () => app.set({ numbers: !app.state.numbers }), tr("numbers on or off"));
  add("c", () => app.set({ drawn: !app.state.drawn }), tr("colours and texts as in the drawing"));
  add("d", does.look, tr("light or dark"));
  add(".", () => does.tab(1), tr("the next panel"));
  add(",", () => does.tab(-1), tr("the panel before"));
  add("s", () => app.set({ side: (app.state.side + 1) % app.stages.length }), tr("the other plan, where two are compared"));
  add("Escape", () => { app.set({ selected: -1, marked: [] }); app.draw(); }, tr("choose nothing"));
  add("?", () => showKeys(app), tr("this list"));
  byId("keys-button").addEventListener("click", () => showKeys(app));
  byId("fit").addEventListener("click", fit);
  byId("fit-parts").addEventListener("click", fitParts);
  byId("nearer").addEventListener("click", () => zoom(ZOOM));
  byId("farther").addEventListener("click", () => zoom(1 / ZOOM));
  const single = /** @type {HTMLInputElement} */ (byId("single-keys"));
  single.checked = remembered(SINGLE) !== "off";
  single.addEventListener("change", () => remember(SINGLE, single.checked ? "on" : "off"));
  document.addEventListener("keydown", event => {
    const target = /** @type {HTMLElement} */ (event.target), { key } = event, withControl = event.ctrlKey || event.metaKey;
    const hidden = target.closest("dialog:not([open])"); // a dialog that was closed may keep the focus
    if (event.altKey || (/^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName) && !hidden)) return;
    // One key alone works anywhere where that is wanted, and always on a drawing (WCAG 2.1.4).
    if (!withControl && key.length === 1 && key !== "?" && !single.checked && !(target instanceof HTMLCanvasElement)) return;
    if ((key === " " || key === "Enter") && /^(BUTTON|SUMMARY|A)$/.test(target.tagName)) return;
    const name = withControl ? `Ctrl+${event.shiftKey ? "Shift+" : ""}${key.toLowerCase()}` : event.shiftKey && key.startsWith("Arrow") ? `Shift+${key}` : key;
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
    make("kbd", {}, one.name === " " ? tr("Space") : one.name), one.text)));
  dialog.showModal();
}
