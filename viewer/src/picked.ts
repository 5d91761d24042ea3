import { loadField } from './fields';
import type { Mesh } from './mesh';
import { count, digitsFor, format } from './numbers';
import { byId, type FieldInfo } from './page';
import type { Pick } from './picking';

/** Position of a vertex in the mesh's own unit. */
export function positionOf(mesh: Mesh, vertex: number): number[] {
  return mesh.info.centre.map((x, k) => x + mesh.info.scale * mesh.positions[3 * vertex + k]);
}

async function valueText(field: FieldInfo, row: number): Promise<string> {
  const values = await loadField(field);
  const begin = row * field.components;
  const digits = digitsFor(field.offset, field.offset === 0 ? 0 : 1e-3 * Math.abs(field.offset), 7);
  return Array.from(values.subarray(begin, begin + field.components), (stored) =>
    format(field.offset + field.scale * stored, digits),
  ).join(', ');
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

function heading(text: string): HTMLHeadingElement {
  const element = document.createElement('h2');
  element.textContent = text;
  return element;
}

async function table(
  fields: FieldInfo[],
  element: number,
  first: HTMLTableRowElement[],
): Promise<HTMLTableElement> {
  const result = document.createElement('table');
  result.append(...first);
  for (const field of fields) result.append(row(field.name, await valueText(field, element)));
  return result;
}

/** Shows number, position and all values of what was picked; `close` for its button. */
export async function showPicked(mesh: Mesh, pick: Pick, close: () => void): Promise<void> {
  const button = document.createElement('button');
  button.className = 'icon close';
  button.title = 'Close (Esc)';
  button.setAttribute('aria-label', 'Close');
  button.textContent = '×';
  button.addEventListener('click', close);
  const { fields } = mesh.info;
  const position = positionOf(mesh, pick.vertex);
  const parts: HTMLElement[] = [
    button,
    heading(`Vertex ${count(pick.vertex)}`),
    await table(
      fields.filter((field) => field.on === 'vertex'),
      pick.vertex,
      position.map((x, k) => row('xyz'[k], format(x, digitsFor(x, mesh.info.scale)))),
    ),
  ];
  if (pick.face >= 0) {
    const size = mesh.faceOffsets[pick.face + 1] - mesh.faceOffsets[pick.face];
    parts.push(
      heading(`Face ${count(pick.face)}`),
      await table(
        fields.filter((field) => field.on === 'face'),
        pick.face,
        [row('vertices', String(size))],
      ),
    );
  }
  const card = byId('picked');
  card.dataset['vertex'] = String(pick.vertex);
  card.dataset['face'] = String(pick.face);
  card.replaceChildren(...parts);
  card.hidden = false;
}

export function hidePicked(): void {
  const card = byId('picked');
  card.hidden = true;
  delete card.dataset['vertex'];
}
