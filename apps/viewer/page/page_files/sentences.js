/** Sentences that kerfwise says in English of single places, in the reader's language: names and numbers stay. */
import { filled, language, translationOf } from "./say.js";

/** @type {{text: string, names: string[], shape: RegExp}[]} */
const SENTENCES = [];

/** Lets a sentence be translated where it comes in English; `{name}` stands for a name, a number, or another sentence. */
/** @type {(...texts: string[]) => void} */
export function sentence(...texts) {
  for (const text of texts) {
    const names = [...text.matchAll(/\{(\w+)\}/g)].map(found => found[1]);
    const shape = text.split(/\{\w+\}/).map(part => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).join("(.+?)");
    SENTENCES.push({ text, names, shape: new RegExp(`^${shape}$`, "s") });
  }
}

/** What comes in English, in the reader's language; a text that is no known sentence stays as it is. */
/** @type {(text: string) => string} */
export function inWords(text) {
  if (language() === "en" || !text) return text;
  if (/^\d+\.\d+$/.test(text)) return text.replace(".", ",");
  for (const { text: known, names, shape } of SENTENCES) {
    const found = shape.exec(text), translation = found && translationOf(known);
    if (found && translation) return filled(translation, Object.fromEntries(names.map((name, k) => [name, inWords(found[k + 1])])));
  }
  return text;
}

// What rules state and find, and what moves cost; of those that begin alike the longer ones stand first.
sentence(
  "{a} (cut {i}) must be cut before {b} (cut {k}): {why}",
  "{a} and {n} more cannot be cut as number {place}: {why} (and {more} more)",
  "{a} cannot be cut as number {place}: {why} (and {more} more)",
  "{a} and {n} more cannot be cut as number {place}: {why}",
  "{a} cannot be cut as number {place}: {why}",
  "{a} and {n} more can be cut as number {place}: {cost}",
  "{a} can be cut as number {place}: {cost}",
  "zone {zone} comes before zone {following}",
  "{a} is cut before the last of {them}: {why}",
  "{a} is cut before {b} and all other scrap lines: {why}",
  "{a} is cut before {b}: {why}",
  "{a} is cut while any of {them} is still in, to hold it",
  "{a} is cut in one go: {them} follow each other",
  "{a} is cut after {b} and all other marks: {why}",
  "{a} is cut {way}: that is the direction of every {kind}",
  "{a} is cut {place} in order, not {wanted}: {why}",
  "{a} is cut {place} in order: {why}",
  "{a} is cut {way}: {why}",
  "{a} is entered at {place}: {why}",
  "{a} is made before {b}: {why}",
  "{a} is held by tabs: {why}",
  "{a} has no tab: {why}",
  "{a} begins along the sheet's edge or metal already cut",
  "{a}, {way} from {place}, ends along metal that holds it",
  "{a} (cut {k}) ends along {share} rigid metal, less than {least}: the rest of its last {tail} faces the sheet's edge or parts already out",
  "no entry and direction of {a} ends along more than {share}, even with all its neighbours in",
  "the plan excuses it: what must be cut before {a} left nothing better",
  "between {a} and {b} there must be at least {wanted}: they heat each other",
  "between {a} (cut {i}) and {b} (cut {k}) there must be {wanted}",
  "after {a} (cut {k}) {b} lies in a narrow strip between {them}",
  "{a} lies in a narrow strip between {them}",
  "{a} lies on an island, cut off from {b} by {them}",
  "{a} (cut {k}) leaves {them} on an island that nothing still in holds",
  "no travel leads over {part} once {a} is cut: it may have tipped up",
  "travel from {from} to {to} leads over {part}, cut out as cut {k}",
  "{a} is the last cut of {part}",
  "it lies inside it, and cutting {a} frees the metal it is in",
  "it lies between {a} and the {side} side, where cutting starts, and would be left on an island behind the torch",
  "it sits in the concavity of {a}, and would be left on an island once {b} is out",
  "it is nested in {a}, and all parts in there are cut before the first hole of {b}",
  "it opens a slot beside metal that cutting {a} frees",
  "it is pierced in the waste of {a}, which falls out when that is cut",
  "marks made after metal is cut through are out of place",
  "cutting up the skeleton takes away what holds it",
  "within these zones no order avoids it: {why}",
  "locked by the operator ({place})",
  "locked by the operator",
  "{why} ({without} as number {place}: {cost})",
  "without it",
  "without these {n}",
  "{why}, and {n} more of {rule}",
  "together: {a}; {b}",
  "{a} is the only cut",
  "no rule keeps {a} here: as number {place} the plan would cost {mm} mm less, which was not found within the limit",
  "no rule asks anything of where {a} is cut, and every other place is longer, by {mm} mm at least: it is cut here for the shortest travel",
  "no rule decides where {a} is cut: with these entries no other place, nor a stretch turned round, makes the plan cheaper, not even against a rule",
  "decided by {n} rules together: {rules} and {last}",
  "entered at {place}: the shortest lawful way from {a} to {b}",
  "pierced at {place}",
  "kept: {why}",
  "{n} more excuses from hard rules, {cost}",
  "{n} fewer excuses from hard rules, {cost}",
  "1 more excuse from hard rules, {cost}",
  "1 fewer excuse from hard rules, {cost}",
  "one place earlier",
  "one place later",
  "as early as can be",
  "as late as can be",
  "{mm} mm more",
  "{mm} mm less",
  "as long",
  "costs {mm} mm",
  "clockwise",
  "counter-clockwise",
  "{rule}: {why}",
);
