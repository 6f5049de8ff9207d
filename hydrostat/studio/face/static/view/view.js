// The view: takes scenes and frames, and paints when something has changed.

import { THREE } from "nicegui-scene";
import { drawGhostsInSpace } from "./felt.js";
import { Link } from "./link.js";
import { Overlay } from "./overlay.js";
import { opened } from "./packet.js";
import { pick } from "./pick.js";
import { Pointer } from "./pointer.js";
import { Probe } from "./probe.js";
import { Shown } from "./shown.js";
import { theme } from "./theme.js";

const BARE = 300; // a scene without a frame is shown at rest after so long [ms]
const MARGIN = { flat: [84, 44, 44, 56], space: [84, 44, 44, 72] };

export class View extends Shown {
  /**
   * @param {HTMLElement} element that is filled
   * @param {HTMLCanvasElement[]} canvases three, one over the other: for ghosts in space, for the body in space, for all else
   * @param {{stream: string, dark: boolean, palette: Record<string, any>, brush: boolean}} options of the page; the
   *   palette has colors by name and `tension`, a row of them
   * @param {(name: string, value: any) => void} tell is told "connected", "failure" and "note"
   */
  constructor(element, canvases, options, tell) {
    super(options.palette, options.dark);
    this.element = element;
    this.tell = tell;
    this.brush = options.brush;
    this.under = canvases[0];
    this.sheet = canvases[1];
    this.underOf = null; // the ghosts that are drawn there,
    this.underAs = ""; // and how they were seen
    /** @type {THREE.WebGLRenderer | null} */
    this.renderer = null; // made for the first body in space: flat ones need no WebGL
    this.slow = hasNoCard();
    this.overlay = new Overlay(canvases[2], this.slow);
    this.font = getComputedStyle(element).fontFamily || "sans-serif";
    this.dirty = new Set();
    this.before = 0; // drags of other rooms that come before the next answer
    this.unseen = 0; // frames that came and were not acknowledged
    this.pixel = new Uint8Array(4);
    this.probe = new Probe(this);
    window.__app = this.probe;
    this.dress(options.dark);
    this.pointer = new Pointer(this);
    this.watch = new ResizeObserver(() => this.mark("size"));
    this.watch.observe(element);
    this.sheet.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.sheet.addEventListener("webglcontextrestored", () => this.mark("camera"));
    const receive = (buffer) => this.guarded(() => this.receive(buffer));
    this.link = new Link(options.stream, receive, (connected) => this.linked(connected));
    document.fonts?.ready.then(() => this.mark("camera")); // labels that were written before the page's letters came
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
      if (this.probe.errors.length < 100) this.probe.errors.push(String((error instanceof Error && error.stack) || error));
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
      this.unseen += 1;
      if (!document.hidden) this.acknowledge(); // the next one need not wait until this one is painted
      if (head.before !== this.before) this.tell("before", head.before);
      this.before = head.before;
      this.mark("frame");
    } else if (head.kind === "note") {
      this.tell("note", head);
    }
  }

  acknowledge() {
    if (this.unseen) this.send({ kind: "seen", count: Math.min(this.unseen, 1000) });
    this.unseen = 0;
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
    this.acknowledge();
    if (fresh) this.probe.saw(this.stamp ?? 0, performance.now() - start);
  }

  /** Take the newest frame, and the scene it belongs to if that is new; whether there was one. */
  advance(bare) {
    const { coming, latest } = this;
    this.latest = null;
    if (coming && (bare || latest?.head.scene === coming.head.serial)) {
      this.coming = null;
      clearTimeout(this.bare);
      if (this.build(coming.head, coming.arrays)) {
        this.camera.begin(this.camera.flat);
        this.fitting = true;
      }
    }
    if (!latest || latest.head.scene !== this.serial) return false;
    this.stamp = latest.head.stamp;
    this.move(latest.arrays);
    if (this.fitting) this.fit();
    return true;
  }

  openRenderer() {
    if (this.renderer) return;
    try {
      this.renderer = new THREE.WebGLRenderer({ canvas: this.sheet, alpha: true, powerPreference: "high-performance" });
    } catch (error) {
      this.tell("failure", "Bodies in space need WebGL, which this browser does not have. Switch it on, or use another.");
      throw error;
    }
    this.renderer.setClearColor(0, 0);
    this.resize();
  }

  dress(dark) {
    this.theme = theme(dark);
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
    const ghosts = Object.values(this.ghosts).map((ghost) => ghost.array);
    this.camera.fit([this.nodes, this.points, ...ghosts], this.camera.flat ? MARGIN.flat : MARGIN.space);
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
    this.under.style.visibility = this.sheet.style.visibility = surface ? "visible" : "hidden";
    const gl = surface && renderer.getContext();
    if (gl) {
      this.paintUnder();
      renderer.render(this.world, camera.now);
      gl.flush(); // the body is drawn while all else is
      this.cover.see(this.nodes, camera, this.cut);
    }
    this.spread();
    overlay.draw(this);
    // reading a pixel waits until all is drawn: what is told as painted is painted
    if (this.slow) overlay.pen.getImageData(0, 0, 1, 1);
    if (gl) gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, this.pixel);
  }

  /** Ghosts in space stay where they are until the camera moves. */
  paintUnder() {
    const { under, ratio } = this;
    const now = [this.overlay.canvas.width, this.overlay.canvas.height, this.theme.back, ...this.camera.matrix.elements].join();
    if (this.underOf === this.ghosts && this.underAs === now) return;
    Object.assign(this, { underOf: this.ghosts, underAs: now });
    [under.width, under.height] = [this.overlay.canvas.width, this.overlay.canvas.height];
    const pen = under.getContext("2d", { willReadFrequently: this.slow });
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawGhostsInSpace(pen, this);
  }

  // What the page may ask for.

  look(name) {
    const moved = this.camera.moved;
    this.camera.look(name, performance.now(), () => moved || this.fit());
    this.mark("camera");
  }

  parallel(on) {
    this.camera.parallel = on;
    this.mark("camera");
  }

  /** How solid a body in space looks, from 0 to 1. */
  seeThrough(opacity) {
    this.opacity = opacity;
    this.applyLook();
    this.mark("camera");
  }

  mesh(on) {
    this.edges = on;
    this.mark("camera");
  }

  open(axis, share) {
    this.cutAcross(axis, share);
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
      pen.drawImage(this.under, 0, 0);
      this.renderer.render(this.world, this.camera.now);
      pen.drawImage(this.sheet, 0, 0);
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
    this.renderer?.dispose();
    if (window.__app === this.probe) delete window.__app;
  }
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
