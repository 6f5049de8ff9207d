// A knob that is turned round, by hand, wheel or arrow keys. While it is held it heeds nobody else.
const SWEEP = 270; // degrees from the least to the most
const OFTEN = 33; // the studio is told no more often [ms]
const LINGER = 400; // so long after the hand has let go the studio's answer may be under way [ms]

const place = (share, radius) => {
  const angle = ((share - 0.5) * SWEEP * Math.PI) / 180;
  return [32 + radius * Math.sin(angle), 32 - radius * Math.cos(angle)];
};

const arc = (from, to, radius) => {
  const [low, high] = from < to ? [from, to] : [to, from];
  const [x1, y1] = place(low, radius);
  const [x2, y2] = place(high, radius);
  return `M${x1} ${y1} A${radius} ${radius} 0 ${(high - low) * SWEEP > 180 ? 1 : 0} 1 ${x2} ${y2}`;
};

export default /** @type {Component} */ ({
  template: `
    <svg viewBox="0 0 64 64" role="slider" tabindex="0" :aria-label="label" :aria-valuemin="least" :aria-valuemax="most"
      :aria-valuenow="shown" :aria-valuetext="shown.toFixed(1) + ' mm'"
      :style="{ cursor: held === null ? 'grab' : 'grabbing', touchAction: 'none', borderRadius: '50%' }"
      @pointerdown="grab" @pointermove="drag" @pointerup="letGo" @pointercancel="letGo" @dblclick="rest"
      @wheel.prevent="wheel" @keydown="key" @keyup="$emit('letgo')" @focus="focused = true" @blur="focused = false">
      <path :d="track" fill="none" stroke="var(--line)" stroke-width="4.5" stroke-linecap="round" />
      <path v-if="Math.abs(reached - zero) > 0.002" :d="filled" fill="none" :stroke="lifted" stroke-width="4.5"
        stroke-linecap="round" />
      <circle cx="32" cy="32" r="21" fill="var(--paper)" :stroke="focused ? lifted : 'var(--line)'"
        :stroke-width="focused ? 2 : 1.5" />
      <line v-for="tooth in teeth" :key="tooth.key" v-bind="tooth" stroke="var(--line)" stroke-width="1.5"
        stroke-linecap="round" />
      <line :x1="inner[0]" :y1="inner[1]" :x2="outer[0]" :y2="outer[1]" :stroke="lifted" stroke-width="4.5"
        stroke-linecap="round" />
    </svg>`,
  props: { value: Number, reach: Number, least: Number, most: Number, step: Number, color: String, label: String },
  emits: ["turn", "letgo"],
  data: () => ({ held: null, angle: 0, told: 0, timer: null, linger: null, focused: false }),
  computed: {
    shown() {
      return this.held === null ? this.value : this.held;
    },
    share() {
      return this.shareOf(this.shown);
    },
    zero() {
      return this.shareOf(0);
    },
    reached() {
      return this.shareOf(this.reach);
    },
    lifted() {
      return `color-mix(in oklab, ${this.color}, white var(--lift, 0%))`;
    },
    track: () => arc(0, 1, 28),
    filled() {
      return arc(this.zero, this.reached, 28);
    },
    inner() {
      return place(this.share, 5);
    },
    outer() {
      return place(this.share, 17);
    },
    teeth() {
      return [0.25, 0.5, 0.75].map((turn) => {
        const share = this.share + (turn * 360) / SWEEP;
        const [x1, y1] = place(share, 15);
        const [x2, y2] = place(share, 18);
        return { key: turn, x1, y1, x2, y2 };
      });
    },
  },
  methods: {
    shareOf(value) {
      return Math.min(Math.max((value - this.least) / (this.most - this.least), 0), 1);
    },
    angleOf(event) {
      const box = this.$el.getBoundingClientRect();
      const x = event.clientX - box.left - box.width / 2;
      const y = event.clientY - box.top - box.height / 2;
      return (Math.atan2(x, -y) * 180) / Math.PI;
    },
    grab(event) {
      if (event.button !== 0) return;
      this.$el.setPointerCapture(event.pointerId);
      this.$el.focus({ preventScroll: true });
      clearTimeout(this.linger);
      this.angle = this.angleOf(event);
      this.held = this.shown;
      this.free = this.shown;
      this.grabbed = true;
      event.preventDefault();
    },
    drag(event) {
      if (!this.grabbed) return;
      const angle = this.angleOf(event);
      const turned = ((angle - this.angle + 540) % 360) - 180;
      this.angle = angle;
      const range = this.most - this.least;
      this.free += ((event.shiftKey ? 0.2 : 1) * turned * range) / SWEEP;
      this.free = Math.min(Math.max(this.free, this.least - range / 6), this.most + range / 6);
      this.set(this.free);
    },
    letGo() {
      if (!this.grabbed) return;
      this.grabbed = false;
      this.flush();
      this.$emit("letgo");
      this.forget();
    },
    forget() {
      clearTimeout(this.linger);
      this.linger = setTimeout(() => (this.held = null), LINGER);
    },
    set(value) {
      const limited = Math.min(Math.max(value, this.least), this.most);
      if (limited === this.held) return;
      this.held = limited;
      this.fresh = true;
      const wait = this.told + OFTEN - performance.now();
      if (wait <= 0) this.flush();
      else if (this.timer === null) this.timer = setTimeout(() => this.flush(), wait);
    },
    flush() {
      clearTimeout(this.timer);
      this.timer = null;
      if (!this.fresh) return;
      this.fresh = false;
      this.told = performance.now();
      this.$emit("turn", this.held);
    },
    nudge(value) {
      if (this.grabbed) return;
      this.set(value);
      this.forget();
    },
    rest() {
      this.nudge(0);
      this.flush();
      this.$emit("letgo");
    },
    wheel(event) {
      this.nudge(this.shown - Math.sign(event.deltaY) * this.step);
    },
    key(event) {
      const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 };
      if (event.altKey || event.ctrlKey || event.metaKey) return; // the browser's
      if (event.key in steps) this.nudge(this.shown + steps[event.key] * this.step);
      else if (event.key === "Home") this.nudge(this.least);
      else if (event.key === "End") this.nudge(this.most);
      else return;
      event.preventDefault();
      event.stopPropagation();
    },
  },
  unmounted() {
    clearTimeout(this.timer);
    clearTimeout(this.linger);
  },
});
