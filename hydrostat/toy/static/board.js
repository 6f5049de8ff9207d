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

/** Angle of a motor from its zero [rad] at which so much cable is taken in [m]; `curve` as in motors.toml. */
export function turned(motor, contraction) {
  const points = [[0, 0], ...motor.curve];
  let piece = [0, 0, motor.radius];
  for (let i = 1; i < points.length; i++) {
    const [angle, taken] = points[i - 1], radius = (points[i][1] - taken) / (points[i][0] - angle);
    if (contraction > taken) piece = [angle, taken, radius];
  }
  return motor.turns * (piece[0] + (contraction - piece[1]) / piece[2]);
}

/** Cable taken in [m] at an angle from the zero [rad]: the inverse of `turned`. */
export function taken(motor, angle) {
  const points = [[0, 0], ...motor.curve], way = motor.turns * angle;
  let piece = [0, 0, motor.radius];
  for (let i = 1; i < points.length; i++) {
    const [start, before] = points[i - 1], radius = (points[i][1] - before) / (points[i][0] - start);
    if (way > start) piece = [start, before, radius];
  }
  return piece[1] + piece[2] * (way - piece[0]);
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
    this.order = facts.motors.map((_, i) => i).sort((a, b) => facts.motors[a].number - facts.motors[b].number);
    this.zeros = facts.motors.map((motor) => motor.zero * (motor.counts / (2 * Math.PI)));
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
      await this.reader.cancel().catch(() => {});
      this.reader.releaseLock();
      this.writer.releaseLock();
      await port.close().catch(() => {});
      throw error;
    }
  }

  /** Refuse what is no board of ours, or one of another robot; a board that the port has reset begins after 2 s. */
  async identify() {
    const answer = (await this.surely("I", 25)).split(" ");
    if (answer[0] !== "ok" || answer[1] !== "hydrostat" || answer.length < 7) throw new Error("This port has no hydrostat firmware.");
    if (answer[4] !== this.facts.robot) throw new Error(`The board was built for ${answer[4]}, not for this robot. Flash it again.`);
    if (Number(answer[5]) !== this.facts.motors.length) throw new Error(`The board has ${answer[5]} motors. Flash it again.`);
    const marked = answer[answer.length - 1] === "marked" && this.facts.calibrated;
    await this.must("O");
    this.change(marked ? "ready" : "new", marked ? "Connected. Hold to arm." : "Turn all spools until each cable is just taut. Then set zero.");
  }

  /** Take where the motors stand as the robot at rest. */
  async setZero() {
    const { counts } = this.parse(await this.surely("R"));
    await this.must("M");
    this.zeros = counts;
    this.change("ready", "Zero is set. Hold to arm.");
  }

  /** Switch torque on where the motors stand; contractions are asked for by `goal` from then on. */
  async arm(goal) {
    if (this.state !== "ready") return;
    const bounds = this.order.map((i) => Math.max(1, Math.round(1000 * this.facts.motors[i].current)));
    await this.must(`A ${bounds.join(" ")}`);
    this.goal = goal;
    this.read(await this.surely("R"), true);
    this.change("armed", "Armed. The robot follows the page.");
    this.timer = setTimeout(() => this.follow(), TURN);
  }

  /** Send goals and read, again and again; whatever goes wrong stops the motors. */
  async follow() {
    if (this.state !== "armed") return;
    try {
      const pairs = this.order.map((i) => {
        const motor = this.facts.motors[i], scale = motor.counts / (2 * Math.PI);
        const wanted = Math.min(motor.high, Math.max(motor.low, this.goal()[i]));
        if (!Number.isFinite(wanted)) throw new Error("The goal is no number.");
        const rate = (this.facts.speed / motor.radius) * scale;
        return `${Math.round(this.zeros[i] + scale * turned(motor, wanted))} ${Math.max(1, Math.round(rate))}`;
      });
      const [went, answer] = await Promise.all([this.ask(`G ${pairs.join(" ")}`), this.ask("R")]);
      if (this.state !== "armed") return;
      if (went !== "ok") throw new Error(went === null ? "The board does not answer." : `The board refused: ${went}.`);
      this.read(answer, false);
      this.timer = setTimeout(() => this.follow(), TURN);
    } catch (error) {
      this.stop(error instanceof Error ? error.message : String(error));
    }
  }

  read(answer, first) {
    const { state, counts, amperes } = this.parse(answer);
    if (!first && state !== "armed") throw new Error(`The board stopped: ${state}.`);
    const places = counts.map((count, i) => taken(this.facts.motors[i], (count - this.zeros[i]) * ((2 * Math.PI) / this.facts.motors[i].counts)));
    this.report(this.state, "", { taken: places, amperes });
  }

  parse(answer) {
    const words = (answer ?? "").split(" "), numbers = words.slice(3).map(Number), count = this.order.length;
    if (words[0] !== "ok" || numbers.length !== 2 * count || !numbers.every(Number.isFinite)) throw new Error("The board sent an unreadable answer.");
    const counts = new Array(count), amperes = new Array(count);
    this.order.forEach((i, slot) => { [counts[i], amperes[i]] = [numbers[2 * slot], numbers[2 * slot + 1] / 1000]; });
    return { state: words[1], counts, amperes };
  }

  /** Stop the motors where they are. Without any word from here the board stops itself 200 ms after the last one. */
  stop(words = "Stopped. Hold to arm.") {
    clearTimeout(this.timer);
    if (this.state === "closed") return;
    for (let i = 0; i < 3; i++) this.send("S");
    if (this.state === "armed") this.change("ready", words);
  }

  async must(words) {
    const answer = await this.surely(words);
    if (answer !== "ok") throw new Error(`The board refused: ${answer}.`);
  }

  async surely(words, trials = 3) {
    for (let i = 0; i < trials; i++) {
      const answer = await this.ask(words);
      if (answer !== null) return answer;
    }
    throw new Error("The board does not answer. Check its power and cable.");
  }

  send(words) {
    this.number = (this.number + 1) % 256;
    this.writer.write(new TextEncoder().encode(lineOf(`${this.number} ${words}`))).catch(() => this.lose());
    return this.number;
  }

  /** The answer to a line, null after the time. */
  ask(words) {
    const number = this.send(words);
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
  }

  change(state, words) {
    this.state = state;
    this.report(state, words, null);
  }
}
