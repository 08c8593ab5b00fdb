/** @import { App } from "./app.js" */
/** @import { NestData, SideData } from "./types.js" */
/** @import { Timeline } from "./timeline.js" */
import { tr } from "./say.js";
import { clock } from "./words.js";

/**
 * What an operator looks out for: the torch waits, a tab is left, a line is marked, a part comes loose.
 *
 * @typedef {object} Notice
 * @property {"stop" | "tab" | "mark" | "loose" | "unkept"} kind
 * @property {number} at_s
 * @property {number} cut from 0
 */

/** What stands for a notice on the time line: of more at one place the first of these is drawn. */
export const NOTICE_SIGNS = /** @type {Record<Notice["kind"], string>} */ ({ unkept: "!", stop: "‖", tab: "⊓", mark: "✎", loose: "◇" });

/**
 * The notices of a plan, in the order of time.
 *
 * @param {NestData} nest
 * @param {SideData} side
 * @param {Timeline} timeline
 * @returns {Notice[]}
 */
export function noticesOf(nest, side, timeline) {
  /** @type {Notice[]} */
  const notices = [];
  side.cuts.forEach((cut, k) => {
    const { kind } = nest.contours[cut.contour], begins = timeline.begins_s[k], ends = timeline.ends_s[k];
    if (cut.excused.length) notices.push({ kind: "unkept", at_s: begins, cut: k });
    if (cut.wait_s) notices.push({ kind: "stop", at_s: Math.max(0, begins - cut.wait_s), cut: k });
    if (kind === "mark") notices.push({ kind: "mark", at_s: begins, cut: k });
    if (cut.tabs.length) notices.push({ kind: "tab", at_s: ends, cut: k });
    else if (kind === "outer") notices.push({ kind: "loose", at_s: ends, cut: k });
  });
  return notices.sort((a, b) => a.at_s - b.at_s || a.cut - b.cut);
}

/** @type {(app: App, side: number, notice: Notice) => string} */
export function noticeText(app, side, { kind, at_s, cut: k }) {
  const { cuts, made } = app.data.sides[side], { id } = app.data.nest.contours[cuts[k].contour], number = made + k + 1, cut = cuts[k];
  const said = {
    unkept: () => tr("{number} {id}: not kept here: {rules}", { number, id, rules: cut.excused.join(", ") }),
    stop: () => tr("the torch waits {s} s before {number} {id}", { s: cut.wait_s, number, id }),
    mark: () => tr("{number} {id} is marked", { number, id }),
    tab: () => tr("{number} {id} is held by tabs", { number, id }),
    loose: () => tr("{number} {id} comes loose", { number, id }),
  }[kind]();
  return `${clock(at_s)} ${said}`;
}

/**
 * The notice under a place of the time line, the weightiest of those that stand there; null for none.
 *
 * @param {Notice[]} notices
 * @param {number} at_s
 * @param {number} within_s
 * @returns {Notice | null}
 */
export function noticeNear(notices, at_s, within_s) {
  const order = Object.keys(NOTICE_SIGNS), near = notices.filter(one => Math.abs(one.at_s - at_s) <= within_s);
  return near.sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind) || Math.abs(a.at_s - at_s) - Math.abs(b.at_s - at_s))[0] ?? null;
}

/** To the next notice, or the one before: the time goes there, its cut is chosen, and it is told. */
/** @type {(app: App, by: number) => void} */
export function toNotice(app, by) {
  const { side } = app.state, stage = app.stages[side];
  if (!stage.plan) return;
  const notices = noticesOf(app.data.nest, stage.plan, stage.timeline), now = app.state.time_s;
  const found = by > 0 ? notices.find(one => one.at_s > now + 1e-6) : notices.findLast(one => one.at_s < now - 1e-6);
  if (!found) return app.tell(by > 0 ? tr("no more notices") : tr("no notice before"));
  app.set({ playing: false });
  app.seek(found.at_s);
  app.choose(stage.plan.cuts[found.cut].contour);
  app.tell(noticeText(app, side, found));
}
