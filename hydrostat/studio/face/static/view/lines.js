// Cables, sheaths, paths and what is still missed, with widths in pixels.

import { FAINT, mix, ramp, veil } from "./theme.js";

const PIECE = 7; // a line in space is looked at so often [px]
const FRONT = 0, INSIDE = 1, BEHIND = 2;

/** Width and color of a cable under its load: thicker, and towards the colors of tension. */
function cableLook(view, line) {
  const load = Math.min(Math.max(line.load ?? 0, 0), 1);
  const towards = ramp(view.palette.tension, load);
  return { width: 2.5 + 3.5 * load, color: load > 0.02 ? mix(line.color, towards, Math.min(0.9, 0.35 + load)) : line.color };
}

/** The strips a line is drawn of, the lowest first: [layer, width, color, dash]. */
function strips(view, line) {
  const { palette, theme } = view;
  const color = line.color === view.ink ? theme.ink : line.color;
  if (line.stroke === "sheath") return [[0, 10, mix(line.color, palette.light, 0.68)]];
  if (line.stroke === "miss") return [[5, 1.8, color, [5, 4]]];
  if (line.stroke === "rim") return [[3, 2.2, color]];
  if (line.stroke === "drawn") return [[0, 2, line.color]];
  if (line.stroke === "path") return [[3, 2, color, line.chosen ? null : [7, 4]]];
  const look = cableLook(view, line);
  const layers = [[2, look.width + 2.6, palette.light], [4, look.width, look.color]];
  if (line.chosen) layers.push([1, 16, mix(line.color, palette.light, 0.45)]);
  else if (line.key && line.key === view.hover) layers.push([1, 13, mix(line.color, palette.light, 0.6)]);
  return layers;
}

/** The runs of a line: [kind, [x, y, x, y ...]]; in the plane just one. */
function runs(view, line) {
  const { camera, cover, points } = view;
  const flat = camera.flat;
  const found = [], here = [0, 0, 0], next = [0, 0, 0];
  let run = null;
  const add = (x, y, kind) => {
    if (!run || run[0] !== kind) {
      const joint = run ? run[1].slice(-2) : [];
      run = [kind, joint];
      found.push(run);
    }
    run[1].push(x, y);
  };
  for (let k = 0; k < line.count; k++) {
    const i = 3 * (line.first + k);
    camera.project(points[i], points[i + 1], points[i + 2], next);
    const length = flat || !k ? 0 : Math.hypot(next[0] - here[0], next[1] - here[1]);
    const pieces = Math.min(Math.max(Math.ceil(length / PIECE), 1), 200);
    for (let p = 1; p <= pieces; p++) {
      const share = k ? p / pieces : 1;
      const [x, y, z] = [0, 1, 2].map((m) => here[m] + share * (next[m] - here[m]));
      add(x, y, flat ? FRONT : Math.min(cover.layers(x, y, z), BEHIND));
    }
    [here[0], here[1], here[2]] = next;
  }
  return found;
}

/** Draw all lines of a view. */
export function drawLines(pen, view) {
  const layers = [[], [], [], [], [], []];
  for (const line of view.lines) {
    const own = runs(view, line);
    const veiled = line.faint ? FAINT : 1;
    for (const [layer, width, color, dash] of strips(view, line)) layers[layer].push({ layer, own, width, color, dash, veiled });
  }
  const inside = 0.55 + 0.35 * (1 - view.opacity);
  for (const kind of [BEHIND, INSIDE, FRONT]) {
    for (const layer of layers) {
      for (const { layer: level, own, width, color, dash, veiled } of layer) {
        if (kind !== FRONT && level === 2) continue; // only what is before the body needs a rim
        pen.globalAlpha = veiled * (kind === FRONT ? 1 : kind === INSIDE ? inside : 0.55 * inside);
        pen.lineWidth = width;
        pen.strokeStyle = color;
        pen.lineCap = kind === FRONT && !dash ? "round" : "butt";
        pen.setLineDash(dash ?? []);
        pen.beginPath();
        for (const [of, spots] of own) {
          if (of !== kind) continue;
          pen.moveTo(spots[0], spots[1]);
          for (let i = 2; i < spots.length; i += 2) pen.lineTo(spots[i], spots[i + 1]);
        }
        pen.stroke();
      }
    }
  }
  pen.globalAlpha = 1;
  pen.setLineDash([]);
  pen.lineCap = "round";
}

/** Draw all clouds of a view. */
export function drawClouds(pen, view) {
  const spot = [0, 0, 0];
  for (const { item, array } of Object.values(view.clouds)) {
    const held = item.name === "pins"; // what is held is seen at once, what can be reached is a mist
    const radius = held ? 2.1 : 1.7;
    for (const hidden of view.camera.flat ? [false] : [true, false]) {
      pen.fillStyle = veil(item.color, hidden ? 0.16 : held ? 0.85 : 0.5);
      pen.beginPath();
      for (let i = 0; i < array.length; i += 3) {
        view.camera.project(array[i], array[i + 1], array[i + 2], spot);
        if (!view.camera.flat && view.cover.layers(...spot) > 0 !== hidden) continue;
        pen.moveTo(spot[0] + radius, spot[1]);
        pen.arc(spot[0], spot[1], radius, 0, 7);
      }
      pen.fill();
    }
  }
}
