/** What the page says, in the reader's language: message catalogues as gettext has them, by the English text. */

/** Languages and their own names. */
export const LANGUAGES = /** @type {Record<string, string>} */ ({ en: "English", de: "Deutsch", es: "Español", ru: "Русский" });
const KEPT = "kerfwise-language", SAID_OF = ["title", "aria-label", "placeholder"];
/** Which form of a plural a number has, by what the browser calls it. */
const FORMS = /** @type {Record<string, Record<string, number>>} */ ({
  es: { one: 0, many: 1, other: 2 }, ru: { one: 0, few: 1, many: 2, other: 2 },
});

const spoken = { language: "en", texts: /** @type {Record<string, string | string[]>} */ ({}) };

/**
 * A text in the reader's language; `{name}` stands for one of the values.
 *
 * @param {string} text
 * @param {Record<string, unknown>} [values]
 * @returns {string}
 */
export function tr(text, values = {}) {
  const found = spoken.texts[text];
  return filled(typeof found === "string" ? found : text, values);
}

/**
 * The same of a number of things; `{n}` is the number.
 *
 * @param {string} one
 * @param {string} many
 * @param {number} n
 * @param {Record<string, unknown>} [values]
 * @returns {string}
 */
export function trn(one, many, n, values = {}) {
  const found = spoken.texts[one], { language } = spoken;
  const form = FORMS[language]?.[new Intl.PluralRules(language).select(n)] ?? (n === 1 ? 0 : 1);
  return filled(Array.isArray(found) ? found[form] ?? found[found.length - 1] : n === 1 ? one : many, { n, ...values });
}

/** How a text is said in the reader's language; undefined where that is not known. */
/** @type {(text: string) => string | undefined} */
export function translationOf(text) {
  const found = spoken.texts[text];
  return typeof found === "string" ? found : undefined;
}

/** @type {(text: string, values: Record<string, unknown>) => string} */
export function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (whole, name) => name in values ? String(values[name]) : whole);
}

/** A number as it is written in the reader's language. */
/** @type {(value: number, digits: number) => string} */
export function figure(value, digits) {
  const text = value.toFixed(digits);
  return spoken.language === "en" ? text : text.replace(".", ",");
}

/** The language that is spoken. */
/** @returns {string} */
export function language() {
  return spoken.language;
}

/**
 * Speaks the language that was chosen here, else the one that the page was made for, else that of the browser.
 *
 * @param {Record<string, Record<string, string | string[]>>} catalogues by language
 * @param {string} [wanted] by the page
 */
export function speak(catalogues, wanted = "") {
  const known = [remembered(KEPT) ?? "", wanted, ...navigator.languages].map(one => one.slice(0, 2)).filter(one => one in LANGUAGES);
  setLanguage(known[0] ?? "en", catalogues);
  document.documentElement.lang = spoken.language;
  if (spoken.language !== "en") translate(document.body);
}

/**
 * Speaks a language from now on.
 *
 * @param {string} name
 * @param {Record<string, Record<string, string | string[]>>} catalogues
 */
export function setLanguage(name, catalogues) {
  spoken.language = name === "en" || name in catalogues ? name : "en";
  spoken.texts = catalogues[name] ?? {};
}

/** The texts of the page's frame, which stand in it in English. */
/** @param {Element} root */
function translate(root) {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    if (node instanceof Element) {
      for (const name of SAID_OF) if (node.hasAttribute(name)) node.setAttribute(name, tr(node.getAttribute(name) ?? ""));
    } else if (node.parentElement?.tagName !== "SCRIPT") {
      const text = node.textContent ?? "", bare = text.trim();
      if (bare) node.textContent = text.replace(bare, tr(bare));
    }
  }
}

/**
 * The choice of languages; another one is spoken once the page is loaded again.
 *
 * @param {HTMLSelectElement} choice
 */
export function languageChoice(choice) {
  for (const [name, own] of Object.entries(LANGUAGES)) choice.append(new Option(own, name, false, name === spoken.language));
  [...choice.options].forEach(option => { option.lang = option.value; });
  choice.addEventListener("change", () => {
    remember(KEPT, choice.value);
    location.reload();
  });
}

/** What this browser has kept of the page; null for nothing, or where it keeps nothing. */
/** @type {(name: string) => string | null} */
export function remembered(name) {
  try {
    return localStorage.getItem(name);
  } catch {
    return null; // a page in a sandbox has no storage
  }
}

/** Has the browser keep something. */
/** @type {(name: string, value: string) => void} */
export function remember(name, value) {
  try {
    localStorage.setItem(name, value);
  } catch {
    // a page in a sandbox has no storage: the choice holds for now
  }
}
