// The report as `carat reproduce` writes it.

export type Cell = number | string | null;

export interface Column {
  name: string;
  title: string;
  unit: string;
  kind: 'number' | 'integer' | 'text';
}

interface FigureBase {
  id: string;
  title: string;
  caption: string;
  filter: Record<string, Cell> | null;
}
export interface LinesFigure extends FigureBase {
  kind: 'lines';
  panel: string | null;
  series: string[];
  x: string;
  y: string;
  x_scale: 'log' | 'linear';
  y_scale: 'log' | 'linear';
  slopes: boolean;
  references: { label: string; slope: number }[];
}
export interface MatrixFigure extends FigureBase {
  kind: 'matrix';
  row: string[];
  column: string[];
  value: string;
}
export interface TableFigure extends FigureBase {
  kind: 'table';
  columns: string[];
}
export interface PictureFigure extends FigureBase {
  kind: 'picture';
  /** A data address. */
  image: string;
}
export type Figure = LinesFigure | MatrixFigure | TableFigure | PictureFigure;

export interface Experiment {
  name: string;
  title: string;
  paper: string | null;
  text: string;
  command: string;
  seconds: number;
  columns: Column[];
  rows: Cell[][];
  figures: Figure[];
  /** Its meshes: elements for the viewer's page. */
  view?: string;
}

export interface Report {
  carat: string;
  machine: { cpu: string | null; cores: number; memory_bytes: number | null; system: string | null };
  seconds: number;
  options: { levels: number | null; quick: boolean; threads: number };
  experiments: Experiment[];
  /** The page of `carat view`, without data. */
  viewer: string;
}

export type Row = Record<string, Cell>;

/** The rows of an experiment that a figure shows. */
export function rowsOf(experiment: Experiment, figure: Figure): Row[] {
  const names = experiment.columns.map((column) => column.name);
  const rows = experiment.rows.map((cells): Row =>
    Object.fromEntries(names.map((name, k) => [name, cells[k] ?? null])),
  );
  const wanted = Object.entries(figure.filter ?? {});
  return rows.filter((row) => wanted.every(([name, value]) => row[name] === value));
}

export function titleOf(experiment: Experiment, name: string): string {
  const column = experiment.columns.find((candidate) => candidate.name === name);
  if (!column) return name;
  return column.unit ? `${column.title} (${column.unit})` : column.title;
}

/** The values of several columns in words. */
export function words(row: Row, names: string[]): string {
  return names
    .map((name) => row[name])
    .filter((value) => value !== null && value !== '')
    .join(', ');
}

export function unique<T>(values: T[]): T[] {
  return [...new Set(values)];
}

export function numberText(value: Cell): string {
  if (value === null) return '–';
  if (typeof value === 'string') return value;
  if (Number.isInteger(value)) return value.toLocaleString('en').replaceAll(',', '\u2009');
  const size = Math.abs(value);
  return size >= 0.01 && size < 1e4 ? String(Number(value.toPrecision(3))) : value.toExponential(2);
}

export function toCsv(experiment: Experiment): string {
  const quoted = (cell: Cell): string =>
    typeof cell === 'string' && cell.includes(',') ? `"${cell}"` : String(cell ?? '');
  const lines = [experiment.columns.map((column) => column.name), ...experiment.rows];
  return lines.map((line) => line.map(quoted).join(',')).join('\n') + '\n';
}
