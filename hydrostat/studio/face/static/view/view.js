// The view: holds a scene, takes frames, paints when something has changed.

import { THREE } from "nicegui-scene";
import { Camera } from "./camera.js";
import { Cover } from "./cover.js";
import { Field, ramp256 } from "./field.js";
import { Link } from "./link.js";
import { Overlay } from "./overlay.js";
import { opened, same } from "./packet.js";
import { pick } from "./pick.js";
import { Pointer } from "./pointer.js";
import { Probe } from "./probe.js";
import { Skin } from "./skin.js";
import { Ghost, Surface } from "./surface.js";
import { mix, theme } from "./theme.js";

const BARE = 300; // a scene without a frame is shown at rest after so long [ms]
const MARGIN = { flat: [84, 44, 44, 56], space: [84, 44, 44, 72] };

export class View {
  /**
   * @param element that is filled
   * @param canvases for the body and for what is drawn on top
   * @param options {stream, dark, palette: colours by name and `tension`, a row of them, brush}
   * @param tell (name, value) is told "connected" and "note"
   */
  constructor(element, canvases, options, tell) {
    Object.assign(this, { element, tell, brush: options.brush, palette: options.palette, ink: options.palette.ink });
    this.sheet = canvases[0];
    this.renderer = null; // made for the first body in space: flat ones need no WebGL
    this.slow = hasNoCard();
    this.overlay = new Overlay(canvases[1], this.slow);
    this.world = new THREE.Scene();
    this.camera = new Camera();
    this.ramp = ramp256(options.palette.tension);
    this.field = new Field(this.ramp);
    this.font = getComputedStyle(element).fontFamily || "sans-serif";
    Object.assign(this, { dots: [], lines: [], areas: [], ghosts: {}, clouds: {}, points: new Float32Array(), hover: "" });
    const none = new Float32Array();
    Object.assign(this, { rest: none, nodes: none, faces: new Uint32Array(), values: null }); // the body
    Object.assign(this, { surface: null, skin: null, cover: null, cut: null, serial: -1, opacityNow: 1 });
    this.see = null; // what the person chose; null: as fits the body
    this.dirty = new Set();
    this.pixel = new Uint8Array(4);
    this.probe = new Probe(this);
    window.__app = this.probe;
    this.dress(options.dark);
    this.pointer = new Pointer(this);
    this.watch = new ResizeObserver(() => this.mark("size"));
    this.watch.observe(element);
    canvases[0].addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvases[0].addEventListener("webglcontextrestored", () => this.mark("camera"));
    this.link = new Link(options.stream, (buffer) => this.guarded(() => this.receive(buffer)), (connected) => this.linked(connected));
    this.mark("size");
  }

  linked(connected) {
    this.probe.connected = connected;
    if (!connected) this.pointer.cancel();
    this.tell("connected", connected);
  }

  send(message) {
    this.link.send(message);
  }

  /** Do something; an error is kept for tests and told on the console, and the view goes on. */
  guarded(work) {
    try {
      return work();
    } catch (error) {
      if (this.probe.errors.length < 100) this.probe.errors.push(String(error?.stack ?? error));
      console.error(error);
      return undefined;
    }
  }

  receive(buffer) {
    const { head, arrays } = opened(buffer);
    if (head.kind === "scene") {
      this.probe.scenes += 1;
      this.coming = { head, arrays };
      clearTimeout(this.bare);
      this.bare = setTimeout(() => this.mark("bare"), BARE);
    } else if (head.kind === "frame") {
      this.probe.frames += 1;
      this.latest = { head, arrays };
      this.mark("frame");
    } else if (head.kind === "note") {
      this.tell("note", head);
    }
  }

  /** Something has changed: the next animation frame paints. */
  mark(what) {
    this.dirty.add(what);
    if (this.ticket || this.ended) return;
    this.ticket = requestAnimationFrame((now) => {
      this.ticket = 0;
      this.guarded(() => this.tick(now));
    });
  }

  tick(now) {
    const dirty = this.dirty;
    this.dirty = new Set();
    this.pointer.tick();
    const start = performance.now();
    if (dirty.has("size")) this.resize();
    let fresh = false;
    if (dirty.has("frame") || dirty.has("bare")) fresh = this.guarded(() => this.advance(dirty.has("bare")));
    if (this.camera.turn(now)) this.mark("camera");
    const only = (...names) => [...dirty].every((name) => names.includes(name));
    if (only("drag")) return;
    if (only("drag", "hover") && !this.point()) return;
    if (!only("hover", "drag")) this.point();
    this.paint();
    if (!dirty.has("frame") && !dirty.has("bare")) return;
    this.send({ kind: "seen" });
    if (fresh) this.probe.saw(this.stamp ?? 0, performance.now() - start);
  }

  /** Take the newest frame, and the scene it belongs to if that is new; whether there was one. */
  advance(bare) {
    const { coming, latest } = this;
    this.latest = null;
    if (coming && (bare || latest?.head.scene === coming.head.serial)) {
      this.coming = null;
      clearTimeout(this.bare);
      this.build(coming.head, coming.arrays);
    }
    if (!latest || latest.head.scene !== this.serial) return false;
    this.stamp = latest.head.stamp;
    this.move(latest.arrays);
    return true;
  }

  /** Show another scene; what is the same in it is kept. */
  build(head, arrays) {
    const flat = head.dim === 2;
    const other = flat !== this.camera.flat || !same(arrays.rest, this.rest) || !same(arrays.faces, this.faces);
    const elsewhere = this.serial < 0 || flat !== this.camera.flat || head.name !== this.name || this.grown(arrays.rest);
    Object.assign(this, { serial: head.serial, name: head.name, rest: arrays.rest });
    this.camera.flat = flat;
    if (other) this.newBody(flat, arrays);
    const before = new Map(this.dots.map((dot) => [dot.key, dot]));
    this.dots = head.things.filter((thing) => thing.kind === "dot").map((dot) => ({
      ...dot, short: initials(dot.label), x: -99, y: -99, depth: 0, density: 1, place: [0, 0, 0], slot: before.get(dot.key)?.slot,
    }));
    this.lines = head.things.filter((thing) => thing.kind === "line");
    this.areas = head.things.filter((thing) => thing.kind === "area").map((area) => ({ ...area, spots: [] }));
    this.takeGhosts(head, arrays);
    this.clouds = named(head, arrays, "cloud");
    this.applyLook();
    if (elsewhere) {
      this.camera.begin(flat);
      this.fitting = true;
    }
    this.mark("camera");
  }

  /** Whether a body is so much larger or smaller than before that one has to look anew. */
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

  openRenderer() {
    if (this.renderer) return;
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas: this.sheet, antialias: false, alpha: false, powerPreference: "high-performance" });
    } catch (error) {
      this.tell("failure", "Bodies in space are drawn with WebGL, which this browser does not have. Switch it on, or use another.");
      throw error;
    }
    this.renderer.setClearColor(this.theme.back, 1);
    this.resize();
  }

  /** Keep ghosts that are the same, make those that are not; of flat bodies only the pen draws them. */
  takeGhosts(head, arrays) {
    const fresh = named(head, arrays, "ghost");
    const { faces } = this;
    for (const [name, ghost] of Object.entries(fresh)) {
      const old = this.ghosts[name];
      if (old?.skin && old.faces === faces && same(old.array, ghost.array)) {
        ghost.skin = old.skin;
        delete old.skin;
      } else if (!this.camera.flat) {
        ghost.skin = new Ghost(ghost.array, faces, 3);
        this.add(ghost.skin);
      }
      ghost.faces = faces;
    }
    for (const old of Object.values(this.ghosts)) this.drop(old.skin);
    this.ghosts = fresh;
  }

  ghostColour(thing) {
    return thing.colour === this.palette.ghost ? this.theme.ghost : thing.colour;
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
    if (this.fitting) this.fit();
  }

  /** Colours, and how much is seen through the body. */
  applyLook() {
    const { surface, palette } = this;
    this.opacityNow = this.camera.flat ? 1 : this.see ?? 1;
    if (!surface) return;
    surface.colour(palette, mix(palette.seam, palette.dark, 0.12));
    surface.see(this.opacityNow);
    surface.section(this.cut);
    for (const { thing, skin } of Object.values(this.ghosts)) {
      skin?.colour(this.ghostColour(thing), thing.colour === palette.ghost ? 0.6 : 0.8);
    }
  }

  dress(dark) {
    this.theme = theme(dark);
    this.renderer?.setClearColor(this.theme.back, 1);
    this.element.style.background = this.theme.back;
    this.applyLook();
    this.mark("camera");
  }

  resize() {
    const { clientWidth, clientHeight } = this.element;
    if (!clientWidth || !clientHeight) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.renderer?.setPixelRatio(ratio);
    this.renderer?.setSize(clientWidth, clientHeight, false);
    this.overlay.resize(clientWidth, clientHeight, ratio);
    this.camera.resize(clientWidth, clientHeight);
    this.ratio = ratio;
    if (!this.camera.moved) this.fit();
  }

  fit() {
    if (this.serial < 0) return;
    this.fitting = !this.element.clientWidth;
    this.camera.fit([this.nodes, this.points, ...Object.values(this.ghosts).map((ghost) => ghost.array)], MARGIN[this.camera.flat ? "flat" : "space"]);
    this.mark("camera");
  }

  /** What is under the pointer; whether that is another thing than before. */
  point() {
    const { pointer, element } = this;
    const { press, at } = pointer;
    const was = this.hover;
    let cursor = this.brush ? "crosshair" : "default";
    if (press) {
      this.hover = press.hit?.key ?? "";
      cursor = press.mode === "still" ? element.style.cursor : press.mode === "orbit" ? "move" : "grabbing";
    } else {
      const hit = at && this.serial >= 0 ? pick(this, ...at) : { key: "" };
      this.hover = hit.key;
      if (!this.brush && hit.key) cursor = hit.key === "body" ? "grab" : "pointer";
    }
    if (element.style.cursor !== cursor) element.style.cursor = cursor;
    return this.hover !== was;
  }

  paint() {
    const { camera, overlay, surface, renderer } = this;
    if (!this.ratio) return;
    camera.place();
    this.sheet.style.visibility = surface ? "visible" : "hidden";
    if (surface) {
      renderer.render(this.world, camera.now);
      this.cover.see(this.nodes, camera, this.cut);
    }
    this.spread();
    overlay.draw(this);
    // reading a pixel waits until all is drawn: what is told as painted is painted
    if (surface) {
      const gl = renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.pixel);
    }
    if (this.slow) overlay.pen.getImageData(0, 0, 1, 1);
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

  // What the page may ask for.

  look(name) {
    this.camera.look(name, performance.now());
    this.mark("camera");
  }

  parallel(on) {
    this.camera.parallel = on;
    this.mark("camera");
  }

  opacity(value) {
    this.see = value;
    this.applyLook();
    this.mark("camera");
  }

  mesh(on) {
    this.edges = on;
    this.applyLook();
    this.mark("camera");
  }

  /** Cut the body across an axis at a share of its extent; the side that faces the viewer goes away. */
  section(axis, share) {
    const k = ["x", "y", "z"].indexOf(axis);
    if (k < 0 || !this.surface) {
      [this.cut, this.cutAxis] = [null, null];
    } else {
      if (this.cutAxis !== axis) this.cutSide = this.camera.toward[axis] < 0 ? -1 : 1;
      this.cutAxis = axis;
      let low = Infinity, high = -Infinity;
      for (let i = k; i < this.rest.length; i += 3) {
        low = Math.min(low, this.rest[i]);
        high = Math.max(high, this.rest[i]);
      }
      const at = low + share * (high - low);
      this.cut = [0, 0, 0, this.cutSide * at];
      this.cut[k] = this.cutSide;
    }
    this.applyLook();
    this.mark("camera");
  }

  /** The view as a PNG, as a data URL. */
  picture() {
    this.paint();
    const sheet = document.createElement("canvas");
    [sheet.width, sheet.height] = [this.overlay.canvas.width, this.overlay.canvas.height];
    const pen = sheet.getContext("2d");
    pen.fillStyle = this.theme.back;
    pen.fillRect(0, 0, sheet.width, sheet.height);
    if (this.surface) {
      this.renderer.render(this.world, this.camera.now);
      pen.drawImage(this.renderer.domElement, 0, 0);
    }
    pen.drawImage(this.overlay.canvas, 0, 0);
    return sheet.toDataURL("image/png");
  }

  dispose() {
    this.ended = true;
    this.link.close();
    this.pointer.dispose();
    this.watch.disconnect();
    cancelAnimationFrame(this.ticket);
    clearTimeout(this.bare);
    this.drop(this.surface);
    for (const { skin } of Object.values(this.ghosts)) this.drop(skin);
    this.renderer?.dispose();
    if (window.__app === this.probe) delete window.__app;
  }
}

/** The things of a kind by name, each with its array. */
function named(head, arrays, kind) {
  const things = head.things.filter((thing) => thing.kind === kind);
  return Object.fromEntries(things.map((thing) => [thing.name, { thing, array: arrays[`${kind}:${thing.name}`] }]));
}

/** Whether WebGL is missing or done by the processor. */
function hasNoCard() {
  const gl = document.createElement("canvas").getContext("webgl");
  if (!gl) return true;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

/** Up to two letters for a disc: "index flexor" is IF, "winch_2" is W2, "left" is L. */
function initials(label) {
  const parts = label.split(/[\s_\-.]+|(?<=[a-z])(?=[0-9])/i).filter(Boolean);
  return parts.slice(0, 2).map((part) => part[0]).join("").toUpperCase();
}
