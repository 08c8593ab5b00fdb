/** @import { App } from "./app.js" */
import { byId } from "./elements.js";
import { NOTICE_SIGNS, noticeNear, noticeText, noticesOf, toNotice } from "./notices.js";
import { tr } from "./say.js";
import { zonesOf } from "./timeline.js";
import { clock } from "./words.js";

const TOP_PX = 15, ROW_OF_NOTICES_PX = 15, SIGN_PX = 13;

/**
 * The ruler of time under the drawing: zones as bands, above them a row of notices; a slider for keyboard and reader.
 *
 * @param {App} app
 */
export function timeRuler(app) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("ruler"));
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  /** @type {import("./notices.js").Notice[][]} */
  let notices = [];
  const collect = () => { notices = app.stages.map(stage => stage.plan ? noticesOf(app.data.nest, stage.plan, stage.timeline) : []); };
  const draw = () => {
    const wide = canvas.clientWidth, high = canvas.clientHeight, ratio = Math.min(2, devicePixelRatio || 1);
    if (!wide || !app.side) return;
    if (canvas.width !== Math.round(wide * ratio)) canvas.width = Math.round(wide * ratio);
    if (canvas.height !== Math.round(high * ratio)) canvas.height = Math.round(high * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { ink, zones } = app.stages[0].palette, end = app.end(), sides = app.stages;
    context.clearRect(0, 0, wide, high);
    const tall = (high - TOP_PX) / sides.length - ROW_OF_NOTICES_PX, top = TOP_PX;
    sides.forEach((stage, s) => {
      if (!stage.plan) return;
      const y = TOP_PX + s * (tall + ROW_OF_NOTICES_PX) + ROW_OF_NOTICES_PX;
      signs(context, notices[s] ?? [], y - 4, wide, end, ink);
      for (const { zone, from_s, to_s } of zonesOf(stage.plan, stage.timeline)) {
        const x = (from_s / end) * wide, long = ((to_s - from_s) / end) * wide;
        context.fillStyle = zone ? zones[(zone - 1) % 8] : ink.part;
        context.fillRect(x, y + 2, Math.max(1, long - 1), tall - 4);
        if (long > 26 && zone) {
          context.fillStyle = ink.text;
          context.font = "10px system-ui, 'DejaVu Sans', sans-serif";
          context.fillText(`Z${zone}`, x + 4, y + tall / 2 + 4);
        }
      }
      chosenCut(context, app, s, y, wide, end, ink);
    });
    scale(context, wide, end, ink.text);
    const x = (app.state.time_s / end) * wide;
    context.fillStyle = ink.torch;
    context.fillRect(x - 1, top - 3, 2, high - top + 3);
    context.beginPath();
    context.arc(x, top - 3, 4, 0, 7);
    context.fill();
    canvas.setAttribute("aria-valuemax", end.toFixed(0));
    canvas.setAttribute("aria-valuenow", app.state.time_s.toFixed(0));
    canvas.setAttribute("aria-valuetext", tr("{now} of {end}, {doing}", { now: clock(app.state.time_s), end: clock(end), doing: app.doing() }));
  };
  /** @param {PointerEvent} event */
  const seek = event => {
    const box = canvas.getBoundingClientRect();
    app.seek(((event.clientX - box.left) / box.width) * app.end());
  };
  /** @type {(event: PointerEvent) => {side: number, notice: import("./notices.js").Notice} | null} */
  const noticeAt = event => {
    const box = canvas.getBoundingClientRect(), high = (box.height - TOP_PX) / app.stages.length, y = event.clientY - box.top - TOP_PX;
    const side = Math.floor(y / high), end = app.end();
    if (y < 0 || y - side * high > ROW_OF_NOTICES_PX || !notices[side]) return null;
    const notice = noticeNear(notices[side], ((event.clientX - box.left) / box.width) * end, (SIGN_PX / box.width) * end);
    return notice && { side, notice };
  };
  canvas.addEventListener("pointerdown", event => {
    const found = noticeAt(event);
    if (found) {
      app.set({ side: found.side, playing: false });
      app.seek(found.notice.at_s);
      app.choose(app.data.sides[found.side].cuts[found.notice.cut].contour);
      app.tell(noticeText(app, found.side, found.notice));
      return;
    }
    canvas.setPointerCapture(event.pointerId);
    seek(event);
  });
  canvas.addEventListener("pointermove", event => {
    if (event.buttons && canvas.hasPointerCapture(event.pointerId)) return seek(event);
    const found = noticeAt(event);
    canvas.title = found ? noticeText(app, found.side, found.notice) : "";
  });
  byId("notice").addEventListener("click", () => toNotice(app, 1));
  new ResizeObserver(draw).observe(canvas);
  app.on(draw);
  app.renewed(() => { collect(); draw(); });
  app.recoloured(draw);
  collect();
  draw();
}

/** @type {(context: CanvasRenderingContext2D, app: App, side: number, y: number, wide: number, end: number, ink: Record<string, string>) => void} */
function chosenCut(context, app, side, y, wide, end, ink) {
  const { scenery, timeline } = app.stages[side], selected = scenery.cutOf.get(app.state.selected);
  if (selected === undefined) return;
  const from = (timeline.begins_s[selected] / end) * wide, to = (timeline.ends_s[selected] / end) * wide;
  context.fillStyle = ink.select;
  context.fillRect(from, y, Math.max(3, to - from), 3);
}

/** The signs of notices, where there are many only the weightiest of each place. */
/** @type {(context: CanvasRenderingContext2D, notices: import("./notices.js").Notice[], y: number, wide: number, end: number, ink: Record<string, string>) => void} */
function signs(context, notices, y, wide, end, ink) {
  const colours = { unkept: ink.unkept, stop: ink.alert, tab: ink.tab, mark: ink.mark, loose: ink.text };
  /** @type {Set<number>} */
  const taken = new Set();
  context.font = "700 11px system-ui, 'DejaVu Sans', sans-serif";
  context.textAlign = "center";
  for (const kind of /** @type {(keyof typeof NOTICE_SIGNS)[]} */ (Object.keys(NOTICE_SIGNS))) {
    for (const notice of notices) {
      if (notice.kind !== kind) continue;
      const x = (notice.at_s / end) * wide, place = Math.floor(x / SIGN_PX);
      if (taken.has(place)) continue;
      taken.add(place);
      context.fillStyle = colours[kind];
      context.fillText(NOTICE_SIGNS[kind], Math.max(5, Math.min(wide - 5, x)), y);
    }
  }
  context.textAlign = "left";
}

/** @type {(context: CanvasRenderingContext2D, wide: number, end: number, colour: string) => void} */
function scale(context, wide, end, colour) {
  const steps = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 18000, 36000];
  const step = steps.find(one => (one / end) * wide > 54) ?? 86400;
  context.fillStyle = colour;
  context.font = "10px system-ui, 'DejaVu Sans', sans-serif";
  for (let at = 0; at <= end; at += step) {
    const x = (at / end) * wide;
    context.fillRect(x, 10, 1, 4);
    if (x + 3 + context.measureText(clock(at)).width <= wide) context.fillText(clock(at), x + 3, 10);
  }
}
