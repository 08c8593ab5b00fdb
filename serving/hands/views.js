/** @import { Work } from "./work.js" */

/**
 * What is drawn goes with what is shown: another plan, another nest, or two plans under one cursor.
 *
 * @param {any} app
 * @param {Work} work
 */
export function planViews(app, work) {
  let asked = work.drawn, shown = work.state.shown;
  markDrawn(work);
  work.on(async (_, what) => {
    if (what !== "state") return;
    const known = work.state.alternatives.map((/** @type {any} */ one) => one.number);
    if (work.state.shown !== shown || !work.compared?.every(number => known.includes(number))) work.compared = null;
    shown = work.state.shown;
    const { view } = work;
    if (view === asked) return;
    asked = view;
    const data = await work.page().catch(error => { work.say(error.message); return null; });
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
    if (work.compared) work.say(`plans ${work.compared.join(" and ")} stand side by side`);
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
  if (plans) work.say(`comparing plans ${plans.join(" and ")} …`);
  work.hear("state");
}
