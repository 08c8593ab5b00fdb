const NEWS = "kerfwise-news", KINDS = ["state", "progress", "planner"], AGAIN_MS = 3000;

/**
 * News of all nests. A browser opens six connections to a server at the most, so one tab listens for all: the one that
 * has the lock. When it is closed, or the server refuses it, the next one has it.
 *
 * @param {(what: string, told: any) => void} heard "connection" tells whether the server is lost
 */
export function listenToNews(heard) {
  const tabs = new BroadcastChannel(NEWS);
  tabs.addEventListener("message", event => heard(event.data.what, event.data.told));
  const stream = () => new Promise(refused => {
    const news = new EventSource("/api/events");
    for (const what of KINDS) {
      news.addEventListener(what, event => {
        const told = JSON.parse(event.data);
        heard(what, told);
        tabs.postMessage({ what, told });
      });
    }
    const connection = (/** @type {boolean} */ lost) => {
      heard("connection", { lost });
      tabs.postMessage({ what: "connection", told: { lost } });
    };
    news.addEventListener("open", () => connection(false));
    // A browser asks again by itself where the server is gone, but not where it refuses, as one with a new token does.
    news.addEventListener("error", () => {
      connection(true);
      if (news.readyState === EventSource.CLOSED) refused(null);
    });
  });
  // The lock is held until the tab is gone, or its stream is refused.
  const listen = () => void navigator.locks.request(NEWS, stream).then(() => setTimeout(listen, AGAIN_MS));
  listen();
  addEventListener("pageshow", event => { if (event.persisted) location.reload(); });
}
