/** @import { Work } from "./work.js" */
import { askServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan } from "./locking.js";
import { tr, trn } from "./say.js";
import { inWords } from "./sentences.js";

const LOOK_MS = 150, BESIDE_PX = 14, UNDER_PX = 18, OVER_FINGER_PX = 40, RIM_PX = 4;
/** How the answer looks: it goes, others have to move, a hard rule yields, it cannot be. */
const KINDS_OF_MOVES = /** @type {Record<string, string>} */ ({ goes: "good", "others move": "", "gives way": "warn", no: "bad" });

/** @typedef {{names: string[], to: number, plan: number}} Move contours, the number that the first of them is to have, and in which plan */

/** Says by the pointer what a move would do. One question is asked at a time, and of places passed over none. */
export class Judge {
  /** @param {Work} work */
  constructor(work) {
    this.work = work;
    this.place = make("div", { id: "hands-verdict", role: "status", hidden: true });
    /** @type {Move | null} */
    this.wanted = null;
    this.asking = false;
    document.body.append(this.place);
  }

  /** @type {(move: Move, event: PointerEvent) => void} */
  show(move, event) {
    this.#put(event);
    if (this.wanted && query(this.wanted, false) === query(move, false)) return;
    this.wanted = move;
    this.place.className = "";
    this.place.textContent = tr("{names} as number {to} …", { names: move.names.join(", "), to: move.to });
    if (!this.asking) void this.#ask();
  }

  /** Says something else by the pointer, until there is a move. */
  /** @type {(text: string, event: PointerEvent) => void} */
  say(text, event) {
    this.hide();
    this.place.textContent = text;
    this.#put(event);
  }

  /** Shows nothing any more. */
  hide() {
    this.wanted = null;
    this.place.hidden = true;
    this.place.replaceChildren();
    this.place.className = "";
  }

  /** By a mouse's pointer, and over a finger, which hides what lies under it. */
  /** @param {PointerEvent} event */
  #put({ clientX, clientY, pointerType }) {
    this.place.hidden = false;
    const { offsetWidth, offsetHeight } = this.place;
    const top = pointerType === "touch" ? clientY - OVER_FINGER_PX - offsetHeight : clientY + UNDER_PX;
    this.place.style.left = `${Math.max(RIM_PX, Math.min(clientX + BESIDE_PX, innerWidth - offsetWidth - 2 * RIM_PX))}px`;
    this.place.style.top = `${Math.max(RIM_PX, Math.min(top, innerHeight - offsetHeight - 2 * RIM_PX))}px`;
  }

  /** Asks until what was told is of the move that is wanted; narrow strips are looked for where it stays for a while. */
  async #ask() {
    this.asking = true;
    for (let move = this.wanted; move; move = this.wanted === move ? null : this.wanted) {
      const told = await this.#tell(move, false);
      if (!told?.lawful || this.wanted !== move) continue;
      await new Promise(done => setTimeout(done, LOOK_MS));
      if (this.wanted === move) await this.#tell(move, true);
    }
    this.asking = false;
  }

  /** @type {(move: Move, look: boolean) => Promise<any>} */
  async #tell(move, look) {
    const told = await askServer(`${this.work.path("move")}?${query(move, look)}`).catch(error => error);
    if (this.wanted !== move) return null;
    if (told instanceof Error) {
      this.place.textContent = told.message;
      this.place.className = "said bad";
      return null;
    }
    this.place.className = `said ${KINDS_OF_MOVES[told.how] ?? ""}`;
    this.place.replaceChildren(make("b", {}, headOf(told)), make("span", {}, bodyOf(told)),
      told.undone.length ? make("span", { class: "replaces" }, tr("takes the place of the lock: {locks}", { locks: told.undone.join("; ") })) : "");
    return told;
  }
}

/** What a drop would come to, in few words. */
/** @type {(told: any) => string} */
function headOf({ how, gives_way }) {
  if (how === "gives way") return trn("A rule gives way: {rules}", "Rules give way: {rules}", gives_way.length, { rules: gives_way.join(", ") });
  return how === "goes" ? tr("It goes there") : how === "others move" ? tr("Others will move: it is planned anew around this place") : tr("Will not go there");
}

/** What it costs, or what stands against it: of a move that is made all the same, not that it cannot be. */
/** @type {(told: any) => string} */
function bodyOf({ how, text, contours, place, breaks: [first, ...more] }) {
  if (!first || how === "no") return inWords(text);
  const [name, ...others] = contours, names = others.length ? `${name} ${tr("and {n} more", { n: others.length })}` : name;
  const said = { names, to: place, rule: first.rule, why: inWords(first.text) };
  const why = how === "gives way" ? tr("{names} as number {to}, against {rule}: {why}", said)
    : tr("{names} as number {to}; in the order as it is now {rule} forbids it: {why}", said);
  return more.length ? `${why} ${tr("and {n} more", { n: more.length })}` : why;
}

/** @type {(move: Move, look: boolean) => string} */
function query({ names, to, plan }, look) {
  return String(new URLSearchParams([...names.map(name => ["contours", name]), ["place", String(to)], ["plan", String(plan)], ["look", look ? "1" : "0"]]));
}

/**
 * Locks contours where they were dropped, and plans; nothing where another plan than theirs is shown meanwhile.
 *
 * @param {Work} work
 * @param {Move} move
 * @returns {Promise<void>}
 */
export async function dropThere(work, move) {
  const told = await askServer(`${work.path("move")}?${query(move, false)}`).catch(error => { work.say(error.message, "bad"); return null; });
  if (!told) return;
  work.say(bodyOf(told));
  await lockAndPlan(work, [...told.undone.map((/** @type {string} */ line) => ({ unlock: line })), ...told.locked.map((/** @type {string} */ line) => ({ lock: line }))], move.plan);
}
