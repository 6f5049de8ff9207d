// A board with our firmware on Web Serial: identify, arm, follow, stop. The lines are those of control/firmware/winches.c.

const TURN = 40, SILENT = 160; // time from one command to the next, and longest time without an answer [ms]

/** A line with its checksum, CRC-16 of Modbus. */
export function lineOf(text) {
  let check = 0xffff;
  for (let i = 0; i < text.length; i++) {
    check ^= text.charCodeAt(i);
    for (let bit = 0; bit < 8; bit++) check = check & 1 ? (check >> 1) ^ 0xa001 : check >> 1;
  }
  return `${text}*${check.toString(16).toUpperCase().padStart(4, "0")}\n`;
}

const RANGE_TOLERANCE = 5e-4; // motors may stand so far beyond the limits of their winch [m], as in bus_link.py
const TAUT = "Turn all spools until each cable is just taut. Then set zero.";

/** Straight pieces of a curve, as in motors.toml: start [rad], cable taken in there [m], radius [m]. */
function piecesOf(motor) {
  const points = [[0, 0], ...motor.curve];
  const rising = motor.curve.map(([angle, taken], i) => [...points[i], (taken - points[i][1]) / (angle - points[i][0])]);
  return [[0, 0, motor.radius], ...rising];
}

/** Angle of a motor from its zero [rad] at which so much cable is taken in [m]. */
function turned(motor, contraction) {
  const pieces = piecesOf(motor), [start, before, radius] = pieces.findLast(([, each]) => contraction > each) ?? pieces[0];
  return motor.turns * (start + (contraction - before) / radius);
}

/** Cable taken in [m] at an angle from the zero [rad]: the inverse of `turned`. */
function taken(motor, angle) {
  const way = motor.turns * angle, pieces = piecesOf(motor);
  const [start, before, radius] = pieces.findLast(([each]) => way > each) ?? pieces[0];
  return before + radius * (way - start);
}

/** Largest radius on the way between two contractions [m]. */
function widest(motor, one, two) {
  const [low, high] = [Math.min(one, two), Math.max(one, two)], pieces = piecesOf(motor);
  const passed = pieces.filter(([, start], i) => (i === 0 || start <= high) && (pieces[i + 1]?.[1] ?? Infinity) >= low);
  return Math.max(...passed.map(([, , radius]) => radius));
}

export class Board {
  /**
   * @param {any} facts of the motors, as toy_page.py writes them: robot, speed [m/s], motors in the order of the winches
   * @param {(state: string, words: string, readings: {taken: number[], amperes: number[]} | null) => void} report
   */
  constructor(facts, report) {
    this.facts = facts;
    this.report = report;
    this.state = "closed";
    this.number = 0;
    this.heard = "";
    this.waiting = new Map();
    this.timer = 0;
    this.stops = 0; // how often it was told to stop or to arm
    this.mayBeArmed = false; // whether the board may have been armed since its zero was set
    this.places = facts.motors.map(() => 0); // cable taken in at the last reading [m]
    this.order = facts.motors.map((_, i) => i).sort((a, b) => facts.motors[a].number - facts.motors[b].number);
    this.zeros = facts.motors.map(() => 0);
  }

  /** Open a port and ask who is there; a board that was made for another robot is refused. */
  async open(port) {
    this.port = port;
    await port.open({ baudRate: 250000 });
    this.writer = port.writable.getWriter();
    this.reader = port.readable.getReader();
    this.listen();
    try {
      await this.identify();
    } catch (error) {
      await this.release();
      throw error;
    }
  }

  /** Refuse what is no board of ours, or one of another robot; a board that the port has reset begins after 2 s. */
  async identify() {
    const answer = (await this.askRepeatedly("I", 25)).split(" ");
    if (answer[0] !== "ok" || answer[1] !== "hydrostat" || answer.length < 7) throw new Error("This port has no hydrostat firmware.");
    if (answer[4] !== this.facts.robot) throw new Error(`The board was built for ${answer[4]}, not for this robot. Flash it again.`);
    if (Number(answer[5]) !== this.facts.motors.length) throw new Error(`The board has ${answer[5]} motors. Flash it again.`);
    await this.command("O");
    this.mayBeArmed = false;
    this.change("new", `Connected. ${TAUT}`);
  }

  /** Take where the motors stand as the robot at rest; only this page knows it, so the board is not marked. */
  async setZero() {
    this.zeros = this.parse(await this.askRepeatedly("R")).counts;
    this.change("ready", "Zero is set. Hold to arm.");
  }

  /** Switch torque on where the motors stand; contractions are asked for by `goal` from then on. */
  async arm(goal) {
    if (this.state !== "ready") return;
    const stops = ++this.stops;
    const bounds = this.order.map((i) => Math.max(1, Math.round(1000 * this.facts.motors[i].current)));
    const heard = (answer) => {
      if (stops !== this.stops) {
        this.stop();
        throw new Error("Stopped. Hold to arm.");
      }
      if (answer === null) { // a reset board may have taken the line, and would take the next one for an old one
        this.forget("The board did not answer.");
        throw new Error(`The board did not answer. ${TAUT}`);
      }
      return answer;
    };
    // A reset board counts from 0 wherever it stands. It takes a line with an old number, and one that was armed is off.
    if (!heard(await this.ask("R", this.number)).startsWith("no old")) return this.forget();
    const stands = this.parse(heard(await this.ask("R")));
    if (this.mayBeArmed && stands.state === "off") return this.forget();
    this.requireWithin(stands);
    this.mayBeArmed = true;
    const answer = heard(await this.ask(`A ${bounds.join(" ")}`)); // not sent again: a reset may be why it is silent
    if (answer !== "ok") throw new Error(`The board refused: ${answer}.`);
    const reading = this.parse(heard(await this.ask("R")));
    if (this.placesAt(reading.counts).some((place, i) => Math.abs(place - this.placesAt(stands.counts)[i]) > RANGE_TOLERANCE)) return this.forget();
    this.goal = goal;
    this.change("armed", "Armed. The robot follows the page.");
    if (this.read(reading)) this.timer = setTimeout(() => this.follow(), TURN);
  }

  /** Refuse to arm motors that stand beyond the limits of their winches. */
  requireWithin({ counts }) {
    this.placesAt(counts).forEach((place, i) => {
      const { mark, low, high } = this.facts.motors[i];
      if (place >= low - RANGE_TOLERANCE && place <= high + RANGE_TOLERANCE) return;
      const [at, from, to] = [place, low, high].map((value) => (1000 * value).toFixed(1));
      const words = `${mark} stands at ${at} mm. Its limits are ${from} and ${to} mm. ${TAUT}`;
      this.change("new", words);
      throw new Error(words);
    });
  }

  placesAt(counts) {
    return counts.map((count, i) => taken(this.facts.motors[i], (count - this.zeros[i]) * ((2 * Math.PI) / this.facts.motors[i].counts)));
  }

  /** Ask for the zero again, as the board was reset, or may have been. */
  forget(why = "The board was reset.") {
    this.stop();
    this.mayBeArmed = false;
    this.change("new", `${why} ${TAUT}`);
  }

  /** Send goals and read, again and again; whatever goes wrong stops the motors. */
  async follow() {
    if (this.state !== "armed") return;
    try {
      const pairs = this.order.map((i) => {
        const motor = this.facts.motors[i], scale = motor.counts / (2 * Math.PI);
        const wanted = Math.min(motor.high, Math.max(motor.low, this.goal()[i]));
        if (!Number.isFinite(wanted)) throw new Error("The goal is no number.");
        const rate = (this.facts.speed / widest(motor, this.places[i], wanted)) * scale;
        return `${Math.round(this.zeros[i] + scale * turned(motor, wanted))} ${Math.max(1, Math.floor(rate))}`;
      });
      const [went, answer] = await Promise.all([this.ask(`G ${pairs.join(" ")}`), this.ask("R")]);
      if (this.state !== "armed") return;
      if (!this.read(this.parse(answer))) return;
      if (went !== "ok") throw new Error(`The board refused: ${went ?? "no answer"}.`);
      this.timer = setTimeout(() => this.follow(), TURN);
    } catch (error) {
      this.stop(error instanceof Error ? error.message : String(error));
    }
  }

  /** Take a reading of armed motors; false if the board was reset. */
  read({ state, counts, amperes }) {
    if (state === "off") this.forget();
    else if (state !== "armed") throw new Error(`The board stopped: ${state}.`);
    if (this.state !== "armed") return false;
    this.places = this.placesAt(counts);
    this.report(this.state, "", { taken: this.places, amperes });
    return true;
  }

  parse(answer) {
    if (answer === null) throw new Error("The board does not answer. Check its power and cable.");
    const words = answer.split(" "), numbers = words.slice(3).map(Number), count = this.order.length;
    if (words[0] !== "ok" || numbers.length !== 2 * count || !numbers.every(Number.isFinite)) throw new Error("The board sent an unreadable answer.");
    const counts = new Array(count), amperes = new Array(count);
    this.order.forEach((i, slot) => { [counts[i], amperes[i]] = [numbers[2 * slot], numbers[2 * slot + 1] / 1000]; });
    return { state: words[1], counts, amperes };
  }

  /** Stop the motors where they are. Without any word from here the board stops itself 200 ms after the last one. */
  stop(words = "Stopped. Hold to arm.") {
    clearTimeout(this.timer);
    this.stops++;
    if (this.state === "closed") return;
    for (let i = 0; this.mayBeArmed && i < 3; i++) this.send("S"); // a line that a reset board takes would hide the reset
    if (this.state === "armed") this.change("ready", words);
  }

  async command(words) {
    const answer = await this.askRepeatedly(words);
    if (answer !== "ok") throw new Error(`The board refused: ${answer}.`);
  }

  async askRepeatedly(words, trials = 3) {
    for (let i = 0; i < trials; i++) {
      const answer = await this.ask(words);
      if (answer !== null) return answer;
    }
    throw new Error("The board does not answer. Check its power and cable.");
  }

  send(words, number = (this.number + 1) % 256) {
    this.number = number;
    this.writer.write(new TextEncoder().encode(lineOf(`${number} ${words}`))).catch(() => this.lose());
    return number;
  }

  /** The answer to a line, null after the time; its number is the next one if none is given. */
  ask(words, given) {
    const number = this.send(words, given);
    return new Promise((resolve) => {
      const late = setTimeout(() => { this.waiting.delete(number); resolve(null); }, SILENT);
      this.waiting.set(number, (text) => { clearTimeout(late); this.waiting.delete(number); resolve(text); });
    });
  }

  async listen() {
    const decoder = new TextDecoder();
    try {
      for (;;) {
        const { value, done } = await this.reader.read();
        if (done) break;
        this.heard = (this.heard + decoder.decode(value)).slice(-4000);
        for (let end; (end = this.heard.indexOf("\n")) >= 0; this.heard = this.heard.slice(end + 1)) this.hear(this.heard.slice(0, end));
      }
    } catch { /* the cable was pulled */ }
    this.lose();
  }

  hear(line) {
    const text = line.slice(0, line.lastIndexOf("*")), space = text.indexOf(" ");
    if (lineOf(text) === `${line}\n`) this.waiting.get(Number(text.slice(0, space)))?.(text.slice(space + 1));
  }

  lose() {
    if (this.state === "closed") return;
    clearTimeout(this.timer);
    this.change("closed", "The cable is unplugged. The board stops by itself.");
    this.release();
  }

  /** Give the port back, so that it can be opened again. */
  async release() {
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
