// Curves in small multiples.
import * as Plot from '@observablehq/plot';
import { numberText, rowsOf, titleOf, unique, words } from './data';
import type { Experiment, LinesFigure, Row } from './data';
import { colorOf, isShown, markerOf, onToggle, toggle } from './series';

interface Point {
  series: string;
  x: number;
  y: number;
  row: Row;
}

/** The least-squares slope of log y over log x through the three points of smallest x. */
export function slopeOf(points: { x: number; y: number }[]): number | null {
  const last = [...points].sort((a, b) => a.x - b.x).slice(0, 3);
  if (last.length < 2) return null;
  const xs = last.map((point) => Math.log(point.x));
  const ys = last.map((point) => Math.log(point.y));
  const mean = (values: number[]): number => values.reduce((a, b) => a + b) / values.length;
  const [mx, my] = [mean(xs), mean(ys)];
  const over = xs.reduce((sum, x) => sum + (x - mx) ** 2, 0);
  return over > 0 ? xs.reduce((sum, x, k) => sum + (x - mx) * (ys[k] - my), 0) / over : null;
}

function pointsOf(rows: Row[], figure: LinesFigure): Point[] {
  const fits = (value: unknown, scale: string): value is number =>
    typeof value === 'number' && (scale === 'linear' || value > 0);
  return rows.flatMap((row) => {
    const [x, y] = [row[figure.x], row[figure.y]];
    return fits(x, figure.x_scale) && fits(y, figure.y_scale)
      ? [{ series: words(row, figure.series), x, y, row }]
      : [];
  });
}

function extent(values: number[]): [number, number] {
  if (values.length === 0) return [0, 1];
  return [values.reduce((a, b) => Math.min(a, b)), values.reduce((a, b) => Math.max(a, b))];
}

function tipText(point: Point, experiment: Experiment): string {
  return experiment.columns
    .filter((column) => point.row[column.name] !== null)
    .map((column) => `${column.title}: ${numberText(point.row[column.name])}`)
    .join('\n');
}

/** \param showMesh  shows the mesh of a family, where families are the panels */
export function drawLines(
  experiment: Experiment,
  figure: LinesFigure,
  showMesh: ((family: string) => void) | null,
): HTMLElement {
  const container = document.createElement('div');
  const rows = rowsOf(experiment, figure);
  const all = pointsOf(rows, figure);
  const series = unique(all.map((point) => point.series));
  const panels = figure.panel === null ? [null] : unique(rows.map((row) => row[figure.panel!]));

  const legend = document.createElement('div');
  legend.className = 'series';
  for (const name of series) {
    const button = document.createElement('button');
    button.dataset['series'] = name;
    const swatch = Plot.plot({
      width: 22,
      height: 14,
      margin: 0,
      axis: null,
      x: { domain: [-1, 1] },
      y: { domain: [-1, 1] },
      marks: [
        Plot.ruleY([0], { stroke: colorOf(name), strokeWidth: 1.5 }),
        Plot.dot([[0, 0]], { fill: colorOf(name), symbol: markerOf(name), r: 4 }),
      ],
    });
    swatch.setAttribute('aria-hidden', 'true');
    button.append(swatch, name);
    button.addEventListener('click', () => toggle(name));
    legend.append(button);
  }

  const grid = document.createElement('div');
  grid.className = 'panels';
  const redraw = (): void => {
    for (const button of legend.querySelectorAll('button'))
      button.setAttribute('aria-pressed', String(isShown(button.dataset['series']!)));
    grid.replaceChildren(
      ...panels.map((panel) => {
        const here = all.filter(
          (point) =>
            isShown(point.series) && (figure.panel === null || point.row[figure.panel] === panel),
        );
        const drawn = drawPanel(experiment, figure, panel === null ? '' : String(panel), here, all);
        if (showMesh && figure.panel === 'family') {
          const button = document.createElement('button');
          button.textContent = '3-D';
          button.title = 'Show the mesh';
          button.addEventListener('click', () => showMesh(String(panel)));
          drawn.querySelector('figcaption')!.append(' ', button);
        }
        return drawn;
      }),
    );
  };
  redraw();
  onToggle(redraw);
  container.append(legend, grid);
  return container;
}

function drawPanel(
  experiment: Experiment,
  figure: LinesFigure,
  title: string,
  points: Point[],
  all: Point[],
): HTMLElement {
  const panel = document.createElement('figure');
  const heading = document.createElement('figcaption');
  const name = document.createElement('span');
  name.textContent = title;
  heading.append(name);
  const axis = (name: string, scale: 'log' | 'linear', values: number[]): Plot.ScaleOptions => ({
    type: scale,
    domain: extent(values),
    label: titleOf(experiment, name),
    nice: scale === 'linear',
    grid: true,
    ...(scale === 'log' ? { tickFormat: '~g', ticks: 5 } : {}),
  });
  const [low, high] = extent(all.map((point) => point.x));
  const top = extent(all.map((point) => point.y))[1];
  const references = figure.references.flatMap(({ label, slope }) =>
    [low, high].map((x) => ({ label, x, y: top * (x / high) ** slope })),
  );
  const order = [...points].sort((a, b) => a.x - b.x);
  const drawing = Plot.plot({
    width: 420,
    height: 300,
    marginLeft: 58,
    marginRight: 16,
    marginTop: 26,
    marginBottom: 40,
    inset: 8,
    style: { background: 'transparent', fontSize: '11px' },
    x: axis(figure.x, figure.x_scale, all.map((point) => point.x)),
    y: axis(figure.y, figure.y_scale, all.map((point) => point.y)),
    color: { domain: unique(points.map((p) => p.series)), range: unique(points.map((p) => p.series)).map(colorOf) },
    symbol: { domain: unique(points.map((p) => p.series)), range: unique(points.map((p) => p.series)).map(markerOf) },
    marks: [
      Plot.line(references, {
        x: 'x',
        y: 'y',
        z: 'label',
        stroke: 'currentColor',
        strokeOpacity: 0.5,
        strokeDasharray: '3 4',
        clip: true,
        className: 'references',
        title: 'label',
      }),
      Plot.line(order, { x: 'x', y: 'y', z: 'series', stroke: 'series', strokeWidth: 1.5, className: 'curves' }),
      Plot.dot(order, { x: 'x', y: 'y', fill: 'series', symbol: 'series', r: 3.5 }),
      Plot.tip(
        order,
        Plot.pointer({ x: 'x', y: 'y', title: (point: Point) => tipText(point, experiment) }),
      ),
    ],
  });
  drawing.setAttribute('role', 'img');
  drawing.setAttribute(
    'aria-label',
    `${figure.title}, ${title}: ${titleOf(experiment, figure.y)} over ${titleOf(experiment, figure.x)}`,
  );
  panel.append(heading, drawing);
  if (figure.slopes) {
    const slopes = document.createElement('p');
    slopes.className = 'slopes';
    slopes.append('slopes ');
    for (const name of unique(points.map((point) => point.series))) {
      const slope = slopeOf(points.filter((point) => point.series === name));
      if (slope === null) continue;
      const item = document.createElement('span');
      item.dataset['series'] = name;
      item.title = name;
      item.style.setProperty('--series', colorOf(name));
      item.textContent = slope.toFixed(2);
      slopes.append(item, ' ');
    }
    panel.append(slopes);
  }
  return panel;
}
