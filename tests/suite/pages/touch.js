// A reader at work on a page: points, drags, presses keys and buttons, pinches. Every line returned is a fault.
async function touch(win, expected) {
  const doc = win.document, faults = [];
  const must = (holds, what) => { if (!holds) faults.push(what); };
  const svg = doc.querySelector('svg'), fig = svg.closest('.fig');
  const readout = () => doc.querySelector('[data-readout]:not([hidden])');
  const send = (node, type, [fx, fy] = [0.5, 0.5], more = {}) => {
    const box = node.getBoundingClientRect();
    const at = { clientX: box.left + fx * box.width, clientY: box.top + (1 - fy) * box.height };
    const kind = type.startsWith('pointer') ? win.PointerEvent : win.MouseEvent;
    node.dispatchEvent(new kind(type, { bubbles: true, pointerId: 1, pointerType: 'mouse', ...at, ...more }));
  };
  const key = (name, more = {}) => svg.dispatchEvent(new win.KeyboardEvent('keydown', { key: name, bubbles: true, cancelable: true, ...more }));
  const drawing = () => [...svg.querySelectorAll('polyline,polygon,path')].map(n => n.getAttribute('points') || n.getAttribute('d'));
  const numbers = () => drawing().join(' ').match(/-?[\d.]+/g).map(Number);
  const button = (text, inside = fig) => [...inside.querySelectorAll('button')].find(b => b.textContent === text);
  must(!!button('reset'), 'the script did not run');
  if (!button('reset')) return faults;

  must(!readout(), 'a read-out shows before anything is touched');
  for (const fx of [0.02, 0.25, 0.5, 0.75, 0.98]) for (const fy of [0.03, 0.5, 0.97]) {
    send(svg, 'pointermove', [fx, fy]);
    must(readout() && /\d/.test(readout().textContent), `no read-out at ${fx}, ${fy}`);
    for (const unit of expected.units) must(readout() && readout().textContent.includes(' ' + unit), `no ${unit} at ${fx}, ${fy}: ${readout()?.textContent}`);
  }
  send(svg, 'pointerleave');
  must(!readout(), 'the read-out stays after the pointer left');
  send(svg, 'mousemove');
  must(!!readout(), 'no read-out by a mouse without pointer events');

  const first = numbers(), labels = () => [...svg.querySelectorAll('.ticks .x')].map(t => t.textContent).join('|');
  const [ticks] = [labels()];
  send(svg, 'pointerdown', [0.3, 0.5]);
  send(svg, 'pointermove', [0.5, 0.5]);
  send(svg, 'pointerup', [0.5, 0.5]);
  must(labels() !== ticks, 'a drag does not zoom');
  must(!button('reset').disabled, 'reset cannot be pressed after zooming');
  button('reset').click();
  const same = () => numbers().every((v, k) => Math.abs(v - first[k]) < 0.02);
  must(same(), 'reset does not give the same figure');
  key('+'); must(!same(), 'the key + does not zoom');
  send(svg, 'dblclick'); must(same(), 'a double click does not reset');
  svg.focus();
  key('ArrowRight'); const one = readout()?.textContent;
  key('ArrowRight'); must(one && readout().textContent !== one, 'arrow keys do not move the read-out');
  key('Escape'); must(!readout(), 'Escape leaves the read-out');

  const other = button('log x') || button('log y');
  if (other) {
    const pressed = other.getAttribute('aria-pressed');
    other.click();
    must(other.getAttribute('aria-pressed') !== pressed && !same(), 'the scale does not change');
    must(numbers().every(isFinite), 'a mark is lost on the other scale');
    button('reset').click();
    must(same() && other.getAttribute('aria-pressed') === pressed, 'reset does not give the scale back');
  }
  for (const entry of fig.querySelectorAll('.key')) {
    const own = [...svg.querySelectorAll('g[data-group]')].filter(g => g.dataset.group === entry.dataset.group);
    const gone = () => own.length > 0 && own.every(g => win.getComputedStyle(g).display === 'none');
    entry.click(); must(gone(), `${entry.textContent} cannot be switched off`);
    send(svg, 'pointermove'); must(!readout().textContent.includes(entry.textContent + ':'), `${entry.textContent} is read although it is off`);
    entry.dispatchEvent(new win.KeyboardEvent('keydown', { key: 'Enter', bubbles: true })); must(!gone(), `${entry.textContent} does not come back by Enter`);
  }
  const finger = (id, type, at) => send(svg, type, at, { pointerId: id, pointerType: 'touch' });
  finger(5, 'pointerdown', [0.4, 0.5]);
  must(!!readout(), 'no read-out under a finger');
  finger(6, 'pointerdown', [0.6, 0.5]);
  finger(6, 'pointermove', [0.8, 0.5]);
  must(!same(), 'two fingers do not zoom');
  finger(5, 'pointerup', [0.4, 0.5]); finger(6, 'pointerup', [0.8, 0.5]);
  button('reset').click();

  // Values that are known: "name: value" read in a figure at a value of x.
  for (const { figure, name, x, value, tolerance } of expected.values) {
    const plot = doc.querySelectorAll('svg.plot')[figure];
    const [low, high] = [+plot.dataset.xFrom, +plot.dataset.xTo];
    const f = plot.dataset.xScale === 'log' ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low);
    send(plot, 'pointermove', [f, 0.5]);
    await new Promise(done => setTimeout(done, 300));
    const line = [...readout().querySelectorAll('p')].map(p => p.textContent).find(t => t.startsWith(name + ':')) || '';
    const match = line.match(/: (−?[\d.]+)(?:·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?/) || [];
    const power = (match[2] || '⁰').replace(/./g, c => c === '⁻' ? '-' : '⁰¹²³⁴⁵⁶⁷⁸⁹'.indexOf(c));
    const got = parseFloat((match[1] || 'NaN').replace('−', '-')) * 10 ** power;
    must(Math.abs(got - value) <= tolerance, `${name} at ${x}: read "${line}", expected ${value} ± ${tolerance}`);
  }
  return faults;
}
