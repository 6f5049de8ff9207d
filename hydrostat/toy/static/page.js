// The page: a canvas to drag on, knobs, poses and the words about how it was made.

import { Model, decode, reach } from "./model.js";
import { Sight } from "./sight.js";
import { draw } from "./drawing.js";
import { Surface } from "./surface.js";
import { Player } from "./player.js";
import { offerMotors } from "./motors.js";

const data = JSON.parse(document.getElementById("toy").textContent);
const model = new Model(data);
const player = new Player();
let inputs = model.rest.slice();
let points = model.points(inputs);
const sight = new Sight({ dim: data.dim, up: data.up, eye: data.eye, points, size: data.size });
const body = data.groups.find(([kind]) => kind === "surface");
const [below, above] = ["below", "above"].map((id) => /** @type {HTMLCanvasElement} */ (document.getElementById(id)));
below.hidden = !body;
const surface = body ? new Surface(below, Uint32Array.from(decode(data.faces, Uint32Array)), body[1], body[2]) : null;
const paper = above.getContext("2d");
const held = new Map(); // pointers that hold a point or turn the view
const state = { held: -1, goal: null, ink: "#000", dots: Boolean(surface && !surface.gl) };
let kept = []; // markers that better stay while another point is dragged
let asked = false, resting = 0;
let box = above.getBoundingClientRect(); // where the canvas is on the page

/** Ask for one picture at the next frame of the screen. */
function redraw() {
  if (!asked) requestAnimationFrame(step);
  asked = true;
}

function step(now) {
  asked = false;
  if (player.plays) {
    move(model.scaled(player.at(now / 1000)));
    if (!player.plays) mark(null);
  } else if (state.goal) {
    inputs = reach(model, inputs, state.held, state.goal, { size: data.size, kept });
    settle();
  }
  surface?.paint(sight, points);
  clearTimeout(resting);
  resting = surface ? setTimeout(() => surface.paint(sight, points, true), 200) : 0;
  draw(paper, sight, data, points, state);
  if (player.plays) redraw();
}

function move(to) {
  inputs = Array.from(to, (value) => Math.min(1, Math.max(-1, value)));
  settle();
}

/** Show where the winches stand. */
function settle() {
  points = model.points(inputs);
  const taken = model.contractions(inputs);
  knobs.forEach((knob, i) => {
    const { unit, factor } = data.winches[i], words = unit ? `${(factor * taken[i]).toFixed(1)} ${unit}` : taken[i].toFixed(2);
    if (knob.value.textContent === words) return; // to write it costs a layout of the page
    knob.slider.value = String(factor * taken[i]);
    knob.value.textContent = words;
  });
}

/** Show which button's pose is played; null for none. */
function mark(played) {
  for (const button of document.querySelectorAll("#poses button")) button.setAttribute("aria-pressed", String(button === played));
}

function resize() {
  const dense = window.devicePixelRatio || 1;
  box = above.getBoundingClientRect();
  Object.assign(above, { width: Math.round(box.width * dense), height: Math.round(box.height * dense) });
  paper.setTransform(dense, 0, 0, dense, 0, 0);
  sight.fit(box.width, box.height);
  redraw();
}

/** Number of the point near some pixels: a marker if one is near, else a point of the body; -1 if none is. */
function find(x, y, reachOf) {
  let best = -1, least = Infinity;
  for (const [kind, first, count] of data.groups) {
    if (!["marker", "outline", "surface"].includes(kind)) continue;
    const favor = kind === "marker" ? 0.4 : 1;
    for (let i = first; i < first + count; i++) {
      const [px, py, depth] = sight.see(points, data.dim * i);
      const far = Math.hypot(px - x, py - y);
      const score = favor * far - (kind === "surface" ? (8 * depth) / data.size : 0);
      if (far < reachOf && score < least) [best, least] = [i, score];
    }
  }
  return best;
}

function placeOf(point) {
  return Array.from(points.subarray(data.dim * point, data.dim * (point + 1)));
}

/** Markers with their places now, but those near a point, which go with it. */
function others(point) {
  const [, first, count] = data.groups.find(([kind]) => kind === "marker"), here = placeOf(point);
  const all = Array.from({ length: count }, (_, i) => ({ point: first + i, target: placeOf(first + i) }));
  return all.filter(({ target }) => Math.hypot(...target.map((value, axis) => value - here[axis])) > 0.15 * data.size);
}

function press(event) {
  box = above.getBoundingClientRect();
  state.ink = getComputedStyle(above).color;
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  const near = event.pointerType === "touch" ? 44 : 26;
  const point = held.size ? -1 : find(x, y, near);
  above.setPointerCapture(event.pointerId);
  held.set(event.pointerId, { x, y, point });
  player.stop();
  mark(null);
  if (point >= 0) {
    state.held = point;
    state.goal = placeOf(point);
    kept = others(point);
  }
  document.body.classList.add("touched");
  redraw();
}

function drag(event) {
  const pointer = held.get(event.pointerId);
  if (!pointer) box = above.getBoundingClientRect(); // which costs a layout where knobs turn
  const [x, y] = [event.clientX - box.left, event.clientY - box.top];
  if (!pointer) {
    above.style.cursor = find(x, y, 26) >= 0 ? "grab" : data.dim === 3 ? "move" : "default";
    return;
  }
  if (pointer.point >= 0) {
    state.goal = sight.place(x, y, points.subarray(data.dim * pointer.point, data.dim * (pointer.point + 1)));
  } else if (data.dim === 3 && held.size === 1) {
    sight.yaw -= 0.01 * (x - pointer.x);
    sight.pitch = Math.max(-1.5, Math.min(1.5, sight.pitch + 0.01 * (y - pointer.y)));
    sight.turn();
  }
  [pointer.x, pointer.y] = [x, y];
  redraw();
}

function release(event) {
  const pointer = held.get(event.pointerId);
  held.delete(event.pointerId);
  if (pointer?.point >= 0) [state.held, state.goal] = [-1, null];
  redraw();
}

function turnWheel(event) {
  event.preventDefault();
  sight.zoom = Math.max(0.4, Math.min(4, sight.zoom * Math.exp(-0.0015 * event.deltaY)));
  sight.fit(sight.width, sight.height);
  redraw();
}

/** Play from a button, or stop what it plays. */
function playFrom(button, start) {
  const on = button.getAttribute("aria-pressed") === "true";
  player.stop();
  mark(null);
  if (!on) {
    mark(button);
    start(model.contractions(inputs), performance.now() / 1000);
  }
  document.body.classList.add("touched");
  redraw();
}

function addButton(text, start) {
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = text;
  button.setAttribute("aria-pressed", "false");
  button.addEventListener("click", () => playFrom(button, start));
  document.getElementById("poses").append(button);
}

const knobs = data.winches.map((winch, i) => {
  const row = document.createElement("label"), name = document.createElement("span");
  const slider = document.createElement("input"), value = document.createElement("output");
  row.className = "knob";
  row.style.setProperty("--winch", winch.color);
  name.textContent = winch.name;
  Object.assign(slider, { type: "range", min: String(winch.factor * winch.low), max: String(winch.factor * winch.high), step: winch.unit ? "0.1" : "0.01" });
  slider.disabled = !(winch.high > winch.low);
  slider.addEventListener("input", () => {
    player.stop();
    mark(null);
    const taken = model.contractions(inputs);
    taken[i] = Number(slider.value) / winch.factor;
    move(model.scaled(taken));
    redraw();
  });
  row.append(name, slider, value);
  document.getElementById("knobs").append(row);
  return { slider, value };
});

const still = data.winches.map(() => 0);
for (const pose of data.poses) addButton(pose.name, (from, now) => player.visit(from, [pose.contractions], now));
const all = data.poses.map((pose) => pose.contractions);
if (data.moves.length > 1) addButton("Moves", (from, now) => player.follow(from, data.moves, now));
if (all.length > 1) addButton("All poses", (from, now) => player.visit(from, [...all, still], now));
addButton("Rest", (from, now) => player.visit(from, [still], now));

offerMotors(data.motors, {
  goal: () => model.contractions(inputs),
  meet: (places) => {
    player.stop();
    state.goal = null;
    move(model.scaled(places).map((value) => Math.min(1, Math.max(-1, value))));
    redraw();
  },
});

above.addEventListener("pointerdown", press);
above.addEventListener("pointermove", drag);
for (const end of ["pointerup", "pointercancel"]) above.addEventListener(end, release);
above.addEventListener("wheel", turnWheel, { passive: false });
new ResizeObserver(resize).observe(above);
settle();
resize();

/** For tests and benchmarks: the model, and what is shown. */
Object.assign(window, { toy: { model, reach, data, shown: () => ({ inputs, points, sight }) } });
