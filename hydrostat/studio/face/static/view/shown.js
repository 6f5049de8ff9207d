// What is shown: a body and the items beside it, from scenes and frames.

import { THREE } from "nicegui-scene";
import { Camera } from "./camera.js";
import { Cover } from "./cover.js";
import { Field, ramp256 } from "./field.js";
import { same } from "./packet.js";
import { Skin } from "./skin.js";
import { Surface } from "./surface.js";
import { mix, theme } from "./theme.js";

export class Shown {
  /**
   * @param {Record<string, any>} palette colors by name, and `tension`, a row of them
   * @param {boolean} dark whether the page is
   */
  constructor(palette, dark) {
    this.palette = palette;
    this.ink = palette.ink;
    this.theme = theme(dark);
    this.world = new THREE.Scene(); // what WebGL draws: a body in space
    this.camera = new Camera();
    this.ramp = ramp256(palette.tension);
    this.field = new Field(this.ramp);
    const none = new Float32Array();
    this.serial = -1; // of the scene
    this.name = "";
    this.rest = this.nodes = this.points = none;
    this.faces = new Uint32Array();
    /** @type {Float32Array | null} */
    this.values = null;
    /** @type {Surface | null} */
    this.surface = null;
    /** @type {Skin | null} */
    this.skin = null;
    /** @type {Cover | null} */
    this.cover = null;
    /** @type {any[]} */
    this.dots = [];
    /** @type {any[]} */
    this.lines = [];
    /** @type {any[]} */
    this.areas = [];
    /** @type {Record<string, any>} */
    this.ghosts = {};
    /** @type {Record<string, any>} */
    this.clouds = {};
    this.hover = "";
    // how it is looked at: solid by default; a plane that cuts it; the edges of its mesh
    this.opacity = 1;
    /** @type {{axis: string, share: number, side: number} | null} */
    this.section = null;
    /** @type {number[] | null} */
    this.cut = null;
    this.edges = false;
  }

  /** Make ready to draw a body in space; who shows one on a screen does. */
  openRenderer() {}

  /** Show another scene; what is the same in it is kept. Returns whether one has to look at it again. */
  build(head, arrays) {
    const flat = head.dim === 2;
    const other = flat !== this.camera.flat || !same(arrays.rest, this.rest) || !same(arrays.faces, this.faces);
    const elsewhere = this.serial < 0 || flat !== this.camera.flat || head.name !== this.name || this.grown(arrays.rest);
    Object.assign(this, { serial: head.serial, name: head.name, rest: arrays.rest });
    this.camera.flat = flat;
    if (other) this.newBody(flat, arrays);
    const before = new Map(this.dots.map((dot) => [dot.key, dot]));
    this.dots = head.items.filter((item) => item.kind === "dot").map((dot) => ({
      ...dot, short: dot.short || initials(dot.label), x: -99, y: -99, depth: 0, density: 1, place: [0, 0, 0], slot: before.get(dot.key)?.slot,
    }));
    this.points = new Float32Array(3 * head.items.reduce((most, item) => Math.max(most, item.first + item.count), 0));
    this.lines = head.items.filter((item) => item.kind === "line");
    this.areas = head.items.filter((item) => item.kind === "area").map((area) => ({ ...area, spots: [] }));
    this.takeGhosts(head, arrays);
    this.clouds = named(head, arrays, "cloud");
    this.recut();
    return elsewhere;
  }

  /** Whether a body is so much larger or smaller than before that one has to look again. */
  grown(rest) {
    const size = (table) => table.reduce((most, value) => Math.max(most, Math.abs(value)), 1e-9);
    const ratio = size(rest) / size(this.rest);
    return ratio > 1.5 || ratio < 0.67;
  }

  newBody(flat, arrays) {
    this.drop(this.surface);
    Object.assign(this, { nodes: arrays.rest, faces: arrays.faces, values: null, surface: null });
    this.skin = flat ? new Skin(arrays.rim, arrays.rest, arrays.faces) : null;
    this.cover = new Cover(arrays.faces, arrays.rest.length / 3);
    if (flat) return;
    this.openRenderer();
    this.surface = new Surface(arrays.rest, arrays.faces, this.ramp, 1);
    this.add(this.surface);
  }

  /** Take the ghosts of a scene; what was found out of the same ones is kept. */
  takeGhosts(head, arrays) {
    const fresh = named(head, arrays, "ghost");
    const { faces } = this;
    for (const [name, ghost] of Object.entries(fresh)) {
      const old = this.ghosts[name];
      const kept = old?.cover?.faces === faces && same(old.array, ghost.array);
      ghost.cover = kept ? old.cover : this.camera.flat ? null : new Cover(faces, ghost.array.length / 3);
      if (kept) Object.assign(ghost, { seen: old.seen, rim: old.rim, field: old.field });
    }
    this.ghosts = fresh;
  }

  ghostColor(item) {
    return item.color === this.palette.ghost ? this.theme.ghost : item.color;
  }

  add(part) {
    for (const object of part.objects) this.world.add(object);
  }

  drop(part) {
    if (!part) return;
    for (const object of part.objects) this.world.remove(object);
    part.dispose();
  }

  /** Everything to the place of a frame. */
  move(arrays) {
    Object.assign(this, { nodes: arrays.nodes, values: arrays.values ?? null });
    this.surface?.move(arrays.nodes, arrays.values);
    this.points = arrays.points;
    this.lines.forEach((line, i) => (line.load = arrays.loads[i] ?? 0));
    for (const dot of this.dots) dot.place = [0, 1, 2].map((k) => arrays.points[3 * dot.first + k]);
  }

  /** Colors, and how much is seen through the body. */
  applyLook() {
    const { surface, palette } = this;
    if (!surface) return;
    surface.color(palette, mix(palette.seam, palette.dark, 0.12));
    surface.see(this.opacity);
    surface.section(this.cut);
  }

  /** Cut the body across an axis at a share of its extent; the side that faces the viewer goes away. */
  cutAcross(axis, share) {
    const side = this.section?.axis === axis ? this.section.side : this.camera.toward[axis] < 0 ? -1 : 1;
    this.section = axis in this.camera.toward ? { axis, share, side } : null;
    this.recut();
  }

  /** Put the section where it belongs in the body that is shown now. */
  recut() {
    this.cut = null;
    if (this.section && this.surface) {
      const { axis, share, side } = this.section;
      const k = "xyz".indexOf(axis);
      let low = Infinity, high = -Infinity;
      for (let i = k; i < this.rest.length; i += 3) {
        low = Math.min(low, this.rest[i]);
        high = Math.max(high, this.rest[i]);
      }
      this.cut = [0, 0, 0, side * (low + share * (high - low))];
      this.cut[k] = side;
    }
    this.applyLook();
  }

  /** Dots and areas to their pixels. */
  spread() {
    const { camera, points } = this;
    const spot = [0, 0, 0];
    for (const dot of this.dots) {
      [dot.x, dot.y] = camera.project(...dot.place, spot);
      dot.density = camera.density(dot.place);
      if (this.surface) dot.depth = this.cover.layers(...spot);
    }
    for (const area of this.areas) {
      area.spots = Array.from({ length: points.length ? area.count : 0 }, (_, k) => {
        const i = 3 * (area.first + k);
        const place = [points[i], points[i + 1], points[i + 2]];
        const [x, y, depth] = camera.project(...place, spot);
        return [x, y, depth, camera.density(place)];
      });
    }
  }
}

/** The items of a kind by name, each with its array. */
function named(head, arrays, kind) {
  const items = head.items.filter((item) => item.kind === kind);
  return Object.fromEntries(items.map((item) => [item.name, { item, array: arrays[`${kind}:${item.name}`] }]));
}

/** Up to two letters for a disc: "index flexor" is IF, "winch_2" is W2, "left" is L. */
function initials(label) {
  const parts = label.split(/[\s_\-.]+|(?<=[a-z])(?=[0-9])/i).filter(Boolean);
  return parts.slice(0, 2).map((part) => part[0]).join("").toUpperCase();
}
