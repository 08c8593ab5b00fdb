/** @import { Work } from "./work.js" */
import { askServer, sendServer } from "./asking.js";
import { effectTable } from "./effect.js";
import { make } from "./elements.js";
import { ruleForm } from "./ruleform.js";
import { tr } from "./say.js";

/**
 * What is to be changed in a profile: by rule and key.
 *
 * @typedef {{rule: string, key: string, to: string}} RuleChange
 */

/**
 * A panel of the rules of the nest's profile: what they say, what another value would bring, and writing it down.
 *
 * @param {any} app
 * @param {Work} work
 */
export function profilePanel(app, work) {
  const panel = app.panel("profile", tr("Profile"));
  const editor = new ProfileEditor(panel, work);
  app.on((/** @type {any} */ _, /** @type {any} */ changes) => { if (changes.tab === "profile") editor.look(); });
  work.on((_, what) => {
    if (what === "state") editor.stale = true;
    else if (what === "planner") editor.waits();
  });
}

class ProfileEditor {
  /**
   * @param {HTMLElement} panel
   * @param {Work} work
   */
  constructor(panel, work) {
    this.work = work;
    /** @type {any} the profile, as the server tells it */
    this.profile = null;
    /** @type {Map<string, RuleChange>} */
    this.changes = new Map();
    this.stale = true;
    /** how often the profile was asked for */
    this.looks = 0;
    /** whether it is being written */
    this.writing = false;
    /** @type {AbortController | null} hangs up on what is being asked of the planner */
    this.asking = null;
    this.head = make("p", { class: "hint", id: "profile-head" });
    this.said = make("p", { id: "profile-said", class: "said bad", role: "alert", hidden: true });
    this.effect = make("div", { id: "profile-effect", role: "status" });
    this.write = make("button", { type: "button", id: "profile-write", onclick: () => this.save() }, tr("Write"));
    this.name = /** @type {HTMLInputElement} */ (make("input", { id: "profile-name", placeholder: "our-profile.yaml", "aria-label": tr("name of a new profile") }));
    const as = make("button", { type: "button", id: "profile-as", onclick: () => this.save(this.name.value.trim() || " ") }, tr("Save as"));
    const drop = make("button", { type: "button", id: "profile-drop", onclick: () => this.forget() }, tr("Take back"));
    this.bar = make("div", { id: "profile-bar", hidden: true }, this.effect, this.said, make("p", {}, this.write, " ", this.name, " ", as, " ", drop));
    this.rules = make("div", { id: "profile-rules" });
    panel.append(this.head, this.bar, this.rules);
  }

  /** Shows the profile as it is now; what is changed and not written stays. */
  async look() {
    if (!this.stale) return;
    this.stale = false;
    const mine = ++this.looks;
    try {
      const profile = await askServer(this.work.path("profile"));
      if (mine !== this.looks) return; // it was asked for again meanwhile
      this.profile = profile;
    } catch (error) {
      if (mine === this.looks) this.head.textContent = /** @type {Error} */ (error).message;
      return;
    }
    const { name, file, why_not, shipped, for_this_nest } = this.profile;
    const set = Object.keys(for_this_nest).filter(key => key.startsWith("rules."));
    const beside = set.length ? ` ${tr("The job file has other values for this nest: {keys}.", { keys: set.join(", ") })}` : "";
    this.head.textContent = (shipped ? tr("{name} comes with kerfwise and is not changed: save it as a profile of your own", { name }) : why_not || tr("{name}, in {file}. What you change is written there.", { name, file })) + beside;
    this.write.toggleAttribute("disabled", !this.profile.writable);
    this.draw();
  }

  draw() {
    const open = new Set([...this.rules.querySelectorAll("details[open]")].map(one => /** @type {HTMLElement} */ (one).dataset.rule));
    const { activeElement: focus } = document, label = this.rules.contains(focus) ? focus?.getAttribute("aria-label") : null;
    this.rules.replaceChildren(...this.profile.rules.map((/** @type {any} */ rule) =>
      ruleForm(this.work, rule, this.changes, open.has(rule.id), change => this.put(change))));
    this.bar.hidden = !this.changes.size;
    if (label) /** @type {HTMLElement | null} */ (this.rules.querySelector(`[aria-label="${CSS.escape(label)}"]`))?.focus();
  }

  /** @param {RuleChange} change */
  put(change) {
    const rule = this.profile.rules.find((/** @type {any} */ one) => one.id === change.rule);
    const now = change.key === "strength" || change.key === "weight" ? rule[change.key] : rule.options.find((/** @type {any} */ one) => one.key === change.key).value;
    const name = `${change.rule}.${change.key}`;
    if (change.to === now) this.changes.delete(name);
    else this.changes.set(name, change);
    if (change.key === "strength" && change.to !== "soft") this.changes.delete(`${change.rule}.weight`);
    setTimeout(() => this.draw()); // once the focus has gone on: what has it then keeps it
    this.see();
  }

  /** Asks what the changes would bring on the nest; what was asked before is cancelled. */
  async see() {
    this.hangUp();
    this.refused(null);
    if (!this.changes.size) return;
    const mine = this.asking = new AbortController(), changes = [...this.changes.values()];
    this.waits();
    try {
      const told = await sendServer(this.work.path("effect"), { changes }, mine.signal);
      if (mine !== this.asking) return;
      this.asking = null;
      this.effect.replaceChildren(effectTable(told, changes));
    } catch (error) {
      if (mine !== this.asking) return;
      this.hangUp();
      this.refused(error);
    }
  }

  /** Says what is waited for, with a button that cancels it. */
  waits() {
    if (!this.asking) return;
    const { planner, state } = this.work, other = planner && planner !== state.nest;
    this.effect.replaceChildren(other ? `${tr("waits: {planner} is being planned", { planner })} ` : `${tr("planning with it and without …")} `,
      make("button", { type: "button", id: "profile-cancel", onclick: () => { this.hangUp(); this.effect.textContent = tr("cancelled: not known what it would bring"); } }, tr("Cancel")));
  }

  /** Nothing is asked any more. */
  hangUp() {
    this.asking?.abort();
    this.asking = null;
    this.effect.replaceChildren();
  }

  /** @param {string} [as] the name of a new profile */
  async save(as) {
    if (this.writing) return; // a double click
    this.writing = true;
    const sent = new Map(this.changes);
    const said = { version: this.work.state.version, sha256: this.profile.sha256, changes: [...this.changes.values()], ...(as === undefined ? {} : { as }) };
    try {
      const told = await sendServer(this.work.path("profile"), said);
      for (const [name, change] of sent) if (this.changes.get(name) === change) this.changes.delete(name); // not what was typed since
      this.hangUp();
      this.work.take(told);
      this.stale = true;
      await this.look();
      this.work.say(tr("written: {file}", { file: told.written.file }), "good");
    } catch (error) {
      const { told } = /** @type {any} */ (error);
      if (told?.kind === "stale") this.work.take(told);
      this.refused(told?.kind === "stale" ? new Error(tr("another tab was quicker: look at what is there now, and do it again")) : error);
      this.stale = true;
    } finally {
      this.writing = false;
    }
  }

  forget() {
    this.changes.clear();
    this.hangUp();
    this.refused(null);
    this.stale = true;
    this.look();
  }

  /** @param {any} error */
  refused(error) {
    const told = error?.told ?? {};
    const place = [told.file, told.line, told.column].filter(Boolean).join(":");
    this.said.hidden = !error;
    this.said.textContent = error ? [`${place ? `${place}: ` : ""}${error.message}`, ...(told.details ?? [])].join("\n") : "";
  }
}
