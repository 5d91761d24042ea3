/** A number for reading: `digits` significant ones, "1.5e-7" where that is shorter. */
export function format(value: number, digits = 6): string {
  if (Number.isNaN(value)) return 'NaN';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const text =
    size >= 1e-4 && size < 10 ** Math.max(7, digits)
      ? String(Number(value.toPrecision(digits)))
      : Number(value.toPrecision(digits)).toExponential();
  return text.replace(/-/g, '−').replace('e+', 'e');
}

/** Significant digits that tell values apart which lie within `span` of each other. */
export function digitsFor(largest: number, span: number, resolved = 6): number {
  const lost = span > 0 ? Math.ceil(Math.log10(Math.abs(largest) / span)) : 0;
  return Math.min(15, Math.max(0, lost) + resolved);
}

/** What `format` wrote, or what a person typed; NaN if it is no number. */
export function parse(text: string): number {
  const plain = text.trim().replace(/−/g, '-').replace(',', '.');
  return plain === '' ? NaN : Number(plain);
}

export function count(n: number): string {
  return n.toLocaleString('en');
}

/** Round numbers inside [low, high], about `n` of them. */
function roundTicks(low: number, high: number, n: number): number[] {
  const span = high - low;
  if (!Number.isFinite(span)) return [];
  const power = 10 ** Math.floor(Math.log10(span / n));
  const step = power * ([1, 2, 2.5, 5, 10].find((m) => span / (m * power) <= n) ?? 10);
  const result: number[] = [];
  for (let i = Math.ceil(low / step - 1e-6); i <= high / step + 1e-6; ++i) {
    const tick = i * step;
    result.push(Number(tick.toPrecision(12)));
    if (result.length > 4 * n) break;
  }
  return result;
}

/** Both ends, and about `n` round numbers between them that leave room for their labels. */
export function ticks(low: number, high: number, n: number): number[] {
  const room = (high - low) / 8;
  if (!(room > 0)) return [low];
  const inner = roundTicks(low, high, n).filter((t) => t - low > room && high - t > room);
  return [low, ...inner, high];
}
