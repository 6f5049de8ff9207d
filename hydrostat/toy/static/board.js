// A board with our firmware on Web Serial: identify, arm, follow, stop. The lines are those of control/firmware/winches.c.

import { Drive, RANGE_TOLERANCE, SILENT, TAUT } from "./drive.js";
import { turned, widest } from "./spool.js";

const TURN = 40; // time from one command to the next [ms]

/** A line with its checksum, CRC-16 of Modbus. */
export function lineOf(text) {
  let check = 0xffff;
  for (let i = 0; i < text.length; i++) {
    check ^= text.charCodeAt(i);
    for (let bit = 0; bit < 8; bit++) check = check & 1 ? (check >> 1) ^ 0xa001 : check >> 1;
  }
  return `${text}*${check.toString(16).toUpperCase().padStart(4, "0")}\n`;
}

export class Board extends Drive {
  baud = 250000;
  unplugged = "The cable is unplugged. The board stops by itself.";

  constructor(facts, report) {
    super(facts, report);
    this.number = 0;
    this.heard = "";
    this.waiting = new Map();
    this.decoder = new TextDecoder();
    this.mayBeArmed = false; // whether the board may have been armed since its zero was set
    this.order = facts.motors.map((_, i) => i).sort((a, b) => facts.motors[a].number - facts.motors[b].number);
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
    this.zeros = this.parse(await this.askRepeatedly("R")).angles;
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
    this.requireWithin(this.placesAt(stands.angles));
    this.mayBeArmed = true;
    const answer = heard(await this.ask(`A ${bounds.join(" ")}`)); // not sent again: a reset may be why it is silent
    if (answer !== "ok") throw new Error(`The board refused: ${answer}.`);
    const reading = this.parse(heard(await this.ask("R")));
    if (this.placesAt(reading.angles).some((place, i) => Math.abs(place - this.placesAt(stands.angles)[i]) > RANGE_TOLERANCE)) return this.forget();
    this.goal = goal;
    this.change("armed", "Armed. The robot follows the page.");
    if (this.read(reading)) this.timer = setTimeout(() => this.follow(), TURN);
  }

  /** Ask for the zero again, as the board was reset, or may have been. */
  forget(why = "The board was reset.") {
    this.stop();
    this.mayBeArmed = false;
    this.askZero(why);
  }

  /** Send goals and read, again and again; whatever goes wrong stops the motors. */
  async follow() {
    if (this.state !== "armed") return;
    try {
      const pairs = this.order.map((i) => {
        const motor = this.facts.motors[i], scale = motor.counts / (2 * Math.PI), wanted = this.wanted(i);
        const rate = (this.facts.speed / widest(motor, this.places[i], wanted)) * scale;
        return `${Math.round(scale * (this.zeros[i] + turned(motor, wanted)))} ${Math.max(1, Math.floor(rate))}`;
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
  read({ state, angles, amperes }) {
    if (state === "off") this.forget();
    else if (state !== "armed") throw new Error(`The board stopped: ${state}.`);
    if (this.state !== "armed") return false;
    this.places = this.placesAt(angles);
    this.report(this.state, "", { taken: this.places, amperes, tensions: [] });
    return true;
  }

  parse(answer) {
    if (answer === null) throw new Error("The board does not answer. Check its power and cable.");
    const words = answer.split(" "), numbers = words.slice(3).map(Number), count = this.order.length;
    if (words[0] !== "ok" || numbers.length !== 2 * count || !numbers.every(Number.isFinite)) throw new Error("The board sent an unreadable answer.");
    const angles = new Array(count), amperes = new Array(count);
    this.order.forEach((i, slot) => {
      [angles[i], amperes[i]] = [(2 * Math.PI * numbers[2 * slot]) / this.facts.motors[i].counts, numbers[2 * slot + 1] / 1000];
    });
    return { state: words[1], angles, amperes };
  }

  /** Stop the motors. Without any word from here the board stops itself 200 ms after the last one. */
  halt() {
    for (let i = 0; this.mayBeArmed && i < 3; i++) this.send("S"); // a line that a reset board takes would hide the reset
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
    this.write(new TextEncoder().encode(lineOf(`${number} ${words}`)));
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

  hear(bytes) {
    this.heard = (this.heard + this.decoder.decode(bytes)).slice(-4000);
    for (let end; (end = this.heard.indexOf("\n")) >= 0; this.heard = this.heard.slice(end + 1)) this.take(this.heard.slice(0, end));
  }

  take(line) {
    const text = line.slice(0, line.lastIndexOf("*")), space = text.indexOf(" ");
    if (lineOf(text) === `${line}\n`) this.waiting.get(Number(text.slice(0, space)))?.(text.slice(space + 1));
  }
}
