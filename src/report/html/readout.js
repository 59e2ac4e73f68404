// What a figure says at a place: the read-out, its cross and the rows of the shown series.
const readout = make(document.body, 'div', { 'data-readout': '', role: 'status', hidden: '' });
let owner = null;

// Colours of a picture, to read values from a heat map.
function pixels(image) {
  return new Promise(done => {
    const picture = new Image();
    picture.onload = () => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [picture.naturalWidth, picture.naturalHeight];
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(picture, 0, 0);
      done({ width: canvas.width, height: canvas.height, rgba: context.getImageData(0, 0, canvas.width, canvas.height).data });
    };
    picture.src = image.getAttribute('href');
  });
}

class Reading {
  hide() {
    if (owner === this) readout.hidden = true;
    if (this.cross) { this.cross.remove(); this.cross = null; }
  }

  // What every shown series says at a place of the plot: how it is called, what it says, where.
  rows(vx, vy) {
    const rows = [], seen = new Map();
    const { x, y, width, height } = this;
    const px = v => x.fraction(v) * width, py = v => (1 - y.fraction(v)) * height;
    const far = p => Math.hypot(px(p[0]) - px(vx), py(p[1]) - py(vy));
    const inside = p => x.fraction(p[0]) >= -1e-6 && x.fraction(p[0]) <= 1.000001;
    for (const shape of this.shapes) {
      const { points, kind, group } = shape;
      if (group.classList.contains('off') || !points.length) continue;
      let row = null;
      if (kind === 'line' || kind === 'dashed') {
        const rising = shape.rising ??= points.every((p, k) => !k || p[0] >= points[k - 1][0]);
        const flat = points.length === 2 && points[0][0] === points[1][0];
        if (rising && !flat) {
          const v = this.along(points, vx);
          if (v === null) continue;
          row = { at: [vx, v], far: Math.abs(py(v) - py(vy)), text: number(v) };
        } else {
          const near = points.reduce((best, p) => far(p) < far(best) ? p : best);
          row = { at: near, far: far(near), text: number(near[1]), other: near[0] };
          if (flat) {
            // An upright line marks a value of x, and speaks only near it.
            row = { at: null, far: Math.abs(px(near[0]) - px(vx)), text: number(near[0]), own: this.x.unit };
            if (row.far > 12) continue;
          }
        }
      } else if (kind === 'dots') {
        const near = points.reduce((best, p) => far(p) < far(best) ? p : best);
        if (!inside(near)) continue;
        row = { at: near, far: far(near), text: number(near[1]), other: near[0] };
      } else if (kind === 'band') {
        const half = this.edges(shape);
        const [low, high] = half.map(edge => this.along(edge, vx));
        if (low === null || high === null) continue;
        row = { at: null, far: 0, text: `${number(low)} to ${number(high)}` };
      } else if (kind === 'bars') {
        for (let k = 0; k + 3 < points.length; k += 4) {
          const [l, r] = [points[k][0], points[k + 2][0]];
          if (vx >= Math.min(l, r) && vx < Math.max(l, r)) row = { at: null, far: 0, text: number(points[k + 1][1]) };
        }
        if (!row) continue;
      } else if (kind === 'whiskers') {
        let best = null;
        for (let k = 0; k + 1 < points.length; k += 2) {
          const d = Math.abs(px(points[k][0]) - px(vx));
          if (!best || d < best.d) best = { d, a: points[k], b: points[k + 1] };
        }
        if (!best || !inside(best.a)) continue;
        row = { at: null, far: best.d, text: `${number(best.a[1])} to ${number(best.b[1])}`, other: best.a[0] };
      }
      if (!row || !row.text) continue;
      row.name = group.dataset.name;
      // A line along the top of its own band says nothing new.
      if (rows.some(r => r.name === row.name && r.text.endsWith('to ' + row.text))) continue;
      row.ink = [...shape.node.classList].find(c => /^[fs]-/.test(c)).slice(2);
      // Of the parts of one series the nearest speaks.
      const id = row.name + kind + (row.name ? '' : row.ink);
      const other = seen.get(id);
      if (other === undefined) { seen.set(id, rows.length); rows.push(row); }
      else if (row.far < rows[other].far) rows[other] = row;
    }
    return rows;
  }

  // Lower and upper edge of a band: there and back again.
  edges(shape) {
    if (!shape.edges) {
      const { points } = shape;
      let turn = 1;
      while (turn < points.length && points[turn][0] >= points[turn - 1][0]) turn++;
      if (turn < points.length && points[turn - 1][0] === points[turn][0]) turn--;
      shape.edges = [points.slice(0, turn), points.slice(turn).reverse()];
    }
    return shape.edges;
  }

  // Height of a rising curve at a place, between two of its points straight as it was drawn; null beyond its ends.
  along(edge, vx) {
    const k = edge.findIndex(p => p[0] >= vx);
    if (k < 0 || !edge.length || vx < edge[0][0]) return null;
    const [a, b] = [edge[Math.max(k - 1, 0)], edge[k]];
    const [ua, ub, u] = [a[0], b[0], vx].map(v => this.x.home.log ? Math.log(v) : v);
    const t = ub > ua ? clamp((u - ua) / (ub - ua), 0, 1) : 1;
    return this.y.home.log ? a[1] * (b[1] / a[1]) ** t : a[1] + t * (b[1] - a[1]);
  }

  read(fx, fy) {
    this.parse();
    [this.cursor, this.cursorY] = [fx, fy];
    const [vx, vy] = [this.x.value(fx), this.y.value(fy)];
    if (owner && owner !== this) owner.hide();
    owner = this;
    const unit = axis => axis.unit ? ' ' + axis.unit : '';
    const rows = this.rows(vx, vy);
    readout.replaceChildren();
    make(readout, 'p', {}, `${this.x.name} ${number(vx)}${unit(this.x)}`);
    if (this.picture || !rows.length) make(readout, 'p', {}, `${this.y.name} ${number(vy)}${unit(this.y)}`);
    if (this.picture) this.cell(vx, vy);
    this.cross ||= make(this.svg, 'g', { class: 'cross' });
    this.cross.replaceChildren();
    make(this.cross, 'line', { x1: fx * 100 + '%', x2: fx * 100 + '%', y1: 0, y2: '100%' });
    if (this.picture || !rows.length) make(this.cross, 'line', { x1: 0, x2: '100%', y1: (1 - fy) * 100 + '%', y2: (1 - fy) * 100 + '%' });
    for (const row of rows) {
      if (row.at) {
        const [cx, cy] = [this.x.fraction(row.at[0]), 1 - this.y.fraction(row.at[1])];
        if (cy >= 0 && cy <= 1 && cx >= 0 && cx <= 1) {
          make(this.cross, 'circle', { class: 'f-' + row.ink, cx: cx * 100 + '%', cy: cy * 100 + '%', r: 4 });
        }
      }
      const line = make(readout, 'p', {});
      make(line, 'i', { class: 'b-' + row.ink });
      const at = row.other === undefined ? '' : ` at ${number(row.other)}${unit(this.x)}`;
      const value = this.y.list ? '' : row.text + (row.own === undefined ? unit(this.y) : row.own && ' ' + row.own);
      make(line, 'span', {}, `${row.name ? row.name + ': ' : ''}${value}${at}`);
    }
    const box = this.svg.getBoundingClientRect();
    readout.hidden = false;
    const [w, h] = [readout.offsetWidth, readout.offsetHeight];
    const [left, top] = [box.left + fx * box.width, box.top + (1 - fy) * box.height];
    const wide = document.documentElement.clientWidth;
    readout.style.left = scrollX + clamp(left + 14 + w > wide ? left - 14 - w : left + 14, 4, Math.max(4, wide - w - 4)) + 'px';
    readout.style.top = scrollY + clamp(top - h - 12, 4, Math.max(4, innerHeight - h - 4)) + 'px';
  }

  // The value of a heat map's cell, by its colour on the colour bar.
  cell(vx, vy) {
    const bar = this.svg.querySelector('svg.bar');
    if (!bar) return;
    const said = make(readout, 'p', {}, '…');
    this.colours ||= Promise.all([pixels(this.data.querySelector('image')), pixels(bar.querySelector('image'))]);
    this.colours.then(([map, ramp]) => {
      const { from, to } = this.pictures[0];
      const inside = (axis, v, a, b) => (axis.u(v) - axis.u(a)) / (axis.u(b) - axis.u(a));
      const column = Math.floor(inside(this.x, vx, from[0], to[0]) * map.width);
      const row = Math.floor((1 - inside(this.y, vy, from[1], to[1])) * map.height);
      const p = 4 * (clamp(row, 0, map.height - 1) * map.width + clamp(column, 0, map.width - 1));
      const name = this.box.querySelector('.over span:last-child').textContent;
      const [, what, unit] = name.match(/^(.*?)(?: \/ \(?(.*?)\)?)?$/);
      if (!map.rgba[p + 3]) { said.textContent = `${what}: none`; return; }
      let best = [Infinity, 0];
      for (let k = 0; k < ramp.height; k++) {
        const d = [0, 1, 2].reduce((sum, c) => sum + (ramp.rgba[4 * k + c] - map.rgba[p + c]) ** 2, 0);
        if (d < best[0]) best = [d, k];
      }
      const share = 1 - best[1] / (ramp.height - 1), low = +bar.dataset.from, high = +bar.dataset.to;
      said.textContent = `${what}: ${number(low + share * (high - low), 2)}${unit ? ' ' + unit : ''}`;
    });
  }
}
