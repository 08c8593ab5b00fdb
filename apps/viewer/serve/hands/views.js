/** @import { Work } from "./work.js" */
import { tr } from "./say.js";

/**
 * What is drawn goes with what is shown: another plan, another nest, or two plans under one cursor.
 *
 * @param {any} app
 * @param {Work} work
 */
export function planViews(app, work) {
  let asked = work.drawn, shown = work.state.shown, rejudging = false;
  /** The program of the plan that is drawn has been checked meanwhile: what is said of it is renewed, and nothing moves. */
  const rejudge = async () => {
    const drawn = app.data.sides[0], { view } = work;
    if (rejudging || work.compared || !work.isDrawn || !drawn?.unchecked || !work.plan?.checked) return;
    rejudging = true;
    const data = await work.page().catch(() => null); // with the next news
    rejudging = false;
    if (data && view === work.view && app.data.sides[0] === drawn) app.app.judged(data.sides[0]);
  };
  markDrawn(work);
  work.on(async (_, what) => {
    if (what !== "state") return;
    const known = work.state.alternatives.map((/** @type {any} */ one) => one.number);
    if (work.state.shown !== shown || !work.compared?.every(number => known.includes(number))) work.compared = null;
    shown = work.state.shown;
    const { view } = work;
    if (view === asked) {
      void rejudge();
      return;
    }
    asked = view;
    const data = await work.page().catch(error => { work.say(error.message, "bad"); return null; });
    if (view !== work.view) return;
    if (!data) {
      asked = ""; // with the next news
      if (work.compared) comparePlans(work, null);
      return;
    }
    app.replace(data);
    const { tab } = app.state;
    if (data.comparison) app.set({ tab: "compared" });
    else if (tab === "compared") app.set({ tab: "plans" });
    markDrawn(work);
    if (work.compared) work.say(tr("plans {a} and {b} stand side by side", { a: work.compared[0], b: work.compared[1] }));
    work.hear("drawn");
  });
}

/** @type {(work: Work) => void} */
function markDrawn(work) {
  document.documentElement.dataset.plan = String(work.data?.sides.length ? work.state.shown : 0);
}

/**
 * Two plans side by side, under one cursor; null for one alone.
 *
 * @param {Work} work
 * @param {[number, number] | null} plans
 */
export function comparePlans(work, plans) {
  work.compared = plans;
  if (plans) work.say(tr("comparing plans {a} and {b} …", { a: plans[0], b: plans[1] }));
  work.hear("state");
}
