/** @import { Work } from "./work.js" */
/** @import { Gap, Lying, Outline } from "./poses.js" */
/** @typedef {{gap: Gap, least: number, other: string, over: string}} Near */
import { askServer, sendServer } from "./asking.js";
import { pen, trace, write } from "./brush.js";
import { make } from "./elements.js";
import { boundsOf, flattened } from "./geometry.js";
import { onCanvas } from "./gestures.js";
import { boxesNear, fromOutline, gapBetween, gapToEdge, inLine, inMetal, PartChanges, placed } from "./poses.js";
import { figure, tr, trn } from "./say.js";

const CHORD_MM = 0.1, GRIP_PX = 6, STEP_MM = 1, FAR_STEP_MM = 10, ROUND_MM = 100, LOOKED_MM = 60, LABEL_RIM_PX = 4;

/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/**
 * A panel in which the parts of the nest are moved, turned, turned over, left out and laid anew, and a new nest is made
 * of it. While a part is dragged the gap to its neighbours is shown; what the server says of all changes counts.
 *
 * @param {any} app
 * @param {Work} work
 */
export function partEditing(app, work) {
  new PartEditor(app, work);
}

class PartEditor {
  /**
   * @param {any} app
   * @param {Work} work
   */
  constructor(app, work) {
    this.app = app;
    this.work = work;
    this.changes = new PartChanges();
    /** @type {Set<string>} */
    this.fixed = new Set();
    /** @type {{gap_mm: number, edge_mm: number, cut: string[]} | null} */
    this.room = null;
    /** @type {any} the nest as the server makes it of the changes, as page data */
    this.made = null;
    /** @type {{pointer: number, part: number, from: [number, number], by: [number, number]} | null} */
    this.drag = null;
    this.on = false;
    this.sound = false;
    this.asked = 0;
    /** @type {{key: string, of: Map<number, Outline>}} */
    this.kept = { key: "", of: new Map() };
    this.part = -1;
    this.panel = app.panel("parts", tr("Parts"));
    this.#build();
    app.gesture((/** @type {PointerEvent} */ event, /** @type {any} */ stage) => this.#gesture(event, stage));
    app.layer((/** @type {CanvasRenderingContext2D} */ context, /** @type {any} */ stage) => this.#paint(context, stage));
    app.on((/** @type {any} */ _, /** @type {any} */ changed) => {
      if (changed.selected !== undefined) this.#choose();
      if (changed.tab !== undefined) this.#switch(changed.tab === "parts");
    });
    app.app.renewed(() => this.#anew());
    addEventListener("keydown", event => this.#key(event), { capture: true });
  }

  #build() {
    const button = (/** @type {string} */ id, /** @type {string} */ text, /** @type {() => void} */ onclick, title = "") => make("button", { type: "button", id, onclick, title }, text);
    this.said = make("p", { id: "parts-said", class: "said", role: "status" });
    this.head = make("h2", { class: "small" }, "");
    this.turns = /** @type {HTMLInputElement} */ (make("input", { type: "number", id: "parts-deg", value: "90", step: "any", "aria-label": tr("degrees, counter-clockwise") }));
    this.fix = /** @type {HTMLInputElement} */ (make("input", { type: "checkbox", id: "parts-fix", onchange: () => this.#setFixed() }));
    this.tools = make("div", { class: "part-tools" },
      button("parts-left", tr("turn left"), () => this.#do(name => `turn ${name} 90`), "r"),
      button("parts-right", tr("turn right"), () => this.#do(name => `turn ${name} -90`), "R"),
      make("span", {}, this.turns, " ", button("parts-turn", tr("turn by °"), () => this.#do(name => `turn ${name} ${this.turns?.value || 0}`))),
      button("parts-mirror", tr("turn over"), () => this.#do(name => `mirror ${name}`), "m"),
      button("parts-drop", tr("leave out"), () => this.#do(name => `drop ${name}`), "Delete"),
      make("label", {}, this.fix, " ", tr("fixed: it stays where it is")));
    this.list = make("ol", { id: "parts-changes" });
    this.file = /** @type {HTMLInputElement} */ (make("input", { id: "parts-file", placeholder: "bracket.dxf=2", "aria-label": tr("file of a part in this folder, and how many") }));
    this.name = /** @type {HTMLInputElement} */ (make("input", { id: "parts-name", "aria-label": tr("name of the new nest") }));
    this.undo = button("parts-undo", tr("Undo"), () => this.#step(-1), "Ctrl+Z");
    this.redo = button("parts-redo", tr("Redo"), () => this.#step(1), "Ctrl+Y");
    this.write = button("parts-write", tr("Write and open the new nest"), () => void this.#save());
    this.panel.append(
      make("p", { class: "hint" }, tr("Drag a part on the drawing. Arrow keys move the chosen one by 1 mm, with Shift by 10. The old nest stays as it is.")),
      this.head, this.tools, this.said,
      make("p", {}, this.undo, " ", this.redo, " ", button("parts-anew", tr("Lay the others anew"), () => this.#layAnew(), tr("all parts that are not fixed, so that the largest rectangle is left"))),
      make("form", { onsubmit: (/** @type {Event} */ event) => { event.preventDefault(); if (this.file?.value.trim()) this.#add(`add ${inLine(this.file.value.trim())}`); } }, this.file, " ", make("button", {}, tr("Add"))),
      this.list,
      make("p", {}, this.name, " ", this.write));
    this.#show();
  }

  /** Another plan or nest is drawn: changes are kept where it is the same nest. */
  #anew() {
    this.kept = { key: "", of: new Map() };
    this.#choose();
  }

  /** @param {boolean} on */
  #switch(on) {
    this.on = on;
    document.body.classList.toggle("editing-parts", on);
    if (on && !this.room) void this.#ask();
    if (on) this.#choose();
    this.app.app.draw();
  }

  /** What the nest's gap is, and what is cut already. */
  async #ask() {
    try {
      this.room = await askServer(this.work.path("room"));
    } catch (error) {
      this.#tell(/** @type {Error} */ (error).message, "bad");
    }
    this.#show();
  }

  get #names() { return /** @type {string[]} */ (this.app.data.nest.parts); }

  #choose() {
    this.part = this.app.data.nest.contours[this.app.state.selected]?.part ?? -1;
    this.#show();
  }

  /** Why a part cannot be changed; "" where it can. */
  /** @param {string} name */
  #held(name) {
    if (this.room?.cut.includes(name)) return tr("{part} is cut already, wholly or in part: it stays", { part: name });
    return this.fixed.has(name) ? tr("{part} is fixed: take that back first", { part: name }) : "";
  }

  /** @param {(name: string) => string} line of changes, by the part's name as it stands there */
  #do(line) {
    const name = this.#names[this.part];
    if (name === undefined) return this.#tell(tr("choose a part first: click it on the drawing"), "warn");
    const held = this.#held(name);
    if (held) return this.#tell(held, "warn");
    this.#add(line(inLine(name)));
  }

  #setFixed() {
    const name = this.#names[this.part];
    if (name === undefined) return;
    if (this.fix?.checked) this.fixed.add(name);
    else this.fixed.delete(name);
    this.app.app.draw();
  }

  #layAnew() {
    this.#add(["nest-anew", ...[...this.fixed].map(inLine)].join(" "));
  }

  /** @param {string} line */
  #add(line) {
    this.changes.add(line);
    void this.#judge();
  }

  /** @param {-1 | 1} by */
  #step(by) {
    if (by < 0 ? this.changes.undo() : this.changes.redo()) void this.#judge();
    else this.#tell(by < 0 ? tr("nothing to undo") : tr("nothing to do again"), "warn");
  }

  /** Has the server say what comes of all changes. */
  async #judge() {
    const mine = ++this.asked, { lines } = this.changes;
    this.kept = { key: "", of: new Map() };
    this.made = null;
    this.sound = false;
    this.#show();
    if (!lines.length) return this.#tell("", "");
    this.#tell(tr("looking …"), "");
    try {
      const told = await sendServer(this.work.path("nest"), { version: this.work.state.version, changes: lines });
      if (mine !== this.asked) return;
      this.made = told.drawing;
      this.sound = true;
      const said = told.off.length ? tr("{n} parts, off the sheet: {off}", { n: told.parts.length, off: told.off.join(", ") })
        : trn("{n} part on the sheet, none too near to another", "{n} parts on the sheet, none too near to another", told.parts.length);
      this.#tell([said, ...told.scrap].join("; "), "good");
    } catch (error) {
      const { told, message } = /** @type {any} */ (error);
      if (mine !== this.asked) return;
      this.#tell([message, ...(told?.details ?? [])].join("; "), "bad");
    }
    this.#show();
    this.app.app.draw();
  }

  async #save() {
    const name = this.name?.value.trim() ?? "", { asked } = this;
    this.write?.toggleAttribute("disabled", true);
    try {
      const told = await sendServer(this.work.path("nest"), { version: this.work.state.version, changes: this.changes.lines, as: name });
      if (asked !== this.asked) return this.#tell(tr("{name} is written, without what was changed since", { name }), "warn");
      location.href = `/nest/${told.id}`;
    } catch (error) {
      const { told, message } = /** @type {any} */ (error);
      this.#tell([message, ...(told?.details ?? [])].join("; "), "bad");
      this.#show();
    }
  }

  /** @type {(text: string, kind: string) => void} */
  #tell(text, kind) {
    if (!this.said) return;
    this.said.className = `said ${kind}`;
    this.said.textContent = text;
  }

  #show() {
    const name = this.#names[this.part], { lines, undone } = this.changes;
    if (!this.head || !this.tools || !this.list || !this.fix || !this.name) return;
    this.head.textContent = name === undefined ? tr("no part is chosen") : tr("part {part}", { part: name });
    for (const control of this.tools.querySelectorAll("button, input")) control.toggleAttribute("disabled", name === undefined);
    this.fix.checked = name !== undefined && this.fixed.has(name);
    this.list.replaceChildren(...lines.map(line => make("li", {}, make("code", {}, line))));
    this.undo?.toggleAttribute("disabled", !lines.length);
    this.redo?.toggleAttribute("disabled", !undone.length);
    this.write?.toggleAttribute("disabled", !this.sound || !lines.length);
    this.write?.classList.toggle("primary", Boolean(this.sound && lines.length));
    if (!this.name.value) this.name.value = `${(this.app.data.nest.file || "nest").replace(/^.*[/\\]/, "").replace(/\.[^.]*$/, "")}-2.json`;
  }

  /** How a part lies, what is dragged included. */
  /** @type {(part: number) => Lying & {dropped: boolean}} */
  #lying(part) {
    const lying = this.changes.of(this.#names[part]), { drag } = this;
    return drag?.part === part ? { ...lying, dx: lying.dx + drag.by[0], dy: lying.dy + drag.by[1] } : lying;
  }

  /** The rings of a part where it lies. */
  /** @type {(part: number) => Outline} */
  #outline(part) {
    const key = this.changes.lines.join("\n");
    if (this.kept.key !== key) this.kept = { key, of: new Map() };
    const known = this.kept.of.get(part);
    if (known && this.drag?.part !== part) return known;
    const of = this.app.data.nest.contours.filter((/** @type {any} */ one) => one.part === part && one.closed);
    const rings = of.map((/** @type {any} */ one) => flattened(one.rows, true, CHORD_MM));
    const at = of.findIndex((/** @type {any} */ one) => one.kind === "outer"), [x0, y0, x1, y1] = boundsOf(rings[at]);
    const lying = this.#lying(part), lies = rings.map((/** @type {Float64Array} */ ring) => placed(ring, lying, [(x0 + x1) / 2, (y0 + y1) / 2]));
    const outline = { outer: lies[at], holes: lies.filter((/** @type {unknown} */ _, /** @type {number} */ k) => of[k].kind === "hole") };
    if (this.drag?.part !== part) this.kept.of.set(part, outline);
    return outline;
  }

  /** The gaps of a part to what lies near it, the least first; `edge` of that to the sheet. */
  /** @type {(part: number) => Near[]} */
  #gaps(part) {
    const mine = this.#outline(part), box = boundsOf(mine.outer), { gap_mm, edge_mm } = this.room ?? { gap_mm: 0, edge_mm: 0 };
    const sheet = this.app.data.nest.sheet.map((/** @type {number[]} */ rows) => flattened(rows, true, CHORD_MM));
    const gaps = [{ gap: gapToEdge(mine, sheet), least: edge_mm, other: tr("edge"), over: tr("would lie over the sheet's edge") }];
    this.#names.forEach((other, k) => {
      if (k === part || this.#lying(k).dropped) return;
      const theirs = this.#outline(k);
      if (!boxesNear(box, boundsOf(theirs.outer), LOOKED_MM)) return;
      gaps.push({ gap: gapBetween(mine, theirs), least: gap_mm, other, over: tr("collides with {other}", { other }) });
    });
    return gaps.filter(one => one.gap.mm < LOOKED_MM).sort((a, b) => a.gap.mm - a.least - b.gap.mm + b.least);
  }

  /** The part at a place of the sheet. */
  /** @type {(x: number, y: number, near: number) => number} */
  #partAt(x, y, near) {
    return this.#names.findIndex((_, k) => {
      if (this.#lying(k).dropped) return false;
      const outline = this.#outline(k), [x0, y0, x1, y1] = boundsOf(outline.outer);
      return x >= x0 - near && x <= x1 + near && y >= y0 - near && y <= y1 + near && (inMetal(outline, x, y) || fromOutline(outline, x, y) < near);
    });
  }

  /** @type {(event: PointerEvent, stage: any) => boolean} */
  #gesture(event, stage) {
    if (!this.on || stage.side || this.work.compared) return false;
    const [x, y] = stage.toSheet(...onCanvas(event, stage));
    if (event.type === "pointerdown") {
      if (this.drag || event.button || event.shiftKey) return Boolean(this.drag);
      const part = this.#partAt(x, y, GRIP_PX / stage.camera.scale);
      if (part < 0) return false;
      const outer = this.app.data.nest.contours.findIndex((/** @type {any} */ one) => one.part === part && one.kind === "outer");
      this.app.choose(outer, false);
      const held = this.#held(this.#names[part]);
      if (held) {
        this.#tell(held, "warn");
        return true;
      }
      this.drag = { pointer: event.pointerId, part, from: [x, y], by: [0, 0] };
      stage.canvas.setPointerCapture(event.pointerId);
      return true;
    }
    const { drag } = this;
    if (drag?.pointer !== event.pointerId) return Boolean(drag);
    if (event.type === "pointermove" && event.buttons) {
      drag.by = [x - drag.from[0], y - drag.from[1]];
      const [nearest] = this.#gaps(drag.part);
      if (nearest) this.#tell(gapText(nearest), nearest.gap.mm < 0 ? "bad" : nearest.gap.mm < nearest.least ? "warn" : "good");
      stage.draw();
      return true;
    }
    const [dx, dy] = drag.by.map(mm => Math.round(mm * ROUND_MM) / ROUND_MM);
    this.drag = null;
    if (event.type === "pointerup" && Math.hypot(dx, dy) * stage.camera.scale > GRIP_PX) this.#add(`move ${inLine(this.#names[drag.part])} ${dx} ${dy}`);
    stage.draw();
    return true;
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    const target = /** @type {HTMLElement} */ (event.target), typed = /^(INPUT|SELECT|TEXTAREA)$/.test(target.tagName);
    if (!this.on || typed || event.altKey || target.closest("dialog[open]")) return;
    const key = event.ctrlKey || event.metaKey ? `Ctrl+${event.key.toLowerCase()}` : event.key, step = ARROWS[event.key];
    const drawn = target instanceof HTMLCanvasElement && target.id !== "ruler", far = event.shiftKey ? FAR_STEP_MM : STEP_MM;
    if (key === "Escape" && this.drag) this.drag = null;
    else if (key === "Ctrl+z") this.#step(event.shiftKey ? 1 : -1);
    else if (key === "Ctrl+y") this.#step(1);
    else if (!drawn || this.part < 0) return;
    else if (step) this.#do(name => `move ${name} ${step[0] * far} ${step[1] * far}`);
    else if (key === "r") this.#do(name => `turn ${name} 90`);
    else if (key === "R") this.#do(name => `turn ${name} -90`);
    else if (key === "m") this.#do(name => `mirror ${name}`);
    else if (key === "Delete" || key === "Backspace") this.#do(name => `drop ${name}`);
    else return;
    event.preventDefault();
    event.stopPropagation();
    this.app.app.draw();
  }

  /** @type {(context: CanvasRenderingContext2D, stage: any) => void} */
  #paint(context, stage) {
    if (!this.on || stage.side) return;
    const { ink } = stage.palette, { camera } = stage;
    const shown = this.drag?.part ?? this.part, gaps = shown >= 0 && !this.#lying(shown).dropped ? this.#gaps(shown) : [];
    this.#names.forEach((name, k) => {
      const lying = this.#lying(k), moved = lying.dropped || lying.dx || lying.dy || lying.turn_deg || lying.mirrored;
      if (moved || k === this.drag?.part) this.#drawn(context, stage, k, lying.dropped);
      if (!this.fixed.has(name)) return;
      const [x0, y0, x1, y1] = boundsOf(this.#outline(k).outer), [x, y] = camera.toScreen((x0 + x1) / 2, (y0 + y1) / 2);
      write(context, "⚓", x, y, ink.text, ink.halo);
    });
    if (this.made && this.changes.lines.some(line => /^(add|nest-anew|sheet|keep)/.test(line))) this.#drawMade(context, camera, ink);
    const [nearest] = gaps;
    if (!nearest) return;
    const bad = nearest.gap.mm < 0, near = nearest.gap.mm < nearest.least, colour = bad ? ink.alert : near ? ink.unkept : ink.good;
    const a = camera.toScreen(...nearest.gap.from), b = camera.toScreen(...nearest.gap.to);
    pen(context, colour, 2);
    context.beginPath();
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
    context.stroke();
    context.font = "700 13px system-ui, 'DejaVu Sans', sans-serif";
    context.textAlign = "center";
    context.textBaseline = "bottom";
    const text = bad ? nearest.over : `${figure(nearest.gap.mm, 1)} mm`, half = context.measureText(text).width / 2 + LABEL_RIM_PX;
    const x = Math.max(half, Math.min(stage.size.wide - half, (a[0] + b[0]) / 2)); // whole on the drawing
    write(context, text, x, (a[1] + b[1]) / 2 - 4, colour, ink.halo);
  }

  /** A part that was moved: where it was, dashed, and where it lies. */
  /** @type {(context: CanvasRenderingContext2D, stage: any, part: number, dropped: boolean) => void} */
  #drawn(context, stage, part, dropped) {
    const { ink } = stage.palette, { camera } = stage;
    context.beginPath();
    this.app.data.nest.contours.forEach((/** @type {any} */ one) => {
      if (one.part === part && one.closed) trace(context, camera, flattened(one.rows, true, CHORD_MM), true);
    });
    context.fillStyle = ink.sheet;
    context.fill("evenodd");
    pen(context, ink.done, 1, [4, 4]);
    context.stroke();
    if (dropped) return;
    const outline = this.#outline(part), [nearest] = this.#gaps(part), bad = nearest && nearest.gap.mm < 0;
    context.beginPath();
    for (const ring of [outline.outer, ...outline.holes]) trace(context, camera, ring, true);
    context.globalAlpha = 0.85;
    context.fillStyle = bad ? ink.alert : ink.part;
    context.fill("evenodd");
    context.globalAlpha = 1;
    pen(context, bad ? ink.alert : ink.select, 2);
    context.stroke();
  }

  /** The nest as the server makes it, over the old one. */
  /** @type {(context: CanvasRenderingContext2D, camera: any, ink: Record<string, string>) => void} */
  #drawMade(context, camera, ink) {
    context.beginPath();
    for (const one of this.made.contours) trace(context, camera, flattened(one.rows, one.closed, CHORD_MM), one.closed);
    pen(context, ink.good, 2);
    context.stroke();
  }
}

/** @type {(near: Near) => string} */
function gapText({ gap, least, other, over }) {
  if (gap.mm < 0) return over;
  const mm = figure(gap.mm, 1);
  return gap.mm < least ? tr("{mm} mm to {other}: {least} mm are kept", { mm, other, least: figure(least, 1) }) : tr("{mm} mm to {other}", { mm, other });
}
