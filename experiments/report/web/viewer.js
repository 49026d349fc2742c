'use strict';
// Flips technique, reference and error of a case at one zoom, exposure and pixel.

(() => {
  const data = JSON.parse(document.getElementById('pictures').textContent);
  const root = document.getElementById('viewer');
  if (!data.cases.length) return;
  const element = (name) => root.querySelector(`[name="${name}"]`);
  const canvas = root.querySelector('canvas'), output = root.querySelector('output');
  const offscreen = document.createElement('canvas');
  const tables = Object.fromEntries(
    Object.entries(data.maps).map(([name, text]) => [name, Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0))]),
  );
  const entries = tables.vik.length / 3 - 3;
  // zoom: screen pixels of a picture's pixel; x, y: of its corner; pixel: the one whose values are told
  const state = { case: null, view: 'technique', zoom: 0, x: 0, y: 0, pixel: null, scale: null };
  let planes = null, loading = 0;

  async function planesOf(shown) {
    const one = async (halves) =>
      halves && decode(document.getElementById(`block-${halves.block}`).textContent, halves.exponent, shown.width);
    const [technique, reference, error, noise] = await Promise.all(
      [shown.technique, shown.reference, shown.error, shown.standard_error].map(one),
    );
    return { technique, reference, error, noise };
  }

  async function load(index) {
    const ticket = ++loading, shown = data.cases[index], before = state.case;
    const found = await planesOf(shown);
    // a later choice was quicker
    if (ticket !== loading) return;
    [state.case, planes] = [shown, found];
    element('case').value = index;
    [offscreen.width, offscreen.height] = [shown.width, shown.height];
    if (!before || before.width !== shown.width || before.height !== shown.height) fit();
    rescale();
    root.querySelector('.about').replaceChildren(document.getElementById(`about-${index}`).content.cloneNode(true));
  }

  // the view's own scale, unless the reader gave its end
  function rescale() {
    const kind = `${element('unit').value} ${element('spacing').value}`;
    element('end').value = Number(state.case.scales[kind].limit.toPrecision(6));
    repaint();
  }

  function scaleNow() {
    const given = state.case.scales[`${element('unit').value} ${element('spacing').value}`];
    const end = Number(element('end').value);
    const limit = end > 0 && Number.isFinite(end) ? end : given.limit;
    return { limit, linear: given.linear && (given.linear / given.limit) * limit, signed: element('map').value === 'signed' };
  }

  const channel = (picture, pixel, which) => {
    const count = state.case.width * state.case.height;
    return planes[picture][pixel + (planes[picture].length > count ? which * count : 0)];
  };
  const luminance = (picture, pixel) =>
    LUMINANCE.reduce((sum, weight, which) => sum + weight * channel(picture, pixel, which), 0);
  // what an error in radiance is to be multiplied by for the unit that is shown
  const factor = (unit, pixel) => {
    if (unit === 'radiance') return 1;
    const lit = Math.max(luminance('reference', pixel), state.case.floor);
    // where all is black there is nothing to be relative to
    return lit > 0 ? 100 / lit : 0;
  };

  function paintError(pixels) {
    const scale = state.scale, unit = element('unit').value, marked = element('noise').checked && planes.noise;
    const table = tables[mapName()];
    for (let pixel = 0; pixel < planes.error.length; pixel++) {
      const error = planes.error[pixel];
      let index = entries + 2;
      if (!(marked && Math.abs(error) < data.noise * planes.noise[pixel])) {
        const scaled = error * factor(unit, pixel);
        index = colourIndex(entries, scale, scale.signed ? scaled : Math.abs(scaled));
      }
      for (let which = 0; which < 3; which++) pixels[4 * pixel + which] = table[3 * index + which];
      pixels[4 * pixel + 3] = 255;
    }
  }

  function paintRadiance(pixels, picture) {
    const gain = 2 ** Number(element('exposure').value) / state.case.white, tone = element('tone').value;
    for (let pixel = 0; pixel < pixels.length / 4; pixel++) {
      for (let which = 0; which < 3; which++) {
        pixels[4 * pixel + which] = screen(tone, gain * channel(picture, pixel, which));
      }
      pixels[4 * pixel + 3] = 255;
    }
  }

  function mapName() {
    if (element('map').value === 'signed') return 'vik';
    return element('colours').value === 'hue' ? 'hue' : 'lajolla';
  }

  function repaint() {
    state.scale = scaleNow();
    const context = offscreen.getContext('2d');
    const image = context.createImageData(state.case.width, state.case.height);
    if (state.view === 'error') paintError(image.data);
    else paintRadiance(image.data, state.view);
    context.putImageData(image, 0, 0);
    for (const button of root.querySelectorAll('[data-view]')) {
      button.setAttribute('aria-pressed', button.dataset.view === state.view);
    }
    drawBar();
    draw();
  }

  function drawBar() {
    const bar = root.querySelector('.bar'), scale = state.scale, table = tables[mapName()];
    bar.hidden = state.view !== 'error';
    const colour = (index) => `rgb(${table.slice(3 * index, 3 * index + 3).join()})`;
    const stops = Array.from({ length: entries }, (_, index) => colour(index));
    const at = (error) => `${100 * Math.min(Math.max(place(scale, error), 0), 1)}%`;
    bar.querySelector('.ramp').style.background = `linear-gradient(to right, ${stops.join()})`;
    bar.querySelector('.under').style.borderRightColor = scale.signed ? colour(entries) : 'transparent';
    bar.querySelector('.over').style.borderLeftColor = colour(entries + 1);
    const level = element('noise').checked ? state.case.noise[element('unit').value] : 0;
    const band = bar.querySelector('.band').style;
    [band.left, band.background] = [at(scale.signed ? -level : 0), colour(entries + 2)];
    band.right = `calc(100% - ${at(level)})`;
    bar.querySelector('.ticks').replaceChildren(
      ...ticks(scale).map((tick) => {
        const label = document.createElement('span');
        [label.textContent, label.style.left] = [String(Number(tick.toPrecision(3))), at(tick)];
        return label;
      }),
    );
    const unit = element('unit').value === 'relative' ? 'relative error [%]' : 'error [radiance]';
    const kind = scale.signed ? `signed ${unit}, red: too bright` : `absolute ${unit}`;
    const spacing = scale.linear ? `logarithmic beyond ${Number(scale.linear.toPrecision(3))}` : 'linear';
    const grey = level ? `; grey: within ${data.noise} standard errors of the reference` : '';
    bar.querySelector('.caption').textContent = `${kind}; ${spacing}${grey}`;
  }

  function fit() {
    const { width, height } = canvas.getBoundingClientRect();
    state.zoom = Math.min(width / state.case.width, height / state.case.height);
    state.x = (width - state.zoom * state.case.width) / 2;
    state.y = (height - state.zoom * state.case.height) / 2;
  }

  function draw() {
    const { width, height } = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    const context = canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(offscreen, state.x, state.y, state.zoom * offscreen.width, state.zoom * offscreen.height);
    if (state.pixel) {
      context.strokeStyle = '#ff40ff';
      context.strokeRect(state.x + state.pixel[0] * state.zoom, state.y + state.pixel[1] * state.zoom, state.zoom, state.zoom);
    }
    tell();
  }

  const digits = (value) =>
    value && Math.abs(value) < 1e-3 ? value.toExponential(3) : Number(value.toPrecision(4)).toString();

  function tell() {
    if (!state.pixel) {
      output.textContent = 'Point at a pixel, or move with the arrow keys, for its values.';
      return;
    }
    const [column, row] = state.pixel, pixel = row * state.case.width + column;
    const colours = (picture) => [0, 1, 2].map((which) => digits(channel(picture, pixel, which)));
    const told = (picture) => [...new Set(colours(picture))].length > 1 ? colours(picture).join(' ') : colours(picture)[0];
    const error = planes.error[pixel];
    const parts = [
      `(${column * state.case.step}, ${row * state.case.step})`,
      `technique ${told('technique')}`,
      `reference ${told('reference')}`,
      `error ${digits(error)}${error ? ` (${digits(error * factor('relative', pixel))} %)` : ''}`,
    ];
    if (planes.noise) {
      const noise = planes.noise[pixel];
      parts.push(`standard error ${digits(noise)}${noise ? ` (the error is ${digits(Math.abs(error) / noise)} of it)` : ''}`);
    }
    output.textContent = parts.join(', ');
  }

  function pointAt(column, row) {
    const inside = column >= 0 && row >= 0 && column < state.case.width && row < state.case.height;
    state.pixel = inside ? [column, row] : null;
    draw();
  }

  function show(view) {
    state.view = view;
    repaint();
  }

  window.airlightViewer = { state, load, show, rescale, repaint, draw, fit, pointAt, element, canvas, root, data };
  load(0);
})();
