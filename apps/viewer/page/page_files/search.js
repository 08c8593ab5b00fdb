/** @import { App } from "./app.js" */
import { byId, make } from "./elements.js";
import { tr } from "./say.js";

const MOST_FOUND = 12;

/**
 * The contours that a text means: a number of the order, an id, or a part, the nearest first.
 *
 * @param {string} text
 * @param {{id: string, part: string, number: number}[]} known number 0 for what is not cut
 * @returns {number[]} places in the list
 */
export function found(text, known) {
  const word = text.trim().toLowerCase();
  if (!word) return [];
  /** @type {[number, number][]} */
  const ranked = [];
  known.forEach(({ id, part, number }, k) => {
    const name = id.toLowerCase(), of = part.toLowerCase();
    const rank = String(number) === word ? 0 : name === word ? 1 : of === word ? 2 : name.startsWith(word) ? 3
      : of.startsWith(word) ? 4 : name.includes(word) ? 5 : -1;
    if (rank >= 0) ranked.push([rank, k]);
  });
  return ranked.sort((a, b) => a[0] - b[0] || a[1] - b[1]).map(([, k]) => k);
}

/**
 * The search in the bar on top.
 *
 * @param {App} app
 */
export function searchField(app) {
  const field = /** @type {HTMLInputElement} */ (byId("search")), menu = byId("found");
  /** @type {number[]} */
  let hits = [];
  let at = 0;
  const show = () => {
    const { contours, parts } = app.data.nest;
    const known = contours.map((contour, k) => ({
      id: contour.id, part: parts[contour.part] ?? "", number: (app.cutOf(k) ?? -1) + 1 + (app.cutOf(k) === undefined ? 0 : app.side.made),
    }));
    hits = found(field.value, known);
    at = Math.min(at, Math.max(0, Math.min(hits.length, MOST_FOUND) - 1));
    menu.hidden = !field.value.trim();
    field.setAttribute("aria-expanded", String(!menu.hidden));
    field.setAttribute("aria-activedescendant", hits.length ? `found-${at}` : "");
    menu.replaceChildren(...hits.slice(0, MOST_FOUND).map((k, place) => make("div", { id: `found-${place}`, role: "option",
      class: place === at ? "chosen" : "", "aria-selected": String(place === at), "data-contour": k },
    make("span", { class: "no" }, known[k].number ? String(known[k].number) : "–"), contours[k].id)),
    make("p", { class: "hint" }, hits.length > MOST_FOUND ? tr("and {n} more", { n: hits.length - MOST_FOUND }) : hits.length ? "" : tr("nothing found")));
  };
  const hide = () => {
    menu.hidden = true;
    field.setAttribute("aria-expanded", "false");
    field.setAttribute("aria-activedescendant", "");
  };
  /** @param {number} k */
  const take = k => {
    if (k === undefined) return;
    hide();
    app.choose(k);
  };
  field.addEventListener("input", () => { at = 0; show(); });
  field.addEventListener("focus", show);
  field.addEventListener("blur", () => hide());
  menu.addEventListener("pointerdown", event => {
    event.preventDefault();
    const hit = /** @type {HTMLElement} */ (event.target).closest("[data-contour]");
    if (hit instanceof HTMLElement) take(Number(hit.dataset.contour));
  });
  field.addEventListener("keydown", event => {
    const most = Math.min(hits.length, MOST_FOUND) - 1;
    if (event.key === "ArrowDown") at = Math.min(most, at + 1);
    else if (event.key === "ArrowUp") at = Math.max(0, at - 1);
    else if (event.key === "Enter") { take(hits[at]); return; }
    else if (event.key === "Escape") { field.value = ""; field.blur(); return; }
    else return;
    event.preventDefault();
    show();
  });
}
