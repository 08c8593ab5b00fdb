/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { tr } from "./say.js";
import { strengthText } from "./words.js";

const STEPS = [0, 10, 20, 50, 100, 150, 200, 250, 300, 400, 500, 700, 1000, 1500, 2000, 3000, 5000, 10000];

/**
 * Over the table of rules: how strong each is, and a slider for what breaking it once costs.
 *
 * @param {any} app
 * @param {Work} work
 */
export function weightSliders(app, work) {
  const place = make("details", { id: "hands-weights" }, make("summary", {}, tr("Weights of rules")));
  const list = make("div", { class: "weights" });
  place.append(list);
  app.slots.rules.append(place);
  let drawn = "";
  work.on((_, what) => {
    const rules = work.state.rules.filter((/** @type {any} */ rule) => rule.settable && rule.strengths.length > 1);
    const now = JSON.stringify(rules);
    if (what !== "state" || now === drawn) return;
    drawn = now;
    list.replaceChildren(...rules.map((/** @type {any} */ rule) => weightRow(work, rule)));
  });
}

/** @type {(work: Work, rule: any) => HTMLElement} */
function weightRow(work, rule) {
  const key = `rules.${rule.id}`, soft = rule.strength === "soft";
  const strength = make("select", { "aria-label": tr("strength of {rule}", { rule: rule.id }), title: tr(rule.sentence),
    onchange: (/** @type {Event} */ event) => work.edit([{ set: `${key}.strength`, to: /** @type {HTMLSelectElement} */ (event.target).value }]) },
    ...rule.strengths.map((/** @type {string} */ one) => make("option", { value: one, selected: one === rule.strength }, strengthText(one))));
  const weight = rule.weight_mm ?? rule.default_weight_mm;
  const at = STEPS.findLastIndex(mm => mm <= weight), told = make("output", {}, soft ? `${weight} mm` : "");
  const slider = make("input", { type: "range", min: 0, max: STEPS.length - 1, value: at, disabled: !soft, "aria-label": tr("weight of {rule}", { rule: rule.id }),
    oninput: (/** @type {Event} */ event) => { told.textContent = `${STEPS[Number(/** @type {HTMLInputElement} */ (event.target).value)]} mm`; },
    onchange: (/** @type {Event} */ event) => work.edit([{ set: `${key}.weight`, to: `${STEPS[Number(/** @type {HTMLInputElement} */ (event.target).value)]} mm` }]) });
  return make("label", {}, make("span", { title: tr(rule.sentence) }, rule.id), strength, slider, told);
}
