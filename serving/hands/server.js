// How the page asks its server. An answer that is none is thrown, with what was told as `told`.

async function answered(response) {
  const told = await response.json();
  if (response.ok) return told;
  const error = new Error(told.message ?? `answer ${response.status}`);
  error.told = told;
  error.status = response.status;
  throw error;
}

/** Ask for something. */
export async function ask(path) {
  return answered(await fetch(path));
}

/** Have something changed: `said` is sent as JSON, a file as it is. */
export async function send(path, said = {}) {
  const file = said instanceof Blob;
  const headers = { "content-type": file ? "application/octet-stream" : "application/json" };
  return answered(await fetch(path, { method: "POST", headers, body: file ? said : JSON.stringify(said) }));
}
