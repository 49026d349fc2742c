'use strict';
// Mouse, touch and keys of the viewer.

(() => {
  const viewer = window.airlightViewer;
  if (!viewer) return;
  const { state, canvas, root, element, data } = viewer;
  const views = ['technique', 'reference', 'error'];

  function zoom(factor, x, y) {
    const next = Math.min(Math.max(state.zoom * factor, 0.1), 100);
    state.x = x - ((x - state.x) * next) / state.zoom;
    state.y = y - ((y - state.y) * next) / state.zoom;
    state.zoom = next;
    viewer.draw();
  }

  const centre = () => [canvas.clientWidth / 2, canvas.clientHeight / 2];

  function reset() {
    viewer.fit();
    viewer.draw();
  }

  function expose(stops) {
    element('exposure').value = Number(element('exposure').value) + stops;
    viewer.repaint();
  }

  function turn(by) {
    const count = data.cases.length, now = data.cases.indexOf(state.case);
    viewer.load((now + by + count) % count);
  }

  function move(columns, rows) {
    const [column, row] = state.pixel ?? [0, 0], { width, height } = state.case;
    viewer.pointAt(Math.min(Math.max(column + columns, 0), width - 1), Math.min(Math.max(row + rows, 0), height - 1));
  }

  const keys = {
    1: () => viewer.show('technique'),
    2: () => viewer.show('reference'),
    3: () => viewer.show('error'),
    f: () => viewer.show(views[(views.indexOf(state.view) + 1) % views.length]),
    e: () => expose(0.5),
    E: () => expose(-0.5),
    '+': () => zoom(1.25, ...centre()),
    '-': () => zoom(0.8, ...centre()),
    0: reset,
    n: () => turn(1),
    p: () => turn(-1),
    ArrowLeft: () => move(-1, 0),
    ArrowRight: () => move(1, 0),
    ArrowUp: () => move(0, -1),
    ArrowDown: () => move(0, 1),
  };

  canvas.addEventListener('keydown', (event) => {
    const act = event.ctrlKey || event.altKey || event.metaKey ? null : keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });

  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      zoom(1.002 ** -event.deltaY, event.offsetX, event.offsetY);
    },
    { passive: false },
  );

  // one finger or the mouse drags, two fingers zoom
  const pointers = new Map();
  const middle = (points) => points.reduce(([x, y], point) => [x + point[0] / points.length, y + point[1] / points.length], [0, 0]);
  const spread = (points) => Math.hypot(points[0][0] - points[1][0], points[0][1] - points[1][1]);

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
  });
  canvas.addEventListener('pointermove', (event) => {
    const here = [event.offsetX, event.offsetY];
    if (pointers.has(event.pointerId)) {
      const before = [...pointers.values()];
      pointers.set(event.pointerId, here);
      const after = [...pointers.values()], [fromX, fromY] = middle(before), [toX, toY] = middle(after);
      state.x += toX - fromX;
      state.y += toY - fromY;
      if (after.length === 2) zoom(spread(after) / Math.max(spread(before), 1), toX, toY);
    }
    viewer.pointAt(Math.floor((here[0] - state.x) / state.zoom), Math.floor((here[1] - state.y) / state.zoom));
  });
  for (const end of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }

  const buttons = { brighter: () => expose(0.5), darker: () => expose(-0.5), closer: keys['+'], farther: keys['-'], reset };
  for (const [name, act] of Object.entries(buttons)) element(name).addEventListener('click', act);
  for (const button of root.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => viewer.show(button.dataset.view));
  }
  element('case').addEventListener('change', (event) => viewer.load(Number(event.target.value)));
  element('next').addEventListener('click', () => turn(1));
  element('previous').addEventListener('click', () => turn(-1));
  for (const name of ['unit', 'spacing']) element(name).addEventListener('change', viewer.rescale);
  for (const name of ['exposure', 'tone', 'map', 'colours', 'end', 'noise']) element(name).addEventListener('change', viewer.repaint);
  for (const button of document.querySelectorAll('[data-case]')) {
    button.addEventListener('click', () => {
      viewer.load(Number(button.dataset.case));
      root.scrollIntoView();
      canvas.focus();
    });
  }
  new ResizeObserver(() => state.case && reset()).observe(canvas);
})();
