import { make } from "./elements.js";

const BEYOND = 6;

/**
 * A list of which only the rows that are seen are made: ten thousand rows scroll as well as ten.
 */
export class VirtualList {
  /**
   * @param {HTMLElement} holder it scrolls
   * @param {number} rowHeight pixels
   * @param {(row: HTMLElement, k: number) => void} fill
   */
  constructor(holder, rowHeight, fill) {
    this.holder = holder;
    this.rowHeight = rowHeight;
    this.fill = fill;
    this.count = 0;
    this.space = make("div", { class: "rows", role: "presentation" });
    /** @type {Map<number, HTMLElement>} */
    this.rows = new Map();
    holder.replaceChildren(this.space);
    holder.addEventListener("scroll", () => this.draw(), { passive: true });
    new ResizeObserver(() => this.draw()).observe(holder);
  }

  /** @param {number} count */
  reset(count) {
    this.count = count;
    this.space.style.height = `${count * this.rowHeight}px`;
    this.rows.forEach(row => row.remove());
    this.rows.clear();
    this.draw();
  }

  /** Makes the rows that have come into sight, and lets the others go. */
  draw() {
    const top = this.holder.scrollTop, high = this.holder.clientHeight;
    const first = Math.max(0, Math.floor(top / this.rowHeight) - BEYOND);
    const last = Math.min(this.count, Math.ceil((top + high) / this.rowHeight) + BEYOND);
    for (const [k, row] of this.rows) {
      if (k >= first && k < last) continue;
      row.remove();
      this.rows.delete(k);
    }
    for (let k = first; k < last; k++) {
      if (this.rows.has(k)) continue;
      const row = make("div", { class: "row" });
      row.style.transform = `translateY(${k * this.rowHeight}px)`;
      this.rows.set(k, row);
      this.fill(row, k);
      this.space.append(row);
    }
  }

  /** Fills the rows that are there once more. */
  refresh() {
    for (const [k, row] of this.rows) {
      row.replaceChildren();
      this.fill(row, k);
    }
  }

  /** @param {number} k */
  reveal(k) {
    const top = k * this.rowHeight, { scrollTop, clientHeight } = this.holder;
    if (top < scrollTop) this.holder.scrollTop = top;
    else if (top + this.rowHeight > scrollTop + clientHeight) this.holder.scrollTop = top + this.rowHeight - clientHeight;
    this.draw();
  }
}
