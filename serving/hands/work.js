/** @import { Source } from "./types.js" */
import { askServer, sendServer } from "./asking.js";

/** The session as this tab knows it: what is asked of the server, and who hears what it says. */
export class Work {
  /** @param {string} id of the session */
  constructor(id) {
    this.id = id;
    /** @type {any} the state, as the server tells it */
    this.state = null;
    /** @type {((work: Work, what: string) => void)[]} */
    this.hearers = [];
    /** @type {(text: string) => void} */
    this.say = () => {};
    /** the contour that a tab is to be drawn on; "" for none */
    this.tabFor = "";
    this.heard = false;
    /** @type {Promise<any>} the change that was asked for last */
    this.turn = Promise.resolve();
  }

  /** The state of now, and then whatever changes. */
  async begin() {
    this.state = await askServer(this.path("state"));
    const news = new EventSource(this.path("events"));
    news.addEventListener("state", event => this.take(JSON.parse(event.data)));
    news.addEventListener("progress", event => {
      const { version, solving } = JSON.parse(event.data);
      if (version === this.state.version) this.state.solving = solving;
      this.hear("progress");
    });
    addEventListener("pagehide", () => news.close());
  }

  /** @param {string} what */
  path(what) { return `/api/${this.id}/${what}`; }

  /** @param {(work: Work, what: string) => void} fn called when anything has changed */
  on(fn) { this.hearers.push(fn); }

  /** @param {string} what "state" or "progress" */
  hear(what) { for (const fn of this.hearers) fn(this, what); }

  /** @param {any} state an older one, or one known already, changes nothing */
  take(state) {
    if (state.version < this.state.version || (state.version === this.state.version && this.heard)) return;
    this.heard = true;
    this.state = state;
    this.hear("state");
  }

  /**
   * Has the server change something; what it refuses is said. Each change waits for the answer to the one before, of
   * whose state it is; only what cancels does not.
   *
   * @param {string} what
   * @param {object} said
   * @returns {Promise<any>} what the server told; null where it refused
   */
  change(what, said) {
    if (what === "cancel") return this.asked(what, said);
    this.turn = this.turn.then(() => this.asked(what, said));
    return this.turn;
  }

  /**
   * @param {string} what
   * @param {object} said
   */
  async asked(what, said) {
    try {
      const told = await sendServer(this.path(what), { version: this.state.version, ...said });
      if (told.version) this.take(told);
      return told;
    } catch (error) {
      const { told, message } = /** @type {any} */ (error);
      if (told?.kind === "stale") {
        this.take(told);
        this.say("another tab was quicker: look at what is there now, and do it again");
      } else {
        this.say(message);
      }
      return null;
    }
  }

  /** @param {object[]} changes of the job file */
  edit(changes) { return this.change("edit", { changes }); }

  /** The plan that is looked at. */
  get plan() { return this.state.alternatives.find((/** @type {any} */ one) => one.number === this.state.shown) ?? null; }

  /** What the page shows, asked for when it is shown. */
  /** @type {() => Source} */
  source() {
    const nothing = (/** @type {any} */ error) => { this.say(error.message); return null; };
    return {
      page: () => askServer(this.path("page")),
      why: (_, contour) => askServer(`${this.path("why")}?${new URLSearchParams({ contour })}`).catch(nothing),
      heat: () => askServer(this.path("heat")).catch(nothing),
      nc: async () => this.shownData?.sides[0]?.nc ?? (await askServer(this.path("page"))).sides[0]?.nc ?? null,
    };
  }

  /** @type {import("./types.js").PageData | null} */
  shownData = null;
}
