import { remember, remembered } from "./say.js";

const LOOK = "kerfwise-look";

/** The look of the system, or the one that was chosen by hand here before. */
export function takeLook() {
  const look = remembered(LOOK);
  if (look === "light" || look === "dark") document.documentElement.dataset.look = look;
}

/** The other look from now on, in this browser; one that is that of the system goes with the system again. */
export function changeLook() {
  const { dataset } = document.documentElement, system = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const other = (dataset.look ?? system) === "dark" ? "light" : "dark";
  if (other === system) delete dataset.look;
  else dataset.look = other;
  remember(LOOK, dataset.look ?? "");
}
