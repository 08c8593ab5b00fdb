/** @import { App } from "./app.js" */
import { byId } from "./elements.js";
import { warm } from "./heat.js";
import { changeLook } from "./look.js";
import { PAPER_COLOURS } from "./palette.js";
import { figure, tr } from "./say.js";

/**
 * The switches over the drawing: travel, numbers, heat, and the light or dark look.
 *
 * @param {App} app
 * @returns {{look: () => void}}
 */
export function toggles(app) {
  const heat = byId("heat"), bent = byId("bent"), dark = matchMedia("(prefers-color-scheme: dark)");
  const recolour = () => {
    app.stages.forEach(stage => stage.recolour());
    app.recolourers.forEach(fn => fn());
  };
  const look = () => {
    changeLook();
    recolour();
  };
  dark.addEventListener("change", recolour);
  byId("look").addEventListener("click", look);
  byId("travel").addEventListener("click", () => app.set({ travel: !app.state.travel }));
  byId("drawn").addEventListener("click", () => app.set({ drawn: !app.state.drawn }));
  byId("numbers").addEventListener("click", () => app.set({ numbers: !app.state.numbers }));
  heat.addEventListener("click", () => void app.showHeat(!app.state.heat));
  bent.addEventListener("click", () => void app.showBent(!app.state.bent));
  let looks = 0;
  const known = async () => {
    const mine = ++looks, { side } = app.state, asked = app.source.heatIsMade && !app.state.heat;
    const data = app.side && !asked ? await app.source.heat(side) : null;
    if (mine !== looks) return; // another plan is shown meanwhile
    heat.hidden = !app.side || (data === null && !app.source.heatIsMade);
    byId("heat-scale").hidden = !app.state.heat;
    if (!data) return;
    const steps = Array.from({ length: 9 }, (_, k) => `rgb(${warm(k / 8).join(" ")})`);
    byId("heat-bar").style.background = `linear-gradient(90deg, ${steps.join(", ")})`;
    byId("heat-low").textContent = `${data.ambient_c} °C`;
    byId("heat-high").textContent = `${data.top_c.toFixed(0)} °C`;
    byId("heat-now").textContent = "";
  };
  const show = () => {
    byId("travel").setAttribute("aria-pressed", String(app.state.travel));
    byId("drawn").hidden = !app.data.nest.contours.some(contour => contour.text || (contour.colour && !PAPER_COLOURS.has(contour.colour)));
    byId("drawn").setAttribute("aria-pressed", String(app.state.drawn));
    byId("numbers").setAttribute("aria-pressed", String(app.state.numbers));
    heat.setAttribute("aria-pressed", String(app.state.heat));
    bent.hidden = !app.side || !app.source.bent;
    bent.setAttribute("aria-pressed", String(app.state.bent));
    byId("bent-said").hidden = !app.state.bent;
    byId("bent-said").textContent = app.state.bent ? bentText(app) : "";
    byId("heat-scale").hidden = !app.state.heat;
    const frames = app.stages[app.state.side].heat;
    if (app.state.heat && frames) byId("heat-now").textContent = tr("hottest now {now} °C, limit {limit} °C", { now: frames.hottest(app.state.time_s).toFixed(0), limit: frames.data.limit_c });
  };
  app.on((_, changes) => {
    if (changes.side !== undefined || (changes.heat && app.source.heatIsMade)) void known();
    show();
  });
  app.renewed(() => { show(); void known(); });
  void known();
  show();
  return { look };
}

/** How far the metal is drawn away, and which part is off most by what is cut. */
/** @param {App} app */
function bentText(app) {
  const { bent, scenery } = app.stages[app.state.side], { time_s } = app.state;
  if (!bent) return "";
  const [part, mm] = [...bent.errors(scenery, time_s)].sort((a, b) => b[1] - a[1])[0] ?? [-1, 0];
  const far = tr("drawn {times} times as far as it moves", { times: bent.times(time_s) });
  return part < 0 ? far : `${far}; ${tr("{part} is off most, {mm} mm", { part: app.data.nest.parts[part], mm: figure(mm, 2) })}`;
}
