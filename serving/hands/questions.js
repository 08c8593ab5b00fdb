/** @import { Work } from "./work.js" */
import { sendServer } from "./asking.js";
import { make } from "./elements.js";
import { lockAndPlan } from "./locking.js";

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
  const open = make("button", { type: "button", id: "answer-all", disabled: true, onclick: () => done({ ...given, ...chosen }) }, "open the drawing so");
  const left = make("p", { id: "answers-left", role: "status" });
  const rows = questions.map(question => {
    const cards = question.choices.map((choice, k) => card(question, choice, k === 0));
    return { question, cards, box: make("fieldset", {}, make("legend", {}, question.text), make("div", { class: "choices" }, ...cards.map(one => one.box))) };
  });
  let turn = 0;

  /** @type {(question: Question, choice: Choice, likeliest: boolean) => {choice: Choice, box: HTMLElement, picture: HTMLImageElement, button: HTMLElement}} */
  function card(question, choice, likeliest) {
    const picture = /** @type {HTMLImageElement} */ (make("img", { alt: `the drawing, if this is answered: ${choice.words}`, hidden: true }));
    const button = make("button", { type: "button", "aria-pressed": "false", onclick: () => choose(question, choice) }, choice.words);
    const box = make("div", { class: "choice" }, button, make("p", {}, likeliest ? make("em", {}, "the likeliest") : "", likeliest && choice.gives ? ": " : "", choice.gives), picture);
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
    left.textContent = missing > 1 ? `${missing} questions are not answered yet.` : missing ? "One question is not answered yet." : "";
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
    make("h2", {}, questions.length > 1 ? `This drawing raises ${questions.length} questions` : "This drawing raises a question"),
    make("p", {}, "A wrong guess would be scrap. The answers are kept in the job file beside the drawing, so that nobody is asked again."),
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
  const place = make("section", { id: "hands-questions", hidden: true, "aria-label": "questions of the planning" });
  app.slots.side.append(place);
  let drawn = "[]";
  work.on(() => {
    const { questions } = work.state, now = JSON.stringify(questions);
    if (now === drawn) return;
    drawn = now;
    place.hidden = !questions.length;
    /** @type {[HTMLImageElement, Answers][]} */
    const pictures = [];
    place.replaceChildren(...questions.map((/** @type {Question} */ question) => make("div", {},
      make("h2", {}, "A question first"), make("p", {}, question.text),
      ...question.choices.map(choice => {
        const picture = /** @type {HTMLImageElement} */ (make("img", { alt: `the nest, if this is answered: ${choice.words}`, hidden: true }));
        if (choice.value !== "refuse") pictures.push([picture, { [question.id]: choice.value }]);
        return make("p", {},
          make("button", { type: "button", onclick: () => lockAndPlan(work, [{ answer: `${question.id}=${choice.value}` }]) }, choice.words),
          choice.gives ? make("small", {}, ` ${choice.gives}`) : "", picture);
      }))));
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
