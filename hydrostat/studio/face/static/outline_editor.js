// An outline that is drawn with the pointer: loops of corners [x, y, smooth] in mm, y up.
const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const NEAR = 11; // pixels within which a click means a corner

export default /** @type {Component} */ ({
  template: `
    <svg class="outline-editor" :class="{faulty: fault, drawing: open}" tabindex="0" role="application" aria-label="Outline"
         aria-roledescription="editor" :aria-description="spoken"
         @pointerdown="down" @pointermove="move" @pointerup="up" @pointercancel="up" @dblclick="twice" @wheel.prevent="zoom"
         @keydown="key" @contextmenu.prevent>
      <image v-if="behind" :href="behind.address" :x="px(behind.left)" :y="py(behind.top)" :width="behind.wide * scale"
             :height="behind.high * scale" preserveAspectRatio="none" opacity="0.75"/>
      <g class="outline-grid">
        <line v-for="line in grid" :key="line.id" :class="line.kind" :x1="line.x1" :y1="line.y1" :x2="line.x2" :y2="line.y2"/>
        <text v-for="text in rulers" :key="text.id" :x="text.x" :y="text.y" :text-anchor="text.anchor">{{ text.words }}</text>
      </g>
      <line v-if="mirror" class="outline-mirror" :x1="px(0)" y1="0" :x2="px(0)" :y2="high"/>
      <path class="outline-body" :class="{over: behind}" :d="body" fill-rule="evenodd"/>
      <path v-if="open && open.length" class="outline-open" :d="openPath"/>
      <path v-if="open && mirror && open.length" class="outline-open outline-ghost" :d="ghostPath"/>
      <template v-for="(loop, l) in shown" :key="l">
        <template v-for="(corner, c) in loop" :key="c">
          <circle v-if="corner[2]" class="outline-corner" :class="{chosen: isChosen(l, c)}" r="5.5"
                  :cx="px(corner[0])" :cy="py(corner[1])"/>
          <rect v-else class="outline-corner" :class="{chosen: isChosen(l, c)}" width="10" height="10" rx="1.5"
                :x="px(corner[0]) - 5" :y="py(corner[1]) - 5"/>
        </template>
      </template>
      <text v-if="open && !open.length" class="outline-hint" :x="wide / 2" :y="high / 2 - 14" text-anchor="middle">
        {{ mirror ? 'Click to set corners of one side, from the line to the line; Enter ends' : 'Click to set corners; click the first one again to close' }}
      </text>
      <text v-if="held" class="outline-place" :x="px(held[0]) + 12" :y="py(held[1]) - 12">{{ held[0] }}, {{ held[1] }} mm</text>
    </svg>`,
  props: { start: Array, handle: Number, fault: Boolean, behind: Object },
  emits: ["change"],
  data() {
    return { loops: copy(this.start), open: null, chosen: null, past: [], future: [], mirror: false, snap: true, wide: 800,
      high: 500, x: 0, y: 0, scale: 2, cursor: null, drag: null, held: null };
  },
  mounted() {
    this.observer = new ResizeObserver(() => this.measure());
    this.observer.observe(this.$el);
    this.measure();
    if (this.loops.length) this.fit();
    else this.open = [];
  },
  beforeUnmount() {
    this.observer.disconnect();
    clearTimeout(this.later);
  },
  computed: {
    spoken() {
      const count = this.loops.flat().length, corner = this.chosen && this.at(this.chosen);
      const state = corner ? `Corner ${this.chosen[1] + 1} at ${corner[0]}, ${corner[1]} mm` : `${count} corners`;
      return `${state}. N and P choose a corner, arrows move it, Space makes it round or sharp, Delete removes it.`;
    },
    step() { return STEPS.find((step) => step * this.scale >= 9) || 1000; },
    shown() { return this.open ? [...this.loops, this.open] : this.loops; },
    body() { return this.loops.map((loop) => this.path(loop)).join(" "); },
    openPath() { return this.line(this.cursor ? [...this.open, this.cursor] : this.open); },
    ghostPath() { return this.line((this.cursor ? [...this.open, this.cursor] : this.open).map(([x, y]) => [-x, y])); },
    edges() {
      return { left: this.mm(0), right: this.mm(this.wide), low: this.mmy(this.high), top: this.mmy(0) };
    },
    grid() {
      const lines = [], { left, right, low, top } = this.edges, step = this.step;
      const kind = (n) => (n === 0 ? "axis" : n % 5 === 0 ? "major" : "minor");
      for (let n = Math.ceil(left / step); n * step <= right; n++)
        lines.push({ id: "x" + n, kind: kind(n), x1: this.px(n * step), x2: this.px(n * step), y1: 0, y2: this.high });
      for (let n = Math.ceil(low / step); n * step <= top; n++)
        lines.push({ id: "y" + n, kind: kind(n), y1: this.py(n * step), y2: this.py(n * step), x1: 0, x2: this.wide });
      return lines;
    },
    rulers() {
      const texts = [], { left, right, low, top } = this.edges, big = this.step * 5;
      for (let n = Math.ceil(left / big); n * big <= right; n++)
        if (this.px(n * big) > 44 && this.px(n * big) < this.wide - 62) texts.push({ id: "x" + n, words: n * big, x: this.px(n * big) + 4, y: this.high - 7, anchor: "start" });
      for (let n = Math.ceil(low / big); n * big <= top; n++)
        if (this.py(n * big) > 18 && this.py(n * big) < this.high - 26) texts.push({ id: "y" + n, words: n * big, x: 7, y: this.py(n * big) - 4, anchor: "start" });
      texts.push({ id: "unit", words: "mm", x: this.wide - 9, y: this.high - 7, anchor: "end" });
      return texts;
    },
  },
  methods: {
    // places
    px(x) { return (x - this.x) * this.scale + this.wide / 2; },
    py(y) { return this.high / 2 - (y - this.y) * this.scale; },
    mm(px) { return (px - this.wide / 2) / this.scale + this.x; },
    mmy(py) { return (this.high / 2 - py) / this.scale + this.y; },
    place(event, snapped) {
      const box = this.$el.getBoundingClientRect();
      const point = [this.mm(event.clientX - box.left), this.mmy(event.clientY - box.top)];
      const grain = snapped && this.snap && !event.altKey ? this.step : 0.1;
      return point.map((value) => round(Math.round(value / grain) * grain));
    },
    measure() {
      const box = this.$el.getBoundingClientRect();
      if (box.width) [this.wide, this.high] = [box.width, box.height];
    },
    fit() {
      const corners = this.loops.flat();
      if (!corners.length) { [this.x, this.y, this.scale] = [0, 0, 2]; return; }
      const xs = corners.map((corner) => corner[0]), ys = corners.map((corner) => corner[1]);
      const [left, right, low, top] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
      [this.x, this.y] = [(left + right) / 2, (low + top) / 2];
      this.scale = Math.min((this.wide - 120) / Math.max(right - left, 1), (this.high - 90) / Math.max(top - low, 1));
    },
    zoom(event) {
      const box = this.$el.getBoundingClientRect(), [u, v] = [event.clientX - box.left, event.clientY - box.top];
      const [x, y] = [this.mm(u), this.mmy(v)];
      this.scale = Math.min(Math.max(this.scale * Math.exp(-event.deltaY * 0.0015), 0.02), 60);
      this.x += x - this.mm(u);
      this.y += y - this.mmy(v);
    },
    // curves, as starting/loops.py makes them
    handles(loop, i) {
      const n = loop.length, a = loop[i], b = loop[(i + 1) % n], before = loop[(i + n - 1) % n], after = loop[(i + 2) % n];
      const reach = this.handle * Math.hypot(b[0] - a[0], b[1] - a[1]);
      const leave = a[2] ? unit(before, b) : unit(a, b), arrive = b[2] ? unit(a, after) : unit(a, b);
      return [[a[0] + reach * leave[0], a[1] + reach * leave[1]], [b[0] - reach * arrive[0], b[1] - reach * arrive[1]]];
    },
    path(loop) {
      if (loop.length < 2) return "";
      const at = ([x, y]) => this.px(x).toFixed(1) + "," + this.py(y).toFixed(1);
      const parts = loop.map((_, i) => {
        const [first, second] = this.handles(loop, i);
        return `C ${at(first)} ${at(second)} ${at(loop[(i + 1) % loop.length])}`;
      });
      return `M ${at(loop[0])} ${parts.join(" ")} Z`;
    },
    line(points) { return "M " + points.map(([x, y]) => `${this.px(x)},${this.py(y)}`).join(" L "); },
    // what is under the pointer
    cornerAt(event) {
      const box = this.$el.getBoundingClientRect(), [u, v] = [event.clientX - box.left, event.clientY - box.top];
      let best = null, least = NEAR;
      this.shown.forEach((loop, l) => loop.forEach((corner, c) => {
        const distance = Math.hypot(this.px(corner[0]) - u, this.py(corner[1]) - v);
        if (distance < least) [best, least] = [[l, c], distance];
      }));
      return best;
    },
    edgeAt(event) {
      const box = this.$el.getBoundingClientRect(), [u, v] = [event.clientX - box.left, event.clientY - box.top];
      let best = null, least = NEAR - 2;
      this.loops.forEach((loop, l) => loop.forEach((a, c) => {
        const b = loop[(c + 1) % loop.length], [p, q] = this.handles(loop, c);
        for (let k = 0; k <= 24; k++) {
          const s = k / 24, w = [(1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s * s * (1 - s), s ** 3];
          const x = w[0] * a[0] + w[1] * p[0] + w[2] * q[0] + w[3] * b[0];
          const y = w[0] * a[1] + w[1] * p[1] + w[2] * q[1] + w[3] * b[1];
          const distance = Math.hypot(this.px(x) - u, this.py(y) - v);
          if (distance < least) [best, least] = [[l, c], distance];
        }
      }));
      return best;
    },
    isChosen(l, c) { return !!this.chosen && this.chosen[0] === l && this.chosen[1] === c; },
    // the pointer
    down(event) {
      this.$el.focus({ preventScroll: true });
      this.$el.setPointerCapture(event.pointerId);
      const begin = { u: event.clientX, v: event.clientY, x: this.x, y: this.y, moved: false };
      const corner = event.button === 0 ? this.cornerAt(event) : null;
      if (this.open && corner && corner[0] === this.loops.length) {
        if (corner[1] === 0 || corner[1] === this.open.length - 1) this.close();
        return;
      }
      if (corner && !this.open) {
        this.chosen = corner;
        this.drag = { ...begin, corner, partner: this.partner(corner), before: this.state() };
        return;
      }
      const edge = !this.open && event.button === 0 ? this.edgeAt(event) : null;
      if (edge) {
        const before = this.state(), put = this.insert(edge, this.place(event, true));
        this.chosen = put;
        this.drag = { ...begin, corner: put, partner: this.partner(put), before, moved: true };
        this.tell();
        return;
      }
      this.drag = { ...begin, pan: true, add: !!this.open && event.button === 0 };
    },
    move(event) {
      this.cursor = this.open ? this.place(event, true) : null;
      const drag = this.drag;
      if (!drag) return;
      const [du, dv] = [event.clientX - drag.u, event.clientY - drag.v];
      if (!drag.moved && Math.hypot(du, dv) < 4) return;
      drag.moved = true;
      if (drag.pan) {
        [this.x, this.y] = [drag.x - du / this.scale, drag.y + dv / this.scale];
        return;
      }
      const place = this.place(event, true);
      if (this.mirror && same(drag.partner, drag.corner)) place[0] = 0;
      this.set(drag.corner, place);
      if (drag.partner && !same(drag.partner, drag.corner)) this.set(drag.partner, [round(-place[0]), place[1]]);
      this.held = place;
      this.tell();
    },
    up(event) {
      const drag = this.drag;
      this.drag = this.held = null;
      if (!drag) return;
      if (drag.before && drag.moved) {
        this.remember(drag.before);
        this.tell();
      } else if (drag.add && !drag.moved && event.type === "pointerup") {
        this.add(this.place(event, true));
      } else if (drag.pan && !drag.moved) {
        this.chosen = null;
      }
    },
    twice(event) {
      if (this.open) return;
      const corner = this.cornerAt(event);
      if (!corner) return;
      this.turn(corner);
    },
    /** Make a corner round, or sharp again. */
    turn(corner) {
      this.remember(this.state());
      const smooth = !this.at(corner)[2], partner = this.partner(corner);
      this.at(corner)[2] = smooth;
      if (partner) this.at(partner)[2] = smooth;
      this.tell();
    },
    key(event) {
      if (event.altKey || ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() !== "z")) return; // the browser's
      const name = event.key.toLowerCase(), arrows = { arrowleft: [-1, 0], arrowright: [1, 0], arrowup: [0, 1], arrowdown: [0, -1] };
      if (name === "delete" || name === "backspace") this.open ? this.open.pop() : this.removeCorner();
      else if (name === "z") event.shiftKey ? this.redo() : this.undo();
      else if (name === "enter") this.close();
      else if (name === "escape") { this.open = this.loops.length ? null : []; this.chosen = null; }
      else if (arrows[name] && this.chosen) this.nudge(arrows[name]);
      else if (name === " " && this.chosen) this.turn(this.chosen);
      else if (name === "n" || name === "p") this.chooseNext(name === "n" ? 1 : -1);
      else return;
      event.preventDefault();
      event.stopPropagation();
    },
    /** Choose the corner after the chosen one, or before it. */
    chooseNext(step) {
      const all = this.loops.flatMap((loop, l) => loop.map((_, c) => [l, c]));
      const now = all.findIndex((corner) => same(corner, this.chosen));
      this.chosen = all[now < 0 ? (step > 0 ? 0 : all.length - 1) : (now + step + all.length) % all.length] ?? null;
    },
    // changes
    at([l, c]) { return this.loops[l][c]; },
    set(corner, [x, y]) { const kept = this.at(corner); [kept[0], kept[1]] = [x, y]; },
    partner(corner) {
      if (!this.mirror) return null;
      const [x, y] = this.at(corner), near = 6 / this.scale;
      let best = null, least = near;
      this.loops.forEach((loop, l) => loop.forEach((other, c) => {
        const distance = Math.hypot(other[0] + x, other[1] - y);
        if (distance < least) [best, least] = [[l, c], distance];
      }));
      return best;
    },
    add(place) {
      const last = this.open[this.open.length - 1];
      if (!last || last[0] !== place[0] || last[1] !== place[1]) this.open.push([place[0], place[1], false]);
    },
    begin() { this.open = []; this.chosen = null; this.$el.focus(); },
    close() {
      if (!this.open) return;
      const made = this.mirrored(this.open);
      if (made.some((loop) => loop.length < 3)) return;
      this.remember(this.state());
      this.loops.push(...made);
      this.open = this.cursor = null;
      this.tell();
    },
    mirrored(loop) { // a half from the line to the line is joined to its other half, a hole beside the line has a twin
      const other = ([x]) => Math.abs(x) > 1e-6, twin = ([x, y, smooth]) => [-x, y, smooth];
      const oneSided = loop.every(([x]) => x > -1e-6) || loop.every(([x]) => x < 1e-6);
      if (!this.mirror || !oneSided) return [loop];
      if (this.loops.length && (other(loop[0]) || other(loop[loop.length - 1]))) return [loop, loop.map(twin)];
      return [[...loop, ...loop.filter(other).reverse().map(twin)]];
    },
    insert([l, c], place) {
      const loop = this.loops[l], next = (c + 1) % loop.length;
      const smooth = loop[c][2] || loop[next][2];
      const [a, b] = [this.partner([l, c]), this.partner([l, next])];
      const across = a && b && same(a, [l, next]);
      if (across) place = [0, place[1]];
      const corner = [place[0], place[1], smooth];
      if (a && b && !across && a[0] === l && (b[1] + 1) % loop.length === a[1]) {
        const twin = [round(-place[0]), place[1], smooth];
        if (b[1] > c) { loop.splice(b[1] + 1, 0, twin); loop.splice(c + 1, 0, corner); return [l, c + 1]; }
        loop.splice(c + 1, 0, corner);
        loop.splice(b[1] + 1, 0, twin);
        return [l, c + 2];
      }
      if (a && b && a[0] === b[0] && a[0] !== l) { // of a twin, which runs the same way round its list
        const twins = this.loops[a[0]], first = Math.min(a[1], b[1]), step = Math.abs(a[1] - b[1]);
        if (step === 1) twins.splice(first + 1, 0, [round(-place[0]), place[1], smooth]);
        else if (step === twins.length - 1) twins.push([round(-place[0]), place[1], smooth]);
      }
      loop.splice(c + 1, 0, corner);
      return [l, c + 1];
    },
    removeCorner() {
      if (!this.chosen) return;
      this.remember(this.state());
      const partner = this.partner(this.chosen), gone = [this.chosen];
      if (partner && !same(partner, this.chosen)) gone.push(partner);
      gone.sort((a, b) => b[1] - a[1]).forEach(([l, c]) => this.loops[l].splice(c, 1));
      this.loops = this.loops.filter((loop) => loop.length > 2);
      this.chosen = null;
      if (!this.loops.length) this.open = [];
      this.tell();
    },
    nudge([x, y]) {
      this.remember(this.state());
      const partner = this.partner(this.chosen), kept = this.at(this.chosen);
      const place = [round(kept[0] + x * this.step), round(kept[1] + y * this.step)];
      if (partner && same(partner, this.chosen)) place[0] = 0;
      this.set(this.chosen, place);
      if (partner && !same(partner, this.chosen)) this.set(partner, [round(-place[0]), place[1]]);
      this.tell();
    },
    put(loops) {
      this.remember(this.state());
      this.loops = copy(loops);
      this.open = this.chosen = null;
      this.fit();
      this.tell();
    },
    setMirror(on) { this.mirror = on; },
    setSnap(on) { this.snap = on; },
    state() { return JSON.stringify(this.loops); },
    remember(state) { this.past.push(state); this.past = this.past.slice(-200); this.future = []; },
    undo() {
      if (this.open && this.open.length) { this.open.pop(); return; }
      this.swap(this.past, this.future);
    },
    redo() { this.swap(this.future, this.past); },
    swap(from, to) {
      if (!from.length) return;
      to.push(this.state());
      this.loops = JSON.parse(from.pop());
      this.chosen = null;
      this.open = this.loops.length ? null : [];
      this.tell();
    },
    tell() { // at most every 80 ms, the last change always
      if (this.later) return;
      this.later = setTimeout(() => { this.later = null; this.$emit("change", copy(this.loops)); }, 80);
    },
  },
});

function copy(loops) { return JSON.parse(JSON.stringify(loops)); }
function same(a, b) { return !!a && !!b && a[0] === b[0] && a[1] === b[1]; }
function round(value) { return Math.round(value * 100) / 100 || 0; }
function unit(a, b) {
  const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1e-9;
  return [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
}
