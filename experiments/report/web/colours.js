'use strict';
// Errors as colours and radiance as sRGB; the scale is that of experiments/heat_maps/scale.py.

const LUMINANCE = [0.2126, 0.7152, 0.0722];

function place(scale, error) {
  let along = Math.abs(error) / scale.limit;
  if (scale.linear) {
    const scaled = Math.abs(error) / scale.linear;
    along = (scaled <= 1 ? scaled : 1 + Math.log10(scaled)) / (1 + Math.log10(scale.limit / scale.linear));
  }
  if (error < 0) along = -along;
  return scale.signed ? (1 + along) / 2 : along;
}

function ticks(scale) {
  const positive = [];
  if (scale.linear) {
    const decades = Math.floor(Math.log10(scale.limit / scale.linear) + 1e-9);
    for (let decade = decades; decade >= 0; decade--) positive.push(scale.limit / 10 ** decade);
  } else {
    for (let quarter = 1; quarter <= 4; quarter++) positive.push((scale.limit * quarter) / 4);
  }
  const negative = scale.signed ? positive.map((tick) => -tick).reverse() : [];
  return [...negative, 0, ...positive];
}

// `table`: RGB bytes of the map's colours, then those below, above, and of noise
function colourIndex(entries, scale, error) {
  const along = place(scale, error);
  if (along < 0) return entries;
  if (along > 1) return entries + 1;
  return Math.min(Math.floor(along * entries), entries - 1);
}

const SRGB = (() => {
  const table = new Uint8ClampedArray(4097);
  for (let step = 0; step <= 4096; step++) {
    const linear = step / 4096;
    table[step] = 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
  }
  return table;
})();

const TONES = {
  clip: (radiance) => radiance,
  reinhard: (radiance) => radiance / (1 + radiance),
};

function screen(tone, radiance) {
  const shown = TONES[tone](Math.max(radiance, 0));
  return SRGB[Math.round(4096 * Math.min(shown, 1))];
}
