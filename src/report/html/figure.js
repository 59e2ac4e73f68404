// A figure: its marks as values, drawn again for other limits and scales; buttons, legend, pointers and keys.
const PAIR = /(-?[\d.]+)[ ,](-?[\d.]+)/g;

class Figure extends Reading {
  constructor(svg) {
    super();
    this.svg = svg;
    this.box = svg.closest('.fig');
    this.data = svg.querySelector('svg.data');
    [, , this.width, this.height] = this.data.getAttribute('viewBox').split(' ').map(Number);
    this.x = new Axis(svg, 'x');
    this.y = new Axis(svg, 'y');
    this.groups = [...this.data.querySelectorAll('g[data-kind]')];
    this.shapes = null;
    this.cursor = 0.5;
    this.cursorY = 0.5;
    this.fingers = new Map();
    this.picture = this.data.querySelector('image, rect[mask]');
    this.buttons();
    this.legend();
    this.listen();
  }

  // Values of every mark, from the places in which it was drawn.
  parse() {
    if (this.shapes) return;
    const value = (px, py) => [this.x.original(px / this.width), this.y.original(1 - py / this.height)];
    this.shapes = [];
    for (const group of this.groups) {
      for (const node of group.children) {
        const key = node.hasAttribute('points') ? 'points' : 'd';
        const text = node.getAttribute(key), points = [];
        text.replace(PAIR, (_, a, b) => points.push(value(+a, +b)));
        this.shapes.push({ group, node, key, text, points, kind: group.dataset.kind });
      }
    }
    this.pictures = [...this.data.querySelectorAll('image, rect[mask], mask')].map(node => {
      const [x, y, w, h] = ['x', 'y', 'width', 'height'].map(k => +node.getAttribute(k));
      return { node, from: value(x, y + h), to: value(x + w, y) };
    });
    const percent = (node, key) => node.getAttribute(key).endsWith('%') ? parseFloat(node.getAttribute(key)) / 100 : null;
    this.words = [...this.svg.querySelectorAll('.note, .name')].map(node => {
      const [fx, fy] = [percent(node, 'x'), percent(node, 'y')];
      return { node, x: fx === null ? null : this.x.original(fx), y: this.y.original(1 - fy) };
    });
  }

  draw() {
    this.parse();
    const { x, y, width, height } = this;
    const place = ([vx, vy]) => [x.fraction(vx) * width, (1 - y.fraction(vy)) * height];
    for (const { node, key, text, points } of this.shapes) {
      let k = 0;
      node.setAttribute(key, text.replace(PAIR, whole => {
        const [px, py] = place(points[k++]);
        return px.toFixed(2) + (whole.includes(',') ? ',' : ' ') + py.toFixed(2);
      }));
    }
    for (const { node, from, to } of this.pictures) {
      const [[left, bottom], [right, top]] = [place(from), place(to)];
      const set = { x: left, y: top, width: right - left, height: bottom - top };
      for (const name in set) node.setAttribute(name, set[name]);
    }
    for (const word of this.words) {
      const fy = 1 - y.fraction(word.y), fx = word.x === null ? 0 : x.fraction(word.x);
      word.node.setAttribute('y', fy * 100 + '%');
      if (word.x !== null) word.node.setAttribute('x', fx * 100 + '%');
      word.node.classList.toggle('off', fy < 0 || fy > 1 || fx < 0 || fx > 1);
    }
    this.axes();
    this.reset.disabled = !x.moved && !y.moved;
    this.hide();
  }

  axes() {
    const old = this.svg.querySelector('.ticks'), grid = this.svg.querySelector('.grid');
    old.querySelectorAll('.x, .y:not(.name)').forEach(node => node.remove());
    if (grid) grid.replaceChildren();
    const wide = this.svg.getBoundingClientRect().width;
    let end = -Infinity;
    const ticks = this.x.ticks(), room = label => label.length * 6.8 + 12;
    const crowded = ticks.reduce((sum, t) => sum + room(t[1]), 0) > wide;
    for (const [value, label, chief] of ticks) {
      const f = this.x.fraction(value);
      if (grid) make(grid, 'line', { x1: f * 100 + '%', x2: f * 100 + '%', y1: 0, y2: '100%' });
      const left = f * wide - room(label) / 2;
      if (left < end || (crowded && !chief)) continue;
      end = left + room(label);
      make(old, 'text', { class: 'x', x: f * 100 + '%', y: '100%', dy: 17 }, label);
    }
    if (this.y.list) return;
    let longest = '';
    for (const [value, label] of this.y.ticks()) {
      const f = 100 * (1 - this.y.fraction(value)) + '%';
      if (grid) make(grid, 'line', { x1: 0, x2: '100%', y1: f, y2: f });
      make(old, 'text', { class: 'y', x: -7, y: f, dy: '.35em' }, label);
      if (label.length > longest.length) longest = label;
    }
    this.box.querySelector('.gap').textContent = longest;
  }

  buttons() {
    const bar = make(this.box.querySelector('.head'), 'div', { class: 'tools' });
    const button = (text, title, act) => {
      const node = make(bar, 'button', { type: 'button', title }, text);
      node.addEventListener('click', act);
      return node;
    };
    button('+', 'Zoom in (key +; or drag over a part of the plot)', () => this.zoom(0.5, this.cursor, this.cursorY));
    button('−', 'Zoom out (key −)', () => this.zoom(2, this.cursor, this.cursorY));
    for (const [name, axis] of [['x', this.x], ['y', this.y]]) {
      if (axis.list || this.picture || !(this.largest(axis) > 0)) continue;
      const node = button(`log ${name}`, `Logarithmic or linear ${name} axis`, () => {
        this.toggle(axis);
        node.setAttribute('aria-pressed', axis.log);
      });
      node.setAttribute('aria-pressed', axis.log);
      axis.button = node;
    }
    this.reset = button('reset', 'The whole figure again (key 0, or double click)', () => this.home());
    this.reset.disabled = true;
  }

  largest(axis) { return Math.max(axis.home.high, axis.high); }

  // From one spacing to the other, over what the data needs.
  toggle(axis) {
    this.parse();
    axis.log = !axis.log;
    if (axis.log === axis.home.log) [axis.low, axis.high] = [axis.home.low, axis.home.high];
    else if (axis.log) {
      const k = axis === this.x ? 0 : 1, high = axis.home.high;
      let low = Infinity;
      for (const { points, kind } of this.shapes) {
        if (kind === 'bars') continue;
        for (const p of points) if (p[k] > high * 1e-4 && p[k] < low) low = p[k];
      }
      [axis.low, axis.high] = [axis.home.low > 0 ? axis.home.low : Math.min(low, high / 10), high];
    }
    this.draw();
  }

  home() {
    for (const axis of [this.x, this.y]) {
      axis.reset();
      if (axis.button) axis.button.setAttribute('aria-pressed', axis.log);
    }
    this.draw();
  }

  // Makes the shown range `factor` times as long, about a place given in fractions from the lower left.
  zoom(factor, fx, fy) {
    this.x.show(fx - fx * factor, fx + (1 - fx) * factor);
    if (!this.y.list) this.y.show(fy - fy * factor, fy + (1 - fy) * factor);
    this.draw();
  }

  legend() {
    for (const key of this.box.querySelectorAll('.key')) {
      key.setAttribute('role', 'button');
      key.setAttribute('tabindex', '0');
      key.setAttribute('aria-pressed', 'true');
      key.title = 'Hide or show';
      const act = () => {
        const shown = key.getAttribute('aria-pressed') !== 'true';
        key.setAttribute('aria-pressed', shown);
        for (const g of this.groups) if (g.dataset.group === key.dataset.group) g.classList.toggle('off', !shown);
        this.hide();
      };
      key.addEventListener('click', act);
      key.addEventListener('keydown', e => {
        if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); act(); }
      });
    }
  }

  // Place of a pointer in fractions from the lower left of the plot.
  at(event) {
    const box = this.svg.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, 1 - (event.clientY - box.top) / box.height];
  }

  listen() {
    const svg = this.svg;
    svg.setAttribute('tabindex', '0');
    const over = e => {
      const [fx, fy] = this.at(e);
      if (fx < 0 || fx > 1 || fy < 0 || fy > 1) return this.hide();
      this.read(fx, fy);
    };
    const move = e => {
      if (e.pointerId !== undefined && this.fingers.has(e.pointerId)) {
        const finger = this.fingers.get(e.pointerId);
        finger.now = this.at(e);
        if (this.fingers.size === 2) return this.pinch();
        if (finger.touch) return over(e);
        if (finger.pan) return this.pan(finger);
        return this.rubber(finger);
      }
      if (!this.fingers.size) over(e);
    };
    svg.addEventListener('pointermove', move);
    svg.addEventListener('mousemove', e => { if (!this.fingers.size) over(e); });
    svg.addEventListener('pointerdown', e => {
      if (e.button) return;
      const start = this.at(e);
      if (start.some(f => f < -0.02 || f > 1.02)) return;
      const touch = e.pointerType === 'touch';
      this.fingers.set(e.pointerId, { start, now: start, touch, pan: e.shiftKey, ranges: [this.x, this.y].map(a => [a.low, a.high]) });
      if (!touch) try { svg.setPointerCapture(e.pointerId); } catch { /* a pointer that a program made up */ }
      if (touch && this.fingers.size === 1) over(e);
    });
    const up = e => {
      const finger = this.fingers.get(e.pointerId);
      this.fingers.delete(e.pointerId);
      if (!finger || finger.touch || finger.pan) return;
      if (this.band) { this.band.remove(); this.band = null; }
      if (e.type === 'pointercancel') return;
      const [[ax, ay], [bx, by]] = [finger.start, finger.now];
      const box = svg.getBoundingClientRect();
      const [dx, dy] = [Math.abs(ax - bx) * box.width, Math.abs(ay - by) * box.height];
      if (dx < 6 && dy < 6) return;
      // A drag along one axis leaves the other as it is.
      if (dx >= 10) this.x.show(clamp(Math.min(ax, bx), 0, 1), clamp(Math.max(ax, bx), 0, 1));
      if (dy >= 10 && !this.y.list) this.y.show(clamp(Math.min(ay, by), 0, 1), clamp(Math.max(ay, by), 0, 1));
      this.draw();
    };
    svg.addEventListener('pointerup', up);
    svg.addEventListener('pointercancel', up);
    svg.addEventListener('pointerleave', () => { if (!this.fingers.size) this.hide(); });
    svg.addEventListener('dblclick', () => this.home());
    svg.addEventListener('wheel', e => {
      // A page is scrolled by the wheel alone.
      if (!e.ctrlKey && !e.metaKey) return;
      e.preventDefault();
      this.zoom(Math.exp(clamp(e.deltaY, -100, 100) * 0.003), ...this.at(e));
    }, { passive: false });
    svg.addEventListener('keydown', e => {
      const step = e.shiftKey ? 0.1 : 0.01;
      const acts = {
        ArrowLeft: () => this.step(-step, 0), ArrowRight: () => this.step(step, 0),
        ArrowDown: () => this.step(0, -step), ArrowUp: () => this.step(0, step),
        '+': () => this.zoom(0.5, this.cursor, this.cursorY), '=': () => this.zoom(0.5, this.cursor, this.cursorY),
        '-': () => this.zoom(2, this.cursor, this.cursorY), '0': () => this.home(), Escape: () => this.hide(),
      };
      if (!acts[e.key] || e.ctrlKey || e.metaKey || e.altKey) return;
      e.preventDefault();
      acts[e.key]();
    });
    svg.addEventListener('blur', () => this.hide());
  }

  // The cursor by keys; beyond an edge of what is shown it takes the view along.
  step(dx, dy) {
    const [fx, fy] = [this.cursor + dx, this.cursorY + dy];
    const along = (axis, f) => {
      if (!axis.moved || axis.list || (f >= 0 && f <= 1)) return;
      axis.show(f < 0 ? -0.2 : 0.2, f < 0 ? 0.8 : 1.2);
      this.draw();
    };
    along(this.x, fx);
    along(this.y, fy);
    this.read(clamp(fx, 0, 1), clamp(fy, 0, 1));
  }

  rubber({ start, now }) {
    this.hide();
    this.band ||= make(this.svg, 'rect', { class: 'rubber' });
    const box = this.svg.getBoundingClientRect();
    let [[ax, ay], [bx, by]] = [start, now].map(p => p.map(f => clamp(f, 0, 1)));
    if (Math.abs(ay - by) * box.height < 10 || this.y.list) [ay, by] = [0, 1];
    else if (Math.abs(ax - bx) * box.width < 10) [ax, bx] = [0, 1];
    const set = { x: Math.min(ax, bx), y: 1 - Math.max(ay, by), width: Math.abs(ax - bx), height: Math.abs(ay - by) };
    for (const name in set) this.band.setAttribute(name, set[name] * 100 + '%');
  }

  pan({ start, now, ranges }) {
    [this.x, this.y].forEach((axis, k) => {
      if (k && axis.list) return;
      [axis.low, axis.high] = ranges[k];
      axis.show(start[k] - now[k], 1 + start[k] - now[k]);
    });
    this.draw();
  }

  // What lay under two fingers stays under them.
  pinch() {
    const [a, b] = [...this.fingers.values()];
    [this.x, this.y].forEach((axis, k) => {
      if (k && axis.list) return;
      [axis.low, axis.high] = a.ranges[k];
      const apart = Math.abs(a.start[k] - b.start[k]);
      const factor = apart > 0.15 ? clamp(apart / Math.max(Math.abs(a.now[k] - b.now[k]), 0.02), 0.1, 10) : 1;
      const [from, to] = [(a.start[k] + b.start[k]) / 2, (a.now[k] + b.now[k]) / 2];
      axis.show(from - to * factor, from + (1 - to) * factor);
    });
    this.draw();
  }
}

for (const svg of document.querySelectorAll('svg.plot')) new Figure(svg);
