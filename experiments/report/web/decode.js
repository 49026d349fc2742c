'use strict';
// Pictures from the page's own text; experiments/report/halves.py says how they are coded.

const HALF = (() => {
  const table = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const exponent = (bits >> 10) & 31, fraction = bits & 1023;
    let value = exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15);
    if (exponent === 31) value = fraction ? NaN : Infinity;
    table[bits] = bits & 32768 ? -value : value;
  }
  return table;
})();

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// (channels, height, width), row by row
async function decode(text, exponent, width) {
  const bytes = await inflate(text), count = bytes.length / 2, factor = 2 ** exponent;
  const values = new Float32Array(count);
  for (let place = 0, bits = 0; place < count; place++) {
    if (place % width === 0) bits = 0;
    bits = (bits + bytes[place] + 256 * bytes[count + place]) & 65535;
    values[place] = HALF[bits] * factor;
  }
  return values;
}
