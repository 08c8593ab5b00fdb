/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { clock, counted, metres, proven, stateClass, stateText } from "./words.js";

/**
 * The bar on top, and the panel that says what the sheet is, what it takes and what is proven.
 *
 * @param {App} app
 */
export function factsPanel(app) {
  const show = () => {
    const { nest, title } = app.data, { side } = app, [x0, y0, x1, y1] = nest.bounds;
    document.title = title;
    byId("title").textContent = title;
    const figures = side ? figuresOf(app) : [];
    byId("figures").replaceChildren(...figures.slice(0, 5).map(([name, value]) => make("span", {}, make("small", {}, name), ` ${value}`)));
    byId("verdict").textContent = side ? stateText(side.state) : "no plan";
    byId("verdict").className = side ? `chip ${stateClass(side.state)}` : "chip";
    byId("verdict").title = side ? side.state.told : "";
    byId("sheet-said").replaceChildren(
      ...(app.data.caption ? [make("p", { class: "warn" }, app.data.caption)] : []),
      make("dl", {}, ...pair("nest", nest.file || title), ...pair("sheet", `${(x1 - x0).toFixed(1)} × ${(y1 - y0).toFixed(1)} mm`),
        ...pair("holds", `${counted(nest.parts.length, "part")}, ${counted(nest.contours.length, "contour")}`),
        ...(side ? pair("profile", side.profile) : []), ...figures.flatMap(([name, value]) => pair(name, value)),
        ...(side?.figures.proof ? pair("proof", side.figures.proof) : [])),
      ...(side?.said.length ? [make("h3", {}, "The plan says"), make("ul", {}, ...side.said.map(text => make("li", {}, text)))] : []),
      ...(nest.notes.length ? [make("h3", {}, "The drawing"), make("ul", {}, ...nest.notes.map(text => make("li", {}, text)))] : []),
      ...(side?.left_out.length ? [make("h3", {}, "Left out"), make("ul", {}, ...side.left_out.map(one => make("li", {}, `${one.contour}: ${one.why}`)))] : []),
      make("h3", {}, "Colours"), make("ul", { class: "legend" },
        ...[["part", "part, still in the sheet (tinted by zone)"], ["loose", "part that has come loose"], ["gap", "metal that is cut away or has fallen out"],
          ["torch", "the torch and its cut"], ["travel", "travel with the torch off"], ["select", "what you have chosen"], ["alert", "places of the rule that you have opened"]]
          .map(([name, text]) => { const box = make("i", {}); box.style.background = `var(--${name})`; return make("li", {}, box, text); })));
  };
  show();
  app.on((_, changes) => { if (changes.side !== undefined) show(); });
  app.renewed(show);
}

/** @type {(app: App) => [string, string][]} */
function figuresOf(app) {
  const { figures, zones } = { figures: app.side.figures, zones: Math.max(0, ...app.side.cuts.map(cut => cut.zone)) };
  return [
    ["time", clock(app.stages[app.state.side].timeline.end_s)], ["cut", metres(figures.cut_mm)], ["idle", metres(figures.idle_mm)],
    ["pierces", String(figures.pierces)], ["plan", proven(figures)], ["zones", String(zones)],
    ...(figures.cost ? /** @type {[string, string][]} */ ([["cost", figures.cost]]) : []),
  ];
}

/** @type {(name: string, value: string) => HTMLElement[]} */
function pair(name, value) {
  return [make("dt", {}, name), make("dd", {}, value)];
}
