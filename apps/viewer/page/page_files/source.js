/** @import { PageData, Source } from "./types.js" */

/**
 * The source of a page that stands alone: the JSON in the file.
 *
 * @returns {Source}
 */
export function embedded() {
  const element = document.getElementById("data");
  /** @type {PageData} */
  const data = JSON.parse(element?.textContent ?? "null");
  element?.remove();
  return {
    page: async () => data,
    why: async (side, contour) => data.sides[side]?.why[contour] ?? null,
    heat: async side => data.sides[side]?.heat ?? null,
    nc: async side => data.sides[side]?.nc ?? null,
  };
}
