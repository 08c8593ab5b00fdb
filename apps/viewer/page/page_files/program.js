/** @import { App } from "./app.js" */
/** @import { NcData } from "./types.js" */
import { byId, make } from "./elements.js";
import { tr } from "./say.js";
import { countUpTo, momentAt } from "./timeline.js";
import { VirtualList } from "./virtual.js";
import { placeOn } from "./way.js";

const LINE_PX = 20;

/**
 * The program, its line in step with the torch.
 *
 * @param {App} app
 */
export function programPanel(app) {
  const holder = byId("nc");
  /** @type {NcData | null} */
  let nc = null;
  /** @type {string[]} */
  let texts = [];
  let current = -1;
  const list = new VirtualList(holder, LINE_PX, (row, k) => {
    row.className = `row${k + 1 === current ? " now" : ""}`;
    row.append(make("span", { class: "no" }, String(k + 1)), make("code", {}, texts[k]));
  });
  let asked = 0;
  const renew = async () => {
    const mine = ++asked, told = app.side ? await app.source.nc(app.state.side) : null;
    if (mine !== asked) return; // another plan is shown meanwhile
    nc = told;
    texts = nc ? nc.text.split(/\r?\n/) : [];
    byId("nc-none").hidden = nc !== null;
    byId("nc-none").textContent = app.side?.unchecked ? tr("The program of this plan is not written and checked yet.") : tr("This page has no program.");
    list.reset(texts.length);
    follow();
  };
  /** @param {boolean} [again] whether the panel has just come into sight */
  const follow = (again = false) => {
    const line = nc ? lineAt(app, nc) : -1;
    if (line === current && !again) return;
    current = line;
    if (line > 0) list.reveal(Math.max(0, Math.min(texts.length - 1, line + 3)));
    if (line > 0) list.reveal(line - 1);
    list.refresh();
  };
  holder.addEventListener("click", event => {
    const row = /** @type {HTMLElement} */ (event.target).closest(".row");
    const line = Number(row?.querySelector(".no")?.textContent);
    if (!nc || !line) return;
    const burn = nc.lines.findLastIndex(lines => lines[0] <= line);
    const { begins_s, firsts } = app.stages[app.state.side].timeline;
    if (burn >= 0 && !app.side.pierces.length && burn < firsts.length) app.seek(begins_s[firsts[burn]] + 1e-3);
  });
  app.on((_, changes) => {
    if (changes.side !== undefined) void renew();
    else if (changes.tab === "nc") requestAnimationFrame(() => follow(true)); // once it has its height
    else if (changes.time_s !== undefined) follow();
  });
  app.renewed(() => void renew(), true);
  void renew();
}

/**
 * The line that the torch is at: in a cut the one of its line or arc, else where the burn begins.
 *
 * @param {App} app
 * @param {NcData} nc
 * @returns {number}
 */
export function lineAt(app, nc) {
  const stage = app.stages[app.state.side], { moment, share } = momentAt(stage.timeline, app.state.time_s);
  if (!moment) return nc.lines.length ? nc.lines[nc.lines.length - 1].at(-1) ?? -1 : -1;
  const before = app.side.pierces.filter(pierce => pierce.before <= app.side.made + moment.cut + 1).length;
  const lines = nc.lines[countUpTo(stage.timeline.firsts, moment.cut) - 1 + before];
  if (!lines) return -1;
  if (moment.does !== "cut") return lines[0];
  const { path } = app.side.cuts[moment.cut], pieces = path.length / 3 - 1;
  if (lines.length !== pieces + 1) return lines[0];
  const way = stage.scenery.way(moment.cut), { along } = placeOn(way, share);
  return lines[1 + Math.min(pieces - 1, pieceAt(path, along))];
}

/**
 * The number of the line or arc that lies so far along a way.
 *
 * @param {number[]} path rows
 * @param {number} along mm
 * @returns {number}
 */
function pieceAt(path, along) {
  let passed = 0;
  for (let k = 0; 3 * (k + 1) < path.length; k++) {
    const chord = Math.hypot(path[3 * k + 3] - path[3 * k], path[3 * k + 4] - path[3 * k + 1]), bulge = path[3 * k + 2];
    const half = 2 * Math.atan(bulge);
    passed += bulge ? (chord * half) / Math.sin(half) : chord;
    if (along < passed - 1e-6) return k;
  }
  return path.length / 3 - 2;
}
