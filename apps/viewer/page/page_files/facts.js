/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { figure, language, tr, trn } from "./say.js";
import { notHeld } from "./unkept.js";
import { clock, metres, proven, stateClass, stateText } from "./words.js";

/**
 * The bar on top, and the panel that says what the sheet is, what it takes and what is proven.
 *
 * @param {App} app
 */
export function factsPanel(app) {
  const chip = byId("verdict"), proof = byId("proof");
  chip.addEventListener("click", () => showUnkept(app));
  const show = () => {
    const { nest, title } = app.data, { side } = app, [x0, y0, x1, y1] = nest.bounds;
    document.title = title;
    byId("title").textContent = title;
    const figures = side ? figuresOf(app) : [];
    byId("figures").replaceChildren(...figures.map(([name, value]) => make("span", {}, make("small", {}, name), ` ${value}`)));
    chip.textContent = side ? stateText(side.state, side.unchecked) : tr("no plan");
    chip.className = side ? `chip ${stateClass(side.state, side.unchecked)}` : "chip";
    chip.title = side ? `${side.state.told}\n${tr("Click: the rules and the places")}` : "";
    chip.toggleAttribute("disabled", !side);
    byId("sheet-said").replaceChildren(
      ...(app.data.caption ? [make("p", { class: "warn" }, app.data.caption)] : []),
      make("dl", {}, ...pair(tr("nest"), nest.file || title), ...pair(tr("sheet"), `${figure(x1 - x0, 1)} × ${figure(y1 - y0, 1)} mm`),
        ...pair(tr("holds"), `${trn("{n} part", "{n} parts", nest.parts.length)}, ${trn("{n} contour", "{n} contours", nest.contours.length)}`),
        ...(side ? pair(tr("profile"), side.profile) : []), ...figures.flatMap(([name, value]) => pair(name, value)),
        ...(side ? pair(tr("proof"), language() === "en" && side.figures.proof || proven(side.figures)) : [])),
      ...(side?.said.length ? [make("h2", { class: "small" }, tr("The plan says")), make("ul", { lang: "en" }, ...side.said.map(text => make("li", {}, text)))] : []),
      ...(nest.notes.length ? [make("h2", { class: "small" }, tr("The drawing")), make("ul", { lang: "en" }, ...nest.notes.map(text => make("li", {}, text)))] : []),
      ...(side?.left_out.length ? [make("h2", { class: "small" }, tr("Left out")), make("ul", {}, ...side.left_out.map(one => make("li", {}, `${one.contour}: ${one.why}`)))] : []),
      make("h2", { class: "small" }, tr("Colours")), make("ul", { class: "legend" },
        ...[["part", tr("part, still in the sheet (tinted by zone)")], ["loose", tr("part that has come loose")], ["gap", tr("metal that is cut away or has fallen out")],
          ["torch", tr("the torch and its cut")], ["travel", tr("travel with the torch off")], ["pierce", tr("pierce, and the lead from it")],
          ["unkept", tr("place where a hard rule is not kept")], ["select", tr("what you have chosen")], ["alert", tr("places of the rule that you have opened")]]
          .map(([name, text]) => { const box = make("i", {}); box.style.background = `var(--${name})`; return make("li", {}, box, text); })));
    stand();
  };
  // The proof is that of the plan that is drawn, and never stands over a wish that is not planned yet.
  const stand = () => {
    const { side } = app, { stale } = app.state;
    proof.textContent = !side ? "" : stale ? tr("the plan before: {proof}", { proof: proven(side.figures) }) : proven(side.figures);
    proof.className = `chip${stale ? " stale" : side?.figures.status === "optimal" ? " good" : ""}`;
  };
  show();
  app.on((_, changes) => {
    if (changes.side !== undefined) show();
    else if (changes.stale !== undefined) stand();
  });
  app.renewed(show, true);
}

/** Where hard rules are not kept: the panel of rules, the places marked, the first one brought into view. */
/** @param {App} app */
function showUnkept(app) {
  app.set({ tab: "rules" });
  const ids = notHeld(app.side).flatMap(one => one.contours);
  if (!ids.length) return;
  app.chooseId(ids.find(id => app.numberOf(id) >= 0) ?? "");
  app.mark(ids);
}

/** @type {(app: App) => [string, string][]} */
function figuresOf(app) {
  const { figures } = app.side, zones = Math.max(0, ...app.side.cuts.map(cut => cut.zone));
  return [
    [tr("time"), clock(app.stages[app.state.side].timeline.end_s)], [tr("cut"), metres(figures.cut_mm)], [tr("idle"), metres(figures.idle_mm)],
    [tr("pierces"), String(figures.pierces)], ...(zones ? /** @type {[string, string][]} */ ([[tr("zones"), String(zones)]]) : []),
    ...(figures.cost ? /** @type {[string, string][]} */ ([[tr("cost"), figures.cost]]) : []),
  ];
}

/** @type {(name: string, value: string) => HTMLElement[]} */
function pair(name, value) {
  return [make("dt", {}, name), make("dd", {}, value)];
}
