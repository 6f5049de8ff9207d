// Keyframes in time: a ruler, the contraction of each winch as a curve, keys as diamonds, and the playhead.
const RULER = 28;
const CURVES = 66;
const KEYS = 26;
const PAD = 18;
const HEIGHT = RULER + CURVES + KEYS;
const OFTEN = 33; // the studio is told no more often [ms]
const LINGER = 300; // so long after a drag the studio's answer may be under way [ms]
const SNAP = 5; // px
const STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120];

export default /** @type {Component} */ ({
  template: `
    <svg :height="height" width="100%" tabindex="0" role="slider" aria-label="Timeline" aria-valuemin="0" :aria-valuemax="seconds"
      :aria-valuenow="time" :aria-valuetext="spoken" style="display: block; --head: color-mix(in oklab, #c8243f, white var(--lift, 0%));
      touch-action: none; user-select: none; font-size: 13px" @pointerdown="grab" @pointermove="drag" @pointerup="letGo"
      @pointercancel="letGo" @dblclick="$emit('add', { time: timeAt($event) })" @keydown="key">
      <rect :x="left" :y="ruler" :width="span" :height="height - ruler - 2" rx="6" fill="var(--room)" />
      <rect :x="left" :y="ruler + curves" :width="span" :height="keyroom - 2" rx="6" fill="var(--line)" opacity="0.45" />
      <g v-for="tick in ticks" :key="tick.time">
        <line :x1="tick.x" :x2="tick.x" :y1="tick.words ? ruler - 7 : ruler - 4" :y2="tick.words ? height - 2 : ruler"
          stroke="var(--line)" stroke-width="1" />
        <text v-if="tick.words" :x="tick.x" :y="12" :text-anchor="tick.anchor" fill="var(--muted)"
          style="font-variant-numeric: tabular-nums">{{ tick.words }}</text>
      </g>
      <path v-for="(path, index) in paths" :key="'path' + index" :d="path" fill="none" :stroke="'color-mix(in oklab, ' + colors[index] + ', white var(--lift, 0%))'"
        stroke-width="1.8" stroke-linejoin="round" opacity="0.9" />
      <g v-for="(mark, index) in marks" :key="'key' + index">
        <line :x1="mark.x" :x2="mark.x" :y1="ruler" :y2="ruler + curves" stroke="var(--muted)" stroke-width="1"
          opacity="0.35" />
        <rect x="-6" y="-6" width="12" height="12" rx="2.5" :data-key="index" style="cursor: grab"
          :transform="'translate(' + mark.x + ' ' + row + ') rotate(45)'"
          :fill="mark.chosen ? 'var(--accent)' : 'var(--paper)'" :stroke="mark.chosen ? 'var(--accent)' : 'var(--muted)'"
          stroke-width="1.8" />
      </g>
      <foreignObject v-if="!keys.length" :x="left" :y="ruler" :width="span" :height="curves" style="pointer-events: none">
        <div class="studio-empty">{{ hint }}</div>
      </foreignObject>
      <g :transform="'translate(' + x(shownTime) + ' 0)'" style="pointer-events: none">
        <line x1="0" x2="0" :y1="ruler - 6" :y2="height - 2" stroke="var(--head)" stroke-width="1.6" />
        <path :d="'M-6 ' + (ruler - 13) + 'h12v6l-6 6l-6 -6z'" fill="var(--head)" stroke="var(--paper)" stroke-width="1" />
      </g>
      <g v-if="held && held.moved" :transform="'translate(' + x(held.time) + ' ' + (ruler + curves - 10) + ')'"
        style="pointer-events: none">
        <rect x="-30" y="-15" width="60" height="21" rx="6" fill="var(--ink)" />
        <text x="0" y="0" text-anchor="middle" fill="var(--paper)">{{ held.time.toFixed(2) }} s</text>
      </g>
    </svg>`,
  props: {
    seconds: Number,
    keys: Array,
    colors: Array,
    smooth: Boolean,
    time: Number,
    playing: Boolean,
    speed: Number,
    loop: Boolean,
    chosen: Number,
    hint: String,
  },
  emits: ["seek", "choose", "move", "drop", "add"],
  data: () => ({ width: 600, held: null, clock: 0, height: HEIGHT, ruler: RULER, curves: CURVES, keyroom: KEYS, left: PAD }),
  computed: {
    spoken() {
      const key = this.keys[this.chosen];
      return `${this.time.toFixed(2)} s${key ? `, keyframe ${this.chosen + 1} of ${this.keys.length}` : ""}`;
    },
    span() {
      return Math.max(this.width - 2 * PAD, 50);
    },
    row() {
      return RULER + CURVES + KEYS / 2 - 1;
    },
    shownTime() {
      return this.held && !this.held.gone ? this.held.time : Math.min(this.clock, this.seconds);
    },
    shownKeys() {
      const held = this.held;
      if (!held || !held.moved) return this.keys.map((key, index) => ({ ...key, chosen: index === this.chosen }));
      return held.keys.map((key, index) =>
        index === held.index ? { ...key, time: held.time, chosen: true } : { ...key, chosen: false },
      );
    },
    marks() {
      return this.shownKeys.map((key) => ({ x: this.x(key.time), chosen: key.chosen }));
    },
    paths() {
      const keys = this.shownKeys.slice().sort((one, other) => one.time - other.time);
      if (!keys.length) return [];
      return this.colors.map((_, winch) => this.path(keys, winch));
    },
    ticks() {
      const step = STEPS.find((each) => (each * this.span) / this.seconds > 70) || 120;
      const parts = this.span / (this.seconds / step) / 5 > 6 ? 5 : 1;
      const ticks = [];
      for (let index = 0; (index * step) / parts <= this.seconds + 1e-9; index++) {
        const time = (index * step) / parts;
        const words = index % parts === 0 ? `${Number(time.toFixed(1))} s` : "";
        ticks.push({ time, x: this.x(time), words, anchor: index === 0 ? "start" : "middle" });
      }
      return ticks;
    },
  },
  watch: {
    time(time) {
      // a playhead that runs here anyway is only drawn towards where it is there, so that it does not tremble
      const off = time - this.clock;
      this.clock += this.playing && Math.abs(off) < 0.3 * this.speed ? 0.2 * off : off;
    },
    playing() {
      this.run();
    },
  },
  mounted() {
    this.clock = this.time;
    this.watcher = new ResizeObserver(() => (this.width = this.$el.getBoundingClientRect().width));
    this.watcher.observe(this.$el);
    this.run();
  },
  unmounted() {
    this.watcher.disconnect();
    clearTimeout(this.timer);
    clearTimeout(this.linger);
    cancelAnimationFrame(this.frame);
  },
  methods: {
    x(time) {
      return PAD + (this.span * time) / this.seconds;
    },
    path(keys, winch) {
      const y = (value) => RULER + CURVES - 7 - (CURVES - 14) * value;
      const points = [[PAD, y(keys[0].values[winch])]];
      keys.forEach((key, index) => {
        const before = keys[index - 1];
        if (before && this.smooth)
          for (let part = 1; part < 16; part++) {
            const share = part / 16;
            const gentle = share * share * (3 - 2 * share);
            const time = before.time + share * (key.time - before.time);
            points.push([this.x(time), y(before.values[winch] + gentle * (key.values[winch] - before.values[winch]))]);
          }
        points.push([this.x(key.time), y(key.values[winch])]);
      });
      points.push([PAD + this.span, y(keys[keys.length - 1].values[winch])]);
      return "M" + points.map(([x, height]) => `${x.toFixed(1)} ${height.toFixed(1)}`).join("L");
    },
    run() {
      cancelAnimationFrame(this.frame);
      let last = performance.now();
      const beat = (now) => {
        if (!this.playing) return;
        this.clock += ((now - last) / 1000) * this.speed;
        if (this.clock > this.seconds) this.clock = this.loop ? this.clock % this.seconds : this.seconds;
        last = now;
        this.frame = requestAnimationFrame(beat);
      };
      if (this.playing) this.frame = requestAnimationFrame(beat);
      else this.clock = this.time;
    },
    timeAt(event) {
      const box = this.$el.getBoundingClientRect();
      const time = ((event.clientX - box.left - PAD) / this.span) * this.seconds;
      const step = this.ticks.length > 1 ? this.ticks[1].time : 1;
      const goals = [Math.round(time / step) * step, ...(this.held && this.held.moved ? [] : this.keys.map((key) => key.time))];
      const near = goals.find((goal) => !event.shiftKey && Math.abs(this.x(goal) - this.x(time)) < SNAP);
      const limited = Math.min(Math.max(near === undefined ? Math.round(time * 100) / 100 : near, 0), this.seconds);
      return Math.round(limited * 1e6) / 1e6;
    },
    grab(event) {
      if (event.button !== 0) return;
      clearTimeout(this.linger);
      this.$el.setPointerCapture(event.pointerId);
      this.grabbed = true;
      const mark = event.target.getAttribute("data-key");
      if (mark === null) {
        this.held = { index: null, time: this.timeAt(event), moved: false };
        this.tell("seek", { time: this.held.time });
        return;
      }
      const index = Number(mark);
      this.held = { index, time: this.keys[index].time, keys: this.keys, from: event.clientX, moved: false };
      this.$emit("choose", { index });
    },
    drag(event) {
      if (!this.grabbed) return;
      const held = this.held;
      if (held.index === null) {
        held.time = this.timeAt(event);
        this.tell("seek", { time: held.time });
      } else if (held.moved || Math.abs(event.clientX - held.from) > 3) {
        held.moved = true;
        held.time = this.timeAt(event);
        this.tell("move", { index: held.index, time: held.time });
      }
    },
    letGo() {
      if (!this.grabbed) return;
      this.grabbed = false;
      this.flush();
      if (this.held.moved) this.$emit("drop");
      this.clock = this.held.time;
      this.linger = setTimeout(() => (this.held = null), LINGER);
      if (this.held.index === null) this.held.gone = this.playing;
    },
    tell(name, value) {
      this.word = [name, value];
      const wait = (this.told || 0) + OFTEN - performance.now();
      if (wait <= 0) this.flush();
      else if (!this.timer) this.timer = setTimeout(() => this.flush(), wait);
    },
    flush() {
      clearTimeout(this.timer);
      this.timer = null;
      if (!this.word) return;
      this.$emit(...this.word);
      this.word = null;
      this.told = performance.now();
    },
    /** Choose the keyframe after the playhead, or with PageUp the one before it. */
    next(event) {
      const order = [...this.keys.keys()].sort((one, other) => this.keys[one].time - this.keys[other].time);
      const late = (index) => this.keys[index].time - this.time;
      const ahead = order.filter((index) => late(index) > 1e-3 && index !== this.chosen);
      const behind = order.filter((index) => late(index) < -1e-3 && index !== this.chosen);
      const index = event.key === "PageDown" ? ahead[0] : behind[behind.length - 1];
      if (index !== undefined) this.$emit("choose", { index });
      event.preventDefault();
    },
    key(event) {
      const steps = { ArrowLeft: -0.05, ArrowRight: 0.05 };
      let time = null;
      if (event.altKey || event.ctrlKey || event.metaKey) return; // the browser's
      if (event.key === "PageUp" || event.key === "PageDown") return this.next(event);
      if (event.key in steps) time = this.time + steps[event.key] * (event.shiftKey ? 10 : 1);
      else if (event.key === "Home") time = 0;
      else if (event.key === "End") time = this.seconds;
      if (time === null) return;
      this.tell("seek", { time: Math.min(Math.max(time, 0), this.seconds) });
      event.preventDefault();
    },
  },
});
