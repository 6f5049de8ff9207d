// The view of the body in the page: a Vue component around `View`.

import { View } from "hydrostat-view";

const FILL = "position:absolute;inset:0;width:100%;height:100%;display:block;pointer-events:none";

const ZOOM = 1.2; // by a key
const TURN = 24; // by a key [pixels of a drag]

let made = 0; // number of views made on this page

export default /** @type {Component} */ ({
  template: `
    <div ref="root" tabindex="0" role="application" aria-roledescription="view" aria-label="Robot view" :aria-describedby="id"
         @keydown="key" style="position:relative;width:100%;height:100%;overflow:hidden;touch-action:none;user-select:none">
      <canvas ref="under" aria-hidden="true" style="${FILL}"></canvas>
      <canvas ref="body" aria-hidden="true" style="${FILL}"></canvas>
      <canvas ref="over" aria-hidden="true" style="${FILL}"></canvas>
      <p :id="id" class="studio-unseen" aria-live="polite">{{ words }}</p>
      <div v-if="failure" role="alert" style="position:absolute;inset:0;display:grid;place-items:center;padding:24px;text-align:center">
        {{ failure }}</div>
      <div v-if="!connected && !failure" role="status"
           style="position:absolute;top:14px;left:50%;transform:translateX(-50%);padding:5px 14px;border-radius:14px;
                  font-size:13px;background:#2b2833;color:#fffdfb;opacity:0.92;pointer-events:none">
        {{ met ? "reconnecting ..." : "connecting ..." }}</div>
      <div v-if="before && connected" data-testid="before"
           style="position:absolute;bottom:14px;left:50%;transform:translateX(-50%);padding:5px 14px;border-radius:14px;
                  font-size:13px;background:#2b2833;color:#fffdfb;opacity:0.92;pointer-events:none">
        {{ before === 1 ? "1 drag is" : before + " drags are" }} ahead of yours</div>
    </div>`,

  props: { stream: String, palette: Object, dark: { default: null }, brush: Boolean, words: String },

  data: () => ({ id: `view-words-${++made}`, connected: true, met: false, failure: "", before: 0 }),

  mounted() {
    const { root, under, body, over } = this.$refs;
    const options = { stream: this.stream, palette: this.palette, dark: this.isDark(), brush: this.brush };
    this.view_ = new View(root, [under, body, over], options, (name, value) => this.hear(name, value));
    this.slow = setTimeout(() => (this.connected = this.connected && this.met), 1500);
    this.page = new MutationObserver(() => this.view_.dress(this.isDark()));
    this.page.observe(document.body, { attributes: true, attributeFilter: ["class"] });
  },

  unmounted() {
    clearTimeout(this.slow);
    this.page?.disconnect();
    this.view_?.dispose();
  },

  watch: {
    dark() {
      this.view_?.dress(this.isDark());
    },
    brush(on) {
      if (this.view_) this.view_.brush = on;
    },
  },

  methods: {
    isDark() {
      return this.dark ?? document.body.classList.contains("body--dark");
    },
    hear(name, value) {
      if (name === "connected") {
        this.connected = value;
        this.met = this.met || value;
      } else if (name === "before") {
        this.before = value ?? 0;
      } else if (name === "failure") {
        this.failure = value;
      } else {
        this.$emit(name, value);
      }
    },
    /** Plus and minus zoom, arrows with Ctrl turn a body in space and shift a flat one. */
    key(event) {
      const view = this.view_;
      const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const zooms = { "+": 1 / ZOOM, "=": 1 / ZOOM, "-": ZOOM };
      if (!view || event.target !== this.$refs.root) return;
      const plain = !event.ctrlKey && !event.metaKey && !event.altKey; // the browser zooms by Ctrl with plus
      if (plain && event.key in zooms) view.camera.zoom(view.camera.width / 2, view.camera.height / 2, zooms[event.key]);
      else if (event.ctrlKey && !event.metaKey && !event.altKey && event.key in ways) {
        const [dx, dy] = ways[event.key].map((way) => way * TURN);
        if (view.camera.flat) view.camera.pan(dx, dy);
        else view.camera.orbit(dx, dy);
      } else return;
      event.preventDefault();
      event.stopPropagation();
      view.mark("camera");
    },
    view(name) {
      this.view_?.look(name);
    },
    fit() {
      this.view_?.fit();
    },
    section(axis, share) {
      this.view_?.open(axis, share);
    },
    orthographic(on) {
      this.view_?.parallel(on);
    },
    opacity(value) {
      this.view_?.seeThrough(value);
    },
    mesh(on) {
      this.view_?.mesh(on);
    },
    picture() {
      return this.view_?.picture() ?? null;
    },
  },
});
