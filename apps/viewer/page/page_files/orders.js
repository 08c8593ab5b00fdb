/** @import { App } from "./app.js" */
/** @import { CutData } from "./types.js" */
import { byId, make } from "./elements.js";
import { tr, trn } from "./say.js";
import { withFirst } from "./timeline.js";
import { VirtualList } from "./virtual.js";
import { clock, kindText, millimetres } from "./words.js";

export const ROW_PX = 27;
const SIGNS = { outer: "▢", hole: "◯", mark: "✎", slit: "╱", scrap: "✂" };

/**
 * The cuts in order, as a list of which only the seen rows are made.
 *
 * @param {App} app
 */
export function orderList(app) {
  const holder = byId("orders"), head = byId("orders-head");
  /** @type {CutData[]} */
  let cuts = [];
  /** @type {Map<number, string>} */
  let differs = new Map();
  let current = -1;
  const list = new VirtualList(holder, ROW_PX, (row, k) => {
    const cut = cuts[k], contour = app.data.nest.contours[cut.contour], stage = app.stages[app.state.side];
    const done = stage.timeline.ends_s[k] <= app.state.time_s, now = k === current;
    const flags = [
      cut.excused.length ? make("b", { class: "flag unkept", title: tr("not kept here: {rules}", { rules: cut.excused.join(", ") }) }, "!") : null,
      cut.wait_s ? make("b", { class: "flag", title: tr("waits {s} s", { s: cut.wait_s }) }, "⏱") : null,
      withFirst(cut) ? make("b", { class: "flag", title: tr("by torch {torch}, together with the cut before", { torch: cut.torch }) }, `T${cut.torch}`) : null,
      cut.linked ? make("b", { class: "flag", title: tr("linked: the torch stays on") }, "∞") : null,
      differs.has(cut.contour) ? make("b", { class: "flag diff", title: differs.get(cut.contour) }, "≠") : null,
    ];
    row.className = `row${done ? " done" : ""}${now ? " now" : ""}${cut.contour === app.state.selected ? " chosen" : ""}`;
    row.setAttribute("role", "option");
    row.id = `row-${k}`;
    row.setAttribute("aria-selected", String(cut.contour === app.state.selected));
    row.setAttribute("aria-posinset", String(k + 1));
    row.setAttribute("aria-setsize", String(cuts.length));
    row.dataset.contour = contour.id;
    const band = make("i", { class: "band", title: cut.zone ? tr("zone {zone}", { zone: cut.zone }) : tr("no zone") });
    band.style.background = cut.zone ? `var(--zone${(cut.zone - 1) % 8})` : "transparent";
    row.append(band, make("span", { class: "no" }, String(app.side.made + k + 1)),
      make("span", { class: `kind ${contour.kind}`, title: kindText(contour.kind) }, SIGNS[contour.kind]),
      make("span", { class: "id", title: contour.id }, contour.id), ...flags.filter(flag => flag !== null),
      make("span", { class: "length" }, millimetres(cut.length_mm)),
      make("span", { class: "at" }, clock(stage.timeline.begins_s[k])));
    app.rowMakers.forEach(fn => fn(row, cut));
  });
  holder.addEventListener("click", event => {
    const row = /** @type {HTMLElement} */ (event.target).closest(".row");
    if (row) app.choose(cuts[Number(row.id.slice(4))].contour);
  });
  holder.addEventListener("dblclick", event => {
    const row = /** @type {HTMLElement} */ (event.target).closest(".row");
    if (row) app.seek(app.stages[app.state.side].timeline.begins_s[Number(row.id.slice(4))]);
  });
  holder.addEventListener("keydown", event => {
    const at = cuts.findIndex(cut => cut.contour === app.state.selected), last = cuts.length - 1;
    const to = { ArrowDown: Math.min(last, at + 1), ArrowUp: Math.max(0, at - 1), PageDown: Math.min(last, at + 12),
      PageUp: Math.max(0, at - 12), Home: 0, End: last }[event.key];
    if (to === undefined || !cuts.length) return;
    event.preventDefault();
    event.stopPropagation();
    app.choose(cuts[to].contour);
  });
  const renew = () => {
    cuts = app.side ? app.side.cuts : [];
    differs = new Map((app.data.comparison?.changed ?? []).map(pair => [pair.contour, pair.told]));
    head.textContent = cuts.length ? `${trn("{n} cut", "{n} cuts", cuts.length)}${app.side.name ? ` · ${app.side.name}` : ""}` : tr("no plan");
    list.reset(cuts.length);
  };
  renew();
  app.renewed(renew);
  app.rowsAnew = () => list.refresh();
  app.on((state, changes) => {
    if (changes.side !== undefined) renew();
    const now = app.cutNow();
    const moved = now !== current;
    current = now;
    if (changes.selected !== undefined) {
      const k = cuts.findIndex(cut => cut.contour === state.selected);
      holder.setAttribute("aria-activedescendant", k < 0 ? "" : `row-${k}`);
      if (k >= 0) list.reveal(k);
      list.refresh();
    } else if (moved) {
      if (state.playing && now >= 0) list.reveal(Math.min(now + 2, cuts.length - 1));
      list.refresh();
    }
  });
}
