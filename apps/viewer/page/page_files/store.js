/**
 * What is shown.
 *
 * @typedef {object} State
 * @property {number} side whose order and reasons are shown
 * @property {number} time_s
 * @property {number} selected number of a contour, -1 for none
 * @property {number} hovered
 * @property {boolean} playing
 * @property {number} speed
 * @property {string} tab
 * @property {boolean} heat
 * @property {boolean} bent whether the sheet is drawn as it moves while it is cut
 * @property {boolean} travel
 * @property {boolean} numbers
 * @property {boolean} drawn whether lines have the colours of the drawing
 * @property {boolean} stale whether something else is wanted than the plan that is shown
 * @property {readonly number[]} marked contours of the places of a rule
 */

/** The state, and those who want to know of changes. */
export class Store {
  constructor() {
    /** @type {State} */
    this.state = {
      side: 0, time_s: 0, selected: -1, hovered: -1, playing: false, speed: 8, tab: "why",
      heat: false, bent: false, travel: true, numbers: true, drawn: false, stale: false, marked: [],
    };
    /** @type {((state: State, changes: Partial<State>) => void)[]} */
    this.listeners = [];
  }

  /** @param {(state: State, changes: Partial<State>) => void} fn */
  on(fn) {
    this.listeners.push(fn);
  }

  /** @param {Partial<State>} changes */
  set(changes) {
    /** @type {Partial<State>} */
    const real = {};
    for (const [name, value] of Object.entries(changes)) {
      // @ts-ignore names of a Partial<State> are those of a State
      if (this.state[name] !== value) real[name] = value;
    }
    if (Object.keys(real).length === 0) return;
    Object.assign(this.state, real);
    for (const fn of this.listeners) fn(this.state, real);
  }
}
