// What the reader does with the page, and the call of every chart.
function themeButton() {
  const root = document.documentElement, dark = matchMedia('(prefers-color-scheme: dark)');
  let chosen = null;
  const button = element('button', {type: 'button'});
  const show = () => {
    const theme = chosen ?? (dark.matches ? 'dark' : 'light');
    root.dataset.theme = theme;
    button.textContent = theme === 'dark' ? 'Light colours' : 'Dark colours';
  };
  button.addEventListener('click', () => { chosen = root.dataset.theme === 'dark' ? 'light' : 'dark'; show(); });
  dark.addEventListener('change', show);
  // Paper is white.
  addEventListener('beforeprint', () => { root.dataset.theme = 'light'; });
  addEventListener('afterprint', show);
  show();
  document.getElementById('controls').append(button);
}

/// Each heading of a column becomes a button that sorts by it.
function sortable(table) {
  const body = table.tBodies[0];
  const key = (row, column) => {
    const cell = row.cells[column], data = cell.querySelector('data');
    if (data) return Number(data.value);
    return cell.textContent.trim().toLowerCase();
  };
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = element('button', {type: 'button'}, heading.textContent);
    heading.replaceChildren(button);
    button.addEventListener('click', () => {
      const numbers = heading.classList.contains('n');
      const before = heading.getAttribute('aria-sort');
      const order = before === null ? (numbers ? 'descending' : 'ascending') : before === 'ascending' ? 'descending' : 'ascending';
      for (const h of table.tHead.rows[0].cells) h.removeAttribute('aria-sort');
      heading.setAttribute('aria-sort', order);
      const sign = order === 'ascending' ? 1 : -1;
      const rows = [...body.rows].map((row) => [key(row, column), row]);
      // Cells without a value come last in either order.
      rows.sort(([a], [b]) => (a === '') - (b === '') || (typeof a === typeof b ? sign * (a < b ? -1 : a > b ? 1 : 0) : typeof a === 'number' ? -1 : 1));
      body.append(...rows.map(([, row]) => row));
    });
  });
}

/// A field above a long table that leaves only the rows with its text.
function searchable(details) {
  const table = details.querySelector('table');
  if (!table || table.tBodies[0].rows.length < 15) return;
  const field = element('input', {type: 'search', placeholder: 'Only rows with \u2026', 'aria-label': `Rows of the table: ${table.caption.textContent}`});
  field.addEventListener('input', () => {
    const wanted = field.value.toLowerCase();
    for (const row of table.tBodies[0].rows) row.hidden = !row.textContent.toLowerCase().includes(wanted);
  });
  details.querySelector('summary').after(field);
}

/// Slider, one or the other picture, and their difference.
function comparison(figure) {
  const stack = figure.querySelector('.stack'), {a, b} = figure.dataset;
  stack.classList.add('slider');
  stack.append(element('div', {class: 'edge'}), element('span', {class: 'tag a'}, a), element('span', {class: 'tag b'}, b));
  const slider = element('input', {type: 'range', min: 0, max: 100, value: 50, 'aria-label': `How much of ${a} is shown, in percent`});
  const cut = () => stack.style.setProperty('--cut', `${slider.value}%`);
  slider.addEventListener('input', cut);
  cut();
  const modes = [['slider', 'Slider'], ['first', a], ['second', b], ['difference', 'Difference'], ['difference strong', 'Difference, 8 times as bright']];
  const choice = element('fieldset', {class: 'choice'}, element('legend', {}, 'What is shown'));
  for (const [mode, label] of modes) {
    const radio = element('input', {type: 'radio', name: figure.id, value: mode});
    radio.checked = mode === 'slider';
    radio.addEventListener('change', () => { stack.className = `stack ${mode}`; slider.disabled = mode !== 'slider'; });
    choice.append(element('label', {}, radio, label));
  }
  choice.append(slider);
  figure.append(choice);
  stack.addEventListener('pointermove', (event) => {
    if (!event.buttons || slider.disabled) return;
    const box = stack.getBoundingClientRect();
    slider.value = 100 * (event.clientX - box.left) / box.width;
    cut();
  });
}

function drawAll(runs) {
  const top = (view) => Math.max(1, ...runs.map((run) => highest(run.timeline?.[view]))) * 1.05;
  const draw = {
    'frames': drawFrames, 'frame-times': drawFrameTimes,
    'bandwidth-detail': (place, run) => drawBandwidth(place, run.timeline.detail, top('detail')),
    'bandwidth-whole': (place, run) => drawBandwidth(place, run.timeline.whole, top('whole')),
    'percentiles': (place, run) => drawPercentiles(place, run, latencySpan(runs)), 'latency': drawLatency,
    'waterfall': drawWaterfall, 'waterfall-difference': (place, run) => drawWaterfallDifference(place, run, runs[0]),
    'banks': (place, run) => drawBanks(place, run, mostInBank(runs)), 'flame': drawFlame,
  };
  for (const place of document.querySelectorAll('[data-chart]')) {
    place.replaceChildren();
    draw[place.dataset.chart](place, runs[Number(place.dataset.run)]);
  }
}

/// Draws all charts, and again when the window's width has changed for good.
function charts() {
  const {runs, ...data} = JSON.parse(document.getElementById('data').textContent);
  words = data.words;
  let width = innerWidth, later = 0;
  drawAll(runs);
  addEventListener('resize', () => {
    clearTimeout(later);
    later = setTimeout(() => {
      if (innerWidth === width) return;
      width = innerWidth;
      drawAll(runs);
    }, 150);
  });
}

themeButton();
document.querySelectorAll('figure.compare').forEach(comparison);
charts();
document.querySelectorAll('details').forEach(searchable);
document.querySelectorAll('table').forEach(sortable);
document.documentElement.dataset.ready = 'true';
