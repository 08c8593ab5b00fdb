/** @import { Work } from "./work.js" */
import { conflictPanel } from "./conflicts.js";
import { notices } from "./differences.js";
import { dragging } from "./dragging.js";
import { partEditing } from "./editparts.js";
import { History } from "./history.js";
import { lockPanel } from "./locking.js";
import { planBar } from "./planning.js";
import { plansPanel } from "./plans.js";
import { profilePanel } from "./profile.js";
import { planningQuestions, readingPicture } from "./questions.js";
import { tabDrawing } from "./tabdrawing.js";
import { planViews } from "./views.js";
import { weightSliders } from "./weights.js";

/**
 * Gives the page hands: planning, locks, drags, edits of parts, weights, undo, conflicts and saving.
 *
 * @param {any} app as docs/page.md says
 * @param {Work} work
 */
export function giveHands(app, work) {
  work.say = (text, kind = "") => sayAloud(app, work, text, kind);
  planBar(app, work, new History(work));
  notices(app, work);
  const drawTab = tabDrawing(app, work);
  lockPanel(app, work, drawTab);
  plansPanel(app, work);
  conflictPanel(app, work);
  planningQuestions(app, work);
  weightSliders(app, work);
  profilePanel(app, work);
  partEditing(app, work);
  dragging(app, work);
  readingPicture(app, work);
  planViews(app, work);
  const { side } = app.slots; // what lies over the panels takes no more room of them than it needs
  new ResizeObserver(() => document.documentElement.style.setProperty("--slot-side", `${side.offsetHeight}px`)).observe(side);
  work.hear("state");
}

/** What was said last is of one plan, and goes with it; what was refused is told at once. */
/** @type {(app: any, work: Work, text: string, kind: string) => void} */
function sayAloud(app, work, text, kind) {
  app.tell(text);
  const place = document.getElementById("hands-said");
  if (!place) return;
  place.textContent = text;
  place.className = `said ${kind}`;
  place.setAttribute("role", kind === "bad" ? "alert" : "status");
  place.dataset.of = work.saidOf;
}
