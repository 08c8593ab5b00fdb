/** @import { PageData, Source } from "./types.js" */
import { askServer, sendServer } from "./asking.js";
import { listenToNews } from "./news.js";
import { tr } from "./say.js";
import { withFirst } from "./timeline.js";

/** The session as this tab knows it: what is asked of the server, and who hears what it says. */
export class Work {
  /** @param {string} id of the session */
  constructor(id) {
    this.id = id;
    /** @type {any} the state, as the server tells it */
    this.state = null;
    /** the nest that the planner works for, "" for none */
    this.planner = "";
    /** @type {[number, number] | null} the plans that are compared */
    this.compared = null;
    /** @type {PageData | null} what the page shows */
    this.data = null;
    /** what the data are of */
    this.drawn = "";
    /** @type {((work: Work, what: string) => void)[]} */
    this.hearers = [];
    /** @type {(text: string, kind?: string) => void} */
    this.say = () => {};
    /** @type {Promise<any>} the change that was asked for last */
    this.turn = Promise.resolve();
    /** how often somebody has cancelled here */
    this.cancels = 0;
    /** whether the server does not answer */
    this.lost = false;
    /** how often the connection came or went */
    this.links = 0;
  }

  /** The state of now, and then whatever changes. */
  async begin() {
    listenToNews((what, told) => this.news(what, told));
    await this.catchUp();
  }

  /** Takes what is so now. */
  async catchUp() {
    const state = await askServer(this.path("state"));
    this.planner = state.planner;
    this.take(state);
  }

  /** The server is there, or is not: it is asked what is so now once it is there again. */
  /** @param {boolean} lost */
  connected(lost) {
    if (lost && this.lost) this.links += 1;
    if (lost === this.lost) return;
    const mine = ++this.links;
    if (!lost) { // not before it is known what is so now, nor where it was lost once more meanwhile
      this.catchUp().then(() => { if (mine === this.links) { this.lost = false; this.hear("connection"); } }, () => {});
      return;
    }
    this.lost = true;
    if (this.state) this.state.solving = null; // whatever was planned, nobody knows how it goes
    this.hear("connection");
  }

  /** @param {string} what */
  path(what) { return `/api/${this.id}/${what}`; }

  /** @param {(work: Work, what: string) => void} fn called when anything has changed */
  on(fn) { this.hearers.push(fn); }

  /** @param {string} what "state", "progress", "planner" or "connection" */
  hear(what) { for (const fn of this.hearers) fn(this, what); }

  /** @type {(what: string, told: any) => void} */
  news(what, told) {
    if (what === "connection") {
      this.connected(told.lost);
    } else if (what === "planner") {
      this.planner = told.nest;
      this.hear("planner");
    } else if (told.id !== this.id) {
      return;
    } else if (what === "state") {
      this.take(told);
    } else if (this.state?.version === told.version) {
      this.state.solving = told.solving;
      this.hear("progress");
    }
  }

  /** @param {any} state an older one, or one that is known already, changes nothing; a new server counts anew */
  take(state) {
    if (this.state?.server === state.server && state.version <= this.state.version) return;
    this.state = state;
    this.hear("state");
  }

  /**
   * Has the server change something; what it refuses is said. Each change waits for the answer to the one before, of
   * whose state it is.
   *
   * @param {string} what
   * @param {object | (() => object)} said what is told to the server, asked for when it is sent
   * @param {number} [plan] the plan that it is about: nothing is changed where another one is shown by then
   * @returns {Promise<any>} what the server told; null where it refused
   */
  change(what, said, plan) {
    this.turn = this.turn.then(() => {
      if (plan === undefined || plan === this.state.shown) return this.asked(what, typeof said === "function" ? said() : said);
      this.say(tr("another plan is shown by now: look at it, and do it again"), "warn");
      return null;
    });
    return this.turn;
  }

  /**
   * Has the nest planned once the changes before are made: not where it is being planned by then, nor where somebody
   * has cancelled since it was wanted.
   *
   * @param {object} said
   * @param {number} cancels how often somebody had cancelled when it was wanted
   * @returns {Promise<any>} what the server told; null where it was not asked, or refused
   */
  solve(said = {}, cancels = this.cancels) {
    this.turn = this.turn.then(() => this.state.solving || cancels !== this.cancels ? null : this.asked("solve", said));
    return this.turn;
  }

  /** Ends the planning, with the best plan so far or at once with none: it waits for no change before. */
  /** @type {(atOnce: boolean) => Promise<any>} */
  cancel(atOnce) {
    this.cancels += 1;
    return this.asked("cancel", { at_once: atOnce });
  }

  /**
   * @param {string} what
   * @param {object} said
   */
  async asked(what, said) {
    try {
      const told = await sendServer(this.path(what), { version: this.state.version, ...said });
      if (told.version) this.take(told);
      if (told.undone?.length) this.say(tr("takes the place of the lock: {locks}", { locks: told.undone.join("; ") }), "warn");
      return told;
    } catch (error) {
      const { told, message } = /** @type {any} */ (error);
      if (told?.kind === "stale") {
        this.take(told);
        this.say(tr("another tab was quicker: look at what is there now, and do it again"), "warn");
      } else {
        this.say(message, "bad");
      }
      return null;
    }
  }

  /**
   * @param {object[]} changes of the job file
   * @param {number} [plan] the plan that they are about
   * @param {boolean} [planned] whether the nest is planned at once, unless somebody cancels before it is asked for
   */
  edit(changes, plan, planned = false) {
    const { cancels } = this;
    return this.change("edit", () => ({ changes, plan: planned && cancels === this.cancels }), plan);
  }

  /** What something that is said now is about: a plan, and whether it is what is wanted. */
  get saidOf() { return this.state ? `${this.view}, ${this.state.fits}` : ""; }

  /** The plan that is looked at. */
  get plan() { return this.state.alternatives.find((/** @type {any} */ one) => one.number === this.state.shown) ?? null; }

  /** Whether what is drawn is the plan that moves are judged in. */
  get free() { return !this.whyNot; }

  /** Whether the plan that is drawn has cuts of further torches. */
  get severalTorches() { return this.data?.sides.some(side => side.cuts.some(withFirst)) ?? false; }

  /** Why nothing can be moved in the order now; "" where it can. */
  get whyNot() {
    if (this.lost) return tr("the connection is lost");
    if (this.compared) return tr("two plans stand side by side: go back to one, then move cuts");
    if (!this.plan) return tr("there is no plan yet: press Plan first");
    if (this.severalTorches) return tr("several torches cut at a time, so cuts are not moved one by one: say a lock in words, or plan with one torch");
    if (!this.state.fits) return this.state.solving ? tr("it is being planned: wait for the first plan, then move cuts") : tr("what is wanted is not planned yet: press Plan, then move cuts");
    return this.isDrawn ? "" : tr("the plan is being drawn: a moment");
  }

  /** Whether what is drawn is what is shown: numbers on the page are of that plan then. */
  get isDrawn() { return this.drawn === this.view; }

  /** What is to be drawn: of the nest as it is on disk, one plan or two, by the numbers of that server. */
  get view() { return `${this.compared?.join(" and ") ?? this.state.shown} of ${this.state.sha256} by ${this.state.server}`; }

  /** What the page shows, asked for when it is shown. */
  /** @type {() => Source} */
  source() {
    const nothing = (/** @type {any} */ error) => { this.say(error.message, "bad"); return null; };
    const plan = (/** @type {number} */ side) => String(this.compared?.[side] ?? this.state.shown);
    /** @type {Map<string, Promise<any>>} by server and plan */
    const heats = new Map();
    const heat = (/** @type {string} */ of) => {
      const name = `${this.state.server} ${of}`;
      if (!heats.has(name)) {
        const asked = askServer(`${this.path("heat")}?${new URLSearchParams({ plan: of })}`).catch(nothing);
        heats.set(name, asked.then(data => { if (!data) heats.delete(name); return data; }));
      }
      return heats.get(name);
    };
    return {
      page: () => this.page(),
      why: (side, contour) => askServer(`${this.path("why")}?${new URLSearchParams({ contour, plan: plan(side) })}`).catch(nothing),
      heat: async side => await heat(plan(side)) ?? null,
      heatIsMade: true,
      bent: async side => {
        this.say(tr("simulating how the sheet moves: this takes seconds to minutes …"));
        const data = await askServer(`${this.path("bent")}?${new URLSearchParams({ plan: plan(side) })}`).catch(nothing);
        if (data) this.say("");
        return data;
      },
      nc: async side => this.data?.sides[side]?.nc ?? null,
    };
  }

  /** @returns {Promise<PageData>} */
  async page() {
    const view = this.view, [plan, other] = this.compared ?? [this.state.shown];
    const query = other ? `?${new URLSearchParams({ plan: String(plan), with: String(other) })}` : plan ? `?plan=${plan}` : "";
    const data = await askServer(this.path("page") + query);
    if (view === this.view) { // else something else is shown meanwhile, and perhaps drawn
      this.data = data;
      this.drawn = view;
    }
    return data;
  }
}
