// The view of the body in the page: a Vue component around `View`.

import { View } from "hydrostat-view";

const FILL = "position:absolute;inset:0;width:100%;height:100%;display:block;pointer-events:none";

export default /** @type {Component} */ ({
  template: `
    <div ref="root" tabindex="-1" role="img" aria-label="The body"
         style="position:relative;width:100%;height:100%;overflow:hidden;touch-action:none;user-select:none;outline:none">
      <canvas ref="under" style="${FILL}"></canvas>
      <canvas ref="body" style="${FILL}"></canvas>
      <canvas ref="over" style="${FILL}"></canvas>
      <div v-if="failure" style="position:absolute;inset:0;display:grid;place-items:center;padding:24px;text-align:center">
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

  props: { stream: String, palette: Object, dark: { default: null }, brush: Boolean },

  data: () => ({ connected: true, met: false, failure: "", before: 0 }),

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
