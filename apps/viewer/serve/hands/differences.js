/** @import { Work } from "./work.js" */
import { make } from "./elements.js";
import { tr } from "./say.js";

/** Why nothing is kept, where it is no sentence of the system. */
/** @type {Record<string, () => string>} */
const WHY_NOT = { "this server was started to keep nothing": () => tr("this server was started to keep nothing") };

/**
 * Notices over the page: the server does not answer, nothing can be kept, what was changed outside while nobody looked.
 *
 * @param {any} app
 * @param {Work} work
 */
export function notices(app, work) {
  const place = make("section", { id: "hands-notices", "aria-live": "polite", "aria-label": tr("notices") });
  app.slots.side.prepend(place);
  const draw = () => {
    const { differences = [], keeping = { ok: true } } = work.state;
    place.replaceChildren(
      ...(work.lost ? [lostNotice(work)] : []),
      ...(keeping.ok ? [] : [make("p", { class: "notice" }, tr("plans and edits are not kept on disk: {why}", { why: WHY_NOT[keeping.why]?.() ?? keeping.why }))]),
      ...(keeping.aside ? [make("p", { class: "notice" }, tr("what was wanted of this nest could not be read, and is set aside: {file}", { file: keeping.aside }))] : []),
      ...differences.map((/** @type {any} */ one) => one.what === "nest" ? nestNotice(work, one) : jobNotice(work, one)),
    );
    place.hidden = !place.childElementCount;
  };
  work.on((_, what) => { if (what === "state" || what === "connection") draw(); });
}

/** @type {(work: Work) => HTMLElement} */
function lostNotice(work) {
  const again = make("button", { type: "button", onclick: () => work.catchUp().then(() => work.connected(false), error => work.say(error.message, "bad")) }, tr("Try again"));
  return make("p", { class: "notice lost", role: "alert" }, `${tr("The connection to kerfwise serve is lost: what was shown is kept. Start it again in the same folder, and this page goes on.")} `, again);
}

/** @type {(work: Work, difference: any) => HTMLElement} */
function nestNotice(work, { parts, sheet }) {
  const told = Object.entries(parts).filter(([, names]) => names.length).map(([how, names]) => howText(how, `${names.slice(0, 8).join(", ")}${names.length > 8 ? ` ${tr("and {n} more", { n: names.length - 8 })}` : ""}`));
  if (sheet) told.push(tr("the sheet is another one"));
  const seen = make("button", { type: "button", onclick: () => work.change("differences", { nest: "seen" }) }, tr("Seen"));
  return make("p", { class: "notice" }, `${tr("The drawing was changed outside: {what}. Plans of the drawing before stay in the list.", { what: told.join("; ") || tr("no part of it differs") })} `, seen);
}

/** @type {(work: Work, difference: any) => HTMLElement} */
function jobNotice(work, { lines, using, unsaved, why }) {
  const take = (/** @type {string} */ job, /** @type {string} */ text) => make("button", { type: "button", "aria-pressed": String(using === job), onclick: () => work.change("differences", { job }) }, text);
  const yours = unsaved ? tr("your edits") : tr("what it said before");
  return make("div", { class: "notice" }, make("p", {}, `${tr("The job file was changed outside (- on disk, + {yours}).", { yours })} ${why ? tr("This does not go with the drawing any more: {why}", { why }) : ""}`),
    make("pre", {}, lines.join("\n")), take("disk", tr("Take the file on disk")), " ", take("kept", unsaved ? tr("Keep my edits") : tr("Take what it said before")));
}

/** @type {(how: string, names: string) => string} */
function howText(how, names) {
  return { added: tr("added {names}", { names }), removed: tr("removed {names}", { names }), changed: tr("changed {names}", { names }) }[how] ?? `${how} ${names}`;
}
