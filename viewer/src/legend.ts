import { colorTable, type ColorMap } from './colormaps';
import type { Range, Scalars } from './fields';
import { digitsFor, format, ticks } from './numbers';
import { byId } from './page';

/** What the colour bar says, for the page and for pictures of it. */
export interface LegendState {
  name: string;
  map: ColorMap;
  range: Range;
  /** Significant ones that the range needs. */
  digits: number;
  ticks: { at: number; text: string }[];
  /** Values lie below or above the range. */
  below: boolean;
  above: boolean;
  hasMissing: boolean;
}

export function legendState(scalars: Scalars, map: ColorMap, range: Range): LegendState {
  const span = range.high - range.low;
  const at = (value: number): number => (span > 0 ? (value - range.low) / span : 0.5);
  const digits = digitsFor(Math.max(-range.low, range.high), span, 5);
  return {
    name: scalars.label,
    map,
    range,
    digits,
    ticks: ticks(range.low, range.high, 5).map((value) => ({
      at: at(value),
      text: format(value, digits),
    })),
    below: scalars.min < range.low,
    above: scalars.max > range.high,
    hasMissing: scalars.nMissing > 0,
  };
}

/** The bar in a rectangle; an end is pointed where values lie beyond it. */
export function drawBar(
  context: CanvasRenderingContext2D,
  legend: LegendState,
  x: number,
  y: number,
  width: number,
  height: number,
): void {
  const table = colorTable(legend.map);
  const gradient = context.createLinearGradient(x, 0, x + width, 0);
  for (let i = 0; i < 256; ++i)
    gradient.addColorStop(
      i / 255,
      `rgb(${table[4 * i]},${table[4 * i + 1]},${table[4 * i + 2]})`,
    );
  context.fillStyle = gradient;
  const tip = height * 0.8;
  const middle = y + height / 2;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + width, y);
  if (legend.above) context.lineTo(x + width + tip, middle);
  context.lineTo(x + width, y + height);
  context.lineTo(x, y + height);
  if (legend.below) context.lineTo(x - tip, middle);
  context.fill();
}

/** Room beside the bar for its pointed ends, in CSS pixels; as in style.css. */
const inset = 14;

/** The colour bar of the page. */
export class Legend {
  private readonly figure = byId('legend');
  private readonly bar = byId<HTMLCanvasElement>('legend-bar');
  private state: LegendState | null = null;

  constructor() {
    new ResizeObserver(() => this.drawBar()).observe(this.bar);
  }

  get current(): LegendState | null {
    return this.state;
  }

  show(state: LegendState | null): void {
    this.state = state;
    this.figure.hidden = state === null;
    if (!state) return;
    const missing = document.createElement('span');
    missing.className = 'missing';
    missing.textContent = 'no value';
    byId('legend-name').replaceChildren(state.name, ...(state.hasMissing ? [missing] : []));
    this.bar.setAttribute(
      'aria-label',
      `Colours from ${format(state.range.low, state.digits)} to ` +
        `${format(state.range.high, state.digits)}, ${state.map.title}`,
    );
    byId('legend-ticks').replaceChildren(
      ...state.ticks.map(({ at, text }) => {
        const tick = document.createElement('span');
        tick.textContent = text;
        tick.style.left = `${100 * at}%`;
        return tick;
      }),
    );
    this.drawBar();
  }

  private drawBar(): void {
    const context = this.bar.getContext('2d');
    if (!this.state || !context) return;
    const ratio = window.devicePixelRatio;
    this.bar.width = Math.round(this.bar.clientWidth * ratio);
    this.bar.height = Math.round(14 * ratio);
    const x = inset * ratio;
    drawBar(context, this.state, x, 0, this.bar.width - 2 * x, this.bar.height);
  }
}
