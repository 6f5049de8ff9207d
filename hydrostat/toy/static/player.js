// Poses and moves in time: from where the winches stand gently to each pose and back, or along keyframes.

const WAY = 1.1, REST = 0.5; // time of a way and of a rest [s]

export class Player {
  constructor() {
    this.keys = [];
    this.began = 0;
  }

  get plays() {
    return this.keys.length > 0;
  }

  /** Go from contractions through others, one after the other. */
  visit(from, stops, now) {
    let time = 0;
    this.keys = [[0, from]];
    for (const stop of stops) {
      this.keys.push([(time += WAY), stop]);
      if (stops.length > 1) this.keys.push([(time += REST), stop]);
    }
    this.began = now;
  }

  /** Follow keyframes, pairs of a time [s] and contractions, after a way to the first. */
  follow(from, keys, now) {
    this.keys = [[0, from], ...keys.map(([time, to]) => [WAY + time - keys[0][0], to])];
    this.began = now;
  }

  stop() {
    this.keys = [];
  }

  /** Contractions at a time [s]; the last ones end it. */
  at(now) {
    const time = now - this.began, next = this.keys.findIndex((key) => key[0] >= time);
    if (next < 0) {
      const last = this.keys[this.keys.length - 1][1];
      this.stop();
      return last;
    }
    if (next === 0) return this.keys[0][1];
    const [[start, from], [end, to]] = [this.keys[next - 1], this.keys[next]];
    const share = (time - start) / (end - start), gentle = share * share * (3 - 2 * share);
    return from.map((value, i) => value + gentle * (to[i] - value));
  }
}
