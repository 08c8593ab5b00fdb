/** @import { App } from "./app.js" */
import { byId } from "./elements.js";
import { zonesOf } from "./timeline.js";
import { clock } from "./words.js";

/**
 * The ruler of time under the drawing: zones as bands, waits and breaches as ticks; a slider for keyboard and reader.
 *
 * @param {App} app
 */
export function timeRuler(app) {
  const canvas = /** @type {HTMLCanvasElement} */ (byId("ruler"));
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const draw = () => {
    const wide = canvas.clientWidth, high = canvas.clientHeight, ratio = Math.min(2, devicePixelRatio || 1);
    if (!wide || !app.side) return;
    if (canvas.width !== Math.round(wide * ratio)) canvas.width = Math.round(wide * ratio);
    if (canvas.height !== Math.round(high * ratio)) canvas.height = Math.round(high * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { ink, zones } = app.stages[0].palette, end = app.end(), sides = app.stages;
    context.clearRect(0, 0, wide, high);
    const top = 15, tall = (high - top) / sides.length;
    sides.forEach((stage, s) => {
      if (!stage.plan) return;
      const y = top + s * tall;
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
      ticks(context, app, s, y, tall, wide, end, ink);
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
    canvas.setAttribute("aria-valuetext", `${clock(app.state.time_s)} of ${clock(end)}, ${app.doing()}`);
  };
  /** @param {PointerEvent} event */
  const seek = event => {
    const box = canvas.getBoundingClientRect();
    app.seek(((event.clientX - box.left) / box.width) * app.end());
  };
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    seek(event);
  });
  canvas.addEventListener("pointermove", event => { if (event.buttons) seek(event); });
  new ResizeObserver(draw).observe(canvas);
  app.on(draw);
  app.renewed(draw);
  app.recoloured(draw);
  draw();
}

/** @type {(context: CanvasRenderingContext2D, app: App, side: number, y: number, tall: number, wide: number, end: number, ink: Record<string, string>) => void} */
function ticks(context, app, side, y, tall, wide, end, ink) {
  const { plan, timeline } = app.stages[side];
  if (!plan) return;
  const selected = app.stages[side].scenery.cutOf.get(app.state.selected);
  plan.cuts.forEach((cut, k) => {
    const colour = cut.excused.length ? ink.alert : cut.wait_s ? ink.travel : "";
    if (!colour) return;
    context.fillStyle = colour;
    context.fillRect((timeline.begins_s[k] / end) * wide - 1, y + tall - 6, 2, 6);
  });
  if (selected === undefined) return;
  const from = (timeline.begins_s[selected] / end) * wide, to = (timeline.ends_s[selected] / end) * wide;
  context.fillStyle = ink.select;
  context.fillRect(from, y, Math.max(3, to - from), 3);
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
    if (x < wide - 30) context.fillText(clock(at), x + 3, 10);
  }
}
