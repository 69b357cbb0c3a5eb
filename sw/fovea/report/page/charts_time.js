// Frames and bandwidth over time.
const LANES = ['capture', 'remap', 'display'];
/// As many as the detailed bandwidth covers.
const DETAILED = 6;

function drawFrames(place, run) {
  const frames = run.frames.slice(0, DETAILED);
  const times = frames.flatMap((f) => LANES.flatMap((lane) => f[lane])).filter((t) => t !== null);
  if (!times.length) return;
  // Cameras capture at the same time; remaps and displayed frames follow one another.
  const cameras = [...new Set(frames.map((f) => f.camera).filter((camera) => camera !== null))].sort();
  const lanes = [...cameras.map((camera) => ({lane: 'capture', camera, name: cameras.length > 1 ? `capture ${camera}` : 'capture'})),
                 {lane: 'remap', name: 'remap'}, {lane: 'display', name: 'display'}];
  const width = widthOf(place), box = {left: 72, right: width - 20, top: 12, bottom: 12 + 46 * lanes.length};
  const at = scale(Math.min(...times), Math.max(...times), box.left, box.right);
  const svg = drawing(place, width, box.bottom + 40,
                      xAxis(box, at, ticks(Math.min(...times), Math.max(...times), width / 110), 'ms since power-up'));
  lanes.forEach(({lane, camera, name}, row) => {
    const y = box.top + row * 46 + 6;
    svg.append(text(box.left - 8, y + 22, name, {'text-anchor': 'end'}));
    for (const f of frames) {
      const [start, end] = f[lane];
      if (start === null || end === null || (f.repeated && lane !== 'display') || (camera ?? f.camera) !== f.camera) continue;
      const length = Math.max(at(end) - at(start), 1);
      const label = `frame ${f.frame}${f.repeated ? ', shown again' : ''}: ${lane} from ${plain(start, 7)} to ${plain(end, 7)} ms, ` +
        `${plain(end - start)} ms` + (f.dropped ? `; ${f.dropped} dropped before it` : '');
      svg.append(element('g', {}, element('title', {}, label),
        element('rect', {x: at(start), y: y + (f.frame % 2) * 4, width: length, height: 30, rx: 2, fill: colour(lane), class: 'edge',
                         'fill-opacity': f.repeated ? 0.45 : 1, 'stroke-dasharray': f.repeated ? '4 3' : undefined}),
        length > 22 ? text(at(start) + length / 2, y + 19 + (f.frame % 2) * 4, f.repeated ? `${f.frame} again` : f.frame,
                           {class: 'on', 'text-anchor': 'middle'}) : undefined,
        f.dropped && lane === 'display' ? text(at(start), y + 1, `${f.dropped} dropped`, {class: 'axis', 'text-anchor': 'middle'}) : undefined));
    }
  });
  place.append(svg);
}

/// An axis for values that differ little: from below the smallest to above the largest, at least 1 % of it wide.
function around(values) {
  const low = Math.min(...values), high = Math.max(...values), pad = Math.max((high - low) * 0.15, high * 0.005);
  return [Math.max(0, low - pad), high + pad];
}

function drawFrameTimes(place, run) {
  const points = run.frames.filter((f) => !f.repeated).map((f) => ({
    frame: f.frame,
    remap: f.remap[0] === null || f.remap[1] === null ? null : f.remap[1] - f.remap[0],
    latency: f.capture[0] === null || f.display[0] === null ? null : f.display[0] - f.capture[0],
  }));
  const parts = [['remap', 'remap', 'remap'], ['latency', 'display', 'capture to display']]
    .map(([key, shade, name]) => ({key, shade, name, known: points.filter((p) => p[key] !== null)})).filter((p) => p.known.length);
  if (!parts.length) return;
  const width = widthOf(place), height = 110, gap = 34, left = 64, right = width - 20, top = 26;
  const first = run.frames[0].frame, last = run.frames[run.frames.length - 1].frame;
  const x = scale(first, Math.max(last, first + 1), left, right);
  const whole = ticks(first, last, width / 90).filter(Number.isInteger);
  const svg = drawing(place, width, top + parts.length * (height + gap) + 6);
  parts.forEach(({key, shade, name, known}, n) => {
    const box = {left, right, top: top + n * (height + gap), bottom: top + n * (height + gap) + height};
    const [low, high] = around(known.map((p) => p[key]));
    const y = scale(low, high, box.bottom, box.top);
    svg.append(yAxis(box, y, ticks(low, high, 4), `${name}, ms`, (v) => plain(v, 6)));
    if (n + 1 === parts.length) svg.append(xAxis(box, x, whole, 'displayed frame'));
    svg.append(element('polyline', {points: known.map((p) => `${x(p.frame)},${y(p[key])}`).join(' '), fill: 'none',
                                    stroke: colour(shade), 'stroke-width': 2}));
    for (const p of known.length <= 60 ? known : [])
      svg.append(element('circle', {cx: x(p.frame), cy: y(p[key]), r: 3.5, fill: colour(shade)},
                         element('title', {}, `frame ${p.frame}: ${name} ${plain(p[key], 6)} ms`)));
  });
  place.append(svg);
  if (run.frames.length < run.frames_in_all)
    place.append(element('p', {class: 'absent'}, `The first ${run.frames.length} of ${run.frames_in_all} frames.`));
}

/// `top` is common to all runs, so that heights can be compared.
function drawBandwidth(place, data, top) {
  if (!data || data.edges_ms.length < 2 || !data.series.length) return;
  const width = widthOf(place), box = {left: 64, right: width - 20, top: 26, bottom: 226};
  const edges = data.edges_ms, first = edges[0], last = edges[edges.length - 1];
  const x = scale(first, last, box.left, box.right), y = scale(0, top, box.bottom, box.top);
  const svg = drawing(place, width, 266, xAxis(box, x, ticks(first, last, width / 110), 'ms since power-up'), yAxis(box, y, ticks(0, top, 4), 'MB/s'));
  const base = new Array(edges.length - 1).fill(0);
  for (const {master, mbps} of data.series) {
    const upper = [], lower = [];
    mbps.forEach((rate, i) => {
      lower.push(`${x(edges[i]).toFixed(1)},${y(base[i]).toFixed(1)}`, `${x(edges[i + 1]).toFixed(1)},${y(base[i]).toFixed(1)}`);
      base[i] += rate;
      upper.push(`${x(edges[i]).toFixed(1)},${y(base[i]).toFixed(1)}`, `${x(edges[i + 1]).toFixed(1)},${y(base[i]).toFixed(1)}`);
    });
    svg.append(element('path', {d: `M${upper.join('L')}L${lower.reverse().join('L')}Z`, fill: colour(master)}));
  }
  const cursor = element('line', {class: 'base', y1: box.top, y2: box.bottom, visibility: 'hidden'});
  svg.append(element('line', {class: 'base', x1: box.left, x2: box.right, y1: box.bottom, y2: box.bottom}), cursor);
  const readout = element('p', {class: 'readout', 'aria-live': 'polite'}, 'Point at the chart, or focus it and use the arrow keys, to read it.');
  let chosen = 0;
  const show = (i) => {
    chosen = Math.max(0, Math.min(edges.length - 2, i));
    const middle = x((edges[chosen] + edges[chosen + 1]) / 2);
    cursor.setAttribute('x1', middle);
    cursor.setAttribute('x2', middle);
    cursor.setAttribute('visibility', 'visible');
    readout.textContent = `${plain(edges[chosen], 7)} to ${plain(edges[chosen + 1], 7)} ms: ` +
      data.series.map((s) => `${s.master} ${plain(s.mbps[chosen], 3)}`).join(', ') + `; together ${plain(base[chosen], 3)} MB/s`;
  };
  svg.addEventListener('pointermove', (event) => {
    const rectangle = svg.getBoundingClientRect();
    const t = first + (((event.clientX - rectangle.left) / rectangle.width) * width - box.left) / (box.right - box.left) * (last - first);
    show(edges.findIndex((e, i) => i + 1 === edges.length - 1 || edges[i + 1] > t));
  });
  const frame = element('div', {tabindex: 0, role: 'group', 'aria-label': 'Bandwidth; arrow keys read it'}, svg);
  frame.addEventListener('keydown', (event) => {
    const step = {ArrowLeft: -1, ArrowRight: 1, PageUp: -20, PageDown: 20, Home: -1e9, End: 1e9}[event.key];
    if (step === undefined) return;
    event.preventDefault();
    show(chosen + step);
  });
  place.append(frame, legend(data.series.map((s) => s.master)), readout);
}

function highest(data) {
  if (!data || !data.series) return 0;
  return Math.max(0, ...data.edges_ms.slice(1).map((_, i) => data.series.reduce((sum, s) => sum + s.mbps[i], 0)));
}
