// The stitched line a little inside the rim of a flat body, stuck to its triangles so that it follows them.

import { THREE } from "nicegui-scene";

const INSET = 0.016; // as a share of the body's size, as in the report
const FINE = 320; // points on a ring as long as the whole rim

/** The closed loops of a rim, as indices of nodes; the body lies to the left of each. */
export function loops(rim, rest) {
  const next = new Map();
  for (let i = 0; i < rim.length; i += 2) {
    for (const [a, b] of [[rim[i], rim[i + 1]], [rim[i + 1], rim[i]]]) {
      if (!next.has(a)) next.set(a, []);
      next.get(a).push(b);
    }
  }
  const found = [], used = new Set();
  for (const start of next.keys()) {
    if (used.has(start)) continue;
    const loop = [start];
    used.add(start);
    for (let here = start; ; ) {
      const on = next.get(here).find((node) => !used.has(node));
      if (on === undefined) break;
      loop.push(on);
      used.add(on);
      here = on;
    }
    if (loop.length > 2) found.push(loop);
  }
  const areas = found.map((loop) => area(loop.map((node) => [rest[3 * node], rest[3 * node + 1]])));
  const largest = areas.reduce((best, value, i) => (Math.abs(value) > Math.abs(areas[best]) ? i : best), 0);
  found.forEach((loop, i) => {
    if (areas[i] > 0 !== (i === largest)) loop.reverse();
  });
  if (found.length) found.unshift(...found.splice(largest, 1));
  return found;
}

export function area(ring) {
  let sum = 0;
  for (let i = 0; i < ring.length; i++) {
    const [a, b] = [ring[i], ring[(i + 1) % ring.length]];
    sum += a[0] * b[1] - b[0] * a[1];
  }
  return sum / 2;
}

/** A ring moved to its left; what would come too near to any ring is left out. */
export function inset(ring, rings, distance) {
  const moved = [];
  for (let i = 0; i < ring.length; i++) {
    const [p, q, r] = [ring[(i + ring.length - 1) % ring.length], ring[i], ring[(i + 1) % ring.length]];
    const [x, y] = [r[0] - p[0], r[1] - p[1]];
    const length = Math.hypot(x, y) || 1;
    const spot = [q[0] - (distance * y) / length, q[1] + (distance * x) / length];
    if (rings.every((other) => clear(spot, other, 0.93 * distance))) moved.push(spot);
  }
  return moved;
}

function clear([x, y], ring, distance) {
  for (let i = 0; i < ring.length; i++) {
    const [a, b] = [ring[i], ring[(i + 1) % ring.length]];
    const [u, v] = [b[0] - a[0], b[1] - a[1]];
    const share = Math.min(Math.max(((x - a[0]) * u + (y - a[1]) * v) / (u * u + v * v || 1), 0), 1);
    if (Math.hypot(a[0] + share * u - x, a[1] + share * v - y) < distance) return false;
  }
  return true;
}

function finer(ring, step) {
  const points = [];
  for (let i = 0; i < ring.length; i++) {
    const [a, b] = [ring[i], ring[(i + 1) % ring.length]];
    const pieces = Math.max(1, Math.round(Math.hypot(b[0] - a[0], b[1] - a[1]) / step));
    for (let k = 0; k < pieces; k++) points.push([a[0] + (k / pieces) * (b[0] - a[0]), a[1] + (k / pieces) * (b[1] - a[1])]);
  }
  return points;
}

/** The triangle that holds a point, and the point's shares of its corners; null if none does. */
export function within(x, y, nodes, faces) {
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ux = nodes[b] - nodes[a], uy = nodes[b + 1] - nodes[a + 1];
    const vx = nodes[c] - nodes[a], vy = nodes[c + 1] - nodes[a + 1];
    const whole = ux * vy - uy * vx;
    const s = ((x - nodes[a]) * vy - (y - nodes[a + 1]) * vx) / whole;
    const t = (ux * (y - nodes[a + 1]) - uy * (x - nodes[a])) / whole;
    if (s >= -1e-6 && t >= -1e-6 && s + t <= 1 + 1e-6) return { face: f, shares: [1 - s - t, s, t] };
  }
  return null;
}

export class Seam {
  constructor(rim, rest, faces) {
    const closed = loops(rim, rest);
    const rough = closed.map((loop) => loop.map((node) => [rest[3 * node], rest[3 * node + 1]]));
    const flat = rough.flat();
    const size = Math.hypot(...[0, 1].map((k) => flat.reduce((most, p) => Math.max(most, p[k]), -1e9) - flat.reduce((least, p) => Math.min(least, p[k]), 1e9)));
    const length = rim.length ? rough.reduce((sum, ring) => sum + ring.reduce((s, p, i) => s + Math.hypot(p[0] - ring[(i + 1) % ring.length][0], p[1] - ring[(i + 1) % ring.length][1]), 0), 0) : 0;
    const fine = rough.map((ring) => finer(ring, length / FINE));
    const rings = fine.map((ring) => inset(ring, rough, INSET * size)).filter((ring) => ring.length > 8);
    this.rims = closed;
    this.rings = [];
    const corners = [], shares = [], places = [];
    for (const ring of rings) {
      const indices = [];
      for (const [x, y] of ring) {
        const home = within(x, y, rest, faces);
        if (!home) continue;
        indices.push(places.length);
        places.push(new THREE.Vector2(x, y));
        corners.push(...[0, 1, 2].map((k) => 3 * faces[home.face + k]));
        shares.push(...home.shares);
      }
      if (indices.length > 8) this.rings.push(indices);
    }
    this.corners = new Uint32Array(corners);
    this.shares = new Float32Array(shares);
    this.position = new Float32Array(3 * places.length);
    const [outer, ...holes] = this.rings.map((ring) => ring.map((i) => places[i]));
    const order = this.rings.flat();
    const triangles = outer ? THREE.ShapeUtils.triangulateShape(outer, holes) : [];
    this.faces = new Uint32Array(triangles.flat().map((i) => order[i]));
    this.move(rest);
  }

  move(nodes) {
    const { corners, shares, position } = this;
    for (let i = 0; i < position.length; i += 3) {
      const a = corners[i], b = corners[i + 1], c = corners[i + 2];
      for (let k = 0; k < 2; k++) position[i + k] = shares[i] * nodes[a + k] + shares[i + 1] * nodes[b + k] + shares[i + 2] * nodes[c + k];
    }
  }
}
