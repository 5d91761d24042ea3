// Matrices of ratios, and plain tables that sort.
import { numberText, rowsOf, titleOf, unique, words } from './data';
import type { Cell, Experiment, MatrixFigure, TableFigure } from './data';

function headerCell(text: string): HTMLTableCellElement {
  const cell = document.createElement('th');
  cell.scope = 'col';
  cell.textContent = text;
  return cell;
}

function scrolling(table: HTMLTableElement): HTMLElement {
  const frame = document.createElement('div');
  frame.className = 'scrolling';
  frame.tabIndex = 0;
  frame.append(table);
  return frame;
}

/** Blue below 1, orange above, stronger the further away on a logarithmic scale. */
function shade(ratio: number): string {
  const strength = Math.min(1, Math.abs(Math.log10(ratio))) * 70;
  return `color-mix(in oklab, var(${ratio < 1 ? '--good' : '--bad'}) ${strength.toFixed(0)}%, transparent)`;
}

export function drawMatrix(experiment: Experiment, figure: MatrixFigure): HTMLElement {
  const rows = rowsOf(experiment, figure);
  const columns = unique(rows.map((row) => words(row, figure.column)));
  const lines = new Map<string, { labels: string[]; values: Map<string, Cell> }>();
  for (const row of rows) {
    const labels = figure.row.map((name) => String(row[name] ?? ''));
    const key = labels.join('\n');
    if (!lines.has(key)) lines.set(key, { labels, values: new Map() });
    lines.get(key)!.values.set(words(row, figure.column), row[figure.value]);
  }
  const table = document.createElement('table');
  table.className = 'matrix';
  const head = table.createTHead().insertRow();
  for (const name of figure.row) head.append(headerCell(titleOf(experiment, name)));
  for (const column of columns) head.append(headerCell(column));
  const body = table.createTBody();
  for (const { labels, values } of lines.values()) {
    const line = body.insertRow();
    for (const label of labels) line.insertCell().textContent = label;
    const numbers = [...values.values()].filter((value) => typeof value === 'number');
    const best = Math.min(...numbers);
    for (const column of columns) {
      const cell = line.insertCell();
      const value = values.get(column) ?? null;
      cell.className = 'number';
      if (typeof value !== 'number') {
        cell.textContent = '–';
        continue;
      }
      cell.textContent = value >= 100 ? value.toFixed(0) : value.toFixed(2);
      cell.style.background = shade(value);
      if (value === best) cell.classList.add('best');
    }
  }
  return scrolling(table);
}

export function drawTable(experiment: Experiment, figure: TableFigure): HTMLElement {
  const rows = rowsOf(experiment, figure);
  const table = document.createElement('table');
  const head = table.createTHead().insertRow();
  const body = table.createTBody();
  const fill = (): void => {
    body.replaceChildren();
    for (const row of rows) {
      const line = body.insertRow();
      for (const name of figure.columns) {
        const cell = line.insertCell();
        cell.textContent = numberText(row[name]);
        if (typeof row[name] === 'number') cell.className = 'number';
      }
    }
  };
  for (const name of figure.columns) {
    const cell = headerCell('');
    const button = document.createElement('button');
    button.textContent = titleOf(experiment, name);
    let sign = -1;
    button.addEventListener('click', () => {
      sign = -sign;
      rows.sort((a, b) => {
        const [x, y] = [a[name], b[name]];
        if (typeof x === 'number' && typeof y === 'number') return sign * (x - y);
        return sign * String(x ?? '').localeCompare(String(y ?? ''));
      });
      for (const other of head.cells) other.removeAttribute('aria-sort');
      cell.setAttribute('aria-sort', sign > 0 ? 'ascending' : 'descending');
      fill();
    });
    cell.append(button);
    head.append(cell);
  }
  fill();
  return scrolling(table);
}
