import { byId } from './page';
import type { View } from './view';

export interface Actions {
  fit: () => void;
  toggleEdges: () => void;
  toggleIsolines: () => void;
  stepField: (by: number) => void;
  stepMesh: (by: number) => void;
  picture: () => void;
  toggleTheme: () => void;
  togglePanel: () => void;
  clearPick: () => void;
  clip: ClipActions;
}

/** What only volumes have. */
export interface ClipActions {
  stepMode: () => void;
  setAxis: (axis: 'x' | 'y' | 'z') => void;
  /** By hundredths of the mesh. */
  move: (by: number) => void;
  flip: () => void;
  play: () => void;
  stepShrink: (by: number) => void;
  stepExplode: (by: number) => void;
}

const list: [string, string][] = [
  ['Drag, one finger, arrow keys', 'Turn'],
  ['Right drag, two fingers, Shift + arrow keys', 'Move'],
  ['Wheel, pinch, + and −', 'Zoom'],
  ['Click or tap', 'Read the nearest vertex; in volumes also the cell'],
  ['0', 'Reset the view'],
  ['[ and ]', 'Previous and next field'],
  ['Page up, page down', 'Previous and next mesh'],
  ['E', 'Polygon edges'],
  ['I', 'Isolines'],
  ['C', 'Volumes: clip by a cut, by whole cells, not'],
  ['X, Y, Z', 'Clip across that axis'],
  [', and .', 'Move the clip plane'],
  ['F, A', 'Flip the clip plane, let it move'],
  ['J and K', 'Shrink the cells less and more'],
  ['N and M', 'Explode the cells less and more'],
  ['P', 'Save a picture'],
  ['T', 'Light or dark'],
  ['S', 'Settings'],
  ['Esc', 'Close what is open'],
];

export function fillHelp(): void {
  byId('keys-list').replaceChildren(
    ...list.map(([keys, meaning]) => {
      const row = document.createElement('tr');
      const head = document.createElement('th');
      head.scope = 'row';
      head.textContent = keys;
      const cell = document.createElement('td');
      cell.textContent = meaning;
      row.append(head, cell);
      return row;
    }),
  );
}

export function openHelp(): void {
  byId<HTMLDialogElement>('keys').showModal();
}

const angle = Math.PI / 24;
const move = 0.06;

/** Keys that steer the camera: [right, up]. */
const arrows: Record<string, [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

function ownsKeys(target: EventTarget | null): boolean {
  return (
    target instanceof HTMLElement &&
    (target.closest('input, select, textarea, dialog') !== null || target.isContentEditable)
  );
}

export function listenToKeys(view: View, actions: Actions): void {
  const { clip } = actions;
  const plain: Record<string, () => void> = {
    '+': () => view.zoom(1.15),
    '=': () => view.zoom(1.15),
    '-': () => view.zoom(1 / 1.15),
    '0': actions.fit,
    Home: actions.fit,
    '[': () => actions.stepField(-1),
    ']': () => actions.stepField(1),
    PageUp: () => actions.stepMesh(-1),
    PageDown: () => actions.stepMesh(1),
    e: actions.toggleEdges,
    i: actions.toggleIsolines,
    c: clip.stepMode,
    x: () => clip.setAxis('x'),
    y: () => clip.setAxis('y'),
    z: () => clip.setAxis('z'),
    ',': () => clip.move(-1),
    '.': () => clip.move(1),
    f: clip.flip,
    a: clip.play,
    j: () => clip.stepShrink(-1),
    k: () => clip.stepShrink(1),
    n: () => clip.stepExplode(-1),
    m: () => clip.stepExplode(1),
    p: actions.picture,
    t: actions.toggleTheme,
    s: actions.togglePanel,
    '?': openHelp,
    Escape: actions.clearPick,
  };
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || ownsKeys(event.target)) return;
    const arrow = arrows[event.key];
    const action = plain[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (arrow && event.shiftKey) view.shift(-move * arrow[0], -move * arrow[1]);
    else if (arrow) view.turn(angle * arrow[0], angle * arrow[1]);
    else if (action) action();
    else return;
    event.preventDefault();
  });
}
