// Servos of ROBOTIS' X series by protocol 2.0: packets and registers, as in control/dynamixel_bus.py.

/** Bytes of a number, the low one first. */
export function bytesOf(value, size) {
  return Array.from({ length: size }, (_, i) => (value >> (8 * i)) & 255);
}

/** Number of some bytes with its sign. */
function signedOf(bytes) {
  const value = bytes.reduce((sum, byte, i) => sum + byte * 256 ** i, 0);
  return value < 256 ** bytes.length / 2 ? value : value - 256 ** bytes.length;
}

const STEP = (2 * Math.PI) / 4096; // angle of a step [rad]
const PACE = (0.229 * 2 * Math.PI) / 60; // speed of a step [rad/s]
const SPEEDING = Math.round(200 / ((214.577 * 2 * Math.PI) / 3600)); // acceleration at which they begin and end to turn

function checkOf(bytes) {
  let value = 0;
  for (const byte of bytes) {
    value ^= byte << 8;
    for (let bit = 0; bit < 8; bit++) value = value & 0x8000 ? ((value << 1) ^ 0x8005) & 0xffff : value << 1;
  }
  return bytesOf(value, 2);
}

/** Bytes with others put in place of three; the search goes on after them. */
function replaced(bytes, three, others) {
  const found = [];
  for (let i = 0; i < bytes.length; i++) {
    const here = three.every((byte, k) => bytes[i + k] === byte);
    found.push(...(here ? others : [bytes[i]]));
    if (here) i += three.length - 1;
  }
  return found;
}

export class Dynamixel {
  baud = 57600;
  torque = 64;
  goal = 116;
  state = [126, 21]; // first register and number of bytes
  watch = [98, 10]; // register of the watchdog, and its time [20 ms]

  constructor(facts) {
    this.models = facts.dynamixel;
  }

  /** A register, or a register and a size, as packets hold them. */
  at(...places) {
    return places.flatMap((place) => bytesOf(place, 2));
  }

  pack(number, instruction, content) {
    const inner = replaced([instruction, ...content], [0xff, 0xff, 0xfd], [0xff, 0xff, 0xfd, 0xfd]);
    const packet = [0xff, 0xff, 0xfd, 0, number, ...bytesOf(inner.length + 2, 2), ...inner];
    return [...packet, ...checkOf(packet)];
  }

  /** The next answer among bytes, null for none that is whole, and the bytes that are left. */
  next(bytes) {
    for (let i = 0; i < bytes.length; i++) {
      const head = bytes.slice(i, i + 4);
      if (![0xff, 0xff, 0xfd, 0].slice(0, head.length).every((byte, k) => head[k] === byte)) continue;
      const length = bytes[i + 5] + 256 * bytes[i + 6], end = i + 7 + length;
      if (!(bytes.length >= i + 7) || (length <= 200 && bytes.length < end)) return [null, bytes.slice(i)];
      const whole = bytes.slice(i, end), sum = checkOf(whole.slice(0, -2));
      if (length < 4 || length > 200 || sum[0] !== whole.at(-2) || sum[1] !== whole.at(-1)) continue;
      const inner = replaced(whole.slice(7, -2), [0xff, 0xff, 0xfd, 0xfd], [0xff, 0xff, 0xfd]);
      const packet = inner[0] === 0x55 ? { number: whole[4], fault: inner[1] & 0x80, content: inner.slice(2) } : null;
      if (packet) return [packet, bytes.slice(end)];
      return this.next(bytes.slice(end));
    }
    return [null, []];
  }

  /** Ratings of a servo, which stands in its mode without torque. */
  async identify(servos, number) {
    const model = signedOf(await servos.get(number, 0, 2)), ratings = this.models[model];
    if (!ratings) throw new Error(`Motor ${number} is a servo of model ${model}, which the page does not know.`);
    await servos.set(number, this.torque, [0], "its torque switch");
    await servos.set(number, 11, [ratings.measures ? 5 : 4], "its mode");
    return ratings;
  }

  /** Register and bytes that bound a current [A]; never as they are when the servo is switched on. */
  bound({ measures, stall }, current) {
    const share = Math.min(current / stall, 1);
    return measures ? [102, bytesOf(Math.max(1, Math.round(1000 * share * stall)), 2)] : [100, bytesOf(Math.max(1, Math.min(884, Math.round(885 * share))), 2)];
  }

  goalBytes(angle) {
    return bytesOf(Math.round(angle / STEP), 4);
  }

  /** First register and bytes that let a servo go to an angle at a speed. */
  going(angle, speed) {
    const pace = Math.max(1, Math.min(32767, Math.round(speed / PACE)));
    return [108, [...bytesOf(SPEEDING, 4), ...bytesOf(pace, 4), ...this.goalBytes(angle)]];
  }

  reading(content, { measures, stall }) {
    const amperes = (signedOf(content.slice(0, 2)) / 1000) * (measures ? 1 : stall);
    return { angle: STEP * signedOf(content.slice(6, 10)), amperes, warm: content[20] };
  }
}
