// How lines look: which strips of which width and colour are drawn for the lines of a scene, the rim and the seam.

import { mix, ramp } from "./theme.js";

const LAYERS = { ghost: 0, rim: 1, seam: 2, sheath: 3, halo: 4, casing: 5, path: 6, cable: 7, miss: 8 };

function range(first, count) {
  return Array.from({ length: count }, (_, k) => first + k);
}

function closed(ring) {
  return ring.length ? [...ring, ring[0]] : ring;
}

/** Width and colour of a cable under its load: thicker, and towards the colours of tension. */
export function cableLook(view, line) {
  const load = Math.min(Math.max(line.load ?? 0, 0), 1);
  const towards = ramp(view.palette.tension, 0.25 + 0.75 * load);
  return { width: 2.5 + 3.5 * load, colour: mix(line.colour, towards, Math.min(1, 2.2 * load)) };
}

/** All strips of a view, for `Strokes.lay`. */
export function strokeLines(view) {
  const { palette, theme, seam } = view;
  const laid = [];
  if (seam) {
    for (const [name, { thing }] of Object.entries(view.ghosts)) {
      const colour = thing.colour === palette.ghost ? theme.ghost : thing.colour;
      for (const rim of seam.rims) {
        laid.push({ source: `ghost:${name}`, points: closed(rim), width: 1.4, colour, opacity: 0.75, layer: LAYERS.ghost });
      }
    }
    for (const rim of seam.rims) laid.push({ source: "nodes", points: closed(rim), width: 2.2, colour: palette.seam, layer: LAYERS.rim });
    for (const ring of seam.rings) {
      laid.push({ source: "seam", points: closed(ring), width: 1.8, colour: palette.stitch, dash: [5, 4], layer: LAYERS.seam });
    }
  }
  for (const line of view.lines) laid.push(...ofLine(view, line));
  return laid;
}

function ofLine(view, line) {
  const { palette, theme } = view;
  const colour = line.colour === view.ink ? theme.ink : line.colour;
  const base = { source: "points", points: range(line.first, line.count) };
  if (line.stroke === "sheath") {
    return [{ ...base, width: 10, colour: mix(line.colour, palette.light, 0.68), under: true, layer: LAYERS.sheath }];
  }
  if (line.stroke === "miss") {
    return [{ ...base, width: 1.6, colour, dash: [5, 4], opacity: 0.9, layer: LAYERS.miss }];
  }
  if (line.stroke === "rim") return [{ ...base, width: 2.2, colour, layer: LAYERS.path }];
  if (line.stroke === "path") return [{ ...base, width: 2, colour, opacity: 0.9, layer: LAYERS.path }];
  const { width } = cableLook(view, line);
  const strips = [
    { ...base, width: width + 2.6, colour: palette.light, cable: line, casing: true, under: true, layer: LAYERS.casing },
    { ...base, width, colour: line.colour, cable: line, layer: LAYERS.cable },
  ];
  if (line.chosen) strips.unshift({ ...base, width: 15, colour: mix(line.colour, palette.light, 0.45), under: true, layer: LAYERS.halo });
  return strips;
}
