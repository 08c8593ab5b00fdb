/** @import { Work } from "./work.js" */
import { tr } from "./say.js";

/**
 * What was wanted of a nest and which plan was shown, so that it can be undone and done again.
 *
 * @typedef {object} Wanted
 * @property {number} shown
 * @property {string[]} locked
 * @property {Record<string, string>} settings
 * @property {number} upto
 */

/** Undo and redo of locks, values and plans, for as long as this tab is open. */
export class History {
  /** @param {Work} work */
  constructor(work) {
    this.work = work;
    /** @type {Wanted[]} */
    this.past = [];
    /** @type {Wanted[]} */
    this.future = [];
    /** @type {Wanted | null} */
    this.now = null;
    this.busy = false;
    /** the step that was asked for last */
    this.turn = Promise.resolve();
    /** the highest number of a plan so far */
    this.newest = 0;
    work.on((_, what) => { if (what === "state") this.note(); });
  }

  /** Notes what is wanted now; plans that are made of it are of one step with it. */
  note() {
    if (this.busy) return;
    const seen = wantedIn(this.work.state), isNew = seen.shown > this.newest;
    this.newest = Math.max(this.newest, ...this.work.state.alternatives.map((/** @type {any} */ one) => one.number));
    if (this.now && sameWanted(this.now, seen)) return;
    if (this.now && !(isNew && sameWanted({ ...this.now, shown: seen.shown }, seen))) {
      this.past.push(this.now);
      this.future = [];
    }
    this.now = seen;
  }

  /** Whether there is something to undo, or with 1 to do again. */
  /** @type {(by: -1 | 1) => boolean} */
  can(by) { return (by < 0 ? this.past : this.future).length > 0; }

  /** One step back, or on, once the step before is made. */
  /** @type {(by: -1 | 1) => Promise<void>} */
  step(by) {
    this.turn = this.turn.then(() => this.#step(by));
    return this.turn;
  }

  /** @type {(by: -1 | 1) => Promise<void>} */
  async #step(by) {
    const { work } = this, [from, to] = by < 0 ? [this.past, this.future] : [this.future, this.past];
    if (!this.now || !this.can(by)) {
      work.say(by < 0 ? tr("nothing to undo") : tr("nothing to do again"));
      return;
    }
    const wanted = /** @type {Wanted} */ (from.pop()), before = this.now;
    this.busy = true;
    const done = await restore(work, wanted);
    this.busy = false;
    if (!done) {
      from.push(wanted);
      return;
    }
    to.push(before);
    this.now = wantedIn(work.state);
    work.say(by < 0 ? tr("undone") : tr("done again"), "good");
    work.hear("state");
  }
}

/** @type {(state: any) => Wanted} */
export function wantedIn({ shown, locked, settings, upto }) {
  return { shown, locked: [...locked], settings: { ...settings }, upto };
}

/** @type {(a: Wanted, b: Wanted) => boolean} */
function sameWanted(a, b) {
  return JSON.stringify([a.shown, a.upto, a.locked, Object.entries(a.settings).sort()]) === JSON.stringify([b.shown, b.upto, b.locked, Object.entries(b.settings).sort()]);
}

/**
 * What has to be changed in a job file so that it says what is wanted.
 *
 * @type {(now: Wanted, wanted: Wanted) => object[]}
 */
export function changesTo(now, wanted) {
  return [
    ...now.locked.filter(line => !wanted.locked.includes(line)).map(line => ({ unlock: line })),
    ...wanted.locked.filter(line => !now.locked.includes(line)).map(line => ({ lock: line })),
    ...Object.keys(now.settings).filter(key => !(key in wanted.settings)).map(key => ({ unset: key })),
    ...Object.entries(wanted.settings).filter(([key, value]) => now.settings[key] !== value).map(([key, value]) => ({ set: key, to: String(value) })),
  ];
}

/** @type {(work: Work, wanted: Wanted) => Promise<boolean>} whether the server did it */
async function restore(work, wanted) {
  if (work.state.solving) await work.cancel(false); // what it has shown stays in the list
  if (wanted.shown && wanted.shown !== work.state.shown && !await work.change("back", { to: wanted.shown })) return false;
  const changes = changesTo(wantedIn(work.state), wanted);
  if (changes.length && !await work.edit(changes)) return false;
  if (wanted.upto !== work.state.upto && !wanted.upto) return Boolean(await work.change("cut", { upto: 0 }));
  return true;
}
