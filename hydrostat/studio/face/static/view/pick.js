// What is under the pointer: dots before lines before the body.

import { within } from "./skin.js";

const DOT = 10;
const LINE = 6;

/** Where a ray first meets triangles: {face, shares, away, inner}, or null. */
function met(origin, direction, nodes, faces, cut) {
  let nearest = null;
  const { x: dx, y: dy, z: dz } = direction;
  for (let f = 0; f < faces.length; f += 3) {
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    const ax = nodes[a], ay = nodes[a + 1], az = nodes[a + 2];
    const ux = nodes[b] - ax, uy = nodes[b + 1] - ay, uz = nodes[b + 2] - az;
    const vx = nodes[c] - ax, vy = nodes[c + 1] - ay, vz = nodes[c + 2] - az;
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const whole = ux * px + uy * py + uz * pz;
    if (Math.abs(whole) < 1e-18) continue;
    const tx = origin.x - ax, ty = origin.y - ay, tz = origin.z - az;
    const s = (tx * px + ty * py + tz * pz) / whole;
    if (s < 0 || s > 1) continue;
    const qx = ty * uz - tz * uy, qy = tz * ux - tx * uz, qz = tx * uy - ty * ux;
    const t = (dx * qx + dy * qy + dz * qz) / whole;
    if (t < 0 || s + t > 1) continue;
    const away = (vx * qx + vy * qy + vz * qz) / whole;
    if (away <= 0 || (nearest && away >= nearest.away)) continue;
    if (cut) {
      const x = origin.x + away * dx, y = origin.y + away * dy, z = origin.z + away * dz;
      if (x * cut[0] + y * cut[1] + z * cut[2] > cut[3]) continue;
    }
    nearest = { face: f, shares: [1 - s - t, s, t], away, inner: whole < 0 };
  }
  return nearest;
}

/** The place in the rest shape of a point near the body, by how the nodes around it have moved. */
export function restOf(point, nodes, rest) {
  let sum = 0, x = 0, y = 0, z = 0;
  for (let i = 0; i < nodes.length; i += 3) {
    const far = (nodes[i] - point[0]) ** 2 + (nodes[i + 1] - point[1]) ** 2 + (nodes[i + 2] - point[2]) ** 2;
    const weight = 1 / (far * far + 1e-16);
    sum += weight;
    x += weight * (nodes[i] - rest[i]);
    y += weight * (nodes[i + 1] - rest[i + 1]);
    z += weight * (nodes[i + 2] - rest[i + 2]);
  }
  return [point[0] - x / sum, point[1] - y / sum, point[2] - z / sum];
}

/** The body under a pixel: {world, rest}, or null. */
export function bodyAt(view, x, y) {
  const { camera, nodes, faces, rest } = view;
  if (camera.flat) {
    const world = camera.facing(x, y, [0, 0, 0]);
    const home = within(world[0], world[1], nodes, faces);
    return home && { world, rest: blend(rest, faces, home) };
  }
  const { origin, direction } = camera.ray(x, y);
  const hit = met(origin, direction, nodes, faces, view.cut);
  if (!hit) return null;
  const world = origin.clone().addScaledVector(direction, hit.away).toArray();
  if (!view.cut || !hit.inner) return { world, rest: blend(rest, faces, hit) };
  // through the section: a point on it, inside the body
  const [a, b, c, far] = view.cut;
  const slope = direction.x * a + direction.y * b + direction.z * c;
  const away = (far - (origin.x * a + origin.y * b + origin.z * c)) / slope;
  if (!(away > 0 && away < hit.away)) return { world, rest: blend(rest, faces, hit) };
  const inside = origin.clone().addScaledVector(direction, away).toArray();
  return { world: inside, rest: restOf(inside, nodes, rest) };
}

function blend(rest, faces, { face, shares }) {
  return [0, 1, 2].map((k) => shares.reduce((sum, share, corner) => sum + share * rest[3 * faces[face + corner] + k], 0));
}

/** The nearest dot with a key within reach of a pixel, or null. */
function dotAt(view, x, y) {
  let best = null, least = Infinity;
  for (const dot of view.dots) {
    if (!dot.key) continue;
    const far = Math.hypot(dot.x - x, dot.y - y);
    const reach = Math.max(DOT, dot.look === "winch" ? 13 : 0);
    const cost = far + (dot.depth > 1 ? 6 : 0);
    if (far <= reach && cost <= least) [best, least] = [dot, cost];
  }
  return best;
}

/** The nearest line with a key within reach of a pixel: {key, world}, or null. */
function lineAt(view, x, y) {
  let best = null, least = LINE;
  const a = [0, 0, 0], b = [0, 0, 0], points = view.points;
  for (const line of view.lines) {
    if (!line.key) continue;
    for (let k = 0; k + 1 < line.count; k++) {
      const i = 3 * (line.first + k), j = i + 3;
      view.camera.project(points[i], points[i + 1], points[i + 2], a);
      view.camera.project(points[j], points[j + 1], points[j + 2], b);
      const [u, v] = [b[0] - a[0], b[1] - a[1]];
      const share = Math.min(Math.max(((x - a[0]) * u + (y - a[1]) * v) / (u * u + v * v || 1), 0), 1);
      const far = Math.hypot(a[0] + share * u - x, a[1] + share * v - y);
      if (far > least) continue;
      least = far;
      best = { key: line.key, world: [0, 1, 2].map((m) => points[i + m] + share * (points[j + m] - points[i + m])) };
    }
  }
  return best;
}

/** The area with a key around a pixel, the last drawn, or null; a brush paints over all of them. */
function areaAt(view, x, y) {
  if (view.brush) return null;
  return view.areas.findLast((area) => area.key && area.path && view.overlay.holds(area, x, y)) ?? null;
}

/** All that is under a pixel: {key, rest, world}. */
export function pick(view, x, y) {
  const body = bodyAt(view, x, y);
  const item = dotAt(view, x, y) ?? lineAt(view, x, y);
  if (item) {
    const world = item.world ?? item.place;
    const flat = view.camera.flat;
    const rest = flat ? body && body.rest : restOf(world, view.nodes, view.rest);
    return { key: item.key, rest, world };
  }
  const area = areaAt(view, x, y);
  if (area) return { key: area.key, rest: body && body.rest, world: body ? body.world : view.camera.facing(x, y, [0, 0, 0]) };
  if (body) return { key: "body", ...body };
  return { key: "", rest: null, world: view.camera.facing(x, y, view.camera.target.toArray()) };
}
