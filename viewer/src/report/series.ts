// Names of curves: one colour and one marker each, the same all over the page, and whether they
// are shown.

// Okabe and Ito's colours, which people with other colour vision can tell apart.
const COLORS = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7f7f7f'];
const MARKERS = ['circle', 'square', 'triangle', 'diamond', 'star', 'wye', 'cross'] as const;

const places = new Map<string, number>();
const hidden = new Set<string>();
const listeners = new Set<() => void>();

function placeOf(series: string): number {
  if (!places.has(series)) places.set(series, places.size);
  return places.get(series)!;
}

export function colorOf(series: string): string {
  return COLORS[placeOf(series) % COLORS.length];
}

/** Series of the same colour have different markers. */
export function markerOf(series: string): (typeof MARKERS)[number] {
  const place = placeOf(series);
  return MARKERS[(place + Math.floor(place / COLORS.length)) % MARKERS.length];
}

export function isShown(series: string): boolean {
  return !hidden.has(series);
}

export function toggle(series: string): void {
  if (!hidden.delete(series)) hidden.add(series);
  for (const listener of listeners) listener();
}

export function onToggle(listener: () => void): void {
  listeners.add(listener);
}
