const NEWS = "kerfwise-news", KINDS = ["state", "progress", "planner"];

/**
 * News of all nests. A browser opens six connections to a server at the most, so one tab listens for all: the one that
 * has the lock. When it is closed, the next one has it.
 *
 * @param {(what: string, told: any) => void} heard
 */
export function listenToNews(heard) {
  const tabs = new BroadcastChannel(NEWS);
  tabs.addEventListener("message", event => heard(event.data.what, event.data.told));
  const stream = () => {
    const news = new EventSource("/api/events");
    for (const what of KINDS) {
      news.addEventListener(what, event => {
        const told = JSON.parse(event.data);
        heard(what, told);
        tabs.postMessage({ what, told });
      });
    }
  };
  // The lock is held until the tab is gone.
  void navigator.locks.request(NEWS, () => new Promise(() => stream()));
  addEventListener("pageshow", event => { if (event.persisted) location.reload(); });
}
