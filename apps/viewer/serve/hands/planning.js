/** @import { History } from "./history.js" */
/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { figure, tr } from "./say.js";
import { inWords } from "./sentences.js";
import { percent, reachedPlan } from "./words.js";

const METRE_MM = 1000, CLOCK_MS = 1000;

/**
 * In the bar on top: plan, cancel, undo, redo and save, with what the planning has reached. One of them stands out: what
 * is to be done next.
 *
 * @param {any} app
 * @param {Work} work
 * @param {History} history
 */
export function planBar(app, work, history) {
  const button = (/** @type {string} */ id, /** @type {string} */ text, /** @type {string} */ title, /** @type {() => void} */ onclick, sign = "") =>
    make("button", { type: "button", id, title, onclick, "aria-label": sign && text || null }, ...(sign ? [make("span", { class: "wide" }, text), make("span", { class: "narrow" }, sign)] : [text]));
  const plan = button("hands-plan", tr("Plan"), tr("plan what is wanted (Enter)"), () => work.solve());
  const cancel = button("hands-cancel", tr("Cancel"), tr("end with the best plan so far"), () => cancelNow(work));
  const undo = button("hands-undo", tr("Undo"), tr("undo the last change (Ctrl+Z)"), () => void history.step(-1), "↶");
  const redo = button("hands-redo", tr("Redo"), tr("do it again (Ctrl+Y)"), () => void history.step(1), "↷");
  const save = button("hands-save", tr("Save"), tr("write the program, the plan and the job file"), () => saveAll(work));
  const said = make("span", { id: "hands-said", class: "said", role: "status" });
  const reached = make("span", { id: "hands-reached" });
  app.slots.tools.append(make("a", { href: "/?list", title: tr("the nests of the folder") }, tr("Nests")), plan, cancel, undo, redo, save, reached, said);
  app.key("Enter", () => work.solve(), tr("plan what is wanted"));
  app.key("Ctrl+z", () => void history.step(-1), tr("undo the last change"));
  app.key("Ctrl+y", () => void history.step(1), tr("do it again"));
  app.key("Ctrl+Shift+z", () => void history.step(1), "");
  let wasSolving = false;
  setInterval(() => { if (work.state?.solving) work.hear("clock"); }, CLOCK_MS);
  work.on(() => {
    const { solving, fits, problem, upto, shown, saved } = work.state, isSaved = saved?.number === shown;
    plan.hidden = Boolean(solving);
    plan.classList.toggle("primary", !fits && !work.state.conflict);
    plan.toggleAttribute("disabled", work.lost);
    plan.title = work.lost ? tr("the connection is lost") : tr("plan what is wanted (Enter)");
    cancel.hidden = !solving;
    undo.toggleAttribute("disabled", !history.can(-1));
    redo.toggleAttribute("disabled", !history.can(1));
    const notSaved = work.lost ? tr("the connection is lost") : !work.plan ? tr("there is no plan yet") : !work.plan.ok ? tr("the check refuses this plan") : work.plan.checked ? "" : tr("its program is not checked yet");
    save.toggleAttribute("disabled", Boolean(notSaved));
    save.title = notSaved || tr("write the program, the plan and the job file");
    save.classList.toggle("primary", !notSaved && fits && !isSaved);
    reached.textContent = solving ? `${reachedText(solving, work)} ${clockOf(solving)}` : `${upto && !fits ? `${tr("cuts 1 to {upto} are made", { upto })}; ` : ""}${stillText(work)}`;
    if (said.textContent && said.dataset.of !== work.saidOf) said.textContent = ""; // it was said of another plan
    app.set({ stale: !fits && Boolean(work.plan) });
    if (wasSolving && !solving && !work.lost) {
      if (problem || work.state.conflict) work.say(inWords(problem) || tr("the rules contradict each other"), "bad");
      else work.say(reachedPlan(work.state.alternatives, work.state.shown), work.plan?.ok ? "good" : "bad");
    }
    wasSolving = Boolean(solving);
  });
}

/** @type {(work: Work) => string} what is to be said of a plan that is not what is wanted; "" of one that is */
function stillText({ state, plan }) {
  if (state.fits) return "";
  if (state.conflict) return plan ? tr("no plan keeps all that is wanted; shown is the one before") : tr("there is no plan");
  return plan ? tr("not planned yet; shown is the plan before") : tr("not planned yet: press Plan");
}

/** @type {(work: Work) => void} */
function cancelNow(work) {
  const again = work.state.solving?.ending;
  work.cancel(Boolean(again));
  work.say(again ? tr("ended without a plan") : tr("ending with the best plan so far; once more ends it at once"));
}

/** @type {(work: Work) => Promise<void>} */
async function saveAll(work) {
  const told = await work.change("save", {});
  if (!told) return;
  const { files, command, same_bytes } = told.saved;
  const names = files.join(", ");
  work.say(same_bytes ? tr("saved {names}; the same by: {command}", { names, command })
    : tr("saved {names}; it was shown on the way: {command} plans anew and may find another", { names, command }), "good");
}

/** What is being done, as a planner says it, by what the server calls it. */
/** @type {Record<string, () => string>} */
const PHASES = {
  waits: () => tr("waits for its turn"),
  "getting ready": () => tr("getting ready the first time (some 20 s)"),
  reading: () => tr("reading"),
  "first plan": () => tr("looking for a first plan"),
  checking: () => tr("checking its program"),
  improving: () => tr("looking for a better plan"),
  proving: () => tr("proving"),
  finishing: () => tr("checking the plan"),
};

/** @type {(solving: any, work: {planner: string, state: any}) => string} */
export function reachedText({ waits, ending, phase, gap, plan, gained_mm }, { planner, state }) {
  if (waits && planner) return `${tr("waits: {planner} is being planned", { planner })} …`;
  const shown = state.alternatives.find((/** @type {any} */ one) => one.number === plan);
  const told = [
    shown && (shown.stage === "first" ? tr("first plan") : tr("better by {mm} m", { mm: figure(gained_mm / METRE_MM, 1) })),
    ending ? tr("ending") : PHASES[phase]?.() ?? phase,
    gap !== null && tr("at most {share} from the best", { share: percent(gap) }),
  ];
  return `${told.filter(Boolean).join("; ")} …`;
}

/** How long it has taken; the clock runs on between the news. */
/** @type {(solving: any) => string} */
export function clockOf(solving) {
  solving.told_ms ??= performance.now();
  return `${Math.floor(solving.elapsed_s + (performance.now() - solving.told_ms) / 1000)} s`;
}
