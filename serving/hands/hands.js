/** @import { Work } from "./work.js" */
import { askServer } from "./asking.js";
import { conflictPanel } from "./conflicts.js";
import { dragging } from "./dragging.js";
import { lockPanel } from "./locking.js";
import { planBar } from "./planning.js";
import { plansPanel } from "./plans.js";
import { profilePanel } from "./profile.js";
import { weightSliders } from "./weights.js";

/**
 * Gives the page hands: planning, locks, drags, weights, undo, conflicts and saving.
 *
 * @param {any} app as docs/page.md says
 * @param {Work} work
 */
export function giveHands(app, work) {
  work.say = text => sayAloud(app, text);
  work.shownData = app.data;
  const now = () => `${work.state.shown} ${work.state.sha256}`;
  let shown = now();
  planBar(app, work);
  lockPanel(app, work);
  plansPanel(app, work);
  conflictPanel(app, work);
  weightSliders(app, work);
  profilePanel(app, work);
  dragging(app, work);
  work.on(async (_, what) => {
    if (what !== "state" || now() === shown) return;
    const asked = shown = now();
    const data = await askServer(work.path("page")).catch(error => { work.say(error.message); return null; });
    if (!data || asked !== now()) return;
    work.shownData = data;
    document.body.classList.toggle("planless", !data.sides.length);
    app.replace(data);
  });
  work.hear("state");
}

/** @type {(app: any, text: string) => void} */
function sayAloud(app, text) {
  app.tell(text);
  const place = document.getElementById("hands-said");
  if (place) place.textContent = text;
}
