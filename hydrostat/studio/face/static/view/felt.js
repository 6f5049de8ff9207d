// A flat body as felt with a stitched seam, and the outline of a body in space.

import { mix, veil } from "./theme.js";

/** A closed path through rings of places of a flat body. */
function ringPath(rings, camera) {
  const path = new Path2D(), spot = [0, 0, 0];
  for (const ring of rings) {
    for (let i = 0; i < ring.length; i += 2) {
      camera.project(ring[i], ring[i + 1], 0, spot);
      if (i) path.lineTo(spot[0], spot[1]);
      else path.moveTo(spot[0], spot[1]);
    }
    path.closePath();
  }
  return path;
}

/** Faint squares, a round number of millimeters wide. */
export function drawGrid(pen, view) {
  const { camera, theme } = view;
  const rough = 70 / camera.meter;
  const nice = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map((k) => k * nice).find((value) => value >= rough);
  const tall = camera.span / 2, wide = tall * (camera.width / camera.height);
  const { x, y } = camera.target;
  pen.beginPath();
  for (let k = Math.ceil((x - wide) / step); k * step < x + wide; k++) {
    const at = Math.round((k * step - x + wide) * camera.meter) + 0.5;
    pen.moveTo(at, 0);
    pen.lineTo(at, camera.height);
  }
  for (let k = Math.ceil((y - tall) / step); k * step < y + tall; k++) {
    const at = Math.round((y + tall - k * step) * camera.meter) + 0.5;
    pen.moveTo(0, at);
    pen.lineTo(camera.width, at);
  }
  pen.strokeStyle = theme.grid;
  pen.lineWidth = 1;
  pen.stroke();
}

/** Other shapes of a flat body, behind it. */
export function drawGhosts(pen, view) {
  for (const { item, array } of Object.values(view.ghosts)) {
    const color = view.ghostColor(item);
    const path = ringPath(view.skin.rim.at(array), view.camera);
    pen.fillStyle = veil(color, 0.2);
    pen.fill(path, "evenodd");
    pen.strokeStyle = veil(color, 0.8);
    pen.lineWidth = 1.4;
    pen.stroke(path);
  }
}

/** A flat body. */
export function drawFelt(pen, view) {
  const { camera, palette, skin, nodes, values } = view;
  const rim = ringPath(skin.rim.at(nodes), camera);
  const seam = ringPath(skin.seam.at(nodes), camera);
  pen.fillStyle = palette.felt;
  pen.fill(rim, "evenodd");
  if (values) {
    pen.save();
    pen.clip(rim, "evenodd");
    view.field.draw(pen, view);
    pen.restore();
  } else {
    pen.fillStyle = palette.felt_light;
    pen.fill(seam, "evenodd");
  }
  if (view.edges) {
    const { edges, spots } = view.cover;
    view.cover.see(nodes, camera, null);
    pen.beginPath();
    for (let e = 0; e < edges.length; e += 4) {
      pen.moveTo(spots[3 * edges[e]], spots[3 * edges[e] + 1]);
      pen.lineTo(spots[3 * edges[e + 1]], spots[3 * edges[e + 1] + 1]);
    }
    pen.strokeStyle = veil(palette.mesh, 0.45);
    pen.lineWidth = 0.8;
    pen.stroke();
  }
  pen.setLineDash([5, 4]);
  pen.lineCap = "butt";
  pen.strokeStyle = values ? "rgba(255,255,255,0.75)" : palette.stitch;
  pen.lineWidth = 1.8;
  pen.stroke(seam);
  pen.setLineDash([]);
  pen.lineCap = "round";
  pen.strokeStyle = values ? mix(palette.dark, palette.seam, 0.4) : palette.seam;
  pen.lineWidth = 2;
  pen.stroke(rim);
  // what is sought stays to be seen through the body
  for (const { item, array } of Object.values(view.ghosts)) {
    if (item.color === palette.ghost) continue;
    pen.strokeStyle = veil(view.ghostColor(item), 0.55);
    pen.lineWidth = 1.2;
    pen.setLineDash([4, 3]);
    pen.stroke(ringPath(skin.rim.at(array), camera));
    pen.setLineDash([]);
  }
}

/** All triangles that face the camera as one path. */
function facesPath({ faces, spots, front }) {
  const path = new Path2D();
  for (let f = 0; f < faces.length; f += 3) {
    if (front[f / 3] < 0) continue;
    const a = 3 * faces[f], b = 3 * faces[f + 1], c = 3 * faces[f + 2];
    path.moveTo(spots[a], spots[a + 1]);
    path.lineTo(spots[b], spots[b + 1]);
    path.lineTo(spots[c], spots[c + 1]);
  }
  return path;
}

/** Field and outline of a ghost in space; kept until the camera moves. */
function ghostPaths(view, ghost) {
  const { camera } = view;
  const seen = [camera.width, camera.height, ...camera.matrix.elements].join();
  if (ghost.seen !== seen) {
    const { cover } = ghost;
    const rim = new Path2D();
    cover.see(ghost.array, camera, null);
    cover.outline((ax, ay, bx, by) => {
      rim.moveTo(ax, ay);
      rim.lineTo(bx, by);
    });
    Object.assign(ghost, { seen, rim, field: facesPath(cover) });
  }
  return ghost;
}

/** Other shapes of a body in space, on the sheet under it. */
export function drawGhostsInSpace(pen, view) {
  pen.lineWidth = 1.2;
  pen.lineCap = "round";
  for (const ghost of Object.values(view.ghosts)) {
    const { field, rim } = ghostPaths(view, ghost);
    const color = view.ghostColor(ghost.item);
    pen.fillStyle = veil(color, 0.2);
    pen.fill(field);
    pen.strokeStyle = veil(color, 0.75);
    pen.stroke(rim);
  }
}

/** The outline of what is sought, seen through the body. */
function drawSought(pen, view) {
  pen.lineWidth = 1.2;
  pen.setLineDash([4, 3]);
  for (const ghost of Object.values(view.ghosts)) {
    if (ghost.item.color === view.palette.ghost) continue;
    pen.strokeStyle = veil(view.ghostColor(ghost.item), 0.55);
    pen.stroke(ghostPaths(view, ghost).rim);
  }
  pen.setLineDash([]);
}

/** What of a body in space is drawn with a pen: its outline, its mesh, the rim of its section. */
export function drawOutline(pen, view) {
  const { cover, palette, camera } = view;
  const add = (ax, ay, bx, by) => {
    pen.moveTo(ax, ay);
    pen.lineTo(bx, by);
  };
  if (view.edges) {
    pen.beginPath();
    cover.mesh(add);
    pen.strokeStyle = veil(palette.mesh, 0.45);
    pen.lineWidth = 0.8;
    pen.stroke();
  }
  pen.beginPath();
  cover.outline(add);
  pen.strokeStyle = palette.seam;
  pen.lineWidth = 1.6;
  pen.stroke();
  drawSought(pen, view);
  if (!view.cut) return;
  pen.beginPath();
  cover.section(camera, add);
  pen.strokeStyle = mix(palette.seam, palette.dark, 0.35);
  pen.lineWidth = 1.6;
  pen.stroke();
}
