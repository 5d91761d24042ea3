import { colorMaps, colorTexture, mapNamed, type ColorMap } from './colormaps';
import {
  defaultRange,
  isSigned,
  loadChannel,
  outlierTail,
  quantileRange,
  symmetric,
  type Channel,
  type Range,
  type Scalars,
} from './fields';
import { drawHistogram } from './histogram';
import { Legend, legendState } from './legend';
import { digitsFor, format, parse } from './numbers';
import { byId } from './page';
import type { Shape } from './shape';

const sliderSteps = 1000;

/** Colour map, range and isolines of the shown scalar, and their controls. */
export class Coloring {
  readonly legend = new Legend();
  private shape: Shape | null = null;
  private scalars: Scalars | null = null;
  private range: Range = { low: 0, high: 1 };
  private map: ColorMap = colorMaps[0];
  private readonly controls = byId('colouring');
  private readonly mapSelect = byId<HTMLSelectElement>('map');
  private readonly lowSlider = byId<HTMLInputElement>('low-slider');
  private readonly highSlider = byId<HTMLInputElement>('high-slider');
  private readonly lowText = byId<HTMLInputElement>('low');
  private readonly highText = byId<HTMLInputElement>('high');
  private readonly isolines = byId<HTMLInputElement>('isolines');
  private readonly isolineCount = byId<HTMLInputElement>('isoline-count');

  /** \param changed  called when the picture has to be drawn again */
  constructor(private readonly changed: () => void) {
    this.mapSelect.replaceChildren(...colorMaps.map(({ title, name }) => new Option(title, name)));
    this.mapSelect.addEventListener('change', () => this.setMap(mapNamed(this.mapSelect.value)));
    this.lowSlider.addEventListener('input', () => this.slide('low'));
    this.highSlider.addEventListener('input', () => this.slide('high'));
    for (const input of [this.lowText, this.highText])
      input.addEventListener('change', () => this.readTexts());
    byId('full-range').addEventListener('click', () => this.useRange(this.fullRange()));
    byId('robust-range').addEventListener('click', () => this.useRange(this.robustRange()));
    this.isolines.addEventListener('change', () => this.apply());
    this.isolineCount.addEventListener('input', () => this.apply());
  }

  toggleIsolines(): void {
    this.isolines.checked = !this.isolines.checked;
    this.apply();
  }

  /** Colours `shape` by `channel`, or leaves it plain. */
  async show(shape: Shape, channel: Channel | null): Promise<void> {
    const scalars = channel ? await loadChannel(channel) : null;
    this.shape = shape;
    this.scalars = scalars;
    this.controls.hidden = scalars === null;
    shape.setScalars(scalars);
    if (scalars) {
      const range = defaultRange(scalars);
      const signed = isSigned(range);
      this.range = signed ? symmetric(range) : range;
      if (signed !== this.map.diverging) this.map = mapNamed(signed ? 'blue-red' : 'viridis');
      byId('isoline-controls').hidden = scalars.on !== 'vertex';
      this.isolines.checked = /dist|geodesic/i.test(scalars.label);
      this.setMap(this.map);
    } else {
      this.apply();
    }
  }

  /** Draws again what depends on the page's colours. */
  restyle(): void {
    this.apply();
  }

  private setMap(map: ColorMap): void {
    this.map = map;
    this.mapSelect.value = map.name;
    this.shape?.setColors(colorTexture(map));
    this.apply();
  }

  private fullRange(): Range {
    const { min = 0, max = 1 } = this.scalars ?? {};
    return { low: min, high: max };
  }

  private robustRange(): Range {
    return this.scalars ? quantileRange(this.scalars, outlierTail) : this.range;
  }

  private useRange(range: Range): void {
    this.range = this.map.diverging && isSigned(range) ? symmetric(range) : range;
    this.apply();
  }

  /** What the sliders span: the values, and the range where it is wider. */
  private domain(): Range {
    const full = this.fullRange();
    return {
      low: Math.min(full.low, this.range.low),
      high: Math.max(full.high, this.range.high),
    };
  }

  private slide(end: 'low' | 'high'): void {
    const domain = this.domain();
    const slider = end === 'low' ? this.lowSlider : this.highSlider;
    const value =
      domain.low + (Number(slider.value) / sliderSteps) * (domain.high - domain.low);
    const { low, high } = this.range;
    this.range =
      end === 'low' ? { low: Math.min(value, high), high } : { low, high: Math.max(value, low) };
    this.apply();
  }

  private readTexts(): void {
    const low = parse(this.lowText.value);
    const high = parse(this.highText.value);
    if (low <= high && Number.isFinite(low) && Number.isFinite(high)) this.range = { low, high };
    this.apply();
  }

  private apply(): void {
    if (!this.scalars || !this.shape) {
      this.legend.show(null);
    } else {
      const span = this.range.high - this.range.low;
      const step = span / Number(this.isolineCount.value);
      const drawn = this.isolines.checked && this.scalars.on === 'vertex' && step > 0;
      this.shape.setRange(this.range, drawn ? step : 0);
      byId('isoline-number').hidden = !drawn;
      byId('isoline-step').textContent = `every ${format(step, 3)}`;
      this.legend.show(legendState(this.scalars, this.map, this.range));
      this.showRange(this.scalars);
    }
    this.changed();
  }

  private showRange(scalars: Scalars): void {
    const { low, high } = this.range;
    const domain = this.domain();
    const span = domain.high - domain.low;
    const place = (value: number): number =>
      span > 0 ? Math.round(((value - domain.low) / span) * sliderSteps) : 0;
    this.lowSlider.value = String(place(low));
    this.highSlider.value = String(span > 0 ? place(high) : sliderSteps);
    const digits = digitsFor(Math.max(-domain.low, domain.high), span);
    this.lowText.value = format(low, digits);
    this.highText.value = format(high, digits);
    this.lowSlider.setAttribute('aria-valuetext', this.lowText.value);
    this.highSlider.setAttribute('aria-valuetext', this.highText.value);
    // Where both thumbs meet at the upper end, the lower one must be reachable.
    this.lowSlider.style.zIndex = place(low) > sliderSteps / 2 ? '2' : '1';
    drawHistogram(byId<HTMLCanvasElement>('histogram'), scalars, domain, this.range);
    byId('range-note').textContent = this.rangeNote(scalars);
  }

  private rangeNote(scalars: Scalars): string {
    const parts: string[] = [];
    const digits = digitsFor(Math.max(-scalars.min, scalars.max), scalars.max - scalars.min, 4);
    if (scalars.min < this.range.low || scalars.max > this.range.high)
      parts.push(
        `Values from ${format(scalars.min, digits)} to ${format(scalars.max, digits)}; ` +
          'those outside the range take the end colours.',
      );
    if (scalars.nMissing > 0)
      parts.push(`${scalars.nMissing} without a finite value: grey.`);
    return parts.join(' ');
  }
}
