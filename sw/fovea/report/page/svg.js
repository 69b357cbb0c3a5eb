'use strict';
// Elements, scales, axes and numbers that all charts use. Lengths are in the SVG's own units.
const SVG = 'http://www.w3.org/2000/svg';

function element(name, attributes = {}, ...children) {
  const svg = ['svg', 'g', 'rect', 'path', 'line', 'text', 'title', 'circle', 'polyline', 'defs', 'pattern'].includes(name);
  const e = svg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) if (value !== undefined) e.setAttribute(key, value);
  e.append(...children.filter((c) => c !== undefined));
  return e;
}
const text = (x, y, content, attributes = {}) => element('text', {x, y, ...attributes}, String(content));

/// A picture for the eye with the sentence of its figure as its name.
function drawing(place, width, height, ...children) {
  const caption = place.parentElement.querySelector('figcaption');
  return element('svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': caption.textContent}, ...children);
}

/// Units from the left to the right edge of a chart: as many as there are pixels, so that text has its size.
const widthOf = (place) => Math.max(340, Math.min(880, place.clientWidth || 880));

/// Numbers for people, with at most `digits` significant ones.
function plain(value, digits = 4) {
  if (value === 0) return '0';
  return Number(value.toPrecision(digits)).toLocaleString('en', {maximumSignificantDigits: digits});
}
/// 4,274,000 as "4.27 M"
function short(value) {
  const [size, letter] = [[1e9, ' G'], [1e6, ' M'], [1e3, ' k']].find(([s]) => Math.abs(value) >= s) ?? [1, ''];
  return plain(value / size, 3) + letter;
}
const percent = (ratio) => `${plain(100 * ratio, 3)} %`;

/// Round steps from `low` to `high`, about `count` of them.
function ticks(low, high, count) {
  const rough = (high - low) / count;
  if (!(rough > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough);
  const out = [];
  for (let i = Math.ceil(low / step); i * step <= high + step * 1e-9; ++i) out.push(i * step);
  return out;
}
const scale = (low, high, from, to) => (v) => from + ((v - low) / (high - low || 1)) * (to - from);
const logScale = (low, high, from, to) => {
  const linear = scale(Math.log10(low), Math.log10(high), from, to);
  return (v) => linear(Math.log10(Math.max(v, low)));
};
/// 1, 2 and 5 times each power of ten.
function logTicks(low, high) {
  const out = [];
  for (let p = Math.floor(Math.log10(low)); p <= Math.log10(high); ++p)
    for (const m of [1, 2, 5]) if (m * 10 ** p >= low * 0.999 && m * 10 ** p <= high * 1.001) out.push(m * 10 ** p);
  return out;
}

/// Lines and labels below (x) or at the left (y) of the rectangle `box`.
function xAxis(box, at, values, name, show = plain) {
  const g = element('g');
  for (const v of values)
    g.append(element('line', {class: 'grid', x1: at(v), x2: at(v), y1: box.top, y2: box.bottom}),
             text(at(v), box.bottom + 15, show(v), {class: 'axis', 'text-anchor': 'middle'}));
  g.append(text((box.left + box.right) / 2, box.bottom + 31, name, {class: 'axis', 'text-anchor': 'middle'}));
  return g;
}
function yAxis(box, at, values, name, show = plain) {
  const g = element('g');
  for (const v of values)
    g.append(element('line', {class: 'grid', x1: box.left, x2: box.right, y1: at(v), y2: at(v)}),
             text(box.left - 6, at(v) + 4, show(v), {class: 'axis', 'text-anchor': 'end'}));
  g.append(text(box.left, box.top - 8, name, {class: 'axis'}));
  return g;
}

/// Words and colours of causes, culprits and masters, as the program that made the page has them.
let words = {causes: {}, groups: {}, group_of: {}, colours: {}};

/// Fixed colours, so that a master looks the same in every chart and every run.
function colour(name) {
  return `var(--c${words.colours[name] ?? 7})`;
}
function legend(names, labels = {}) {
  return element('ul', {class: 'legend'}, ...names.map((name) => {
    const mark = element('i');
    mark.style.background = colour(name);
    return element('li', {}, mark, labels[name] ?? name);
  }));
}
