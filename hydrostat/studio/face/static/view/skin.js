// The smooth rim of a flat body and the stitches a little inside it, stuck to its nodes so that they follow.

const INSET = 0.016; // as a share of the body's size, as in the report
const POINTS = 1600; // on all rims, about; an edge has four at most
const CORNER = Math.cos((60 * Math.PI) / 180); // what turns more is a corner, and stays one

/** The closed loops of a rim, as indices of nodes, the outer first; the body lies to the left of each. */
export function loops(rim, rest) {
  const next = new Map();
  const join = (a, b) => (next.has(a) ? next.get(a).push(b) : next.set(a, [b]));
  for (let i = 0; i < rim.length; i += 2) {
    join(rim[i], rim[i + 1]);
    join(rim[i + 1], rim[i]);
  }
  const found = [], used = new Set();
  for (const start of next.keys()) {
    const loop = [];
    const onward = (node) => next.get(node).find((other) => !used.has(other));
    for (let here = used.has(start) ? undefined : start; here !== undefined; here = onward(here)) {
      used.add(here);
      loop.push(here);
    }
    if (loop.length > 2) found.push(loop);
  }
  const areas = found.map((loop) => area(loop.map((node) => [rest[3 * node], rest[3 * node + 1]])));
  const largest = areas.reduce((best, value, i) => (Math.abs(value) > Math.abs(areas[best]) ? i : best), 0);
  found.forEach((loop, i) => areas[i] > 0 !== (i === largest) && loop.reverse());
  if (found.length) found.unshift(...found.splice(largest, 1));
  return found;
}

function area(ring) {
  return ring.reduce((sum, a, i) => {
    const b = ring[(i + 1) % ring.length];
    return sum + (a[0] * b[1] - b[0] * a[1]) / 2;
  }, 0);
}

/** A ring moved to its left; what would come too near to any ring is left out. */
function inset(ring, rings, distance) {
  const moved = [];
  for (let i = 0; i < ring.length; i++) {
    const p = ring[(i + ring.length - 1) % ring.length], q = ring[i], r = ring[(i + 1) % ring.length];
    const x = r[0] - p[0], y = r[1] - p[1];
    const length = Math.hypot(x, y) || 1;
    const spot = [q[0] - (distance * y) / length, q[1] + (distance * x) / length];
    if (rings.every((other) => isClear(spot, other, 0.95 * distance))) moved.push(spot);
  }
  return moved;
}

/**
 * Whether a place is so far from a ring.
 * @param {number[]} spot
 * @param {number[][]} ring
 * @param {number} distance
 */
function isClear(spot, ring, distance) {
  const [x, y] = spot;
  for (let i = 0; i < ring.length; i++) {
    const a = ring[i], b = ring[i + 1 === ring.length ? 0 : i + 1];
    const u = b[0] - a[0], v = b[1] - a[1];
    const share = Math.min(Math.max(((x - a[0]) * u + (y - a[1]) * v) / (u * u + v * v || 1), 0), 1);
    if ((a[0] + share * u - x) ** 2 + (a[1] + share * v - y) ** 2 < distance * distance) return false;
  }
  return true;
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

/** Points that are sums of nodes with weights, in rings. */
class Rings {
  constructor(rings, count) {
    this.count = count; // nodes that a point hangs on
    this.nodes = new Uint32Array(rings.flatMap((ring) => ring.flatMap((point) => point.nodes)));
    this.weights = new Float32Array(rings.flatMap((ring) => ring.flatMap((point) => point.weights)));
    this.lengths = rings.map((ring) => ring.length);
  }

  /** Where the points are when the nodes are in a table: for each ring [x, y, x, y ...]. */
  at(table) {
    let i = 0;
    return this.lengths.map((length) => {
      const ring = new Float32Array(2 * length);
      for (let k = 0; k < length; k++) {
        for (let n = 0; n < this.count; n++, i++) {
          ring[2 * k] += this.weights[i] * table[3 * this.nodes[i]];
          ring[2 * k + 1] += this.weights[i] * table[3 * this.nodes[i] + 1];
        }
      }
      return ring;
    });
  }
}

export class Skin {
  constructor(rim, rest, faces) {
    this.loops = loops(rim, rest);
    const pieces = Math.min(4, Math.max(1, Math.floor((2 * POINTS) / Math.max(rim.length, 1))));
    this.rim = new Rings(this.loops.map((loop) => smooth(loop, rest, pieces)), 4);
    const rings = this.rim.at(rest).map(pairs);
    const size = Math.max(extent(rings.flat(), 0), extent(rings.flat(), 1));
    const seams = rings.map((ring) => inset(ring, rings, INSET * size));
    const stuck = seams.map((ring) => ring.map(([x, y]) => within(x, y, rest, faces)).filter(Boolean).map(({ face, shares }) => ({
      nodes: [...faces.subarray(face, face + 3)], weights: shares,
    })));
    this.seam = new Rings(stuck.filter((ring) => ring.length > 8), 3);
  }
}

function extent(points, k) {
  const values = points.map((point) => point[k]);
  return Math.max(...values) - Math.min(...values);
}

function pairs(ring) {
  return Array.from({ length: ring.length / 2 }, (_, k) => [ring[2 * k], ring[2 * k + 1]]);
}

/** A curve through the nodes of a loop, by Hermite's polynomials. */
function smooth(loop, rest, pieces) {
  const at = (i) => loop[(i + loop.length) % loop.length];
  const bend = loop.map((node, i) => {
    const [a, b, c] = [at(i - 1), node, at(i + 1)].map((n) => [rest[3 * n], rest[3 * n + 1]]);
    const u = [b[0] - a[0], b[1] - a[1]], v = [c[0] - b[0], c[1] - b[1]];
    return (u[0] * v[0] + u[1] * v[1]) / (Math.hypot(...u) * Math.hypot(...v) || 1) < CORNER ? 0 : 0.5;
  });
  return loop.flatMap((_, i) => Array.from({ length: pieces }, (_, k) => {
    const t = k / pieces, u = 1 - t;
    const from = bend[i] * t * u * u, to = -bend[(i + 1) % loop.length] * t * t * u;
    const start = u * u * (1 + 2 * t), end = t * t * (3 - 2 * t);
    return { nodes: [at(i - 1), at(i), at(i + 1), at(i + 2)], weights: [-from, start - to, end + from, to] };
  }));
}
