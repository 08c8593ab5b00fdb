import { byId, make } from "./elements.js";
import { tr } from "./say.js";

/** What the words of the page mean, as docs/glossary.md says it. */
/** @type {() => [string, string][]} */
export const glossary = () => [
  [tr("nest"), tr("the parts laid out on one sheet, as a drawing or as JSON")],
  [tr("contour"), tr("one line that the torch follows: the outer contour of a part, a hole, a mark, or a slit")],
  [tr("mark"), tr("a line that is scribed or engraved and not cut through")],
  [tr("kerf"), tr("the strip of metal that a cut takes away, and its width")],
  [tr("pierce"), tr("the place where the torch is lit and goes through the sheet; it lies in waste")],
  [tr("entry"), tr("the point where the torch joins the contour")],
  [tr("lead-in, lead-out"), tr("the path from the pierce to the entry; the path off the contour, if there is one")],
  [tr("tab"), tr("a short stretch of a contour that is left uncut, so that the part stays where it is")],
  [tr("loose"), tr("metal that is cut off from the sheet; nothing can be cut in it any more")],
  [tr("idle travel"), tr("the path of the torch while it is off, from one cut to the next pierce, from home and back")],
  [tr("zone"), tr("a group of contours that is completed before the next zone begins")],
  [tr("profile"), tr("a plant's YAML file: machine, material, rules, options, prices")],
  [tr("hard, soft, off"), tr("a hard rule must hold, or there is no plan; a soft rule costs its weight each time it is broken; a rule that is off has no effect")],
  [tr("weight"), tr("cost of breaking a soft rule once, in mm of idle travel")],
  [tr("lock"), tr("one decision fixed by the operator: an order, a position, an entry, a direction, a zone")],
  [tr("kept but for"), tr("a plan that may be cut, with places where a hard rule is not kept: each is named with its reason")],
  [tr("proven best"), tr("no plan under these rules and locks is better: that was shown, not guessed")],
  [tr("gap"), tr("how far the plan can be from the best one at most")],
];

/** The words, behind a button of the bar. */
export function wordsDialog() {
  const dialog = /** @type {HTMLDialogElement} */ (byId("words"));
  byId("words-button").addEventListener("click", () => {
    byId("words-said").replaceChildren(...glossary().flatMap(([word, text]) => [make("dt", {}, word), make("dd", {}, text)]));
    dialog.showModal();
  });
}
