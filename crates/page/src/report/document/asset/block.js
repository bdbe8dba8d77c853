// Reads what src/report/document/packed.rs writes: columns of whole numbers, differences, zigzag, seven bits a byte, base64.
"use strict";
const realgap = {};
realgap.reader = text => {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  let at = 0;
  const next = () => {
    let number = 0, factor = 1;
    for (;;) {
      const byte = bytes[at++];
      number += (byte & 127) * factor;
      if (byte < 128) return number;
      factor *= 128;
    }
  };
  return step => {
    const column = new Float64Array(next());
    let sum = 0;
    for (let k = 0; k < column.length; k++) {
      const coded = next();
      sum += coded % 2 ? -(coded + 1) / 2 : coded / 2;
      column[k] = sum * step;
    }
    return column;
  };
};
// Index of the last time that is not after t, and how far t is on the way to the next.
realgap.place = (times, t) => {
  const last = times.length - 1;
  if (t <= times[0]) return [0, 0];
  if (t >= times[last]) return [last - 1, 1];
  let low = 0, high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return [low, (t - times[low]) / (times[low + 1] - times[low])];
};
realgap.mix = (column, [k, share]) => column[k] + (column[k + 1] - column[k]) * share;
