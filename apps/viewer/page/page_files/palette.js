/** The colours of the drawing, by the style sheet's variables: they follow the light and the dark look. */
const NAMES = ["ground", "sheet", "edge", "part", "loose", "gap", "outer", "hole", "mark", "slit", "scrap", "pierce",
  "travel", "torch", "select", "alert", "text", "halo", "tab", "done", "unkept", "warn", "good", "bad", "strong"];

/** Drawn in the colour of paper or ink, whichever the look has. */
export const PAPER_COLOURS = new Set(["white", "black", "#ffffff", "#000000"]);

/**
 * @typedef {object} Palette
 * @property {Record<string, string>} ink
 * @property {string[]} zones
 */

/** @returns {Palette} */
export function palette() {
  const style = getComputedStyle(document.documentElement);
  /** @type {Record<string, string>} */
  const ink = {};
  for (const name of NAMES) ink[name] = style.getPropertyValue(`--${name}`).trim() || "#888";
  const zones = Array.from({ length: 8 }, (_, k) => style.getPropertyValue(`--zone${k}`).trim() || ink.part);
  return { ink, zones };
}
