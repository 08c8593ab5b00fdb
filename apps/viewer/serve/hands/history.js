/** @import { Work } from "./work.js" */
import { tr } from "./say.js";

/**
 * What was wanted of a nest and which plan was shown, so that it can be undone and done again.
 *
 * @typedef {object} Wanted
 * @property {number} shown
 * @property {string | null} job_text
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
function wantedIn({ shown, job_text, upto }) {
  return { shown, job_text, upto };
}

/** @type {(a: Wanted, b: Wanted) => boolean} */
function sameWanted(a, b) {
  return a.shown === b.shown && a.upto === b.upto && (a.job_text ?? "") === (b.job_text ?? "");
}

/** In one request: nothing is seen of a plan with the locks of another. */
/** @type {(work: Work, wanted: Wanted) => Promise<boolean>} whether the server did it */
async function restore(work, { shown, job_text, upto }) {
  if (work.state.solving) await work.cancel(false); // what it has shown stays in the list
  return Boolean(await work.change("back", { to: shown, job_text, upto }));
}
