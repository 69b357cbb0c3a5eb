// The core's clocks: waterfall, difference, call stacks.
/// What a cause is called beside a bar.
const causeLabel = (cause) => words.causes[cause] ?? cause;

/// [cause, clocks, {culprit: clocks}] of everything that has clocks; issue first, idle last, waits by size between.
function clocksByCause(run) {
  const value = (name) => (run.stats[name] ?? [0])[0];
  const waits = Object.keys(run.stats).map((name) => /^cpu\.stall\.([^.]+)$/.exec(name)).filter(Boolean).map((m) => m[1]);
  const parts = (cause) => Object.fromEntries(Object.keys(run.stats).filter((n) => n.startsWith(`cpu.stall.${cause}.by.`) && value(n) > 0)
    .map((n) => [n.slice(`cpu.stall.${cause}.by.`.length), value(n)]));
  const rows = waits.map((cause) => [cause, value(`cpu.stall.${cause}`), parts(cause)]).filter((r) => r[1] > 0).sort((a, b) => b[1] - a[1]);
  return [['issue', value('cpu.issue'), {}], ...rows, ['idle', value('cpu.idle'), {}]].filter((r) => r[1] > 0);
}

/// Who is to blame, in groups that colours can tell apart; the table has each one.
const group = (culprit) => words.group_of[culprit] ?? 'other';

/// Over the clocks in which the core is awake: an idle core would leave no room for the rest.
function drawWaterfall(place, run) {
  const idle = (run.stats['cpu.idle'] ?? [0])[0], cycles = run.stats['cpu.cycles'][0], all = cycles - idle;
  if (all <= 0) return;
  const every = clocksByCause(run).filter((r) => r[0] !== 'idle');
  // Rows that would be thinner than a line are one row, so that all still add up.
  const rows = every.filter((r) => r[1] >= all / 1000), small = every.filter((r) => !rows.includes(r));
  const parts = {};
  for (const r of small) for (const [culprit, n] of Object.entries(r[2])) parts[culprit] = (parts[culprit] ?? 0) + n;
  if (small.length) rows.push([small.length === 1 ? small[0][0] : `${small.length} others`, small.reduce((sum, r) => sum + r[1], 0), parts]);
  const width = widthOf(place), box = {left: 142, right: width - 66, top: 6, bottom: 6 + 30 * rows.length};
  const x = scale(0, all, box.left, box.right);
  const svg = drawing(place, width, box.bottom + 40,
    xAxis(box, x, ticks(0, 1, width / 120).map((v) => v * all), "share of the core's awake clocks", (v) => percent(v / all)));
  const used = new Set();
  let from = 0;
  rows.forEach(([cause, clocks, parts], row) => {
    const y = box.top + 30 * row + 4, name = causeLabel(cause), sums = {};
    for (const [culprit, n] of Object.entries(parts)) sums[group(culprit)] = (sums[group(culprit)] ?? 0) + n;
    const known = Object.values(sums).reduce((sum, n) => sum + n, 0);
    if (clocks > known) sums[cause === 'issue' ? 'issue' : 'itself'] = (sums.itself ?? 0) + clocks - known;
    svg.append(text(box.left - 8, y + 15, name, {'text-anchor': 'end'}));
    let start = from;
    for (const key of Object.keys(words.groups).filter((g) => sums[g] > 0)) {
      used.add(key);
      svg.append(element('rect', {x: x(start), y, width: Math.max(x(start + sums[key]) - x(start), 0.4), height: 22, fill: colour(key),
                                  class: sums[key] > all / 200 ? 'edge' : undefined},
        element('title', {}, `${name}, ${words.groups[key]}: ${plain(sums[key], 12)} clocks, ${percent(sums[key] / all)}`)));
      start += sums[key];
    }
    svg.append(text(x(from + clocks) + 6, y + 15, percent(clocks / all)));
    if (row + 1 < rows.length) svg.append(element('line', {class: 'base', x1: x(from + clocks), x2: x(from + clocks), y1: y + 22, y2: y + 34}));
    from += clocks;
  });
  const events = Object.entries(run.events).map(([event, words]) => [words, (run.stats[`cpu.idle.${event}`] ?? [0])[0]])
    .filter(([, n]) => n > 0).sort((a, b) => b[1] - a[1]).map(([words, n]) => `${words} ${percent(n / cycles)}`);
  const ended = events.length ? ` The interrupt that ended the sleep came from: ${events.join(', ')}.` : '';
  // A sleep within remaps waits for work that the program has given away.
  const spare = run.stats['cpu.spare'];
  const free = idle && spare ? ` It has nothing to do in ${percent(spare[0] / cycles)}${spare[0] < idle ? '; the rest of its sleep waits for the EDMA or the remap engine' : ''}.` : '';
  place.append(element('p', {}, `The core is awake in ${percent(all / cycles)} of its ${short(cycles)} clocks and asleep, waiting for an interrupt, in ${percent(idle / cycles)}.${free}${ended}`),
               svg, legend(Object.keys(words.groups).filter((g) => used.has(g)), words.groups));
}

function drawWaterfallDifference(place, run, first) {
  const perFrame = (r) => Object.fromEntries(clocksByCause(r).map(([cause, clocks]) => [cause, clocks / r.stats['frame.remapped'][0]]));
  const a = perFrame(first), b = perFrame(run);
  const every = [...new Set([...Object.keys(a), ...Object.keys(b)])].map((cause) => [cause, (b[cause] ?? 0) - (a[cause] ?? 0)])
    .sort((p, q) => Math.abs(q[1]) - Math.abs(p[1]));
  const largest = Math.abs(every[0]?.[1] ?? 0), rows = every.filter((r) => Math.abs(r[1]) >= Math.max(0.5, largest / 1000));
  if (!rows.length) {
    place.append(element('p', {class: 'absent'}, 'No cause differs.'));
    return;
  }
  const width = widthOf(place), box = {left: 142, right: width - 30, top: 6, bottom: 6 + 28 * rows.length};
  const x = scale(-largest * 1.15, largest * 1.15, box.left, box.right);
  const svg = drawing(place, width, box.bottom + 40,
    xAxis(box, x, ticks(-largest, largest, width / 130), 'clocks for each corrected frame; left: fewer, right: more', short));
  rows.forEach(([cause, change], row) => {
    const y = box.top + 28 * row + 4;
    svg.append(text(box.left - 8, y + 15, causeLabel(cause).replace(/ \(.*/, ''), {'text-anchor': 'end'}),
      element('rect', {x: Math.min(x(0), x(change)), y, width: Math.abs(x(change) - x(0)), height: 20, fill: change < 0 ? 'var(--c0)' : 'var(--c1)'}),
      text(x(0) + (change < 0 ? 6 : -6), y + 15, `${change > 0 ? '+' : ''}${short(change)}`, {'text-anchor': change < 0 ? 'start' : 'end'}));
  });
  svg.append(element('line', {class: 'base', x1: x(0), x2: x(0), y1: box.top, y2: box.bottom}));
  place.append(svg);
}

/// Boxes below their caller; choosing one widens it, Escape or the outermost box shows all again.
function drawFlame(place, run) {
  const depth = (node) => 1 + Math.max(0, ...(node.children ?? []).map(depth));
  const root = run.stacks, width = widthOf(place), step = 22, height = depth(root) * step;
  const readout = element('p', {class: 'readout', 'aria-live': 'polite'}, '');
  const holder = element('div');
  const tell = (node) => { readout.textContent = `${node.name}: ${plain(node.clocks, 9)} clocks, ${percent(node.clocks / root.clocks)} of all`; };
  let path = [root];
  function show(focus) {
    const svg = element('svg', {viewBox: `0 0 ${width} ${height}`, role: 'group', 'aria-label': 'Call stacks; choose a box to widen it'});
    const box = (node, x, w, row, chain) => {
      if (w < 0.7) return;
      const inPath = chain.length < path.length;
      const g = element('g', {class: 'box', tabindex: w > 12 ? 0 : undefined, role: w > 12 ? 'button' : undefined,
                              'aria-label': w > 12 ? `${node.name}, ${percent(node.clocks / root.clocks)}` : undefined},
        w > 12 ? undefined : element('title', {}, `${node.name}: ${plain(node.clocks, 9)} clocks, ${percent(node.clocks / root.clocks)}`),
        element('rect', {x, y: row * step, width: w, height: step - 1, class: 'edge', fill: inPath ? 'var(--c9)' : `var(--c${[0, 4, 2, 3, 6][row % 5]})`, 'fill-opacity': 0.55}));
      const letters = Math.floor((w - 8) / 6.6);
      // Beside the box, not in it: a shortened name is for the eye alone, and the box has its whole name.
      const shown = node.name.length > letters ? `${node.name.slice(0, letters - 1)}\u2026` : node.name;
      const label = letters > 2 ? text(x + 4, row * step + 15, shown, {'aria-hidden': 'true', 'pointer-events': 'none'}) : undefined;
      const choose = () => { path = chain; tell(node); show(true); };
      g.addEventListener('click', choose);
      g.addEventListener('pointerenter', () => tell(node));
      g.addEventListener('focus', () => tell(node));
      g.addEventListener('keydown', (event) => {
        if (event.key === 'Enter' || event.key === ' ') { event.preventDefault(); choose(); }
        if (event.key === 'Escape') { path = [root]; show(true); }
      });
      svg.append(g);
      if (label) svg.append(label);
      const next = path[chain.length];
      if (next) { box(next, 0, width, row + 1, [...chain, next]); return; }
      let from = x;
      for (const child of node.children ?? []) {
        const part = (child.clocks / node.clocks) * w;
        box(child, from, part, row + 1, [...chain, child]);
        from += part;
      }
    };
    box(root, 0, width, 0, [root]);
    holder.replaceChildren(svg);
    if (focus) svg.querySelectorAll('g')[path.length - 1]?.focus();
  }
  show(false);
  place.append(holder, readout);
}
