import { loadField } from './fields';
import { count, digitsFor, format } from './numbers';
import { byId, type FieldInfo, type ItemInfo, type Place } from './page';
import type { Pick } from './shape';

/** One heading with its rows, and the fields that are read there. */
export interface PickedPart {
  title: string;
  rows: [string, string][];
  on: Place;
  /** Row of the fields and its weight. */
  weights: [number, number][];
}

/** Position of a stored point in the mesh's own unit, as rows. */
export function positionRows(info: ItemInfo, stored: ArrayLike<number>): [string, string][] {
  return info.centre.map((centre, k) => {
    const x = centre + info.scale * stored[k];
    return ['xyz'[k], format(x, digitsFor(x, info.scale))];
  });
}

export function vertexPart(info: ItemInfo, positions: Float32Array, vertex: number): PickedPart {
  return {
    title: `Vertex ${count(vertex)}`,
    rows: positionRows(info, positions.subarray(3 * vertex, 3 * vertex + 3)),
    on: 'vertex',
    weights: [[vertex, 1]],
  };
}

export function facePart(face: number, nVertices: number): PickedPart {
  return {
    title: `Face ${count(face)}`,
    rows: [['vertices', String(nVertices)]],
    on: 'face',
    weights: [[face, 1]],
  };
}

async function valueText(field: FieldInfo, weights: [number, number][]): Promise<string> {
  const values = await loadField(field);
  const digits = digitsFor(field.offset, field.offset === 0 ? 0 : 1e-3 * Math.abs(field.offset), 7);
  return Array.from({ length: field.components }, (_, k) => {
    const stored = weights.reduce(
      (sum, [row, weight]) => sum + weight * values[row * field.components + k],
      0,
    );
    return format(field.offset + field.scale * stored, digits);
  }).join(', ');
}

function row(name: string, value: string): HTMLTableRowElement {
  const line = document.createElement('tr');
  const head = document.createElement('th');
  head.scope = 'row';
  head.textContent = name;
  const cell = document.createElement('td');
  cell.textContent = value;
  line.append(head, cell);
  return line;
}

async function elementsOf(part: PickedPart, fields: FieldInfo[]): Promise<HTMLElement[]> {
  const heading = document.createElement('h2');
  heading.textContent = part.title;
  const table = document.createElement('table');
  table.append(...part.rows.map(([name, value]) => row(name, value)));
  for (const field of fields)
    if (field.on === part.on) table.append(row(field.name, await valueText(field, part.weights)));
  return [heading, table];
}

/** Shows number, position and all values of what was picked; `close` for its button. */
export async function showPicked(info: ItemInfo, pick: Pick, close: () => void): Promise<void> {
  const button = document.createElement('button');
  button.className = 'icon close';
  button.title = 'Close (Esc)';
  button.setAttribute('aria-label', 'Close');
  button.textContent = '×';
  button.addEventListener('click', close);
  const parts: HTMLElement[] = [button];
  for (const part of pick.parts) parts.push(...(await elementsOf(part, info.fields)));
  const card = byId('picked');
  for (const name of ['vertex', 'face', 'cell'] as const)
    card.dataset[name] = String(pick[name]);
  card.replaceChildren(...parts);
  card.hidden = false;
}

export function hidePicked(): void {
  const card = byId('picked');
  card.hidden = true;
  for (const name of ['vertex', 'face', 'cell']) delete card.dataset[name];
}
