// SDRAM: latencies and banks.
/// Reads to their first beat and writes to their last: how long a master is kept waiting.
function latencies(run) {
  const rows = [];
  for (const [prefix, requests] of [['', 'reads'], ['write_last.', 'writes']])
    for (const name of Object.keys(run.stats)) {
      const master = /^ddr\.([^.]+)\.latency\.(.*)mean$/.exec(name);
      if (!master || master[2] !== prefix) continue;
      const value = (which) => (run.stats[`ddr.${master[1]}.latency.${prefix}${which}`] ?? [NaN])[0] * 1e9;
      rows.push({master: master[1], requests, ...Object.fromEntries(['p50', 'p95', 'p99', 'mean', 'max'].map((w) => [w, value(w)]))});
    }
  return rows;
}

function drawPercentiles(place, run, span) {
  const rows = latencies(run);
  const width = widthOf(place), box = {left: 142, right: width - 20, top: 8, bottom: 8 + 34 * rows.length};
  const x = logScale(span[0], span[1], box.left, box.right);
  const svg = drawing(place, width, box.bottom + 40, xAxis(box, x, logTicks(span[0], span[1]), 'ns'));
  rows.forEach(({master, requests, p50, p95, p99, mean, max}, row) => {
    const y = box.top + 34 * row + 17;
    svg.append(text(box.left - 8, y + 4, `${master}, ${requests}`, {'text-anchor': 'end'}),
      element('g', {}, element('title', {}, `${master}, ${requests}: median ${plain(p50)}, 95 % ${plain(p95)}, 99 % ${plain(p99)}, mean ${plain(mean)}, largest ${plain(max)} ns`),
        element('line', {class: 'base', x1: x(p99), x2: x(max), y1: y, y2: y, 'stroke-dasharray': '2 3'}),
        element('rect', {x: x(p50), y: y - 6, width: Math.max(x(p99) - x(p50), 2), height: 12, fill: colour(master), 'fill-opacity': 0.5}),
        element('rect', {x: x(p50), y: y - 9, width: Math.max(x(p95) - x(p50), 2), height: 18, fill: colour(master)}),
        element('path', {d: `M${x(mean)} ${y - 12}l5 -6h-10z`, fill: 'var(--text)'}),
        element('circle', {cx: x(max), cy: y, r: 4.5, fill: 'var(--page)', stroke: colour(master), 'stroke-width': 2.5})));
  });
  place.append(svg, element('p', {class: 'legend'}, 'Full bar: median to 95 %; pale bar: to 99 %; triangle: mean; ring: largest.'));
}
function latencySpan(runs) {
  const all = runs.flatMap((run) => latencies(run).flatMap((r) => [r.p50, r.mean, r.max])).filter((v) => v > 0);
  return all.length ? [Math.min(...all) / 1.25, Math.max(...all) * 1.15] : [1, 10];
}

/// One small chart for each direction and beat; masters are lines of steps.
function drawLatency(place, run) {
  const rows = run.latency.map(([master, direction, beat, low, high, count]) => ({master, direction, beat, low, high, count}));
  const low = Math.max(1, Math.min(...rows.map((r) => r.low))), high = Math.max(...rows.map((r) => r.high));
  const most = Math.max(...rows.map((r) => r.count));
  const kinds = [...new Set(rows.map((r) => `${r.direction}, ${r.beat} beat`))];
  for (const kind of kinds) {
    const of = rows.filter((r) => `${r.direction}, ${r.beat} beat` === kind);
    const width = widthOf(place), box = {left: 64, right: width - 20, top: 26, bottom: 166};
    const x = logScale(low, high, box.left, box.right), y = logScale(0.7, most * 1.3, box.bottom, box.top);
    const svg = drawing(place, width, 206, xAxis(box, x, logTicks(low, high), 'ns'),
      yAxis(box, y, logTicks(1, most).filter((v) => Number.isInteger(Math.round(Math.log10(v) * 1e6) / 1e6)), `requests: ${kind}`, short));
    const requests = (master) => of.filter((r) => r.master === master).reduce((sum, r) => sum + r.count, 0);
    const masters = [...new Set(of.map((r) => r.master))].sort((a, b) => requests(b) - requests(a));
    masters.forEach((master, i) => {
      const bins = of.filter((r) => r.master === master).sort((a, b) => a.low - b.low);
      let d = '', end = null;
      for (const b of bins) {
        d += end === b.low ? `V${y(b.count)}` : `${end === null ? '' : `V${box.bottom}`}M${x(b.low)} ${box.bottom}V${y(b.count)}`;
        d += `H${x(b.high)}`;
        end = b.high;
      }
      svg.append(element('path', {d: `${d}V${box.bottom}`, fill: colour(master), 'fill-opacity': 0.18, stroke: colour(master), 'stroke-width': 1.4,
                                  'stroke-dasharray': ['', '7 2', '2 2', '9 2 2 2'][i % 4] || undefined},
                         element('title', {}, `${master}: ${plain(bins.reduce((sum, b) => sum + b.count, 0), 6)} requests`)));
    });
    place.append(svg, legend(masters));
  }
}

const BANK_ROWS = [['row_hits', 'row open'], ['row_misses', 'bank closed'], ['row_conflicts', 'another row open']];
function drawBanks(place, run, most) {
  const banks = Object.keys(run.stats).filter((name) => /^ddr\.bank\d+\.row_hits$/.test(name)).length;
  const box = {left: 122, top: 24}, width = Math.min(90, (widthOf(place) - 132) / banks);
  const svg = drawing(place, box.left + banks * width + 10, box.top + BANK_ROWS.length * 40 + 10);
  for (let bank = 0; bank < banks; ++bank)
    svg.append(text(box.left + (bank + 0.5) * width, 16, width > 55 ? `bank ${bank}` : bank, {class: 'axis', 'text-anchor': 'middle'}));
  BANK_ROWS.forEach(([name, label], row) => {
    svg.append(text(box.left - 8, box.top + row * 40 + 24, label, {'text-anchor': 'end'}));
    for (let bank = 0; bank < banks; ++bank) {
      const count = (run.stats[`ddr.bank${bank}.${name}`] ?? [0])[0];
      const share = most ? count / most : 0;
      svg.append(element('rect', {x: box.left + bank * width + 1, y: box.top + row * 40 + 1, width: width - 2, height: 38, rx: 3,
                                  style: `fill: rgba(var(--heat), ${(0.06 + 0.6 * Math.sqrt(share)).toFixed(3)})`}),
                 text(box.left + (bank + 0.5) * width, box.top + row * 40 + 24, short(count), {'text-anchor': 'middle'}));
    }
  });
  place.append(svg);
}
function mostInBank(runs) {
  return Math.max(0, ...runs.flatMap((run) => Object.entries(run.stats).filter(([name]) => /^ddr\.bank\d+\./.test(name)).map(([, [v]]) => v)));
}
