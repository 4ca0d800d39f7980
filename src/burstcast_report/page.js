'use strict';

// -- figures: a switch chooses the case of all figures that have it ---------------------------------

for (const button of document.querySelectorAll('figure button[data-case]')) {
  button.addEventListener('click', () => {
    const place = button.getBoundingClientRect().top;
    for (const figure of document.querySelectorAll('figure')) {
      const views = [...figure.querySelectorAll('.view')];
      if (!views.some((view) => view.dataset.case === button.dataset.case)) continue;
      for (const view of views) view.hidden = view.dataset.case !== button.dataset.case;
      for (const other of figure.querySelectorAll('button[data-case]')) {
        other.classList.toggle('on', other.dataset.case === button.dataset.case);
      }
    }
    // pictures above may have other heights now: the reader stays where he was
    window.scrollBy({ top: button.getBoundingClientRect().top - place, behavior: 'instant' });
  });
}

// -- tables: drawn from their CSV when they are opened ----------------------------------------------

const MOST_ROWS = 100;
const MOST_BUTTONS = 6;

function parsedCsv(text) {
  const rows = [];
  let row = [];
  for (const [, separator, quoted, plain] of
    text.matchAll(/(^|,|\r?\n)(?:"((?:[^"]|"")*)"|([^,"\r\n]*))/g)) {
    if (separator !== ',' && row.length) { rows.push(row); row = []; }
    row.push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
  }
  rows.push(row);
  return rows.filter((cells) => cells.length > 1 || cells[0] !== '');
}

const isNumber = (text) => text !== '' && isFinite(text);

function readable(text) {
  if (!isNumber(text) || /^-?\d+$/.test(text)) return text;
  return String(Number(Number(text).toPrecision(4)));
}

const LETTERS = {
  alpha: 'α', beta: 'β', gamma: 'γ', delta: 'δ', epsilon: 'ε', zeta: 'ζ', eta: 'η', theta: 'θ',
  lambda: 'λ', mu: 'μ', nu: 'ν', pi: 'π', rho: 'ρ', sigma: 'σ', tau: 'τ', phi: 'φ', chi: 'χ',
  psi: 'ψ', omega: 'ω', times: '×', cdot: '·', leq: '≤', geq: '≥',
};

// Formulas in LaTeX, as far as tables of parameters have any.
function withFormulas(text) {
  const escaped = text.replaceAll('&', '&amp;').replaceAll('<', '&lt;');
  return escaped.replaceAll(/\$([^$]*)\$/g, (_, formula) => formula
    .replaceAll(/\\(?:mathrm|text|mathit)\{([^{}]*)\}/g, '$1')
    .replaceAll(/_(?:\{([^{}]*)\}|(\w))/g, '<sub>$1$2</sub>')
    .replaceAll(/\^(?:\{([^{}]*)\}|(\w))/g, '<sup>$1$2</sup>')
    .replaceAll(/\\([a-zA-Z]+)/g, (whole, name) => LETTERS[name] ?? whole)
    .replaceAll(/\\[,;: ]/g, '\u2009'));
}

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function inOrder(values) {
  const numbers = values.every((value) => value === '' || isNumber(value));
  return values.sort((a, b) => (numbers ? a - b : a.localeCompare(b, 'en', { numeric: true })));
}

// Buttons for few values, a list for many: what is chosen is handed to `choose`; '' is all.
function chooser(column, values, choose) {
  const group = element('div', { className: 'switch' }, element('span', {}, column.name));
  if (column.switch && values.length <= MOST_BUTTONS) {
    for (const value of [null, ...values]) {
      const button = element('button', { type: 'button' }, value === null ? 'all' : value || 'none');
      button.classList.toggle('on', value === null);
      button.addEventListener('click', () => {
        for (const other of group.querySelectorAll('button')) other.classList.remove('on');
        button.classList.add('on');
        choose(value);
      });
      group.append(button);
    }
    return group;
  }
  const options = values.map((value, index) => element('option', { value: index }, value || 'none'));
  const list = element('select', {}, element('option', { value: '' }, 'all'), ...options);
  list.addEventListener('change', () => choose(list.value === '' ? null : values[list.value]));
  group.append(list);
  return group;
}

function drawTable(details) {
  const { name, csv, columns } = JSON.parse(details.querySelector('script').textContent);
  const rows = parsedCsv(csv).slice(1);
  const chosen = new Map();
  let sorting = null;
  let most = MOST_ROWS;

  const numeric = columns.map((_, index) => {
    const cells = rows.map((row) => row[index]).filter((cell) => cell !== '');
    return cells.length > 0 && cells.every(isNumber);
  });
  const body = element('tbody');
  const count = element('p', { className: 'note' });
  const more = element('button', { type: 'button', className: 'more' });
  more.addEventListener('click', () => { most = Infinity; fill(); });

  function fill() {
    let shown = rows.filter((row) => [...chosen].every(([index, value]) => row[index] === value));
    if (sorting) {
      const { index, sign } = sorting;
      const before = numeric[index]
        ? (a, b) => a[index] - b[index]
        : (a, b) => a[index].localeCompare(b[index], 'en', { numeric: true });
      // what is undefined comes last either way
      const [known, unknown] = [true, false].map(
        (wanted) => shown.filter((row) => (row[index] !== '') === wanted));
      shown = [...known.sort((a, b) => sign * before(a, b)), ...unknown];
    }
    body.replaceChildren(...shown.slice(0, most).map((row) => element('tr', {}, ...row.map(
      (cell, index) => {
        const made = element('td', { title: numeric[index] ? cell : '' });
        made.innerHTML = numeric[index] ? readable(cell) : withFormulas(cell);
        made.className = numeric[index] ? 'number' : cell.length > 60 ? 'long' : '';
        return made;
      }))));
    count.textContent = `${shown.length} of ${rows.length} rows`
      + (shown.length > most ? `, the first ${most} shown` : '');
    more.textContent = `show all ${shown.length}`;
    more.hidden = shown.length <= most;
  }

  const switches = element('div', { className: 'switches' });
  columns.forEach((column, index) => {
    const values = inOrder([...new Set(rows.map((row) => row[index]))]);
    const few = values.length > 1 && values.length <= 60;
    const names = !numeric[index] && values.length < rows.length;
    if (few && column.name !== 'reynolds' && (column.key || names)) {
      switches.append(chooser(column, values, (value) => {
        if (value === null) chosen.delete(index); else chosen.set(index, value);
        fill();
      }));
    }
  });

  const heads = columns.map((column, index) => {
    const head = element('th', { title: column.meaning, className: numeric[index] ? 'number' : '' },
      column.name, element('small', {}, column.unit));
    head.addEventListener('click', () => {
      sorting = { index, sign: sorting && sorting.index === index ? -sorting.sign : 1 };
      fill();
    });
    return head;
  });

  const file = new Blob([csv], { type: 'text/csv' });
  const link = element('a', { href: URL.createObjectURL(file), download: `${name}.csv` }, 'CSV');
  const meanings = columns.filter((column) => column.meaning).map((column) => element('tr', {},
    element('td', {}, column.name), element('td', {}, column.unit),
    element('td', {}, column.meaning)));
  details.append(
    switches,
    element('div', { className: 'wide' },
      element('table', {}, element('thead', {}, element('tr', {}, ...heads)), body)),
    count, more,
    element('p', { className: 'files' }, link),
    element('details', {}, element('summary', {}, 'What the columns are'),
      element('table', { className: 'columns' }, element('tbody', {}, ...meanings))));
  fill();
}

for (const details of document.querySelectorAll('details.data')) {
  details.addEventListener('toggle', () => drawTable(details), { once: true });
}

// what a link leads to is opened
function openTarget() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (target && target.tagName === 'DETAILS') target.open = true;
}
window.addEventListener('hashchange', openTarget);
openTarget();
