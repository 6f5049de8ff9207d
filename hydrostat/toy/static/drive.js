// Motors on Web Serial, whatever they speak: a port, a zero that only this page knows, limits, states and words.

import { taken } from "./spool.js";

export const SILENT = 160; // longest time without an answer, or from one command to the next [ms]
export const RANGE_TOLERANCE = 5e-4; // motors may stand so far beyond the limits of their winch [m], as in bus_link.py
export const TAUT = "Turn all spools until each cable is just taut. Then set zero.";

/** Those who extend it have `identify`, `setZero`, `arm`, `halt` (motors that may turn stand), and `hear` (bytes came). */
export class Drive {
  baud = 0;
  unplugged = "The cable is unplugged.";
  released = Promise.resolve(); // once the port is given back

  /**
   * @param {any} facts of the motors, as motor_facts.py writes them: speed [m/s], motors in the order of the winches
   * @param {(state: string, words: string, readings: {taken: number[], amperes: number[], tensions: number[]} | null) =>
   *   void} report
   */
  constructor(facts, report) {
    this.facts = facts;
    this.report = report;
    this.state = "closed";
    this.timer = 0;
    this.goal = () => facts.motors.map(() => 0); // contractions that are wanted [m]
    this.stops = 0; // how often it was told to stop or to arm
    this.places = facts.motors.map(() => 0); // cable taken in at the last reading [m]
    this.zeros = facts.motors.map(() => 0); // angles [rad]
  }

  /** Open a port and ask who is there; motors that are not this robot's are refused. */
  async open(port) {
    await this.released; // or it would let go of the new port
    this.port = port;
    await port.open({ baudRate: this.baud });
    this.writer = port.writable.getWriter();
    this.reader = port.readable.getReader();
    this.listen();
    try {
      await /** @type {any} */ (this).identify();
    } catch (error) {
      await this.release();
      throw error;
    }
  }

  placesAt(angles) {
    return angles.map((angle, i) => taken(this.facts.motors[i], angle - this.zeros[i]));
  }

  /** Contraction that is wanted of a winch [m], within its limits. */
  wanted(i) {
    const { low, high } = this.facts.motors[i], wanted = Math.min(high, Math.max(low, this.goal()[i]));
    if (!Number.isFinite(wanted)) throw new Error("The goal is no number.");
    return wanted;
  }

  /** Refuse to arm motors that stand beyond the limits of their winches. */
  requireWithin(places) {
    places.forEach((place, i) => {
      const { mark, low, high } = this.facts.motors[i];
      if (place >= low - RANGE_TOLERANCE && place <= high + RANGE_TOLERANCE) return;
      const [at, from, to] = [place, low, high].map((value) => (1000 * value).toFixed(1));
      throw new Error(this.askZero(`${mark} stands at ${at} mm. Its limits are ${from} and ${to} mm.`));
    });
  }

  /** Ask for the zero again; returns the words. */
  askZero(why) {
    const words = `${why} ${TAUT}`;
    this.change("new", words);
    return words;
  }

  /** Stop the motors where they are. */
  stop(words = "Stopped. Hold to arm.") {
    clearTimeout(this.timer);
    this.stops++;
    if (this.state === "closed") return;
    /** @type {any} */ (this).halt();
    if (this.state === "armed") this.change("ready", words);
  }

  write(bytes) {
    this.writer.write(bytes).catch(() => this.lose());
  }

  async listen() {
    try {
      for (;;) {
        const { value, done } = await this.reader.read();
        if (done) break;
        /** @type {any} */ (this).hear(value);
      }
    } catch { /* the cable was pulled */ }
    this.lose();
  }

  lose(words = this.unplugged) {
    if (this.state === "closed") return;
    clearTimeout(this.timer);
    this.change("closed", words);
    this.released = this.release();
  }

  /** Give the port back, so that it can be opened again. */
  async release() {
    const late = new Promise((resolve) => { setTimeout(resolve, 100); });
    await Promise.race([this.writer.close().catch(() => {}), late]); // what stops the motors leaves first
    await this.reader.cancel().catch(() => {});
    this.reader.releaseLock();
    this.writer.releaseLock();
    await this.port.close().catch(() => {});
  }

  change(state, words) {
    this.state = state;
    this.report(state, words, null);
  }
}
