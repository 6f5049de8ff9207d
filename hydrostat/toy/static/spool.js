// Cable on the spool of a motor: angles from its zero [rad] and cable taken in [m], as in motors.toml.

/** Straight pieces of a curve: start [rad], cable taken in there [m], radius [m]. */
function piecesOf(motor) {
  const points = [[0, 0], ...motor.curve];
  const rising = motor.curve.map(([angle, taken], i) => [...points[i], (taken - points[i][1]) / (angle - points[i][0])]);
  return [[0, 0, motor.radius], ...rising];
}

/** Angle of a motor from its zero [rad] at which so much cable is taken in [m]. */
export function turned(motor, contraction) {
  const pieces = piecesOf(motor), [start, before, radius] = pieces.findLast(([, each]) => contraction > each) ?? pieces[0];
  return motor.turns * (start + (contraction - before) / radius);
}

/** Cable taken in [m] at an angle from the zero [rad]: the inverse of `turned`. */
export function taken(motor, angle) {
  const way = motor.turns * angle, pieces = piecesOf(motor);
  const [start, before, radius] = pieces.findLast(([each]) => way > each) ?? pieces[0];
  return before + radius * (way - start);
}

/** Largest radius on the way between two contractions [m]. */
export function widest(motor, one, two) {
  const [low, high] = [Math.min(one, two), Math.max(one, two)], pieces = piecesOf(motor);
  const passed = pieces.filter(([, start], i) => (i === 0 || start <= high) && (pieces[i + 1]?.[1] ?? Infinity) >= low);
  return Math.max(...passed.map(([, , radius]) => radius));
}
