/** @import { Work } from "./work.js" */
import { askServer } from "./asking.js";
import { make } from "./elements.js";
import { tr } from "./say.js";
import { strengthText } from "./words.js";

/**
 * One rule of a profile: its strength and weight, its options, and once it is opened its page and its pictures.
 *
 * @param {Work} work
 * @param {any} rule as the server tells it
 * @param {Map<string, import("./profile.js").RuleChange>} changes
 * @param {boolean} open
 * @param {(change: import("./profile.js").RuleChange) => void} put
 * @returns {HTMLElement}
 */
export function ruleForm(work, rule, changes, open, put) {
  /** @type {(key: string, value: string) => string} */
  const now = (key, value) => changes.get(`${rule.id}.${key}`)?.to ?? value;
  const changed = [...changes.values()].some(one => one.rule === rule.id);
  const strength = now("strength", rule.strength), weight = now("weight", rule.weight ?? rule.default_weight);
  const said = `${strengthText(strength)}${strength === "soft" ? ` ${weight}` : ""}`;
  const page = make("div", { class: "page" });
  const fields = [
    ruleField(rule, "strength", strength, rule.strengths, "", put),
    strength === "soft" ? ruleField(rule, "weight", weight, [], tr("cost of breaking it once, in mm of idle travel"), put) : null,
    ...rule.options.map((/** @type {any} */ one) => ruleField(rule, one.key, now(one.key, one.value), one.words,
      `${one.help}: ${one.expected}; ${tr("{value} where nothing is said", { value: one.default })}`, put)),
  ];
  const whole = make("details", { "data-rule": rule.id, open, class: changed ? "changed" : null },
    make("summary", { title: rule.said_at || tr("nothing is said of it: the default") }, rule.id, make("small", {}, said)),
    make("p", { class: "hint" }, tr(rule.sentence), rule.brought ? ` ${tr("From {rule}.", { rule: rule.brought })}` : ""),
    rule.settable ? make("div", {}, ...fields) : make("p", { class: "hint" }, tr("A rule of the plant's own: change it in the file, under own_rules.")),
    page);
  const fill = () => { if (/** @type {HTMLDetailsElement} */ (whole).open && !page.firstChild) fillPage(work, rule.id, page); };
  whole.addEventListener("toggle", fill);
  return whole;
}

/** @type {(rule: any, key: string, value: string, words: string[], help: string, put: (change: import("./profile.js").RuleChange) => void) => HTMLElement} */
function ruleField(rule, key, value, words, help, put) {
  const label = tr("{key} of {rule} in the profile", { key, rule: rule.id });
  const onchange = (/** @type {Event} */ event) => put({ rule: rule.id, key, to: /** @type {HTMLInputElement} */ (event.target).value.trim() });
  const choice = words.length ? make("select", { "aria-label": label, onchange }, ...words.map(one => make("option", { value: one, selected: one === value }, key === "strength" ? strengthText(one) : one)))
    : make("input", { "aria-label": label, value, onchange });
  return make("label", {}, make("span", {}, key), choice, help ? make("small", {}, help) : null);
}

/** @type {(work: Work, rule: string, place: HTMLElement) => Promise<void>} */
async function fillPage(work, rule, place) {
  place.textContent = "…";
  try {
    const told = await askServer(`${work.path("rule")}?${new URLSearchParams({ rule })}`);
    place.replaceChildren(
      ...["wrong", "right"].filter(kind => told[kind]).map(kind => make("img", { alt: `${rule}: ${kind === "wrong" ? tr("wrong") : tr("right")}`, src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(told[kind])}` })),
      ...pageOf(told.page));
  } catch (error) {
    place.textContent = /** @type {Error} */ (error).message;
  }
}

/** A page of a rule: headings and paragraphs, every text as it is. */
/** @type {(page: string) => HTMLElement[]} */
function pageOf(page) {
  return page.split(/\n{2,}/).filter(one => one.trim()).map(one =>
    one.startsWith("#") ? make("h3", {}, one.replace(/^#+\s*/, "")) : make("p", {}, ...one.split("`").map((text, k) => k % 2 ? make("code", {}, text) : text)));
}
