/** @import { App } from "./app.js" */
/** @import { Place, RuleData } from "./types.js" */
import { byId, make } from "./elements.js";
import { tr, trn } from "./say.js";
import { inWords } from "./sentences.js";
import { droppedOrders, notHeld } from "./unkept.js";
import { metres, stateClass, strengthText } from "./words.js";

/**
 * The rules: first what was excused and dropped, which is never hidden, then every rule with its verdict and price.
 *
 * @param {App} app
 */
export function rulesPanel(app) {
  const panel = byId("rules-said");
  let open = "";
  /** The places of the rule that is open, while this panel is seen. */
  const mark = () => {
    const rule = app.state.tab === "rules" ? app.side?.rules.find(one => one.id === open) : undefined;
    app.mark(rule ? [...rule.breaches, ...rule.excused].flatMap(place => place.contours) : []);
  };
  const show = () => {
    if (!app.side) {
      panel.replaceChildren(make("p", { class: "hint" }, tr("No plan, no verdict.")));
      return;
    }
    const { rules, warnings } = app.side, unkept = notHeld(app.side), orders = droppedOrders(app.side);
    panel.replaceChildren(
      verdict(app),
      ...(warnings ?? []).map(text => make("p", { class: "warn" }, text)),
      ...(unkept.length ? [make("section", { class: "kept-open" }, make("h2", { class: "small" }, trn("Not kept: {n} place", "Not kept: {n} places", unkept.length)),
        ...unkept.map(place => spot(app, place, place.text, place.why)))] : []),
      ...(orders.length ? [make("section", {}, make("h2", { class: "small" }, tr("dropped orders")), ...orders.map(place => spot(app, place, place.text, place.why)))] : []),
      ...(unkept.length || orders.length ? [] : [make("p", { class: "hint" }, tr("Nothing was excused, and no statement was dropped."))]),
      make("table", { class: "score" },
        make("thead", {}, make("tr", {}, ...[tr("rule"), tr("strength"), tr("breaches"), tr("cost")].map(text => make("th", { scope: "col" }, text)))),
        make("tbody", {}, ...sorted(rules).flatMap(rule => lines(app, rule, open === rule.id, () => {
          open = open === rule.id ? "" : rule.id;
          mark();
          show();
          /** @type {HTMLElement | null} */ (panel.querySelector(`[data-rule="${CSS.escape(rule.id)}"] button`))?.focus();
        })))));
  };
  show();
  app.renewed(() => { open = ""; show(); }, true);
  app.on((_, changes) => {
    if (changes.side !== undefined) { open = ""; show(); }
    else if (changes.tab !== undefined && open) mark();
  });
}

/** @type {(app: App) => HTMLElement} */
function verdict(app) {
  const { state, rules, unchecked } = app.side;
  const broken = rules.filter(rule => rule.strength === "hard" && rule.verdict === "broken").map(rule => rule.id);
  return make("p", { class: `said ${stateClass(state, unchecked)}` }, unchecked ? `${tr("The plan was judged alone: its program is not written and checked yet.")} ` : "", state.kind === "kept" ? tr("Every hard rule holds.")
    : state.kind === "kept but for" ? trn("It may be cut, but {n} place is not kept.", "It may be cut, but {n} places are not kept.", state.count) : tr("Broken, not to be cut: {rules}.", { rules: broken.join(", ") || tr("see below") }));
}

/** Broken ones first, then what costs, then the others. */
/** @type {(rules: RuleData[]) => RuleData[]} */
function sorted(rules) {
  /** @type {(rule: RuleData) => number} */
  const weight = rule => (rule.verdict === "broken" && rule.strength === "hard" ? 4 : rule.breaches.length ? 3
    : rule.excused.length ? 2 : rule.unjudged ? 1 : 0);
  return [...rules].sort((a, b) => weight(b) - weight(a) || b.cost_mm - a.cost_mm);
}

/** @type {(app: App, rule: RuleData, open: boolean, toggle: () => void) => HTMLElement[]} */
function lines(app, rule, open, toggle) {
  const bad = rule.breaches.length > 0, places = [...rule.breaches, ...rule.excused];
  const row = make("tr", { class: `${bad ? (rule.strength === "hard" ? "bad" : "soft") : ""}`, "data-rule": rule.id },
    make("td", {}, make("button", { class: "link", type: "button", "aria-expanded": String(open), title: tr(rule.sentence), onclick: toggle }, rule.id),
      rule.unjudged ? make("small", {}, ` ${tr("not judged")}`) : null),
    make("td", {}, strengthText(rule.strength)),
    make("td", { class: "figure" }, rule.breaches.length ? String(rule.breaches.length) : "–",
      rule.excused.length ? make("small", {}, ` ${tr("+{n} excused", { n: rule.excused.length })}`) : null),
    make("td", { class: "figure" }, rule.cost_mm ? metres(rule.cost_mm) : "–"));
  if (!open) return [row];
  return [row, make("tr", { class: "places" }, make("td", { colspan: 4 },
    rule.sentence ? make("p", {}, tr(rule.sentence)) : null, rule.unjudged ? make("p", {}, rule.unjudged) : null,
    ...places.slice(0, 200).map(place => spot(app, place, inWords(place.text) || place.contours.join(", "), place.why)),
    places.length ? (places.length > 200 ? make("p", { class: "hint" }, tr("and {n} more", { n: places.length - 200 })) : null)
      : make("p", { class: "hint" }, tr("0 breaches: it holds everywhere"))))];
}

/** @type {(app: App, place: Place, text: string, why?: string) => HTMLElement} */
function spot(app, place, text, why) {
  const known = place.contours.filter(id => app.numberOf(id) >= 0);
  return make("p", { class: "place" },
    known.length ? make("button", { class: "link", type: "button", onclick: () => {
      app.mark(known);
      app.chooseId(known[0]);
    } }, text) : text, why ? make("span", { class: "because" }, ` – ${inWords(why)}`) : null);
}
