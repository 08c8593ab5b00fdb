/** Unit tests of the page's modules that know no screen. The test in Python copies the modules to ../page_files. */
import assert from "node:assert/strict";
import test from "node:test";

import { Camera } from "../page_files/camera.js";
import { boundsOf, distanceTo, flattened, inside, simplified } from "../page_files/geometry.js";
import { History } from "../page_files/history.js";
import { nearestOn, placeAlong } from "../page_files/nearest.js";
import { listenToNews } from "../page_files/news.js";
import { Outlines } from "../page_files/outlines.js";
import { placeOf, scrolledBy } from "../page_files/places.js";
import { gapBetween, gapToEdge, inLine, PartChanges, placed } from "../page_files/poses.js";
import { paintNumbers } from "../page_files/numbers.js";
import { clockOf, reachedText } from "../page_files/planning.js";
import { joinOf, paintRoute, paintStarts } from "../page_files/route.js";
import { noticeNear, noticesOf } from "../page_files/notices.js";
import { droppedOrders, notHeld } from "../page_files/unkept.js";
import { setLanguage, tr, trn } from "../page_files/say.js";
import { inWords } from "../page_files/sentences.js";
import { found } from "../page_files/search.js";
import { countUpTo, momentAt, timelineOf, zonesOf } from "../page_files/timeline.js";
import { clock, millimetres, proven, provenShort, reachedPlan, stateClass, stateText } from "../page_files/words.js";
import { placeOn, wayOf } from "../page_files/way.js";
import { Work } from "../page_files/work.js";
import { zoneAreas } from "../page_files/zones.js";

const near = (a, b, within = 1e-9) => assert.ok(Math.abs(a - b) <= within, `${a} is not ${b}`);

const CUT = {
  contour: 0, zone: 1, direction: "ccw", entry: [0, 0], from_s: 3, to_s: 9, stand_s: 1, wait_s: 1, length_mm: 20,
  because: [], linked: false, excused: [], tabs: [], path: [10, 0, 0, 20, 0, 0, 20, 10, 0], unlit: [], slow: [],
};
const SIDE = {
  made: 0, home: [0, 0], end_s: 20, pierces: [],
  cuts: [CUT, { ...CUT, contour: 1, zone: 2, from_s: 12, to_s: 18, wait_s: 0, path: [30, 10, 0, 40, 10, 0] }],
};

test("an arc keeps within the tolerance of its circle, whichever way it turns", () => {
  for (const bulge of [1, -1, 0.3, -0.3, 2, -2]) {
    const points = flattened([0, 0, bulge, 10, 0, 0], false, 0.01);
    const sweep = 4 * Math.atan(bulge), radius = 5 / Math.sin(sweep / 2);
    const centre = [5, radius * Math.cos(sweep / 2)];
    for (let k = 0; k < points.length; k += 2) near(Math.hypot(points[k] - centre[0], points[k + 1] - centre[1]), Math.abs(radius), 1e-9);
    const middle = points.length / 4 | 0;
    assert.equal(Math.sign(points[2 * middle + 1]), -Math.sign(bulge));
  }
});

test("two half circles make a circle, and its last chord is closed", () => {
  const points = flattened([-5, 0, 1, 5, 0, 1], true, 0.01);
  assert.deepEqual(boundsOf(points).map(v => Math.round(10 * v) / 10), [-5, -5, 5, 5]);
  assert.ok(points.length > 40);
});

test("a simplified line strays no farther than the tolerance, and keeps its ends", () => {
  const fine = flattened([0, 0, 0.5, 100, 0, -0.5, 200, 0, 0], false, 0.01);
  for (const tolerance of [0.1, 1, 10]) {
    const coarse = simplified(fine, tolerance);
    for (let k = 0; k < fine.length; k += 2) assert.ok(distanceTo(coarse, false, fine[k], fine[k + 1]) <= tolerance + 1e-9);
    assert.deepEqual([...coarse.slice(0, 2), ...coarse.slice(-2)], [0, 0, 200, 0]);
  }
  assert.ok(simplified(fine, 10).length < simplified(fine, 0.1).length);
});

test("inside and beside a ring", () => {
  const ring = [0, 0, 10, 0, 10, 10, 0, 10];
  assert.equal(inside(ring, 5, 5), true);
  assert.equal(inside(ring, 15, 5), false);
  near(distanceTo(ring, true, 5, -2), 2);
  near(distanceTo(ring, false, -3, 5), Math.hypot(3, 5));
});

test("what lies under the pointer stays there when it zooms, and goes along when it drags", () => {
  const camera = new Camera();
  camera.fit([0, 0, 200, 100], 800, 600);
  const before = camera.toSheet(300, 250);
  camera.zoom(3, 300, 250);
  camera.toSheet(300, 250).forEach((v, k) => near(v, before[k], 1e-9));
  camera.pan(10, -20);
  camera.toSheet(310, 230).forEach((v, k) => near(v, before[k], 1e-9));
  camera.toScreen(...camera.toSheet(17, 23)).forEach((v, k) => near(v, [17, 23][k], 1e-9));
});

test("a sheet that fits is seen whole", () => {
  const camera = new Camera();
  camera.fit([-50, 10, 6000, 1500], 390, 300, 16);
  for (const [x, y] of [[-50, 10], [6000, 1500]]) {
    const [px, py] = camera.toScreen(x, y);
    assert.ok(px >= 15.9 && px <= 374.1 && py >= 15.9 && py <= 284.1);
  }
});

const square = (id, x, y, size, kind = "outer", part = 0) => ({
  id, part, kind, closed: true, rows: [x, y, 0, x + size, y, 0, x + size, y + size, 0, x, y + size, 0],
});

test("the contour at a place is a near line, else the smallest that is around it", () => {
  const nest = { contours: [square("A", 0, 0, 100), square("A.hole", 40, 40, 20, "hole"), square("B", 200, 0, 50, "outer", 1)],
    bounds: [0, 0, 300, 100], sheet: [], left_out: [], parts: ["A", "B"] };
  const outlines = new Outlines(nest);
  assert.equal(outlines.at(50, 50, 1), 1);
  assert.equal(outlines.at(20, 20, 1), 0);
  assert.equal(outlines.at(39.5, 50, 1), 1);
  assert.equal(outlines.at(150, 50, 1), -1);
  assert.equal(outlines.at(225, 25, 1), 2);
});

test("farther away fewer points are drawn, and none is missed by a pixel", () => {
  const circle = { id: "C", part: 0, kind: "outer", closed: true, rows: [-50, 0, 1, 50, 0, 1] };
  const outlines = new Outlines({ contours: [circle], bounds: [-50, -50, 50, 50], sheet: [], left_out: [], parts: ["C"] });
  let before = Infinity;
  for (const scale of [20, 1, 0.1, 0.01]) {
    const points = outlines.points(0, Outlines.level(scale));
    assert.ok(points.length <= before);
    before = points.length;
    const fine = outlines.points(0, 0);
    for (let k = 0; k < fine.length; k += 2) assert.ok(scale * distanceTo(points, true, fine[k], fine[k + 1]) < 1);
  }
});

test("the program has no gap: travel, wait, pierce, cut, and the way home", () => {
  const timeline = timelineOf(SIDE);
  assert.deepEqual(timeline.moments.map(m => [m.does, m.from_s, m.to_s]), [
    ["travel", 0, 2], ["wait", 2, 3], ["pierce", 3, 4], ["cut", 4, 9], ["travel", 9, 12], ["pierce", 12, 13],
    ["cut", 13, 18], ["home", 18, 20]]);
  assert.deepEqual(timeline.begins_s, [3, 12]);
  assert.deepEqual(timeline.ends_s, [9, 18]);
  for (const [time_s, does, share, done] of [[1, "travel", 0.5, 0], [6.5, "cut", 0.5, 0], [9, "travel", 0, 1], [19, "home", 0.5, 2]]) {
    const now = momentAt(timeline, time_s);
    assert.deepEqual([now.moment.does, now.share, now.done], [does, share, done]);
  }
  assert.equal(momentAt(timeline, 20).moment, null);
  assert.equal(momentAt(timeline, 20).done, 2);
});

test("a plan without times is played at guessed ones", () => {
  const cuts = SIDE.cuts.map(cut => ({ ...cut, from_s: 0, to_s: 0, wait_s: 0, stand_s: 0 }));
  const timeline = timelineOf({ ...SIDE, cuts, end_s: 0 });
  assert.equal(timeline.timed, false);
  assert.ok(timeline.ends_s[0] > 0 && timeline.ends_s[1] > timeline.ends_s[0] && timeline.end_s > timeline.ends_s[1]);
});

test("holes of a pierce pass are made before the cut that they stand before", () => {
  const pierces = [{ contour: 0, at: [5, 5], before: 1, from_s: 1, to_s: 1.5 }];
  const [travel, pierce] = timelineOf({ ...SIDE, pierces }).moments;
  assert.deepEqual([travel.does, travel.to, pierce.does, pierce.from_s, pierce.to_s], ["travel", [5, 5], "pierce", 1, 1.5]);
});

test("zones follow each other on the ruler", () => {
  assert.deepEqual(zonesOf(SIDE, timelineOf(SIDE)), [{ zone: 1, from_s: 0, to_s: 9 }, { zone: 2, from_s: 9, to_s: 18 }]);
});

test("the torch goes evenly, and slower where it is told", () => {
  const even = wayOf(CUT), half = placeOn(even, 0.5);
  assert.deepEqual([half.x, half.y, half.along], [20, 0, 10]);
  const slow = placeOn(wayOf({ ...CUT, slow: [1, 3] }), 0.25);
  assert.deepEqual([slow.x, slow.y], [20, 0]);
  const end = placeOn(even, 1);
  assert.deepEqual([end.x, end.y], [20, 10]);
});

test("counting up to a limit", () => {
  assert.deepEqual([0, 1, 2.5, 3, 9].map(limit => countUpTo([1, 2, 3], limit)), [0, 1, 2, 3, 3]);
});

test("a number of the order comes first, then an id, then a part, then what holds the text", () => {
  const known = [{ id: "P12.outer", part: "P12", number: 3 }, { id: "P3.hole1", part: "P3", number: 1 },
    { id: "P3.outer", part: "P3", number: 2 }, { id: "X3", part: "", number: 0 }];
  assert.deepEqual(found("3", known), [0, 1, 2, 3]);
  assert.deepEqual(found("p3", known), [1, 2]);
  assert.deepEqual(found("P3.outer", known), [2]);
  assert.deepEqual(found("  ", known), []);
  assert.deepEqual(found("none", known), []);
});

test("times and lengths for people", () => {
  assert.deepEqual([0, 59.9, 61, 3725].map(clock), ["0:00", "0:59", "1:01", "1:02:05"]);
  assert.deepEqual([12.34, 567.8, 12345].map(millimetres), ["12.3 mm", "568 mm", "12.345 m"]);
});

test("green stands only over a plan that keeps every hard rule", () => {
  const said = ["kept", "kept but for", "broken"].map(kind => ({ kind, count: 3, short: "", told: "", for_operator: "" }));
  assert.deepEqual(said.map(one => stateClass(one)), ["good", "warn", "bad"]);
  assert.deepEqual(said.map(one => stateText(one)), ["every hard rule holds", "3 places not kept", "a hard rule is broken"]);
  assert.deepEqual(said.map(one => stateClass(one, true)), ["warn", "warn", "bad"], "nor before its program is checked");
  assert.equal(stateText(said[0], true), "program not checked yet");
});

test("what was dropped and is broken therefore is told once", () => {
  const rule = { id: "hull-before", breaches: [], excused: [{ contours: ["A", "B"], text: "A after B", why: "they clash" }] };
  const dropped = [{ rule: "hull-before", contours: ["B", "A"], why: "cycle" }, { rule: "hull-before", contours: ["C", "D"], why: "cycle" }];
  const side = { ...SIDE, rules: [rule], dropped };
  const [unkept, others] = [notHeld, droppedOrders].map(list => list(side).map(({ text, why }) => `${text} – ${why}`));
  assert.deepEqual(unkept, ["hull-before: A after B – they clash"], "as many as the plan's state counts");
  assert.deepEqual(others, ["hull-before: C before D – cycle"]);
});

test("numbers of the drawing never overlap", () => {
  const written = [];
  const context = { setLineDash: () => {}, strokeText: () => {}, fillText: (text, x, y) => written.push([text, x, y]) };
  const cuts = Array.from({ length: 200 }, (_, k) => ({ ...CUT, contour: k, path: [(k * 37) % 300, (k * 53) % 200, 0, 0, 0, 0] }));
  const contours = cuts.map((_, k) => ({ id: `P${k}`, part: k, kind: "outer" }));
  const scenery = {
    data: { nest: { contours, parts: [] } }, side: { ...SIDE, cuts }, cuts, cutOf: new Map(cuts.map((_, k) => [k, k])),
    outlines: { bounds: contours.map(() => [0, 0, 50, 50]) },
  };
  const ink = { text: "#000", halo: "#fff" };
  paintNumbers(context, new Camera(), { ink, zones: [] }, scenery, contours.map((_, k) => k), 11);
  assert.ok(written.length > 60 && written.length < 200, `${written.length} numbers`);
  const boxes = written.map(([text, x, y]) => [x - 3.3 * text.length, y - 5, x + 3.3 * text.length, y + 5]);
  for (const [k, a] of boxes.entries()) {
    for (const b of boxes.slice(k + 1)) assert.ok(a[0] >= b[2] || b[0] >= a[2] || a[1] >= b[3] || b[1] >= a[3], "two numbers meet");
  }
});

test("the place that is so far along an outline, round and round", () => {
  const square = [0, 0, 10, 0, 10, 10, 0, 10];
  assert.deepEqual([0, 4, 13, 35, 40, 44].map(mm => placeAlong(square, mm)).map(({ x, y }) => [x, y]), [[0, 0], [4, 0], [10, 3], [0, 5], [0, 0], [4, 0]]);
  assert.deepEqual(placeAlong(square, -5), { x: 0, y: 5 });
  assert.deepEqual(placeAlong([7, 7], 3), { x: 7, y: 7 });
});

test("the place of an outline that is nearest, on its last side too, at a corner and on a point", () => {
  const square = [0, 0, 10, 0, 10, 10, 0, 10];
  assert.deepEqual(nearestOn(square, true, 4, -3), { x: 4, y: 0, away: 3 });
  assert.deepEqual(nearestOn(square, true, -2, 5), { x: 0, y: 5, away: 2 });
  assert.deepEqual(nearestOn(square, false, -2, 5), { x: 0, y: 0, away: Math.hypot(2, 5) });
  assert.deepEqual(nearestOn(square, true, 13, 14), { x: 10, y: 10, away: 5 });
  assert.deepEqual(nearestOn([7, 7], true, 7, 9), { x: 7, y: 7, away: 2 });
});

test("a run that is dropped on a later row ends there, on an earlier one begins there", () => {
  assert.equal(placeOf({ names: ["a"], from: 3, to: 1 }), 2);
  assert.equal(placeOf({ names: ["a"], from: 1, to: 3 }), 4);
  assert.equal(placeOf({ names: ["a", "b", "c"], from: 3, to: 6 }), 5);
  assert.equal(placeOf({ names: ["a", "b", "c"], from: 2, to: 0 }), 1);
});

test("a list scrolls the faster the nearer the pointer is to its end, and not from its middle", () => {
  const box = { top: 100, bottom: 500 };
  assert.deepEqual([90, 100, 120, 140, 300, 460, 480, 500, 700].map(y => scrolledBy(box, y)), [-1, -1, -0.5, 0, 0, 0, 0.5, 1, 1]);
});

test("what comes late is not taken for what is drawn, and no number is of a plan that is not drawn", async context => {
  const answers = [];
  context.mock.method(globalThis, "fetch", () => new Promise(done => answers.push(of => done({ ok: true, json: async () => of }))));
  const work = new Work("nest");
  const alternatives = [{ number: 2 }, { number: 3 }], told = text => ({ text, sides: [] });
  work.state = { version: 2, shown: 2, sha256: "a", fits: true, alternatives };
  const first = work.page();
  answers[0](told("plan 2"));
  await first;
  assert.deepEqual([work.isDrawn, work.free, work.data.text], [true, true, "plan 2"]);
  work.compared = [2, 1];
  const both = work.page();
  assert.equal(work.isDrawn, false);
  work.compared = null;
  const again = work.page();
  answers[2](told("plan 2 again"));
  await again;
  answers[1](told("plans 2 and 1"));
  assert.equal((await both).text, "plans 2 and 1");
  assert.deepEqual([work.isDrawn, work.free, work.data.text], [true, true, "plan 2 again"]);
  work.state = { version: 3, shown: 3, sha256: "a", fits: true, alternatives };
  assert.deepEqual([work.isDrawn, work.free], [false, false]);
  work.data.sides = [{ cuts: [{ torch: 1 }, { torch: 2 }] }];
  assert.match(work.whyNot, /several torches/);
});

test("a tab whose stream is refused leaves the lock to the next one, and asks again", async context => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const streams = [], held = [];
  class EventSource extends EventTarget {
    static CLOSED = 2;
    readyState = 0;
    constructor() { super(); streams.push(this); }
  }
  const request = async (name, fn) => { held.push(name); await fn(); held.pop(); };
  const globals = { EventSource, navigator: { locks: { request } }, addEventListener: () => {}, BroadcastChannel: class extends EventTarget { postMessage() {} } };
  for (const [name, value] of Object.entries(globals)) Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
  const heard = [];
  const some = () => new Promise(done => setImmediate(done));
  listenToNews((what, told) => heard.push([what, told]));
  streams[0].dispatchEvent(new Event("error")); // the server is gone: the browser asks again by itself
  await some();
  assert.deepEqual([streams.length, held.length], [1, 1]);
  streams[0].readyState = EventSource.CLOSED;
  streams[0].dispatchEvent(new Event("error"));
  await some();
  assert.deepEqual([streams.length, held.length], [1, 0]);
  assert.deepEqual(heard.splice(0), [["connection", { lost: true }], ["connection", { lost: true }]]); // and it is said
  context.mock.timers.tick(3000);
  await some();
  assert.deepEqual([streams.length, held.length], [2, 1]);
  streams[1].dispatchEvent(new MessageEvent("planner", { data: '{"nest": "a.dxf"}' }));
  assert.deepEqual(heard, [["planner", { nest: "a.dxf" }]]);
});

test("of one server a later state counts, of another server any", () => {
  const work = new Work("nest"), at = () => [work.state.server, work.state.version];
  work.take({ server: "a", version: 7, shown: 1 });
  const view = work.view;
  work.take({ server: "a", version: 6, shown: 2 });
  assert.deepEqual([...at(), work.view], ["a", 7, view]);
  work.take({ server: "b", version: 1, shown: 1 });
  assert.deepEqual(at(), ["b", 1]);
  assert.notEqual(work.view, view); // its plan 1 is another one
  work.take({ server: "b", version: 2 });
  assert.deepEqual(at(), ["b", 2]);
});

test("a gap is said as how far the best may be, places that are not kept aside", () => {
  const figures = { status: "feasible", gap: 0.0004, light_gap: 0.0108 };
  assert.equal(proven(figures), "at most 1.1 % from the best (places that are not kept aside)");
  assert.equal(provenShort(figures), "gap 1.1 %");
  assert.equal(proven({ ...figures, light_gap: null }), "at most 0.0 % from the best");
  assert.deepEqual(["optimal", "feasible"].map(status => proven({ status, gap: null, light_gap: null })), ["proven best", "nothing proven"]);
  assert.deepEqual(["optimal", "feasible"].map(status => provenShort({ status, gap: null, light_gap: null })), ["proven", "nothing proven"]);
});

test("texts are said in the language that is spoken, numbers of things by its rules", () => {
  const texts = { "{n} of {all}": "{n} из {all}", "{n} cut": ["{n} рез", "{n} реза", "{n} резов"] };
  setLanguage("ru", { ru: texts });
  assert.equal(tr("{n} of {all}", { n: 2, all: 3 }), "2 из 3");
  assert.deepEqual([1, 3, 5, 11, 21, 22].map(n => trn("{n} cut", "{n} cuts", n)), ["1 рез", "3 реза", "5 резов", "11 резов", "21 рез", "22 реза"]);
  assert.equal(tr("no such text"), "no such text");
  assert.equal(millimetres(12.5), "12,5 mm");
  setLanguage("en", {});
  assert.deepEqual([1, 2].map(n => trn("{n} cut", "{n} cuts", n)), ["1 cut", "2 cuts"]);
});

test("notices stand where they happen, and of more in one place the weightiest is told", () => {
  const nest = { contours: [{ id: "A", kind: "outer" }, { id: "B", kind: "mark" }] };
  const side = { ...SIDE, cuts: [{ ...SIDE.cuts[0], excused: ["pierce"] }, SIDE.cuts[1]] };
  const notices = noticesOf(nest, side, timelineOf(side));
  assert.deepEqual(notices.map(one => [one.kind, one.cut]), [["stop", 0], ["unkept", 0], ["loose", 0], ["mark", 1]]);
  assert.equal(noticeNear(notices, 2.9, 2).kind, "unkept");
  assert.equal(noticeNear(notices, 50, 1), null);
  const held = { ...side, cuts: side.cuts.map(cut => ({ ...cut, tabs: [[0, 0, 1]] })) };
  assert.ok(!noticesOf(nest, held, timelineOf(held)).some(one => one.kind === "loose"), "what tabs hold does not come loose");
});

test("a zone is the convex ring around its contours", () => {
  const bounds = [[0, 0, 10, 10], [20, 5, 30, 25], [100, 0, 110, 10]];
  const cuts = [{ contour: 0, zone: 1 }, { contour: 1, zone: 1 }, { contour: 2, zone: 2 }];
  const [one, two] = zoneAreas(cuts, bounds);
  assert.deepEqual([one.zone, one.cuts, one.last, two.zone, two.cuts, two.last], [1, 2, 1, 2, 1, 2]);
  assert.deepEqual(two.middle, [105, 5]);
  for (const [x0, y0, x1, y1] of bounds.slice(0, 2)) assert.ok(inside(one.hull, (x0 + x1) / 2, (y0 + y1) / 2));
  assert.equal(inside(one.hull, 60, 5), false);
});

const SQUARE = (x, y, size) => [x, y, x + size, y, x + size, y + size, x, y + size];
const BLOCK = (x, y, size, ...holes) => ({ outer: SQUARE(x, y, size), holes });

test("how near two parts come, and where they collide", () => {
  const a = BLOCK(0, 0, 10), gap = gapBetween(a, BLOCK(17.5, 2, 10));
  near(gap.mm, 7.5);
  near(gap.from[0], 10);
  near(gap.to[0], 17.5);
  assert.ok(gapBetween(a, BLOCK(9, 9, 10)).mm < 0, "they cross");
  assert.ok(gapBetween(BLOCK(0, 0, 100), BLOCK(40, 40, 10)).mm < 0, "one lies in the metal of the other");
  near(gapBetween(BLOCK(0, 0, 100, SQUARE(30, 30, 40)), BLOCK(40, 45, 10)).mm, 10);
  near(gapBetween(BLOCK(40, 45, 10), BLOCK(0, 0, 100, SQUARE(30, 30, 40))).mm, 10);
  assert.ok(gapBetween(BLOCK(25, 45, 10), BLOCK(0, 0, 100, SQUARE(30, 30, 40))).mm < 0, "half in the hole");
});

test("how far a part keeps from the edge of the sheet, and from its holes", () => {
  const sheet = [SQUARE(0, 0, 100)];
  near(gapToEdge(BLOCK(12, 40, 10), sheet).mm, 12);
  assert.ok(gapToEdge(BLOCK(95, 40, 10), sheet).mm < 0);
  assert.ok(gapToEdge(BLOCK(120, 40, 10), sheet).mm < 0);
  near(gapToEdge(BLOCK(12, 40, 10), [SQUARE(0, 0, 100), SQUARE(26, 40, 10)]).mm, 4);
  assert.ok(gapToEdge(BLOCK(28, 42, 4), [SQUARE(0, 0, 100), SQUARE(26, 40, 10)]).mm < 0);
});

test("changes of parts add up as kerfwise edit has them, and are undone and done again", () => {
  const changes = new PartChanges();
  for (const line of ["move P1 10 -5", "turn P1 90", 'mirror "P 2"', "move P1 1 1", "drop P3"]) changes.add(line);
  assert.deepEqual(changes.of("P1"), { turn_deg: 90, mirrored: false, dx: 11, dy: -4, dropped: false });
  assert.equal(changes.of("P 2").mirrored, true);
  assert.equal(changes.of("P3").dropped, true);
  assert.ok(changes.undo() && changes.undo());
  assert.deepEqual([changes.of("P1").dx, changes.of("P3").dropped], [10, false]);
  assert.ok(changes.redo());
  assert.equal(changes.of("P1").dx, 11);
  changes.add("turn P1 -90");
  assert.equal(changes.redo(), false);
  assert.equal(changes.of("P1").turn_deg, 0);
  assert.deepEqual(["P1", 'a "b"'].map(inLine), ["P1", '"a \\"b\\""']);
});

test("a part lies where it was turned over, turned and moved to", () => {
  const points = [0, 0, 10, 0, 10, 4], at = (lying) => [...placed(points, lying, [5, 2])].map(v => Math.round(1e6 * v) / 1e6 + 0);
  assert.deepEqual(at({ turn_deg: 0, mirrored: false, dx: 3, dy: -1 }), [3, -1, 13, -1, 13, 3]);
  assert.deepEqual(at({ turn_deg: 90, mirrored: false, dx: 0, dy: 0 }), [7, -3, 7, 7, 3, 7]);
  assert.deepEqual(at({ turn_deg: 0, mirrored: true, dx: 0, dy: 0 }), [10, 0, 0, 0, 0, 4]);
});

test("what further torches cut has the times of the first one, and a row of its own", () => {
  const timeline = timelineOf({ ...SIDE, cuts: [SIDE.cuts[0], { ...SIDE.cuts[0], contour: 2, torch: 2 }, SIDE.cuts[1]] });
  const alone = timelineOf(SIDE);
  assert.deepEqual([timeline.firsts, timeline.end_s], [[0, 2], alone.end_s]);
  assert.deepEqual(timeline.ends_s, [alone.ends_s[0], alone.ends_s[0], alone.ends_s[1]]);
  assert.deepEqual(timeline.moments.map(one => one.does), alone.moments.map(one => one.does));
  assert.equal(momentAt(timeline, alone.ends_s[0]).done, 2);
});

test("undo goes past the plans that were made of one change, and redo comes back", async () => {
  const asked = [], hearers = [];
  const work = {
    state: { shown: 1, job_text: null, upto: 0, alternatives: [{ number: 1 }] }, on: fn => hearers.push(fn), say: () => {}, hear: () => {},
    change: async (what, said) => { asked.push([what, said]); work.state = { ...work.state, shown: said.to, job_text: said.job_text }; return {}; },
    cancel: async () => {},
  };
  const history = new History(work), told = more => { work.state = { ...work.state, ...more }; hearers.forEach(fn => fn(work, "state")); };
  told({});
  told({ job_text: "locks: [C first]", solving: {} });
  told({ shown: 2, alternatives: [{ number: 1 }, { number: 2 }] });
  told({ shown: 3, solving: null, alternatives: [{ number: 1 }, { number: 2 }, { number: 3 }] });
  assert.deepEqual([history.can(-1), history.can(1)], [true, false]);
  await history.step(-1);
  assert.deepEqual(asked, [["back", { to: 1, job_text: null, upto: 0 }]], "one request, so that no lock of another plan is seen");
  assert.deepEqual([history.can(-1), history.can(1)], [false, true]);
  await history.step(1);
  assert.deepEqual(asked[1], ["back", { to: 3, job_text: "locks: [C first]", upto: 0 }]);
});

test("what the server says in English comes in the reader's language, with its names and numbers", () => {
  const move = "A.outer and 2 more cannot be cut as number 3: level-ahead: B.outer is cut before A.outer: it lies inside it, and cutting A.outer frees the metal it is in (and 1 more)";
  assert.equal(inWords(move), move);
  setLanguage("de", { de: {
    "{a} and {n} more cannot be cut as number {place}: {why} (and {more} more)": "{a} und {n} weitere nicht als {place}: {why} (und {more} weitere)",
    "{a} is cut before {b}: {why}": "{a} vor {b}: {why}", "{rule}: {why}": "{rule}: {why}",
    "it lies inside it, and cutting {a} frees the metal it is in": "es liegt darin, und {a} löst es", "{mm} mm more": "{mm} mm mehr",
  } });
  assert.equal(inWords(move), "A.outer und 2 weitere nicht als 3: level-ahead: B.outer vor A.outer: es liegt darin, und A.outer löst es (und 1 weitere)");
  assert.equal(inWords("12.5 mm more"), "12,5 mm mehr");
  for (const text of ["P.1 (x) said: so", "", "12.5 mm moreover"]) assert.equal(inWords(text), text);
  setLanguage("en", {});
});

test("the dense are thinned out: near by every pierce and way is drawn, from afar some", () => {
  const { Path2D: before } = globalThis;
  const paths = [];
  globalThis.Path2D = class { constructor() { this.arcs = 0; this.lines = 0; paths.push(this); } moveTo() {} lineTo() { this.lines++; } arc() { this.arcs++; } };
  const context = { setLineDash: () => {}, stroke: () => {}, fill: () => {}, beginPath: () => {}, moveTo: () => {}, lineTo: () => {} };
  const cuts = Array.from({ length: 400 }, (_, k) => {
    const x = 40 * (k % 20), y = 40 * Math.floor(k / 20);
    return { ...CUT, contour: k, entry: [x + 4, y], path: [x, y, 0, x + 4, y, 0, x + 20, y, 0, x + 20, y + 34, 0] };
  });
  const side = { ...SIDE, cuts }, palette = { ink: {}, zones: [] };
  const scenery = { side, cuts, cutOf: new Map(cuts.map((_, k) => [k, k])), way: k => wayOf(cuts[k]), outlines: { bounds: cuts.map(({ entry: [x, y] }) => [x, y, x + 30, y + 34]) } };
  const counted = scale => {
    paths.length = 0;
    const camera = Object.assign(new Camera(), { scale, x: 1000, y: 9000 });
    for (const _ of paintStarts(context, camera, palette, scenery, cuts.map((_, k) => k)));
    const [, pierces, ways] = paths.map(({ arcs, lines }) => arcs + lines);
    for (const _ of paintRoute(context, camera, palette, side, 0, { wide: 1e6, high: 1e6 }));
    return { pierces, ways, arrows: paths.slice(3).reduce((sum, { lines }) => sum + lines / 2, 0) };
  };
  const [near, far] = [counted(3), counted(0.1)];
  globalThis.Path2D = before;
  assert.equal(near.pierces, 400);
  assert.ok(near.ways >= 400 && near.arrows > 300, JSON.stringify(near));
  assert.ok(far.pierces > 10 && far.pierces < 100, `${far.pierces} pierces`);
  assert.equal(far.ways, 0);
  assert.ok(far.arrows < 20, `${far.arrows} arrows`);
});

test("the clock of a planning runs on between the news", context => {
  let now_ms = 5000;
  context.mock.method(performance, "now", () => now_ms);
  const solving = { elapsed_s: 3.4 };
  assert.equal(clockOf(solving), "3 s");
  now_ms += 2700;
  assert.equal(clockOf(solving), "6 s");
});

test("progress is told in a planner's words", () => {
  const told = (solving, work = {}) => reachedText({ waits: false, ending: "", gap: null, plan: null, gained_mm: 0, ...solving }, { planner: "a.dxf", state: { alternatives: [{ number: 1, stage: "first" }, { number: 2, stage: "better" }] }, ...work });
  assert.equal(told({ phase: "getting ready" }), "getting ready the first time (some 20 s) …");
  assert.equal(told({ phase: "first plan" }), "looking for a first plan …");
  assert.equal(told({ phase: "improving", plan: 1 }), "first plan; looking for a better plan …");
  assert.equal(told({ phase: "proving", plan: 2, gained_mm: 412, gap: 0.012 }), "better by 0.4 m; proving; at most 1.2 % from the best …");
  assert.equal(told({ phase: "proving", ending: "soon", plan: 2, gained_mm: 412 }), "better by 0.4 m; ending …");
  assert.equal(told({ waits: true, phase: "waits" }), "waits: a.dxf is being planned …");
});

test("the lead of a cut ends half a kerf from its entry", () => {
  assert.equal(joinOf([0, 0, 3, 0, 5, 0.75, 9, 0.75], [5, 0], 0.85), 2);
  assert.equal(joinOf([5, 0.75, 9, 0.75], [5, 0], 0.85), 0);
});

test("a plan that stays because the one made anew is dearer says so", () => {
  const figures = { idle_mm: 4200, status: "feasible", gap: 0.02, light_gap: null };
  const plans = [{ number: 1, run: 1, stage: "first", figures }, { number: 2, run: 1, stage: "better", figures }, { number: 3, run: 1, stage: "final", figures }];
  const shown = /^plan [23]: idle 4\.200.m, gap 2(\.0)?.%$/;
  assert.match(reachedPlan(plans, 3), shown);
  assert.match(reachedPlan(plans, 2), /^plan 2: .*%; it stays: plan 3, made anew, is dearer$/);
  assert.match(reachedPlan([...plans, { number: 4, run: 2, stage: "final", figures }], 3), shown);
  assert.equal(reachedPlan([], 0), "");
});
