/** @import { Work } from "./work.js" */
import { make } from "./elements.js";

/**
 * Notices over the page: the server does not answer, nothing can be kept, what was changed outside while nobody looked.
 *
 * @param {any} app
 * @param {Work} work
 */
export function notices(app, work) {
  const place = make("aside", { id: "hands-notices", "aria-live": "polite" });
  app.slots.side.before(place);
  const draw = () => {
    const { differences = [], keeping = { ok: true } } = work.state;
    place.replaceChildren(
      ...(work.lost ? [lostNotice(work)] : []),
      ...(keeping.ok ? [] : [make("p", { class: "notice" }, `plans and edits are not kept on disk: ${keeping.why}`)]),
      ...differences.map((/** @type {any} */ one) => one.what === "nest" ? nestNotice(work, one) : jobNotice(work, one)),
    );
    place.hidden = !place.childElementCount;
  };
  work.on((_, what) => { if (what === "state" || what === "connection") draw(); });
}

/** @type {(work: Work) => HTMLElement} */
function lostNotice(work) {
  const again = make("button", { type: "button", onclick: () => work.catchUp().then(() => work.connected(false), error => work.say(error.message)) }, "Try again");
  return make("p", { class: "notice lost", role: "alert" }, "The connection to kerfwise serve is lost: what was shown is kept. Start it again in the same folder, and this page goes on. ", again);
}

/** @type {(work: Work, difference: any) => HTMLElement} */
function nestNotice(work, { parts, sheet }) {
  const told = Object.entries(parts).filter(([, names]) => names.length).map(([how, names]) => `${how} ${names.slice(0, 8).join(", ")}${names.length > 8 ? ` and ${names.length - 8} more` : ""}`);
  if (sheet) told.push("the sheet is another one");
  const seen = make("button", { type: "button", onclick: () => work.change("differences", { nest: "seen" }) }, "Seen");
  return make("p", { class: "notice" }, `The drawing was changed outside: ${told.join("; ") || "no part of it differs"}. Plans of the drawing before stay in the list. `, seen);
}

/** @type {(work: Work, difference: any) => HTMLElement} */
function jobNotice(work, { lines, using, unsaved, why }) {
  const take = (/** @type {string} */ job, /** @type {string} */ text) => make("button", { type: "button", "aria-pressed": String(using === job), onclick: () => work.change("differences", { job }) }, text);
  const yours = unsaved ? "your edits" : "what it said before";
  return make("div", { class: "notice" }, make("p", {}, `The job file was changed outside (- on disk, + ${yours}). ${why ? `${yours} do not go with the drawing any more: ${why}` : ""}`),
    make("pre", {}, lines.join("\n")), take("disk", "Take the file on disk"), " ", take("kept", unsaved ? "Keep my edits" : "Take what it said before"));
}
