// What of a body in space lies before a point, and where its outline is, as the camera sees them.

const CELL = 20;

/** Each edge of some triangles once: [node, node, face, other face or -1]. */
export function edgesOf(faces) {
  const found = new Map();
  for (let f = 0; f < faces.length; f += 3) {
    for (let k = 0; k < 3; k++) {
      const a = Math.min(faces[f + k], faces[f + ((k + 1) % 3)]), b = Math.max(faces[f + k], faces[f + ((k + 1) % 3)]);
      const edge = found.get(a * 4294967 + b);
      if (edge) edge[3] = f / 3;
      else found.set(a * 4294967 + b, [a, b, f / 3, -1]);
    }
  }
  return new Int32Array([...found.values()].flat());
}

export class Cover {
  constructor(faces, count) {
    this.faces = faces;
    this.edges = edgesOf(faces);
    this.spots = new Float32Array(3 * count); // pixels and depth of each node
    this.front = new Int8Array(faces.length / 3); // 1: faces the camera, -1: does not
    /** @type {number[][]} */
    this.cells = [];
    this.nodes = new Float32Array();
    /** @type {number[] | null} */
    this.cut = null;
  }

  /** Look at the nodes again. */
  see(nodes, camera, cut) {
    const { spots, faces, front } = this;
    Object.assign(this, { nodes, cut });
    const out = [0, 0, 0];
    for (let i = 0; i < nodes.length; i += 3) {
      camera.project(nodes[i], nodes[i + 1], nodes[i + 2], out);
      spots[i] = out[0]; spots[i + 1] = out[1]; spots[i + 2] = out[2];
    }
    this.across = Math.ceil(camera.width / CELL);
    this.down = Math.ceil(camera.height / CELL);
    const count = this.across * this.down;
    while (this.cells.length < count) this.cells.push([]);
    for (const cell of this.cells) cell.length = 0;
    for (let f = 0; f < faces.length; f += 3) {
      const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
      const turn = (spots[b] - spots[a]) * (spots[c + 1] - spots[a + 1]) - (spots[b + 1] - spots[a + 1]) * (spots[c] - spots[a]);
      front[f / 3] = turn < 0 ? 1 : -1; // pixels count downwards
      const left = Math.max(Math.floor(Math.min(spots[a], spots[b], spots[c]) / CELL), 0);
      const right = Math.min(Math.floor(Math.max(spots[a], spots[b], spots[c]) / CELL), this.across - 1);
      const top = Math.max(Math.floor(Math.min(spots[a + 1], spots[b + 1], spots[c + 1]) / CELL), 0);
      const bottom = Math.min(Math.floor(Math.max(spots[a + 1], spots[b + 1], spots[c + 1]) / CELL), this.down - 1);
      for (let y = top; y <= bottom; y++) for (let x = left; x <= right; x++) this.cells[y * this.across + x].push(f);
    }
    this.slack = camera.slack(0.006 * camera.reach);
  }

  /** How many layers of skin lie before a place: one if it is inside the body, two or more if it is behind. */
  layers(x, y, depth) {
    const { spots, faces, nodes, cut } = this;
    const column = Math.floor(x / CELL), row = Math.floor(y / CELL);
    if (!(column >= 0 && row >= 0 && column < this.across && row < this.down)) return 0;
    let count = 0;
    for (const f of this.cells[row * this.across + column]) {
      const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
      const ux = spots[b] - spots[a], uy = spots[b + 1] - spots[a + 1], vx = spots[c] - spots[a], vy = spots[c + 1] - spots[a + 1];
      const whole = ux * vy - uy * vx;
      const s = ((x - spots[a]) * vy - (y - spots[a + 1]) * vx) / whole;
      const t = (ux * (y - spots[a + 1]) - uy * (x - spots[a])) / whole;
      if (!(s >= 0 && t >= 0 && s + t <= 1)) continue;
      const r = 1 - s - t;
      if (r * spots[a + 2] + s * spots[b + 2] + t * spots[c + 2] > depth - this.slack) continue;
      if (cut) {
        let beyond = -cut[3];
        for (let k = 0; k < 3; k++) beyond += cut[k] * (r * nodes[a + k] + s * nodes[b + k] + t * nodes[c + k]);
        if (beyond > 0) continue;
      }
      count += 1;
    }
    return count;
  }

  /** Calls `draw` with the ends in pixels of all that is seen of the edges between the near and the far side. */
  outline(draw) {
    const { edges, front } = this;
    for (let e = 0; e < edges.length; e += 4) {
      const one = edges[e + 2], other = edges[e + 3];
      if (other >= 0 && (front[one] === front[other] || !this.isRidge(e))) continue;
      this.pieces(e, 3, draw);
    }
  }

  /** Calls `draw` with the ends in pixels of all that is seen of the mesh. */
  mesh(draw) {
    const { edges, front } = this;
    for (let e = 0; e < edges.length; e += 4) {
      if (front[edges[e + 2]] > 0 || (edges[e + 3] >= 0 && front[edges[e + 3]] > 0)) this.pieces(e, 1, draw);
    }
  }

  /** What is seen of an edge, in some pieces. */
  pieces(e, count, draw) {
    const { edges, spots, nodes, cut } = this;
    const a = 3 * edges[e], b = 3 * edges[e + 1];
    if (cut) {
      let beyond = -2 * cut[3];
      for (let k = 0; k < 3; k++) beyond += cut[k] * (nodes[a + k] + nodes[b + k]);
      if (beyond > 0) return;
    }
    const at = (share, k) => spots[a + k] + share * (spots[b + k] - spots[a + k]);
    for (let i = 0; i < count; i++) {
      const middle = (i + 0.5) / count, from = i / count, to = (i + 1) / count;
      if (this.layers(at(middle, 0), at(middle, 1), at(middle, 2)) === 0) draw(at(from, 0), at(from, 1), at(to, 0), at(to, 1));
    }
  }

  /** Whether an edge is a ridge; one in a fold is never part of an outline. */
  isRidge(e) {
    const { edges, faces, nodes } = this;
    const [one, other] = [3 * edges[e + 2], 3 * edges[e + 3]];
    const [a, b, c] = [3 * faces[one], 3 * faces[one + 1], 3 * faces[one + 2]];
    let tip = faces[other];
    for (let k = 1; k < 3 && (tip === edges[e] || tip === edges[e + 1]); k++) tip = faces[other + k];
    const ux = nodes[b] - nodes[a], uy = nodes[b + 1] - nodes[a + 1], uz = nodes[b + 2] - nodes[a + 2];
    const vx = nodes[c] - nodes[a], vy = nodes[c + 1] - nodes[a + 1], vz = nodes[c + 2] - nodes[a + 2];
    const wx = nodes[3 * tip] - nodes[a], wy = nodes[3 * tip + 1] - nodes[a + 1], wz = nodes[3 * tip + 2] - nodes[a + 2];
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz < 0;
  }

  /** How far beyond the section a node is; less than nothing if it is shown. */
  side(node) {
    const { nodes, cut } = this;
    return cut[0] * nodes[3 * node] + cut[1] * nodes[3 * node + 1] + cut[2] * nodes[3 * node + 2] - cut[3];
  }

  /** Calls `draw` with the ends in pixels of each piece of the section's rim. */
  section(camera, draw) {
    const { faces, nodes } = this;
    const ends = [[0, 0, 0], [0, 0, 0]];
    for (let f = 0; f < faces.length; f += 3) {
      let found = 0;
      for (let k = 0; k < 3 && found < 2; k++) {
        const a = faces[f + k], b = faces[f + ((k + 1) % 3)], p = this.side(a), q = this.side(b);
        if (p > 0 === q > 0) continue;
        const share = p / (p - q);
        const at = (i) => nodes[3 * a + i] + share * (nodes[3 * b + i] - nodes[3 * a + i]);
        camera.project(at(0), at(1), at(2), ends[found++]);
      }
      if (found === 2) draw(ends[0][0], ends[0][1], ends[1][0], ends[1][1]);
    }
  }
}
