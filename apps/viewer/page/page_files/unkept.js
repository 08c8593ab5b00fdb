/** @import { Place, SideData } from "./types.js" */
import { tr } from "./say.js";
import { inWords } from "./sentences.js";

/**
 * What was excused, and what was dropped; a statement that was dropped and broken then is told once, where it is broken.
 *
 * @param {SideData} side
 * @returns {Place[]}
 */
export function notHeld(side) {
  const excused = side.rules.flatMap(rule => rule.excused.map(({ contours, text, why }) => ({ rule: rule.id, contours, text: `${rule.id}: ${inWords(text) || contours.join(", ")}`, why })));
  const told = new Set(excused.map(one => JSON.stringify([one.rule, [...one.contours].sort()])));
  const dropped = side.dropped.filter(one => !told.has(JSON.stringify([one.rule, [...one.contours].sort()])));
  return [...excused, ...dropped.map(({ rule, contours, why }) => ({ contours, text: `${rule}: ${contours.join(` ${tr("before")} `)}`, why }))];
}
