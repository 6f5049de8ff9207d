// A message of the server, opened; the other side is packet.py.

/** Head and arrays of a message; an array knows its `rows` and `columns`. Throws if the message is cut short. */
export function opened(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays = {};
  let place = 4 + length;
  for (const [name, [kind, rows, columns]] of Object.entries(head.arrays)) {
    const Kind = kind === "f4" ? Float32Array : Uint32Array;
    const array = new Kind(buffer, place, rows * columns);
    arrays[name] = Object.assign(array, { rows, columns });
    place += 4 * rows * columns;
  }
  delete head.arrays;
  return { head, arrays };
}

/** Whether two tables hold the same numbers. */
export function same(first, second) {
  if (!first || !second || first.length !== second.length) return false;
  for (let i = 0; i < first.length; i++) if (first[i] !== second[i]) return false;
  return true;
}
