import "./messages.js";
import { tr } from "./say.js";
import { inWords } from "./sentences.js";

/**
 * The server's answer in the reader's language; one that is none is thrown, with what was told as `told`.
 *
 * @param {Response} response
 */
async function answered(response) {
  const told = await response.json();
  if (response.ok) return told;
  const details = (told.details ?? []).map(inWords);
  throw Object.assign(new Error(inWords(told.message) || `answer ${response.status}`), { told: { ...told, details }, status: response.status });
}

/** @type {(path: string, asked: RequestInit) => Promise<Response>} */
async function reach(path, asked) {
  try {
    return await fetch(path, asked);
  } catch (error) {
    if (/** @type {Error} */ (error).name === "AbortError") throw error;
    throw new Error(tr("the server does not answer: is kerfwise serve still running?"));
  }
}

/**
 * Asks for something.
 *
 * @param {string} path
 * @returns {Promise<any>}
 */
export async function askServer(path) {
  return answered(await reach(path, {}));
}

/**
 * Has something changed: what is said goes as JSON, a file as it is.
 *
 * @param {string} path
 * @param {object | Blob} [said]
 * @param {AbortSignal} [signal] hangs up: what is being planned for it is cancelled
 * @returns {Promise<any>}
 */
export async function sendServer(path, said = {}, signal = undefined) {
  const file = said instanceof Blob;
  const headers = { "content-type": file ? "application/octet-stream" : "application/json" };
  return answered(await reach(path, { method: "POST", headers, body: file ? said : JSON.stringify(said), signal }));
}
