/** @import { Work } from "./work.js" */
import { conflictPanel } from "./conflicts.js";
import { notices } from "./differences.js";
import { dragging } from "./dragging.js";
import { lockPanel } from "./locking.js";
import { planBar } from "./planning.js";
import { plansPanel } from "./plans.js";
import { profilePanel } from "./profile.js";
import { planningQuestions } from "./questions.js";
import { tabDrawing } from "./tabdrawing.js";
import { planViews } from "./views.js";
import { weightSliders } from "./weights.js";

/**
 * Gives the page hands: planning, locks, drags, weights, undo, conflicts and saving.
 *
 * @param {any} app as docs/page.md says
 * @param {Work} work
 */
export function giveHands(app, work) {
  work.say = text => sayAloud(app, text);
  planBar(app, work);
  notices(app, work);
  const drawTab = tabDrawing(app, work);
  lockPanel(app, work, drawTab);
  plansPanel(app, work);
  conflictPanel(app, work);
  planningQuestions(app, work);
  weightSliders(app, work);
  profilePanel(app, work);
  dragging(app, work);
  planViews(app, work);
  work.hear("state");
}

/** @type {(app: any, text: string) => void} */
function sayAloud(app, text) {
  app.tell(text);
  const place = document.getElementById("hands-said");
  if (place) place.textContent = text;
}
