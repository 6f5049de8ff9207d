// The learned shape: contractions, scaled to -1 to 1, to points of the picture, and back from a point to contractions.

/** Numbers of a base64 text, as an array of a kind. */
export function decode(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Kind(bytes.buffer);
}

export class Model {
  /** @param {any} data facts of the page, as toy_page.py writes them */
  constructor(data) {
    this.dim = data.dim;
    this.low = data.winches.map((winch) => winch.low);
    this.high = data.winches.map((winch) => winch.high);
    this.mean = Float64Array.from(decode(data.mean, Float32Array));
    this.basis = decode(data.basis, Float32Array);
    this.layers = layersOf(data.sizes, decode(data.numbers, Float32Array));
    this.inputs = data.sizes[0];
    this.outputs = data.sizes[data.sizes.length - 1];
    this.rest = this.scaled(data.winches.map(() => 0));
  }

  /** Contractions [m] scaled to -1 to 1; 0 for a winch without range. */
  scaled(contractions) {
    return contractions.map((value, i) => {
      const span = this.high[i] - this.low[i];
      return span > 0 ? (2 * (value - this.low[i])) / span - 1 : 0;
    });
  }

  /** Contractions [m] of scaled ones. */
  contractions(inputs) {
    return inputs.map((value, i) => this.low[i] + ((value + 1) / 2) * (this.high[i] - this.low[i]));
  }

  /** Values of the last hidden layer, and their slopes with the inputs if asked: one row for each input. */
  hidden(inputs, sloped) {
    let values = Float64Array.from(inputs);
    let slopes = null;
    for (const { matrix, rows, columns, bias } of this.layers.weights.slice(0, -1)) {
      const sums = times(matrix, values, rows, columns, bias), rises = new Float64Array(columns);
      for (let i = 0; i < columns; i++) {
        const gate = 1 / (1 + Math.exp(-sums[i]));
        rises[i] = gate * (1 + sums[i] * (1 - gate));
        sums[i] *= gate;
      }
      values = sums;
      if (!sloped) continue;
      slopes = inputs.map((_, k) => {
        const row = slopes ? times(matrix, slopes[k], rows, columns) : Float64Array.from(matrix.subarray(k * columns, (k + 1) * columns));
        for (let i = 0; i < columns; i++) row[i] *= rises[i];
        return row;
      });
    }
    return { values, slopes: slopes ?? inputs.map((_, k) => inputs.map((_, i) => (i === k ? 1 : 0))) };
  }

  /** Coordinates of the shape. */
  coordinates(inputs) {
    const { weights, linear } = this.layers, { matrix, rows, columns, bias } = weights[weights.length - 1];
    const values = times(matrix, this.hidden(inputs, false).values, rows, columns, bias);
    const straight = times(linear, inputs, this.inputs, this.outputs);
    return values.map((value, i) => value + straight[i]);
  }

  /** The last layer and the linear map for some numbers of the points [m] in place of the coordinates. */
  outlets(indices) {
    const { weights, linear } = this.layers, { matrix, rows, columns, bias } = weights[weights.length - 1];
    const length = this.mean.length;
    const mapped = (numbers, count, constant) => {
      const found = new Float64Array(count * indices.length);
      for (let i = 0; i < count; i++) {
        indices.forEach((index, j) => {
          let sum = constant ? this.mean[index] : 0;
          for (let k = 0; k < columns; k++) sum += numbers[i * columns + k] * this.basis[k * length + index];
          found[i * indices.length + j] = sum;
        });
      }
      return found;
    };
    return {
      count: indices.length, rows, matrix: mapped(matrix, rows, false), bias: mapped(bias, 1, true), linear: mapped(linear, this.inputs, false),
    };
  }

  /** All points of the picture [m] at scaled contractions, one after the other. */
  points(inputs) {
    const values = this.coordinates(inputs);
    const found = this.mean.slice();
    const length = found.length;
    for (let k = 0; k < values.length; k++) {
      const share = values[k];
      const first = k * length;
      for (let i = 0; i < length; i++) found[i] += share * this.basis[first + i];
    }
    return found;
  }
}

/** Weights (inputs, outputs) and biases of each layer, and the linear map beside them. */
function layersOf(sizes, numbers) {
  let at = 0;
  const take = (count) => numbers.subarray(at, (at += count));
  const weights = sizes.slice(1).map((columns, i) => {
    const rows = sizes[i];
    return { rows, columns, matrix: take(rows * columns), bias: take(columns) };
  });
  return { weights, linear: take(sizes[0] * sizes[sizes.length - 1]) };
}

/** A row times a matrix, plus a bias. */
function times(matrix, row, rows, columns, bias = null) {
  const found = bias ? Float64Array.from(bias) : new Float64Array(columns);
  for (let i = 0; i < rows; i++) {
    const value = row[i];
    if (value === 0) continue;
    const first = i * columns;
    for (let j = 0; j < columns; j++) found[j] += value * matrix[first + j];
  }
  return found;
}

/**
 * Scaled contractions that bring a point to a target: Levenberg-Marquardt within -1 to 1, from where the winches stand.
 * Where that misses, slack winches hide how they would help: the search begins again with these at rest.
 * @param {Model} model
 * @param {number[]} start scaled contractions
 * @param {number} point number of the point
 * @param {number[]} target place [m]
 * @param {{size: number, rounds?: number, still?: number, kept?: {point: number, target: number[]}[]}} options size of
 *   the body [m]; most steps; weight of winches that stay where they are; points that better stay at a place [m]
 */
export function reach(model, start, point, target, { size, rounds = 8, still = 1e-3, kept = [] }) {
  const wishes = [{ point, target, weight: 1 / size }, ...kept.map((each) => ({ ...each, weight: KEPT / size }))];
  const numbers = wishes.flatMap((wish) => wish.target.map((goal, axis) => ({ goal, weight: wish.weight, index: wish.point * model.dim + axis })));
  const wish = { start, still, numbers, outlets: model.outlets(numbers.map(({ index }) => index)) };
  const found = descend(model, start, wish, rounds);
  const near = 1e-5, taut = start.map((value, i) => Math.max(value, model.rest[i]));
  if (found.cost < near || taut.every((value, i) => value === start[i])) return found.inputs;
  const other = descend(model, taut, wish, rounds);
  return other.cost < 0.95 * found.cost ? other.inputs : found.inputs;
}

/** The best inputs near some, and their cost. */
function descend(model, from, wish, rounds) {
  let inputs = from.slice();
  let now = miss(model, inputs, wish);
  let damping = 1e-3;
  for (let round = 0; round < rounds && damping < 1e4; round++) {
    const step = solveWithin(now.matrix, now.slope, inputs, damping);
    const next = inputs.map((value, i) => Math.min(1, Math.max(-1, value + step[i])));
    const found = miss(model, next, wish);
    if (!(found.cost < now.cost)) {
      damping *= 8;
      continue;
    }
    const gain = now.cost - found.cost;
    inputs = next;
    now = found;
    damping = Math.max(damping / 5, 1e-7);
    if (gain < 1e-12 + 1e-4 * now.cost) break;
  }
  return { inputs, cost: now.cost };
}

const KEPT = 0.2; // weight of points that better stay, beside the one that is dragged

/** Half the squares of what is missed, in sizes of the body, with slope and matrix of normal equations. */
function miss(model, inputs, { start, still, numbers, outlets }) {
  const inner = inputs.length, { count, rows } = outlets;
  const { values, slopes } = model.hidden(inputs, true);
  const places = times(outlets.matrix, values, rows, count, outlets.bias), straight = times(outlets.linear, inputs, inner, count);
  const rises = slopes.map((row) => times(outlets.matrix, row, rows, count));
  const matrix = Array.from({ length: inner }, (_, i) => Float64Array.from({ length: inner }, (_, j) => (i === j ? still * still : 0)));
  const slope = inputs.map((value, i) => still * still * (value - start[i]));
  let cost = 0.5 * still * still * inputs.reduce((sum, value, i) => sum + (value - start[i]) ** 2, 0);
  for (let k = 0; k < count; k++) {
    const { goal, weight } = numbers[k], far = weight * (places[k] + straight[k] - goal);
    cost += 0.5 * far * far;
    for (let i = 0; i < inner; i++) rises[i][k] = weight * (rises[i][k] + outlets.linear[i * count + k]);
    for (let i = 0; i < inner; i++) {
      slope[i] += far * rises[i][k];
      for (let j = 0; j < inner; j++) matrix[i][j] += rises[i][k] * rises[j][k];
    }
  }
  return { cost, slope, matrix };
}

/** A damped Newton step; inputs at a bound that it would leave stay there. */
function solveWithin(matrix, slope, inputs, damping) {
  const free = inputs.map((value, i) => !((value >= 1 && slope[i] < 0) || (value <= -1 && slope[i] > 0)));
  for (;;) {
    const some = inputs.map((_, i) => i).filter((i) => free[i]);
    const rows = some.map((i) => [...some.map((j) => matrix[i][j] + (i === j ? damping * (matrix[i][i] + 1e-9) : 0)), -slope[i]]);
    const found = eliminate(rows);
    const out = some.filter((i, k) => (inputs[i] >= 1 && found[k] > 0) || (inputs[i] <= -1 && found[k] < 0));
    if (!out.length) {
      const step = inputs.map(() => 0);
      some.forEach((i, k) => { step[i] = found[k]; });
      return step;
    }
    out.forEach((i) => { free[i] = false; });
  }
}

/** Solution of symmetric positive definite equations, rows with the right side last. */
function eliminate(rows) {
  const count = rows.length;
  for (let k = 0; k < count; k++) {
    for (let i = k + 1; i < count; i++) {
      const share = rows[i][k] / rows[k][k];
      for (let j = k; j <= count; j++) rows[i][j] -= share * rows[k][j];
    }
  }
  const found = new Array(count).fill(0);
  for (let k = count - 1; k >= 0; k--) {
    let sum = rows[k][count];
    for (let j = k + 1; j < count; j++) sum -= rows[k][j] * found[j];
    found[k] = sum / rows[k][k];
  }
  return found;
}
