/** @import { Work } from "./work.js" */
import { Judge, dropThere } from "./judge.js";
import { partDrags } from "./partdrags.js";
import { rowDrags } from "./rowdrags.js";
import { tr } from "./say.js";

/**
 * A row of the order, or a part on the drawing, dragged to another place: the verdict is there before it is dropped.
 *
 * @param {any} app
 * @param {Work} work
 */
export function dragging(app, work) {
  const judge = new Judge(work);
  rowDrags(app, work, judge);
  partDrags(app, work, judge);
  app.key("<", () => byKey(app, work, -1), tr("move the chosen cut one place earlier"));
  app.key(">", () => byKey(app, work, 1), tr("move the chosen cut one place later"));
}

/** The chosen contour one place on or back, by the keyboard. */
/** @type {(app: any, work: Work, by: number) => void} */
function byKey(app, work, by) {
  const side = app.data.sides[0], k = side?.cuts.findIndex((/** @type {any} */ cut) => cut.contour === app.state.selected) ?? -1;
  const to = k + by;
  if (k < 0) return work.say(tr("choose a cut first"), "warn");
  if (work.whyNot) return work.say(work.whyNot, "warn");
  if (to < 0 || to >= side.cuts.length) return work.say(by < 0 ? tr("it is the first cut already") : tr("it is the last cut already"), "warn");
  void dropThere(work, { names: [app.data.nest.contours[app.state.selected].id], to: side.made + to + 1, plan: work.state.shown });
}
