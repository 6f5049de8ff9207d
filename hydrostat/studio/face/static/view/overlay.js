// All that is drawn with a pen: flat bodies, lines, areas, dots, labels, the scale bar and the sign of the axes.

import { drawFelt, drawGhosts, drawGrid, drawOutline } from "./felt.js";
import { drawClouds, drawLines } from "./lines.js";
import { FAINT, mix, veil } from "./theme.js";

export class Overlay {
  /**
   * @param {HTMLCanvasElement} canvas to draw on
   * @param {boolean} slow whether there is no graphics card: then the processor draws on its own, which is faster
   */
  constructor(canvas, slow) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d", { willReadFrequently: slow });
    this.width = this.height = 0;
    this.ratio = 1;
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    Object.assign(this, { width, height, ratio });
  }

  holds(area, x, y) {
    return this.pen.isPointInPath(area.path, x * this.ratio, y * this.ratio);
  }

  /** Draw all of a view again. */
  draw(view) {
    const { pen, ratio } = this;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    pen.lineJoin = pen.lineCap = "round";
    const { flat } = view.camera;
    if (flat) drawGrid(pen, view);
    if (view.serial >= 0) {
      if (flat) drawGhosts(pen, view);
      (flat ? drawFelt : drawOutline)(pen, view);
      drawClouds(pen, view);
    }
    for (const area of view.areas) this.area(view, area);
    for (const dot of view.dots) if (dot.look === "pin") this.pin(view, dot);
    drawLines(pen, view);
    for (const dot of view.dots) if (dot.look !== "pin") this.dot(view, dot);
    this.labels(view);
    this.scaleBar(view);
    if (!flat) this.axes(view);
  }

  area(view, area) {
    const { pen } = this;
    const path = new Path2D();
    const [first] = area.spots;
    if (area.spots.length > 2) {
      area.spots.forEach(([x, y], i) => (i ? path.lineTo(x, y) : path.moveTo(x, y)));
      path.closePath();
    } else if (first) {
      path.arc(first[0], first[1], Math.max(area.radius * first[3], 1), 0, 2 * Math.PI);
    }
    area.path = path;
    const lively = area.chosen || area.key === view.hover;
    pen.fillStyle = veil(area.color, lively ? 0.3 : 0.2);
    pen.fill(path);
    pen.lineWidth = lively ? 2.5 : 1.5;
    pen.strokeStyle = veil(area.color, 0.9);
    pen.setLineDash(lively ? [] : [6, 4]);
    pen.stroke(path);
    pen.setLineDash([]);
  }

  pin(view, dot) {
    const { pen } = this;
    const color = this.tone(view, dot.color);
    pen.globalAlpha = dot.depth > 1 ? 0.4 : 1;
    this.halo(view, dot, 13);
    if (dot.radius > 0 && view.camera.flat) {
      const radius = Math.max(dot.radius * dot.density, 6);
      const reach = new Path2D();
      reach.arc(dot.x, dot.y, radius, 0, 2 * Math.PI);
      pen.save();
      pen.clip(reach);
      pen.lineWidth = 1;
      pen.strokeStyle = veil(dot.color, 0.4);
      pen.beginPath();
      for (let k = -2 * radius; k < 2 * radius; k += 6) {
        pen.moveTo(dot.x + k - radius, dot.y + radius);
        pen.lineTo(dot.x + k + radius, dot.y - radius);
      }
      pen.stroke();
      pen.restore();
      pen.setLineDash([4, 4]);
      pen.strokeStyle = veil(dot.color, 0.8);
      pen.lineWidth = 1.2;
      pen.stroke(reach);
      pen.setLineDash([]);
    }
    // the sign of a support: a triangle on its ground
    pen.beginPath();
    pen.moveTo(dot.x, dot.y - 7);
    pen.lineTo(dot.x + 7, dot.y + 5);
    pen.lineTo(dot.x - 7, dot.y + 5);
    pen.closePath();
    pen.fillStyle = dot.color;
    pen.strokeStyle = "#ffffff";
    pen.lineWidth = 1.5;
    pen.stroke();
    pen.fill();
    pen.beginPath();
    pen.moveTo(dot.x - 9, dot.y + 8);
    pen.lineTo(dot.x + 9, dot.y + 8);
    pen.lineWidth = 2;
    pen.strokeStyle = view.camera.flat ? dot.color : color;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  winch(view, dot, lively) {
    const { pen } = this;
    this.halo(view, dot, 18);
    this.disc(dot.x, dot.y, lively ? 13 : 12, dot.color, "#ffffff", 2);
    pen.fillStyle = "#ffffff";
    pen.font = `600 ${dot.short.length > 1 ? 11 : 13}px ${view.font}`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(dot.short, dot.x, dot.y + 0.5);
  }

  dot(view, dot) {
    const { pen } = this;
    const { x, y, look } = dot;
    const lively = dot.key && dot.key === view.hover;
    pen.globalAlpha = (dot.faint ? FAINT : 1) * (dot.depth > 1 ? 0.45 : 1);
    if (look === "winch") {
      this.winch(view, dot, lively);
    } else if (look === "marker") {
      this.halo(view, dot, 11);
      this.disc(x, y, lively ? 6.5 : 5.5, dot.color, "#ffffff", 2);
      this.disc(x, y, 1.6, "#ffffff");
    } else if (look === "target") {
      this.halo(view, dot, 15);
      const tone = this.tone(view, dot.color);
      this.cross(x, y, 9, tone === dot.color ? "#ffffff" : view.theme.paper, 4.5); // colors of poses are dark ones
      this.cross(x, y, 9, tone, 1.8);
    } else if (look === "via") {
      this.halo(view, dot, 10);
      this.disc(x, y, lively ? 5.5 : 4, "#ffffff", dot.color, 2);
    } else if (look === "stopper") {
      this.halo(view, dot, 11);
      const half = lively ? 5.5 : 4.5;
      pen.beginPath();
      pen.roundRect(x - half, y - half, 2 * half, 2 * half, 1.5);
      pen.fillStyle = dot.color;
      pen.strokeStyle = "#ffffff";
      pen.lineWidth = 3;
      pen.stroke();
      pen.fill();
    } else if (look === "touch") {
      this.disc(x, y, 4, dot.color, "#ffffff", 1.5);
    } else if (look === "flag") {
      const radius = dot.chosen || told(view, dot) ? 19 : 16;
      this.ring(x, y, radius, view.theme.paper, 5);
      this.ring(x, y, radius, dot.color, dot.chosen ? 3 : 2);
    } else {
      this.halo(view, dot, 13);
      this.disc(x, y, lively ? 8 : 7, "#ffffff", dot.color, 2.5);
    }
    pen.globalAlpha = 1;
  }

  halo(view, dot, radius) {
    if (!dot.chosen) return;
    const color = dot.look === "winch" || dot.look === "via" || dot.look === "stopper" ? dot.color : view.theme.accent;
    this.disc(dot.x, dot.y, radius, veil(color, 0.28), veil(color, 0.85), 1.5);
  }

  disc(x, y, radius, fill, stroke, width) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = fill;
    pen.fill();
    if (!stroke) return;
    pen.strokeStyle = stroke;
    pen.lineWidth = width;
    pen.stroke();
  }

  ring(x, y, radius, color, width) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.stroke();
  }

  cross(x, y, radius, color, width) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.moveTo(x - radius - 4, y);
    pen.lineTo(x - 2.5, y);
    pen.moveTo(x + 2.5, y);
    pen.lineTo(x + radius + 4, y);
    pen.moveTo(x, y - radius - 4);
    pen.lineTo(x, y - 2.5);
    pen.moveTo(x, y + 2.5);
    pen.lineTo(x, y + radius + 4);
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.stroke();
  }

  /** Dark ink is light on a dark page. */
  tone(view, color) {
    return color === view.ink ? view.theme.ink : color;
  }

  /** Labels beside their dots, where there is room; those of what is chosen or under the pointer always. */
  labels(view) {
    const { pen } = this;
    const signs = view.dots.filter((dot) => dot.look !== "via" && dot.look !== "flag" && dot.look !== "touch");
    const taken = signs.map((dot) => box(dot.x - 9, dot.y - 9, 18, 18, dot));
    pen.textBaseline = "middle";
    pen.textAlign = "left";
    const must = (dot) => dot.chosen || (dot.key && dot.key === view.hover) || told(view, dot);
    const wanted = once(view.dots.filter((dot) => dot.label && (dot.look !== "flag" || must(dot)))).sort((a, b) => Number(must(b)) - Number(must(a)));
    for (const dot of wanted) {
      const pill = dot.look === "winch";
      pen.font = pill ? `600 13px ${view.font}` : `500 13px ${view.font}`;
      const wide = pen.measureText(dot.label).width + (pill ? 14 : 4);
      const tall = 20, off = pill ? 17 : 10;
      const slots = [
        box(dot.x + off, dot.y - tall / 2, wide, tall, dot), box(dot.x - off - wide, dot.y - tall / 2, wide, tall, dot),
        box(dot.x - wide / 2, dot.y - off - tall, wide, tall, dot), box(dot.x - wide / 2, dot.y + off, wide, tall, dot),
      ];
      const free = (slot) => slot && !taken.some((other) => other.dot !== dot && meets(slot, other));
      const slot = [slots[dot.slot ?? 0], ...slots].find(free) ?? (must(dot) ? slots[0] : null);
      if (!slot) continue;
      dot.slot = slots.indexOf(slot);
      taken.push({ ...slot, dot: null });
      pen.globalAlpha = dot.depth > 1 && !must(dot) ? 0.55 : 1;
      this.label(view, dot, slot, pill);
      pen.globalAlpha = 1;
    }
    for (const area of view.areas) if (area.label) this.areaLabel(view, area);
  }

  label(view, dot, slot, pill) {
    const { pen } = this;
    if (pill) {
      pen.beginPath();
      pen.roundRect(slot.x, slot.y, slot.w, slot.h, 6);
      pen.fillStyle = dot.color;
      pen.fill();
      pen.strokeStyle = "rgba(255,255,255,0.85)";
      pen.lineWidth = 1.2;
      pen.stroke();
      pen.fillStyle = "#ffffff";
      pen.fillText(dot.label, slot.x + 7, slot.y + slot.h / 2 + 1);
      return;
    }
    this.words(view, dot.label, slot.x + 2, slot.y + slot.h / 2 + 1, view.theme.ink);
  }

  areaLabel(view, area) {
    const { pen } = this;
    const x = area.spots.reduce((sum, spot) => sum + spot[0], 0) / area.spots.length;
    const y = area.spots.reduce((sum, spot) => sum + spot[1], 0) / area.spots.length;
    pen.font = `600 13px ${view.font}`;
    pen.textAlign = "center";
    this.words(view, area.label, x, y, mix(area.color, view.ink, 0.45), view.palette.light);
    pen.textAlign = "left";
  }

  /** Words with a rim of paper, so that they are read on felt as on the page. */
  words(view, text, x, y, ink, rim = view.theme.back) {
    const { pen } = this;
    pen.strokeStyle = veil(rim, 0.9);
    pen.lineWidth = 3.5;
    pen.strokeText(text, x, y);
    pen.fillStyle = ink;
    pen.fillText(text, x, y);
  }

  scaleBar(view) {
    const { pen } = this;
    const millimeter = view.camera.meter / 1000;
    const nice = Math.pow(10, Math.floor(Math.log10(120 / millimeter)));
    const length = [5, 2, 1].map((k) => k * nice).find((value) => value * millimeter <= 120);
    const wide = length * millimeter, x = view.camera.flat ? 20 : 92, y = this.height - 22;
    pen.strokeStyle = view.theme.ink;
    pen.lineWidth = 2;
    pen.lineCap = "butt";
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + wide, y);
    pen.moveTo(x, y - 4);
    pen.lineTo(x, y + 4);
    pen.moveTo(x + wide, y - 4);
    pen.lineTo(x + wide, y + 4);
    pen.stroke();
    pen.lineCap = "round";
    pen.font = `500 13px ${view.font}`;
    pen.textAlign = "center";
    pen.textBaseline = "alphabetic";
    this.words(view, `${Number(length.toPrecision(3))} mm`, x + wide / 2, y - 8, view.theme.muted);
  }

  axes(view) {
    const { pen } = this;
    const { right, up, toward } = view.camera;
    const [x, y] = [46, this.height - 44];
    const arms = ["x", "y", "z"].map((name) => ({ name, u: right[name], v: up[name], w: toward[name] }));
    arms.sort((a, b) => a.w - b.w);
    pen.font = `600 13px ${view.font}`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    for (const { name, u, v, w } of arms) {
      pen.globalAlpha = w < -0.3 ? 0.55 : 1;
      pen.strokeStyle = view.theme.axes[name];
      pen.lineWidth = 2.2;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(x + 22 * u, y - 22 * v);
      pen.stroke();
      if (Math.hypot(u, v) > 0.25) this.words(view, name, x + 32 * u, y - 32 * v, view.theme.axes[name]);
    }
    pen.globalAlpha = 1;
  }
}

function box(x, y, w, h, dot) {
  return { x, y, w, h, dot };
}

function meets(a, b) {
  return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

/** Whether a flag is about the part under the pointer. */
function told(view, dot) {
  return Boolean(dot.about) && dot.about === view.hover;
}

/** Dots without flags that say what an earlier one says. */
function once(dots) {
  const said = new Set();
  return dots.filter((dot) => dot.look !== "flag" || !(said.has(dot.label) || !said.add(dot.label)));
}
