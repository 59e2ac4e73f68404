// What a reader would see go wrong on a page, frame by frame; the page runs in an iframe of the width under test.
const round = v => Math.round(v * 10) / 10;
function visible(node, win) {
  for (let n = node; n && n.nodeType === 1; n = n.parentElement) {
    const style = win.getComputedStyle(n);
    if (style.display === 'none' || style.visibility === 'hidden') return false;
  }
  return true;
}
function measure(win, width, print) {
  const doc = win.document, faults = [];
  const fault = (what, node, more) => faults.push(`${what}: ${(node.textContent || node.tagName).trim().slice(0, 60)} ${more}`);
  if (doc.documentElement.scrollWidth > width + 0.5) faults.push(`the page is ${doc.documentElement.scrollWidth} px wide`);
  // A box that scrolls: allowed on a small screen, with an edge.
  const boxes = new Set();
  for (const box of doc.querySelectorAll('*')) {
    const style = win.getComputedStyle(box);
    if (!['auto', 'scroll'].includes(style.overflowX) || box === doc.documentElement) continue;
    if (box.scrollWidth <= box.clientWidth + 1) continue;
    if (width >= 960 || print) fault('a box scrolls', box, `${box.scrollWidth} in ${box.clientWidth}`);
    else if (!(parseFloat(style.borderRightWidth) > 0)) fault('a box without an edge', box, '');
    boxes.add(box);
  }
  const inBox = node => { for (let n = node; n; n = n.parentElement) if (boxes.has(n)) return true; return false; };
  const walker = doc.createTreeWalker(doc.body, 4);
  while (walker.nextNode()) {
    const text = walker.currentNode, node = text.parentElement;
    if (!text.data.trim() || ['SCRIPT', 'STYLE'].includes(node.tagName) || !visible(node, win)) continue;
    let px = parseFloat(win.getComputedStyle(node).fontSize);
    const svg = node.ownerSVGElement;
    if (svg && node.getScreenCTM) px *= Math.hypot(node.getScreenCTM().a, node.getScreenCTM().b);
    if (!print && px < 10.99) fault('small text', node, `${round(px)} px`);
    const range = doc.createRange();
    range.selectNodeContents(text);
    for (const r of range.getClientRects()) {
      if ((r.right > width + 0.5 || r.left < -0.5) && !inBox(node)) { fault('clipped', node, `${round(r.left)} to ${round(r.right)}`); break; }
    }
  }
  for (const fig of doc.querySelectorAll('figure')) {
    const labels = [...fig.querySelectorAll('svg text, .title, .key, .over span, .under, button')].filter(n => visible(n, win));
    const rects = labels.map(n => { const r = n.getBoundingClientRect(); return { l: r.left + 1, r: r.right - 1, t: r.top + 2, b: r.bottom - 2 }; });
    for (let i = 0; i < labels.length; i++) for (let j = 0; j < i; j++) {
      const [a, b] = [rects[i], rects[j]];
      if (a.l < b.r && b.l < a.r && a.t < b.b && b.t < a.b) fault('labels overlap', labels[i], `and ${labels[j].textContent.trim().slice(0, 40)}`);
    }
    const own = fig.getBoundingClientRect();
    labels.forEach((n, i) => { if (rects[i].r > own.right + 1 && !inBox(n)) fault('beyond its figure', n, ''); });
  }
  return faults;
}
