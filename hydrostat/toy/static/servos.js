// Servos on their adapter: identify, arm, follow, stop. A goal is never further ahead than a motor turns in 120 ms, so
// motors that hear nothing more stand within that time, whatever has become of the page or the cable.

import { Drive, SILENT, TAUT } from "./drive.js";
import { turned, widest } from "./spool.js";

const AHEAD = 0.12; // time for which a goal is ahead of a motor [s], as in bus_link.py
const PAUSE = 20; // time between a goal and the next reading [ms]
const RISE = 1; // acceleration of cables [m/s^2]
const HOTTEST = 75; // warmest that a motor may be [degree C]
const LAG = 1e-3, STUCK = 0.5; // a motor so far from its goal [m] that stands for so long [s] does not follow
const STANDING = 3; // speed at which motors return to where they must stand [rad/s]
const ZERO_TOLERANCE = 3e-3; // cable by which a taut one may differ from its zero in motors.toml [m]
const LAST_NUMBER = 20; // highest number at which servos of other robots are looked for
const READ = 2, WRITE = 3, PING = 1, READ_ALL = 0x82, WRITE_ALL = 0x83, EVERY = 0xfe;

const pause = (time) => new Promise((resolve) => { setTimeout(resolve, time); });

export class Servos extends Drive {
  unplugged = "The cable is unplugged. The motors stand.";

  constructor(facts, report, speech) {
    super(facts, report);
    this.speech = speech;
    this.baud = speech.baud;
    this.numbers = facts.motors.map(({ number }) => number);
    this.bytes = [];
    this.strangers = new Set(); // numbers of servos that answered and are not of this robot
    /** @type {(packet: any) => void} takes the next answer */
    this.heard = () => {};
    this.angles = facts.motors.map(() => 0); // at the last reading [rad]
    this.mayTurn = false; // whether torque may be on
    this.speed = 0; // of the cables [m/s]
  }

  /** Refuse servos that are not all of this robot and no more; these stand without torque then. */
  async identify() {
    this.strangers.clear();
    for (let number = 0; number <= LAST_NUMBER; number++) {
      if (this.numbers.includes(number)) continue;
      this.send(number, PING);
      await pause(10);
    }
    await pause(50); // adapters keep answers for a while
    this.mayTurn = false;
    this.ratings = [];
    for (const number of this.numbers) this.ratings.push(await this.speech.identify(this, number));
    const [other] = this.strangers; // all have been heard, for answers keep the order of questions
    if (other !== undefined) throw new Error(`Motor ${other} is not in motors.toml. Connect the motors of this robot only.`);
    this.change("new", `Connected. ${TAUT}`);
  }

  /** Take where the motors stand as the robot at rest. A bound of current that a reset forgets is the mark of it. */
  async setZero() {
    const { angles } = await this.read();
    this.facts.motors.forEach((motor, i) => {
      if (motor.zero === null) return;
      const off = motor.radius * (angles[i] - motor.zero - 2 * Math.PI * Math.round((angles[i] - motor.zero) / (2 * Math.PI)));
      if (Math.abs(off) <= ZERO_TOLERANCE) return;
      throw new Error(`${motor.mark} is ${Math.abs(1000 * off).toFixed(1)} mm from its zero in motors.toml. `
        + "Make its cable just taut. If it is, this is another robot, or calibrate it again.");
    });
    this.facts.motors.forEach((motor, i) => {
      this.speech.requireAngles?.(motor.number, [motor.low, motor.high].map((place) => angles[i] + turned(motor, place)));
    });
    for (const [i, motor] of this.facts.motors.entries()) {
      await this.set(motor.number, ...this.speech.bound(this.ratings[i], motor.current), "its bound of current");
    }
    this.zeros = angles;
    this.change("ready", "Zero is set. Hold to arm.");
  }

  /** Switch torque on where the motors stand; contractions are asked for by `goal` from then on. */
  async arm(goal) {
    if (this.state !== "ready") return;
    const stops = ++this.stops;
    const going = () => { if (stops !== this.stops) throw new Error("Stopped. Hold to arm."); };
    for (const [i, motor] of this.facts.motors.entries()) {
      const [place, bytes] = this.speech.bound(this.ratings[i], motor.current);
      const marked = await this.get(motor.number, place, bytes.length);
      if (!bytes.every((byte, k) => byte === marked[k])) return this.forget();
    }
    const { angles } = await this.read();
    going();
    this.requireWithin(this.placesAt(angles));
    const { watch } = this.speech;
    for (const [i, number] of this.numbers.entries()) {
      if (watch) await this.set(number, watch[0], [0], "its watchdog"); // one that has fired refuses goals
      await this.set(number, this.speech.goal, this.speech.goalBytes(angles[i]), "its goal");
      going();
      this.mayTurn = true;
      await this.set(number, this.speech.torque, [1], "its torque switch");
      going();
    }
    if (watch) await this.begin(watch);
    going();
    this.goal = goal;
    this.speed = 0;
    this.sent = this.moved = performance.now();
    this.stood = this.places = this.goals = this.placesAt(angles);
    this.change("armed", "Armed. The robot follows the page.");
    this.follow();
  }

  /** Let the own watchdogs of all begin at one time. */
  async begin([place, time]) {
    for (let i = 0; i < 5; i++) {
      this.tellAll(place, this.numbers.map(() => [time]));
      const answers = await this.askAll(place, 1);
      if (answers.every((answer) => answer?.content[0] === time)) return;
    }
    throw new Error("A motor did not take its watchdog. Check its power and cable.");
  }

  /** Motors with torque hold on, so that no load falls, until Connect lets go. */
  askZero(why) {
    if (!this.mayTurn) return super.askZero(why);
    const words = `${why} Connect again.`;
    this.stop();
    this.lose(words);
    return words;
  }

  /** A motor that lost power counts its turns from 0. */
  forget() {
    this.askZero("A motor lost power, and its count of turns.");
  }

  /** Read and send goals, again and again; whatever goes wrong stops the motors. */
  async follow() {
    if (this.state !== "armed") return;
    const stops = this.stops, before = this.angles;
    try {
      const { angles, amperes } = await this.read();
      if (stops !== this.stops) return;
      if (angles.some((angle, i) => Math.abs(angle - before[i]) > 1.5 * Math.PI)) return this.forget();
      this.places = this.placesAt(angles);
      const tensions = amperes.map((value, i) => (Math.abs(value) * this.ratings[i].constant) / this.facts.motors[i].radius);
      this.report(this.state, "", { taken: this.places, amperes, tensions });
      this.judge();
      this.tell();
      this.timer = setTimeout(() => this.follow(), PAUSE);
    } catch (error) {
      if (stops === this.stops) this.stop(error instanceof Error ? error.message : String(error));
    }
  }

  /** Refuse motors that stand beyond their limits, or away from their goals. */
  judge() {
    this.requireWithin(this.places);
    const now = performance.now();
    if (this.places.some((place, i) => Math.abs(place - this.stood[i]) > 1e-4)) [this.stood, this.moved] = [this.places, now];
    const behind = this.places.findIndex((place, i) => Math.abs(place - this.goals[i]) > LAG);
    if (behind < 0) this.moved = now;
    else if (now - this.moved > 1000 * STUCK) {
      throw new Error(`${this.facts.motors[behind].mark} does not follow. Its cable is held, or its power is off.`);
    }
  }

  tell() {
    const since = performance.now() - this.sent, { motors, speed } = this.facts;
    if (since > SILENT) throw new Error("This computer was late. Hold to arm.");
    this.speed = Math.min(speed, this.speed + RISE * Math.max(since / 1000, 1e-3));
    this.goals = motors.map((_, i) => this.wanted(i));
    const ahead = this.speed * AHEAD;
    const near = this.goals.map((goal, i) => Math.min(this.places[i] + ahead, Math.max(this.places[i] - ahead, goal)));
    if (this.goals.every((goal, i) => Math.abs(goal - this.places[i]) < 1e-4)) this.speed = 0;
    this.go(motors.map((motor, i) => {
      const rate = Math.max(this.speed, 1e-3) / widest(motor, this.places[i], near[i]);
      return this.speech.going(this.zeros[i] + turned(motor, near[i]), rate);
    }));
    this.sent = performance.now();
  }

  go(values) {
    this.tellAll(values[0][0], values.map(([, bytes]) => bytes));
  }

  halt() {
    for (let i = 0; this.mayTurn && i < 2; i++) this.go(this.angles.map((angle) => this.speech.going(angle, STANDING)));
  }

  /** Angles [rad] and currents [A] of all motors; an error if one is silent, hot or at fault. */
  async read() {
    const answers = await this.askAll(...this.speech.state);
    const readings = answers.map((answer, i) => {
      const { mark } = this.facts.motors[i];
      if (!answer) throw new Error(`${mark} does not answer. Check its power and cable.`);
      const reading = this.speech.reading(answer.content, this.ratings[i]);
      if (answer.fault) throw new Error(`${mark} reports a fault. Check its supply, heat and load.`);
      if (reading.warm > HOTTEST) throw new Error(`${mark} is ${reading.warm} °C warm, ${HOTTEST} °C at most. Let it cool.`);
      return reading;
    });
    this.angles = readings.map(({ angle }) => angle);
    return { angles: this.angles, amperes: readings.map(({ amperes }) => amperes) };
  }

  send(number, instruction, content = []) {
    this.write(Uint8Array.from(this.speech.pack(number, instruction, content)));
  }

  /** Answers of all motors to one question, three times at most within the time; null where one is silent. */
  async askAll(place, size) {
    let answers = this.numbers.map(() => null);
    for (let i = 0; i < 3 && answers.includes(null); i++) {
      const content = [...this.speech.at(place, size), ...this.numbers];
      const came = await this.ask(EVERY, READ_ALL, content, this.numbers, size, SILENT / 3);
      answers = answers.map((answer, k) => answer ?? came.get(this.numbers[k]) ?? null);
    }
    return answers;
  }

  tellAll(place, values) {
    const size = values[0].length;
    this.send(EVERY, WRITE_ALL, [...this.speech.at(place, size), ...values.flatMap((value, i) => [this.numbers[i], ...value])]);
  }

  /** Write a register, and read that it was taken. */
  async set(number, place, value, name) {
    for (let i = 0; i < 5; i++) {
      await this.ask(number, WRITE, [...this.speech.at(place), ...value], [number], 0);
      const told = await this.get(number, place, value.length);
      if (value.every((byte, k) => byte === told[k])) return;
    }
    throw new Error(`Motor ${number} did not take ${name}. Check its power and cable.`);
  }

  async get(number, place, size) {
    for (let i = 0; i < 3; i++) {
      const told = (await this.ask(number, READ, this.speech.at(place, size), [number], size)).get(number);
      if (told) return told.content;
    }
    throw new Error(`Motor ${number} does not answer. Check its power, number and baud rate.`);
  }

  /** Answers of such a size from some motors, by their numbers; fewer after the time. */
  ask(number, instruction, content, from, size, time = SILENT) {
    this.bytes = [];
    return new Promise((resolve) => {
      const came = new Map(), late = setTimeout(() => resolve(came), time);
      this.heard = (packet) => {
        if (!from.includes(packet.number) || packet.content.length !== size) return;
        came.set(packet.number, packet);
        if (came.size < from.length) return;
        clearTimeout(late);
        resolve(came);
      };
      this.send(number, instruction, content);
    });
  }

  hear(bytes) {
    this.bytes.push(...bytes);
    for (;;) {
      const [packet, left] = this.speech.next(this.bytes);
      this.bytes = left;
      if (!packet) return;
      if (!this.numbers.includes(packet.number)) this.strangers.add(packet.number);
      this.heard(packet);
    }
  }
}
