/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { tr } from "./say.js";

/**
 * What differs between two plans: figures, rules and cuts. A click on a cut chooses it in both.
 *
 * @param {App} app
 */
export function comparedPanel(app) {
  const panel = byId("compared-said"), tab = byId("tab-compared");
  const show = () => {
    const { comparison } = app.data;
    tab.hidden = comparison === null;
    if (!comparison) return;
    const { sides, figures, rules, proofs, summary, changed } = comparison;
    panel.replaceChildren(
      ...sides.map((text, k) => make("p", {}, make("button", { type: "button", class: "link", onclick: () => app.set({ side: k }) }, text))),
      grid(["", "A", "B", ""], figures.map(row => row.map(text => make("span", {}, text)))),
      ...proofs.map(text => make("p", { class: "hint" }, text)),
      make("h2", { class: "small" }, summary),
      changed.length ? grid([tr("contour"), "A", "B", ""], changed.slice(0, 400).map(one => {
        const id = app.data.nest.contours[one.contour]?.id ?? "";
        return [make("button", { type: "button", class: "link", onclick: () => app.chooseId(id) }, id),
          make("span", {}, String(one.a ?? "–")), make("span", {}, String(one.b ?? "–")), make("span", {}, one.told)];
      })) : "",
      changed.length > 400 ? make("p", { class: "hint" }, tr("and {n} more", { n: changed.length - 400 })) : "",
      make("h2", { class: "small" }, tr("Rules")), grid([tr("rule"), "A", "B", ""], rules.map(row => row.map(text => make("span", {}, text)))));
  };
  show();
  app.renewed(show);
}

/** @type {(head: string[], rows: HTMLElement[][]) => HTMLElement} */
function grid(head, rows) {
  return make("table", { class: "score" }, make("thead", {}, make("tr", {}, ...head.map(text => text ? make("th", { scope: "col" }, text) : make("td", {})))),
    make("tbody", {}, ...rows.map(row => make("tr", {}, ...row.map(cell => make("td", {}, cell))))));
}
