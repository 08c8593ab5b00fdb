/** @import { CutData, PageData, SideData, Source } from "./types.js" */
/** @import { State } from "./store.js" */
import { byId } from "./elements.js";
import { BentFrames } from "./bent.js";
import { HeatFrames } from "./heat.js";
import { Outlines } from "./outlines.js";
import { doingText } from "./player.js";
import { tr } from "./say.js";
import { Stage } from "./stage.js";
import { Store } from "./store.js";
import { momentAt } from "./timeline.js";

/** The page: what is shown, who shows it, and all that can be done to it. */
export class App {
  /**
   * @param {Source} source
   * @param {PageData} data
   */
  constructor(source, data) {
    this.source = source;
    this.data = data;
    this.store = new Store();
    /** @type {Stage[]} */
    this.stages = [];
    /** @type {(() => void)[]} */
    this.renewers = [];
    /** @type {(() => void)[]} */
    this.rejudgers = [];
    /** @type {(() => void)[]} */
    this.recolourers = [];
    /** @type {((row: HTMLElement, cut: CutData) => void)[]} */
    this.rowMakers = [];
    /** Draws the seen rows of the order again. */
    this.rowsAnew = () => {};
    /** @type {((event: PointerEvent, stage: Stage) => boolean)[]} */
    this.gestures = [];
    /** @type {{name: string, fn: () => void, text: string}[]} */
    this.keys = [];
    this.slots = { tools: byId("slot-tools"), why: byId("slot-why"), rules: byId("slot-rules"), side: byId("slot-side"), sheet: byId("slot-sheet") };
    /** @type {Map<string, number>} */
    this.numbers = new Map();
    this.#stand();
  }

  #stand() {
    const outlines = new Outlines(this.data.nest), old = this.stages[0]?.camera;
    this.numbers = new Map(this.data.nest.contours.map((contour, k) => [contour.id, k]));
    const layers = this.stages.map(stage => stage.layers);
    const sides = Math.max(1, this.data.sides.length);
    this.stages = Array.from({ length: sides }, (_, side) => new Stage(this.data, side, this.store, outlines));
    this.stages.forEach((stage, k) => {
      stage.layers = layers[k] ?? layers[0] ?? [];
      if (old) stage.camera.like(old);
    });
  }

  /** @returns {State} */
  get state() { return this.store.state; }

  /** The side whose order and reasons are shown; null where there is no plan. */
  /** @type {SideData} */
  get side() { return /** @type {SideData} */ (this.data.sides[this.state.side] ?? null); }

  /** @param {Partial<State>} changes */
  set(changes) { this.store.set(changes); }

  /** @param {(state: State, changes: Partial<State>) => void} fn */
  on(fn) { this.store.on(fn); }

  /**
   * @param {() => void} fn called when there are other data
   * @param {boolean} [judged] also where the same plan was judged once more
   */
  renewed(fn, judged = false) {
    this.renewers.push(fn);
    if (judged) this.rejudgers.push(fn);
  }

  /** @param {SideData} side of the plan that is shown, judged once more, with its program: nothing of the drawing changes */
  judged(side) {
    Object.assign(this.data.sides[0], side);
    this.rejudgers.forEach(fn => fn());
  }

  /** @param {() => void} fn called when the colours are others */
  recoloured(fn) { this.recolourers.push(fn); }

  /** Another plan, or another nest; the view and the choice stay where they can. */
  /** @param {PageData} data */
  replace(data) {
    const chosen = this.data.nest.contours[this.state.selected]?.id, same = data.nest.sha256 === this.data.nest.sha256;
    const { fits, fitted } = this.stages[0];
    this.data = data;
    this.#stand();
    this.set({ side: Math.min(this.state.side, this.stages.length - 1), bent: false });
    this.renewers.forEach(fn => fn());
    if (fits || !same) this.stages.forEach(stage => stage.fit(same ? fitted.parts : undefined));
    if (this.state.heat) void this.showHeat(true);
    this.set({ selected: this.numberOf(chosen ?? ""), marked: [], time_s: Math.min(this.state.time_s, this.end()) });
    this.draw();
  }

  /** @type {() => void} */
  draw() { this.stages.forEach(stage => stage.draw()); }

  /** When the longer side ends, s. */
  /** @type {() => number} */
  end() { return Math.max(1e-3, ...this.stages.map(stage => stage.timeline.end_s)); }

  /** @param {number} time_s */
  seek(time_s) { this.set({ time_s: Math.max(0, Math.min(this.end(), time_s)) }); }

  /** The number of the cut that is being made, or that the torch is on its way to; -1 at the end. */
  /** @type {() => number} */
  cutNow() {
    const { moment } = momentAt(this.stages[this.state.side].timeline, this.state.time_s);
    return moment && moment.does !== "home" ? moment.cut : -1;
  }

  /** @type {() => string} */
  doing() {
    const { moment, done } = momentAt(this.stages[this.state.side].timeline, this.state.time_s);
    return doingText(this, moment, done);
  }

  /** @type {() => void} */
  toggle() {
    if (!this.side) return;
    const again = !this.state.playing && this.state.time_s >= this.end();
    this.set({ playing: !this.state.playing, ...(again ? { time_s: 0 } : {}) });
    this.tell(this.state.playing ? tr("playing, {speed} times as fast as the machine", { speed: this.state.speed }) : tr("paused: {doing}", { doing: this.doing() }));
  }

  /** The end of the cut before, or of the next. */
  /** @param {number} by */
  step(by) {
    const { ends_s } = this.stages[this.state.side].timeline, now = this.state.time_s;
    const after = ends_s.find(end => end > now + 1e-6), before = ends_s.findLast(end => end < now - 1e-6);
    this.set({ playing: false });
    this.seek(by > 0 ? after ?? this.end() : before ?? 0);
    this.tell(this.doing());
  }

  /** @type {(contour: number) => number | undefined} */
  cutOf(contour) { return this.stages[this.state.side].scenery.cutOf.get(contour); }

  /** @type {(id: string) => number} */
  numberOf(id) { return this.numbers.get(id) ?? -1; }

  /** @type {(contour: number, bring?: boolean) => void} */
  choose(contour, bring = true) {
    if (contour >= 0 && bring) this.stages[0].show(contour);
    this.set({ selected: contour });
    this.moved();
    const cut = this.cutOf(contour), { contours } = this.data.nest;
    if (contour >= 0) this.tell(`${contours[contour].id}${cut === undefined ? "" : `, ${tr("cut {number}", { number: this.side.made + cut + 1 })}`}`);
  }

  /** @param {string} id */
  chooseId(id) { this.choose(this.numberOf(id)); }

  /** @param {string[]} ids contours to draw in red */
  mark(ids) { this.set({ marked: ids.map(id => this.numberOf(id)).filter(k => k >= 0) }); }

  /** The view of one drawing has moved: the others go with it. */
  /** @param {Stage} [by] */
  moved(by = this.stages[0]) {
    for (const stage of this.stages) if (stage !== by) stage.camera.like(by.camera);
    this.draw();
  }

  /** Says something on the page, and to a screen reader. */
  /** @param {string} text */
  tell(text) { byId("live").textContent = text; }

  /** The sheet as it moves while it is cut: simulated when it is asked for first. */
  /** @param {boolean} bent */
  async showBent(bent) {
    const { stages, source } = this;
    for (const stage of bent ? stages : []) {
      const data = stage.bent ? null : await source.bent?.(stage.side);
      if (data) stage.bent = new BentFrames(data, this.numbers);
    }
    if (stages === this.stages) this.set({ bent: bent && stages.some(stage => stage.bent) });
  }

  /** @param {boolean} heat */
  async showHeat(heat) {
    const { stages, source } = this;
    for (const stage of heat ? stages : []) {
      const data = stage.heat ? null : await source.heat(stage.side);
      if (data) stage.heat = await HeatFrames.of(data);
    }
    if (stages !== this.stages) return; // another plan has come meanwhile, and its heat is asked for
    const known = stages.some(stage => stage.heat);
    if (heat && !known) this.tell(tr("the heat of this plan is not known, or takes long: kerfwise heat simulates it"));
    this.set({ heat: heat && known });
    this.draw();
  }
}
