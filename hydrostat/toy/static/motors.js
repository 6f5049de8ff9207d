// The part of the page that drives the real robot: connect, set zero, arm by a press and hold, stop.

import { Board } from "./board.js";
import { Dynamixel } from "./dynamixel.js";
import { Feetech } from "./feetech.js";
import { Servos } from "./servos.js";

const HOLD = 800; // time of a press that arms [ms]

/**
 * @param {any} facts of the motors; null where the robot has none that the page drives
 * @param {{goal: () => number[], meet: (taken: number[]) => void}} toy contractions that are wanted [m]; show where the
 *   motors stand
 */
export function offerMotors(facts, { goal, meet }) {
  if (!facts) return;
  const serial = /** @type {any} */ (navigator).serial;
  const section = document.getElementById("motors"), status = section.querySelector("p"), amperes = section.querySelector("output");
  const [first, zero, arm] = section.querySelectorAll("button");
  section.hidden = false;
  status.textContent = serial ? "" : "This browser has no Web Serial. Use Chrome or Edge on a computer.";
  let fresh = false, holding = 0;
  const attempt = async (work) => {
    try {
      await work();
    } catch (error) {
      status.textContent = error instanceof Error ? error.message : String(error);
    }
  };
  /** @param {string} state @param {string} words @param {any} readings */
  const report = (state, words, readings) => {
    if (words) status.textContent = words;
    for (const each of connects) each.hidden = state !== "closed";
    zero.hidden = state !== "new";
    arm.hidden = state !== "ready" && state !== "armed";
    arm.textContent = state === "armed" ? "Stop" : "Hold to arm";
    arm.classList.toggle("armed", state === "armed");
    if (!readings) return;
    if (fresh) meet(readings.taken);
    fresh = false;
    const force = (i) => (readings.tensions[i] ? ` ${readings.tensions[i].toFixed(1)} N` : "");
    amperes.textContent = readings.amperes.map((value, i) => `${facts.motors[i].mark} ${Math.abs(value).toFixed(2)} A${force(i)}`).join("  ");
  };
  /** @type {[string, any][]} */
  const kinds = facts.kind === "firmware" ? [["Connect", new Board(facts, report)]] : [
    ["Connect Dynamixel", new Servos(facts, report, new Dynamixel(facts))],
    ["Connect Feetech", new Servos(facts, report, new Feetech(facts))],
  ];
  let [[, board]] = kinds;
  const connects = kinds.map(([name, drive], i) => {
    const button = i ? section.insertBefore(/** @type {HTMLButtonElement} */ (first.cloneNode()), zero) : first;
    button.textContent = name;
    button.disabled = !serial;
    button.addEventListener("click", () => attempt(async () => {
      status.textContent = "Connecting …";
      board = drive;
      await board.open(await serial.requestPort());
    }));
    return button;
  });
  zero.addEventListener("click", () => attempt(() => board.setZero()));
  const press = () => {
    if (board.state === "armed") {
      board.stop();
      return;
    }
    clearTimeout(holding);
    holding = setTimeout(() => attempt(() => {
      fresh = true;
      return board.arm(goal);
    }), HOLD);
    arm.classList.add("holding");
  };
  const release = () => {
    clearTimeout(holding);
    arm.classList.remove("holding");
  };
  arm.addEventListener("pointerdown", press);
  arm.addEventListener("keydown", (event) => { if (!event.repeat && [" ", "Enter"].includes(event.key)) press(); });
  for (const end of ["pointerup", "pointerleave", "pointercancel", "keyup", "blur"]) arm.addEventListener(end, release);
  const away = () => {
    release();
    board.stop("Stopped: the page was hidden. Hold to arm.");
  };
  document.addEventListener("visibilitychange", () => { if (document.hidden) away(); });
  for (const end of ["pagehide", "freeze"]) window.addEventListener(end, away, true); // freeze does not bubble
  window.addEventListener("keydown", (event) => { if (event.key === "Escape") board.stop(); });
}
