/** @import { App } from "./app.js" */
/** @import { EntryWay, Holds, Told, Why } from "./types.js" */
import { byId, make } from "./elements.js";
import { tr, trn } from "./say.js";
import { inWords } from "./sentences.js";
import { withFirst } from "./timeline.js";
import { clock, kindText, millimetres, placeText, wayText } from "./words.js";

const FEW_WAYS = 4;

/**
 * The panel that says why the chosen contour is cut where it is, then, and so.
 *
 * @param {App} app
 */
export function whyPanel(app) {
  const panel = byId("why-said");
  let asked = 0;
  const show = async () => {
    const mine = ++asked, contour = app.data.nest.contours[app.state.selected];
    if (!contour) {
      panel.replaceChildren(make("p", { class: "hint" }, app.side
        ? tr("Click a contour, or a row of the list: this panel then says why it is cut there and not earlier or later.")
        : tr("Click a contour to read its name. There is no plan to explain.")));
      return;
    }
    panel.replaceChildren(...said(app, app.state.selected, null)); // the reasons may take a while
    const why = app.side ? await app.source.why(app.state.side, idOfFirst(app)) : null;
    if (why && mine === asked) panel.replaceChildren(...said(app, app.state.selected, why));
  };
  app.on((_, changes) => { if (changes.selected !== undefined || changes.side !== undefined) void show(); });
  app.renewed(show);
  void show();
}

/** The chosen contour, or where a further torch cuts it the one that the first cuts by the same motion: it has the reasons. */
/** @type {(app: App) => string} */
function idOfFirst(app) {
  const { cuts } = app.side, { contours } = app.data.nest;
  let k = app.cutOf(app.state.selected) ?? -1;
  while (withFirst(cuts[k])) k -= 1;
  return contours[k < 0 ? app.state.selected : cuts[k].contour].id;
}

/**
 * @param {App} app
 * @param {number} contour
 * @param {Why | null} why
 * @returns {(Node)[]}
 */
function said(app, contour, why) {
  const { id, kind, part, drawn } = app.data.nest.contours[contour], k = app.cutOf(contour);
  const head = [make("h2", {}, id),
    make("p", { class: "sub" }, [kindText(kind), part >= 0 ? tr("part {part}", { part: app.data.nest.parts[part] }) : "", app.side ? "" : drawn ?? ""].filter(Boolean).join(" · "))];
  const left = app.side?.left_out.find(one => one.contour === id);
  if (left) return [...head, make("p", {}, tr("Not cut: {why}", { why: left.why }))];
  if (k === undefined) return head;
  const cut = app.side.cuts[k], { timeline } = app.stages[app.state.side];
  const facts = make("dl", {},
    ...row(tr("cut"), tr("{number} of {of}", { number: app.side.made + k + 1, of: app.side.made + app.side.cuts.length }) + (cut.zone ? `, ${tr("zone {zone}", { zone: cut.zone })}` : "")),
    ...row(tr("time"), `${clock(timeline.begins_s[k])} – ${clock(timeline.ends_s[k])}${timeline.timed ? "" : ` ${tr("(guessed)")}`}`),
    ...row(tr("way"), tr("{direction}, {length}, from {place}", { direction: wayText(cut.direction), length: millimetres(cut.length_mm), place: placeText(cut.path) })),
    ...(cut.wait_s ? row(tr("waits"), tr("{s} s, so that metal may cool", { s: cut.wait_s })) : []),
    ...(cut.excused.length ? row(tr("not kept here"), cut.excused.join(", ")) : []));
  const sections = [...head, facts, part_(tr("Why here"), list(cut.because))];
  return [...sections, ...(why ? reasonsOf(app, why) : [])];
}

/**
 * @param {App} app
 * @param {Why} why
 * @returns {Node[]}
 */
function reasonsOf(app, why) {
  const { entry } = why;
  const free = !why.earlier.nearest.length && !why.later.nearest.length && !why.also.length && !why.heat.length;
  return [
    part_("", list(why.said)),
    part_(tr("Not earlier"), holds(app, why.earlier)),
    part_(tr("Not later"), holds(app, why.later)),
    part_(tr("Also asked"), told(why.also)),
    part_(tr("Heat"), list(why.heat.map(one => `${one.kept ? tr("kept") : tr("broken, costs {mm} mm", { mm: one.price_mm })}: ${inWords(one.text)}`))),
    free ? make("p", {}, tr("No order rule is about it: it is cut here for the shortest travel.")) : null,
    entry && part_(tr("Entries weighed"), ways(entry)),
    why.moves.length ? part_(tr("If it were moved"), make("ul", {}, ...why.moves.map(move => make("li", {},
      make("b", {}, `${inWords(move.label)} (${move.place})`),
      move.together.length ? ` ${trn("with {n} other", "with {n} others", move.together.length)}` : "", ": ",
      move.breaks.length ? make("span", { class: "no-way" }, `${tr("breaks {rule}: {text}", { rule: move.breaks[0].rule, text: inWords(move.breaks[0].text) })}`
        + (move.breaks.length > 1 ? ` ${tr("and {n} more", { n: move.breaks.length - 1 })}` : "")) : make("span", { class: "cost" }, inWords(move.cost)))))) : null,
    part_(tr("Note"), list(why.notes)),
    why.full ? null : make("p", { class: "hint" }, tr("Other entries and places were not tried out for this page: write it with --why, or ask"), " ", make("code", {}, `kerfwise explain NEST PLAN.json '${app.data.nest.contours[app.state.selected].id}'`)),
  ].filter(node => node !== null);
}

/** @type {(name: string, value: string) => HTMLElement[]} */
function row(name, value) {
  return [make("dt", {}, name), make("dd", {}, value)];
}

/** @type {(title: string, content: HTMLElement | null) => HTMLElement | null} */
function section(title, content) {
  return content && make("section", {}, title ? make("h3", {}, title) : null, content);
}

/** @type {(title: string, content: HTMLElement | null) => Node} */
function part_(title, content) {
  return section(title, content) ?? document.createTextNode("");
}

/** @type {(texts: string[]) => HTMLElement | null} */
function list(texts) {
  return texts.length ? make("ul", {}, ...texts.map(text => make("li", {}, inWords(text)))) : null;
}

/** @type {(abouts: Told[]) => HTMLElement | null} */
function told(abouts) {
  return abouts.length ? make("ul", {}, ...abouts.map(about => make("li", {}, make("b", {}, about.rule), `: ${inWords(about.text)}`))) : null;
}

/** The number of a cut as the page counts them, all torches together. */
/** @type {(app: App, one: {contour: string, place: number}) => number} */
function numberOf(app, { contour, place }) {
  const k = app.cutOf(app.numberOf(contour));
  return k === undefined ? place : app.side.made + k + 1;
}

/** @type {(app: App, held: Holds) => HTMLElement | null} */
function holds(app, held) {
  if (!held.nearest.length) return null;
  return make("ul", {}, ...held.nearest.map(one => make("li", {},
    make("button", { class: "link", type: "button", onclick: () => app.chooseId(one.contour) }, `${numberOf(app, one)} ${one.contour}`),
    " ", make("b", {}, one.rule), `: ${inWords(one.text)}`)),
  held.more ? make("li", { class: "hint" }, tr("and {n} more of these rules", { n: held.more })) : null);
}

/** @type {(entry: NonNullable<Why["entry"]>) => HTMLElement} */
function ways(entry) {
  /** @type {(way: EntryWay) => string} */
  const place = way => `${placeText(way.at)} ${wayText(way.direction)}`;
  return make("ul", {},
    make("li", {}, make("b", {}, `${place(entry.used)}`), `, ${inWords(entry.used.text)}: ${tr("taken")}`),
    entry.one_way_by.length ? make("li", {}, tr("{rules}: no other way round than {direction}", { rules: entry.one_way_by.join(", "), direction: wayText(entry.used.direction) })) : null,
    ...entry.lawful.slice(0, FEW_WAYS).map(way => make("li", {}, `${place(way)}, ${inWords(way.text)}: `, make("span", { class: "cost" }, inWords(way.cost ?? "")))),
    entry.lawful.length > FEW_WAYS ? make("li", { class: "hint" }, tr("and {n} more lawful ones", { n: entry.lawful.length - FEW_WAYS })) : null,
    entry.lawful.length ? null : make("li", {}, tr("no other entry is lawful in this order")),
    ...entry.unlawful.map(one => make("li", { class: "no-way" }, `${one.ways.map(place).join(", ")}`
      + `${one.more ? ` ${tr("and {n} more", { n: one.more })}` : ""}: `, make("b", {}, one.rule), `: ${inWords(one.text)}`)));
}
