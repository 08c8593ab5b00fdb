/** @import { Work } from "./work.js" */
import { sendServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan } from "./locking.js";
import { tr, trn } from "./say.js";

/**
 * @typedef {{value: string, words: string, gives: string}} Choice
 * @typedef {{id: string, text: string, choices: Choice[]}} Question
 * @typedef {Record<string, string>} Answers choices by question
 */

/**
 * What a drawing does not decide: each question with a button for each choice, and a picture of what it would give.
 *
 * @param {Question[]} questions
 * @param {Answers} given what was answered before
 * @param {(answers: Answers) => Promise<string>} preview the address of a picture of the drawing with some answers
 * @param {(answers: Answers) => void} done takes all answers
 * @returns {HTMLElement}
 */
export function drawingQuestions(questions, given, preview, done) {
  /** @type {Answers} */
  const chosen = {};
  const open = make("button", { type: "button", id: "answer-all", disabled: true, onclick: () => done({ ...given, ...chosen }) }, tr("open the drawing so"));
  const left = make("p", { id: "answers-left", role: "status" });
  const rows = questions.map(question => {
    const cards = question.choices.map((choice, k) => card(question, choice, k === 0));
    return { question, cards, box: make("fieldset", {}, make("legend", {}, question.text), make("div", { class: "choices" }, ...cards.map(one => one.box))) };
  });
  let turn = 0;

  /** @type {(question: Question, choice: Choice, likeliest: boolean) => {choice: Choice, box: HTMLElement, picture: HTMLImageElement, button: HTMLElement}} */
  function card(question, choice, likeliest) {
    const picture = /** @type {HTMLImageElement} */ (make("img", { alt: tr("the drawing, if this is answered: {words}", { words: choice.words }), hidden: true }));
    const button = make("button", { type: "button", "aria-pressed": "false", onclick: () => choose(question, choice) }, choice.words);
    const box = make("div", { class: "choice" }, button, make("p", {}, likeliest ? make("em", {}, tr("the likeliest")) : "", likeliest && choice.gives ? ": " : "", choice.gives), picture);
    return { choice, box, picture, button };
  }

  /** @type {(question: Question, choice: Choice) => void} */
  function choose(question, choice) {
    const before = chosen[question.id];
    chosen[question.id] = choice.value;
    for (const row of rows) {
      for (const { choice: one, button, box } of row.cards) {
        const pressed = chosen[row.question.id] === one.value;
        button.setAttribute("aria-pressed", String(pressed));
        box.classList.toggle("chosen", pressed);
      }
    }
    tell();
    if (rows.length > 1 && before !== choice.value) draw(question);
  }

  function tell() {
    const missing = questions.length - Object.keys(chosen).length;
    /** @type {HTMLButtonElement} */ (open).disabled = missing > 0;
    left.textContent = missing ? trn("{n} question is not answered yet.", "{n} questions are not answered yet.", missing) : "";
  }

  /**
   * The pictures, one after the other; those of the question that was just answered stay.
   *
   * @param {Question} [answered]
   */
  async function draw(answered) {
    turn += 1;
    const mine = turn, likeliest = Object.fromEntries(questions.map(one => [one.id, one.choices[0].value]));
    for (const { question, cards } of rows) {
      if (question === answered) continue;
      for (const { choice, picture } of cards) {
        const address = await preview({ ...given, ...likeliest, ...chosen, [question.id]: choice.value }).catch(() => "");
        if (mine !== turn) return;
        picture.hidden = !address;
        if (address) picture.src = address;
      }
    }
    document.documentElement.dataset.previews = "drawn";
  }

  tell();
  draw();
  return make("section", { id: "questions" },
    make("h2", {}, trn("This drawing raises {n} question", "This drawing raises {n} questions", questions.length)),
    make("p", {}, tr("A wrong guess would be scrap. The answers are kept in the job file beside the drawing, so that nobody is asked again.")),
    ...rows.map(row => row.box),
    left, open);
}

/**
 * What the planning does not decide, such as narrow slots: a button for each choice, which plans with that answer, and a
 * picture of what it would give.
 *
 * @param {any} app
 * @param {Work} work
 */
export function planningQuestions(app, work) {
  const place = make("section", { id: "hands-questions", hidden: true, "aria-label": tr("questions of the planning") });
  app.slots.side.append(place);
  let drawn = "[]";
  work.on(() => {
    const { questions } = work.state, now = JSON.stringify(questions);
    if (now === drawn) return;
    drawn = now;
    place.hidden = !questions.length;
    const about = questions.flatMap((/** @type {Question} */ question) => contoursIn(app, question.text));
    if (about.length) app.app.mark(about);
    /** @type {[HTMLImageElement, Answers][]} */
    const pictures = [];
    place.replaceChildren(...questions.map((/** @type {Question} */ question) => make("div", {},
      make("h2", {}, tr("A question first")), make("p", {}, question.text),
      ...question.choices.map(choice => {
        const picture = /** @type {HTMLImageElement} */ (make("img", { alt: tr("the drawing, if this is answered: {words}", { words: choice.words }), hidden: true }));
        if (choice.value !== "refuse") pictures.push([picture, { [question.id]: choice.value }]);
        return make("p", {},
          make("button", { type: "button", onclick: () => lockAndPlan(work, [{ answer: `${question.id}=${choice.value}` }]) }, choice.words),
          choice.gives ? make("small", {}, ` ${choice.gives}`) : "", picture);
      }),
      contoursIn(app, question.text).length ? make("p", { class: "hint" }, tr("Marked in red on the drawing."), " ",
        make("button", { type: "button", class: "link", onclick: () => app.app.chooseId(contoursIn(app, question.text)[0]) }, tr("look at it"))) : null)));
    show(pictures, now);
  });

  /** @type {(pictures: [HTMLImageElement, Answers][], asked: string) => Promise<void>} */
  async function show(pictures, asked) {
    for (const [picture, answers] of pictures) {
      if (asked !== drawn) return;
      const { nest, repair } = work.state;
      const told = await sendServer("/api/preview", { nest, repair, answers }).catch(() => ({}));
      picture.hidden = !told.picture;
      if (told.picture) picture.src = told.picture;
    }
    place.dataset.previews = "drawn";
  }
}

/** The contours that a question names. */
/** @type {(app: any, text: string) => string[]} */
function contoursIn(app, text) {
  const words = new Set(text.split(/[\s,;:()]+/).map(word => word.replace(/\.$/, "")));
  return app.data.nest.contours.map((/** @type {any} */ one) => one.id).filter((/** @type {string} */ id) => words.has(id));
}

/**
 * In the panel of the sheet: what the drawing is taken for, its lines in the colours of what they stand for.
 *
 * @param {any} app
 * @param {Work} work
 */
export function readingPicture(app, work) {
  const picture = /** @type {HTMLImageElement} */ (make("img", { alt: tr("the drawing as it was read: what is cut, marked and left out"), hidden: true, id: "reading" }));
  const show = make("button", { type: "button", id: "show-reading", onclick: async () => {
    const told = await sendServer("/api/preview", { nest: work.state.nest, repair: work.state.repair }).catch(error => { work.say(error.message, "bad"); return null; });
    if (!told) return;
    picture.src = told.picture;
    picture.hidden = false;
  } }, tr("show the drawing as it was read"));
  app.slots.sheet.append(make("h2", { class: "small" }, tr("The drawing as read")), show, picture);
}
