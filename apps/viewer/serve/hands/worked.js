import { byId } from "./elements.js";
import { start } from "./start.js";
import { giveHands } from "./hands.js";
import { Work } from "./work.js";

const work = new Work(location.pathname.split("/").at(-1) ?? "");
work.begin().then(() => start(work.source(), app => giveHands(app, work)))
  .catch(error => { byId("title").textContent = error.message; });
