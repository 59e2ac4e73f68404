'use strict';
// Figures that answer: read-out, zoom, logarithmic or linear axes, series by their legend; by mouse, touch and keyboard.
// Everything is read from the drawing itself: places of the marks, and the data- attributes of plots and series.
// Here: numbers as the page writes them, and axes.
const NS = 'http://www.w3.org/2000/svg';
const make = (parent, name, attributes = {}, text) => {
  const svg = parent.namespaceURI === NS;
  const node = svg ? document.createElementNS(NS, name) : document.createElement(name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  return parent.appendChild(node);
};
const clamp = (v, low, high) => Math.min(Math.max(v, low), high);

const raised = n => String(n).replace(/[-\d]/g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
const minus = text => text.replace('-', '−');
function number(v, digits = 4) {
  if (!isFinite(v)) return '–';
  if (v === 0) return '0';
  const power = Math.floor(Math.log10(Math.abs(v)));
  if (power >= -3 && power < 6) return minus(v.toFixed(clamp(digits - 1 - power, 0, 8)));
  return minus((v / 10 ** power).toFixed(digits - 1)) + '·10' + raised(power);
}

// An axis: low and high are values; u is the coordinate in which ticks of equal ratio are equally far apart.
class Axis {
  constructor(svg, which) {
    const of = key => svg.getAttribute(`data-${which}${key}`);
    this.name = of('');
    this.unit = of('-unit');
    this.log = of('-scale') === 'log';
    this.low = +of('-from');
    this.high = +of('-to');
    this.list = of('-list') !== null;
    this.home = { log: this.log, low: this.low, high: this.high };
  }
  u(v) { return this.log ? Math.log(Math.max(v, 1e-300)) : v; }
  back(u) { return this.log ? Math.exp(u) : u; }
  fraction(v) {
    const [a, b] = [this.u(this.low), this.u(this.high)];
    return clamp((this.u(v) - a) / (b - a), -1e4, 1e4);
  }
  value(f) {
    const [a, b] = [this.u(this.low), this.u(this.high)];
    return this.back(a + f * (b - a));
  }
  // What a place of the drawing, as it was made, stands for.
  original(f) {
    const { log, low, high } = this.home;
    return log ? low * (high / low) ** f : low + f * (high - low);
  }
  reset() { Object.assign(this, this.home); }
  get moved() { return this.log !== this.home.log || this.low !== this.home.low || this.high !== this.home.high; }
  // Shows from one fraction of the present range to another; never less than a five-hundredth of the whole.
  show(from, to) {
    const least = this.log === this.home.log
      ? Math.abs(this.u(this.home.high) - this.u(this.home.low)) / 500
      : Math.abs(this.u(this.high) - this.u(this.low)) / 500;
    let [a, b] = [this.u(this.value(from)), this.u(this.value(to))];
    if (!(b - a > 0)) return;
    if (b - a < least) [a, b] = [(a + b - least) / 2, (a + b + least) / 2];
    const [low, high] = [this.back(a), this.back(b)];
    if (isFinite(low) && isFinite(high) && high > low && (!this.log || low > 0)) [this.low, this.high] = [low, high];
  }
  // Ticks as [value, label, whether it is a power of ten].
  ticks() {
    const { low, high } = this;
    if (this.log && Math.log10(high / low) > 0.7) {
      const decades = Math.log10(high / low);
      const [first, last] = [Math.ceil(Math.log10(low) - 1e-9), Math.floor(Math.log10(high) + 1e-9)];
      const every = Math.max(Math.floor((last - first) / 8) + 1, 1);
      const within = decades < 1.2 ? [1, 2, 3, 5, 7] : decades < 2.6 ? [1, 2, 5] : [1];
      const out = [];
      for (let e = first - 1; e <= last; e++) {
        if ((((e - first) % every) + every) % every) continue;
        for (const m of within) {
          const v = m * 10 ** e;
          if (v < low * 0.999 || v > high * 1.001) continue;
          const plain = e >= -2 && e < 4;
          out.push([v, plain ? String(+v.toPrecision(1)) : (m === 1 ? '' : m + '·') + '10' + raised(e), m === 1]);
        }
      }
      if (out.length > 1) return out;
    }
    const raw = (high - low) / 6, ten = 10 ** Math.floor(Math.log10(raw));
    const step = ([1, 2, 2.5, 5, 10].find(n => n * ten >= raw * 0.999) || 10) * ten;
    const largest = Math.max(Math.abs(low), Math.abs(high));
    const power = Math.floor(Math.log10(largest));
    const shrink = power >= -3 && power < 6 ? 1 : 10 ** power;
    let decimals = Math.max(0, -Math.floor(Math.log10(step / shrink) + 1e-9));
    if ((step / shrink * 10 ** decimals) % 1 > 0.01) decimals += 1;
    const out = [];
    for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9 && out.length < 30; k++) {
      const v = k * step;
      const label = Math.abs(v) < step * 1e-6 ? '0' : minus((v / shrink).toFixed(decimals)) + (shrink === 1 ? '' : '·10' + raised(power));
      out.push([v, label, k % 2 === 0]);
    }
    return out;
  }
}
