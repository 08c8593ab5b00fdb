/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";

/**
 * The panels beside the drawing, one of which is seen.
 *
 * @param {App} app
 * @returns {{step: (by: number) => void, add: (name: string, title: string) => HTMLElement}}
 */
export function tabsOf(app) {
  const bar = byId("tabs"), panels = byId("panels");
  const all = () => /** @type {HTMLElement[]} */ ([...bar.querySelectorAll("[role=tab]")]).filter(tab => !tab.hidden && tab.offsetParent !== null);
  const show = () => {
    const seen = all(), reached = seen.find(tab => tab.id === `tab-${app.state.tab}`) ?? seen[0];
    for (const tab of /** @type {HTMLElement[]} */ ([...bar.querySelectorAll("[role=tab]")])) {
      tab.setAttribute("aria-selected", String(tab.id === `tab-${app.state.tab}`));
      tab.tabIndex = tab === reached ? 0 : -1;
    }
    for (const panel of /** @type {HTMLElement[]} */ ([byId("panel-order"), ...panels.children])) panel.classList.toggle("shown", panel.id === `panel-${app.state.tab}`);
    document.body.dataset.tab = app.state.tab;
  };
  /** @param {number} by */
  const step = by => {
    const tabs = all(), at = tabs.findIndex(tab => tab.id === `tab-${app.state.tab}`);
    const next = tabs[at < 0 ? 0 : (at + by + tabs.length) % tabs.length];
    if (next) app.set({ tab: next.id.slice(4) });
  };
  bar.addEventListener("click", event => {
    const tab = /** @type {HTMLElement} */ (event.target).closest("[role=tab]");
    if (tab) app.set({ tab: tab.id.slice(4) });
  });
  bar.addEventListener("keydown", event => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    event.preventDefault();
    event.stopPropagation();
    step(by);
    byId(`tab-${app.state.tab}`).focus();
  });
  app.on((_, changes) => { if (changes.tab !== undefined) show(); });
  if (app.data.comparison) app.set({ tab: "compared" });
  show();
  return {
    step,
    add: (name, title) => {
      const panel = make("div", { id: `panel-${name}`, class: "panel", role: "tabpanel", tabindex: 0, "aria-labelledby": `tab-${name}` });
      bar.append(make("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": panel.id }, title));
      panels.append(panel);
      show();
      return panel;
    },
  };
}
