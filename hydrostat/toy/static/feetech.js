// Feetech's STS3215: packets and registers, as in control/feetech_bus.py. They have no watchdog.

import { bytesOf } from "./dynamixel.js";

const TICK = (2 * Math.PI) / 4096; // angle of a step [rad]

/** Number with its sign in the highest of 16 bits. */
function tickOf(low, high) {
  return high & 0x80 ? -(low + 256 * (high & 0x7f)) : low + 256 * high;
}

function sumOf(bytes) {
  return ~bytes.reduce((sum, byte) => sum + byte, 0) & 255;
}

/** True if a packet without one byte or its end fails its sum when a repeated value follows, as in feetech_bus.py. */
function isRefused(packet, value) {
  if (packet.includes(value)) return false;
  const cuts = [[packet[2] + value, value], [2 * value, value]];
  let kept = packet[2];
  for (let place = 1; place < packet.length - 3; place++) cuts.push([(kept += packet[place + 2]), packet.length - 3 - place]);
  return cuts.every(([sum, missing]) => (sum + missing * value) % 256 !== 255);
}

function fillerOf(sent) {
  let value = 0;
  while (!sent.every((packet) => isRefused(packet, value))) value++;
  return new Array(Math.max(...sent.map((packet) => packet.length), 0, value + 2)).fill(value);
}

export class Feetech {
  baud = 1_000_000;
  torque = 40;
  goal = 42;
  state = [56, 15];
  watch = null;

  constructor(facts) {
    this.facts = facts.feetech;
    this.spans = new Map(); // steps that each may turn to
    this.rated = 0; // supply of the servos [V]
    this.sent = []; // packets of which one may still wait for its end in a servo
  }

  at(...places) {
    return places;
  }

  /** A packet behind a filler, with which no earlier one that was damaged on the way passes its sum. */
  pack(number, instruction, content) {
    const inner = [number, content.length + 2, instruction, ...content], packet = [0xff, 0xff, ...inner, sumOf(inner)];
    const filler = fillerOf(this.sent);
    this.sent = [...this.sent.slice(-2), packet];
    return [...filler, ...packet];
  }

  next(bytes) {
    for (let i = 0; i < bytes.length; i++) {
      if (bytes[i] !== 0xff || (bytes[i + 1] ?? 0xff) !== 0xff) continue;
      const number = bytes[i + 2], length = bytes[i + 3], end = i + 4 + length;
      if (number > 0xfe || length < 2) continue;
      if (!(bytes.length >= end)) return [null, bytes.slice(i)];
      if (sumOf(bytes.slice(i + 2, end - 1)) !== bytes[end - 1]) continue;
      return [{ number, fault: bytes[i + 4], content: bytes.slice(i + 5, end - 1) }, bytes.slice(end)];
    }
    return [null, []];
  }

  async identify(servos, number) {
    if (number === servos.numbers[0]) this.spans.clear();
    const told = await servos.get(number, 0, 13), model = told[3] + 256 * told[4];
    if (!this.facts.models.includes(model)) throw new Error(`Motor ${number} is a servo of model ${model}, not an STS3215.`);
    const mode = await servos.get(number, 33, 1);
    if (mode[0] !== 0) throw new Error(`Motor ${number} is not in position mode. Set its register 33 to 0.`);
    await servos.set(number, this.torque, [0], "its torque switch");
    const [low, high] = [tickOf(told[9], told[10]), tickOf(told[11], told[12])];
    this.spans.set(number, low < high ? [low, high] : [-30719, 30719]);
    await this.requireSupply(servos, number);
    return { measures: true, stall: this.facts.stall, constant: 0 };
  }

  /** Refuse a supply that is not that of the servo, by the limits in its memory; those for 7.4 V and 12 V look alike. */
  async requireSupply(servos, number) {
    const [most, least] = (await servos.get(number, 14, 2)).map((value) => value / 10);
    const volts = (await servos.get(number, 62, 1))[0] / 10, rated = most <= 10 ? 7.4 : 12;
    const [from, to] = [Math.max(least, rated === 12 ? 9 : 0), Math.min(most, rated === 12 ? 14 : 8.4)];
    if (volts < from || volts > to || (this.spans.size > 1 && rated !== this.rated)) {
      throw new Error(`Motor ${number} is a servo for ${rated} V and measures ${volts} V. Switch the power off, then connect its supply.`);
    }
    this.rated = rated;
  }

  /** As a share of the torque at stall, of the strongest variant. */
  bound({ stall }, current) {
    return [48, bytesOf(Math.max(1, Math.min(999, Math.round((1000 * current) / stall))), 2)];
  }

  goalBytes(angle) {
    const step = Math.round(angle / TICK);
    return bytesOf(Math.abs(step) | (step < 0 ? 0x8000 : 0), 2);
  }

  going(angle, speed) {
    const pace = Math.max(1, Math.min(32767, Math.round(speed / TICK)));
    return [41, [0, ...this.goalBytes(angle), 0, 0, ...bytesOf(pace, 2)]];
  }

  reading(content) {
    return { angle: TICK * tickOf(content[0], content[1]), amperes: 0.0065 * tickOf(content[13], content[14]), warm: content[7] };
  }

  requireAngles(number, angles) {
    const [low, high] = this.spans.get(number);
    if (angles.every((angle) => angle / TICK >= low && angle / TICK <= high)) return;
    throw new Error(`Motor ${number} turns from step ${low} to ${high} only. Set both its limits of angle to 0.`);
  }
}
