/** @import { Work } from "./work.js" */
import { make } from "./elements.js";

const METRE_MM = 1000, CLOCK_MS = 1000;

/**
 * In the bar on top: plan, cancel, undo and save, with what the engines have reached.
 *
 * @param {any} app
 * @param {Work} work
 */
export function planBar(app, work) {
  const plan = make("button", { type: "button", id: "hands-plan", title: "plan what is wanted (Enter)", onclick: () => work.solve() }, "Plan");
  const cancel = make("button", { type: "button", id: "hands-cancel", hidden: true, onclick: () => cancelNow(work) }, "Cancel");
  const undo = make("button", { type: "button", id: "hands-undo", title: "back to the plan before (u)", onclick: () => undoLast(work) }, "Undo");
  const save = make("button", { type: "button", id: "hands-save", title: "write the program, the plan and the job file", onclick: () => saveAll(work) }, "Save");
  const said = make("span", { id: "hands-said" });
  const reached = make("span", { id: "hands-reached" });
  app.slots.tools.append(make("a", { href: "/?list", title: "the nests of the folder" }, "Nests"), plan, cancel, undo, save, reached, said);
  app.key("Enter", () => work.solve(), "plan what is wanted");
  app.key("u", () => undoLast(work), "back to the plan before");
  let wasSolving = false;
  setInterval(() => { if (work.state?.solving) work.hear("clock"); }, CLOCK_MS);
  work.on(() => {
    const { solving, fits, problem, upto } = work.state, clock = solving ? clockOf(solving) : "";
    plan.hidden = Boolean(solving);
    plan.classList.toggle("wanted", !fits);
    cancel.hidden = !solving;
    undo.toggleAttribute("disabled", !beforeShown(work));
    save.toggleAttribute("disabled", !work.plan?.ok || work.lost);
    reached.textContent = solving ? `${reachedText(solving, work)} ${clock}` : `${upto && !fits ? `cuts 1 to ${upto} are made; ` : ""}${stillText(work)}`;
    if (wasSolving && !solving) work.say(problem || (work.state.conflict ? "the rules contradict each other" : plannedText(work)));
    wasSolving = Boolean(solving);
  });
}

/** @type {(work: Work) => string} what is to be said of a plan that is not what is wanted; "" of one that is */
function stillText({ state, plan }) {
  if (state.fits) return "";
  if (state.conflict) return plan ? "no plan keeps all that is wanted; shown is the one before:" : "no plan:";
  return plan ? "not planned yet; shown is the plan before" : "not planned yet: press Plan";
}

/** @type {(work: Work) => void} */
function cancelNow(work) {
  const again = work.state.solving?.ending;
  work.cancel(Boolean(again));
  work.say(again ? "ended without a plan" : "ending with the best plan so far; once more ends it at once");
}

/** What the list of plans has before the shown one. */
/** @type {(work: Work) => number} */
function beforeShown(work) {
  const { alternatives, shown, fits } = work.state;
  const at = alternatives.findIndex((/** @type {any} */ one) => one.number === shown);
  return fits ? alternatives[at - 1]?.number ?? 0 : shown;
}

/** @type {(work: Work) => void} */
function undoLast(work) {
  const to = beforeShown(work);
  if (to) work.change("back", { to });
}

/** @type {(work: Work) => Promise<void>} */
async function saveAll(work) {
  const told = await work.change("save", {});
  if (!told) return;
  const { files, command, same_bytes } = told.saved;
  const same = same_bytes ? `the same by: ${command}` : `it was cancelled: ${command} may find a better one`;
  work.say(`saved ${files.join(", ")}; ${same}`);
}

/** What is being done, as a planner says it, by what the server calls it. */
/** @type {Record<string, string>} */
const PHASES = {
  waits: "waits for its turn",
  "getting ready": "getting ready the first time (some 20 s)",
  reading: "reading",
  "first plan": "looking for a first plan",
  improving: "looking for a better plan",
  proving: "proving",
  finishing: "checking the plan",
};

/** @type {(solving: any, work: Work) => string} */
function reachedText({ waits, ending, phase, gap, plan, gained_mm }, { planner, state }) {
  if (waits && planner) return `waits: ${planner} is being planned`;
  const shown = state.alternatives.find((/** @type {any} */ one) => one.number === plan);
  const told = [
    shown && (shown.stage === "first" ? "first plan" : `better by ${(gained_mm / METRE_MM).toFixed(1)} m`),
    ending ? "ending" : PHASES[phase] ?? phase,
    gap !== null && `at most ${(100 * gap).toFixed(1)} % from the best`,
  ];
  return `${told.filter(Boolean).join("; ")} …`;
}

/** How long it has taken; the clock runs on between the news. */
/** @type {(solving: any) => string} */
function clockOf(solving) {
  solving.told_ms ??= performance.now();
  return `${Math.floor(solving.elapsed_s + (performance.now() - solving.told_ms) / 1000)} s`;
}

/** @type {(work: Work) => string} */
function plannedText(work) {
  const { figures } = work.plan ?? { figures: null };
  return figures ? `plan ${work.state.shown}: idle ${(figures.idle_mm / METRE_MM).toFixed(3)} m, ${figures.status === "optimal" ? "proven" : "not proven"}` : "";
}
