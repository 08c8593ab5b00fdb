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
  const probe = document.createElement("i"), style = getComputedStyle(probe);
  document.body.append(probe);
  const colour = (/** @type {string} */ name) => { probe.style.color = `var(--${name})`; return style.color; };
  const ink = Object.fromEntries(NAMES.map(name => [name, colour(name)])), zones = Array.from({ length: 8 }, (_, k) => colour(`zone${k}`));
  probe.remove();
  return { ink, zones };
}
