/** @import { Place, SideData } from "./types.js" */
import { tr } from "./say.js";
import { inWords } from "./sentences.js";

/**
 * The places where a hard rule is not kept: excused, relaxed, or of an order that was dropped.
 *
 * @param {SideData} side
 * @returns {Place[]}
 */
export function notHeld(side) {
  return side.rules.flatMap(rule => rule.excused.map(({ contours, text, why }) => ({ contours, text: `${rule.id}: ${inWords(text) || contours.join(", ")}`, why })));
}

/**
 * The orders that were dropped and are none of these places: the plan keeps them all the same, or a lock has several.
 *
 * @param {SideData} side
 * @returns {Place[]}
 */
export function droppedOrders(side) {
  const told = new Set(side.rules.flatMap(rule => rule.excused.map(one => JSON.stringify([rule.id, [...one.contours].sort()]))));
  const others = side.dropped.filter(one => !told.has(JSON.stringify([one.rule, [...one.contours].sort()])));
  return others.map(({ rule, contours, why }) => ({ contours, text: `${rule}: ${contours.join(` ${tr("before")} `)}`, why }));
}
