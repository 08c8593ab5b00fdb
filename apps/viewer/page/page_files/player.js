/** @import { App } from "./app.js" */
import { byId } from "./elements.js";
import { figure, tr } from "./say.js";
import { clock, metres } from "./words.js";

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];

/**
 * Play, pause, one cut back and on, and the speed: so many times as fast as the machine.
 *
 * @param {App} app
 */
export function player(app) {
  const play = byId("play"), speed = /** @type {HTMLSelectElement} */ (byId("speed"));
  speed.append(...SPEEDS.map(one => new Option(`${figure(one, one < 1 ? one === 0.25 ? 2 : 1 : 0)} ×`, String(one))));
  let before = 0;
  /** @param {number} now */
  const tick = now => {
    if (!app.state.playing) return;
    const passed = Math.min(0.25, (now - before) / 1000) * app.state.speed, time_s = app.state.time_s + passed;
    before = now;
    if (time_s >= app.end()) app.set({ time_s: app.end(), playing: false });
    else {
      app.set({ time_s });
      requestAnimationFrame(tick);
    }
  };
  play.addEventListener("click", () => app.toggle());
  byId("back").addEventListener("click", () => app.step(-1));
  byId("next").addEventListener("click", () => app.step(1));
  speed.value = String(app.state.speed);
  speed.addEventListener("change", () => app.set({ speed: Number(speed.value) }));
  const show = () => {
    byId("clock").textContent = `${clock(app.state.time_s)} / ${clock(app.end())}`;
    byId("doing").textContent = app.doing();
  };
  app.on((state, changes) => {
    if (changes.playing !== undefined) {
      play.textContent = state.playing ? "❚❚" : "▶";
      play.setAttribute("aria-label", state.playing ? tr("pause") : tr("play"));
      if (state.playing) {
        before = performance.now();
        requestAnimationFrame(tick);
      }
    }
    if (changes.speed !== undefined) speed.value = String(state.speed);
    show();
  });
  app.renewed(show);
  show();
}

/**
 * What the torch does, for the line under the ruler.
 *
 * @param {App} app
 * @param {import("./timeline.js").Moment | null} moment
 * @param {number} done
 * @returns {string}
 */
export function doingText(app, moment, done) {
  if (!app.side) return tr("no plan");
  const of = app.side.made + app.side.cuts.length;
  if (!moment) return tr("done: {of} cuts, {cut} cut, {idle} idle", { of, cut: metres(app.side.figures.cut_mm), idle: metres(app.side.figures.idle_mm) });
  const number = app.side.made + moment.cut + 1, id = app.data.nest.contours[app.side.cuts[moment.cut].contour].id;
  const does = { travel: tr("travels to {number} {id}", { number, id }), wait: tr("waits at {number} {id}", { number, id }),
    pierce: tr("pierces {number} {id}", { number, id }), cut: tr("cuts {number} {id}", { number, id }), home: tr("travels home from {number} {id}", { number, id }) }[moment.does];
  return `${does} · ${tr("{done} of {of} done", { done: app.side.made + done, of })}`;
}
