import { readFloats } from './blocks';
import type { FieldInfo, Place } from './page';

/** A scalar to colour by: a field, one of its components, or its length. */
export interface Channel {
  label: string;
  field: FieldInfo;
  component: number | 'length';
}

/** The numbers of a channel, as stored; not finite where there is no value. */
export interface Scalars {
  label: string;
  on: Place;
  values: Float32Array<ArrayBuffer>;
  offset: number;
  scale: number;
  /** Finite values, ascending, thinned out to some ten thousands. */
  sorted: Float32Array<ArrayBuffer>;
  /** Of all finite values, in the field's unit. */
  min: number;
  max: number;
  nMissing: number;
}

const cache = new Map<number, Promise<Float32Array<ArrayBuffer>>>();

/** The numbers of a field as stored, decoded on first use. */
export function loadField(field: FieldInfo): Promise<Float32Array<ArrayBuffer>> {
  let values = cache.get(field.block);
  if (!values) cache.set(field.block, (values = readFloats(field.block)));
  return values;
}

export function channelsOf(fields: FieldInfo[]): Channel[] {
  return fields.flatMap((field): Channel[] => {
    if (field.components === 1) return [{ label: field.name, field, component: 0 }];
    const component = (k: number): Channel => ({
      label: `${field.name} ${field.components === 3 ? 'xyz'[k] : `[${k}]`}`,
      field,
      component: k,
    });
    const components = Array.from({ length: field.components }, (_, k) => component(k));
    if (field.components !== 3) return components;
    return [{ label: `|${field.name}|`, field, component: 'length' }, ...components];
  });
}

export async function loadChannel(channel: Channel): Promise<Scalars> {
  const { field, component } = channel;
  const all = await loadField(field);
  const k = field.components;
  let values = all;
  if (component === 'length') {
    values = new Float32Array(all.length / 3);
    for (let i = 0; i < values.length; ++i)
      values[i] = Math.hypot(all[3 * i], all[3 * i + 1], all[3 * i + 2]);
  } else if (k > 1) {
    values = new Float32Array(all.length / k);
    for (let i = 0; i < values.length; ++i) values[i] = all[k * i + component];
  }
  return { label: channel.label, on: field.on, values, ...summary(field, values) };
}

function summary(
  field: FieldInfo,
  values: Float32Array,
): Pick<Scalars, 'offset' | 'scale' | 'sorted' | 'min' | 'max' | 'nMissing'> {
  const stride = Math.max(1, Math.floor(values.length / 50000));
  const sample = new Float32Array(Math.ceil(values.length / stride));
  let nSampled = 0;
  let nMissing = 0;
  let min = Infinity;
  let max = -Infinity;
  for (let i = 0; i < values.length; ++i) {
    const value = values[i];
    if (!Number.isFinite(value)) {
      ++nMissing;
      continue;
    }
    if (value < min) min = value;
    if (value > max) max = value;
    if (i % stride === 0) sample[nSampled++] = value;
  }
  if (min > max) min = max = 0;
  const { offset, scale } = field;
  return {
    offset,
    scale,
    sorted: sample.slice(0, nSampled).sort(),
    min: offset + scale * min,
    max: offset + scale * max,
    nMissing,
  };
}

export interface Range {
  low: number;
  high: number;
}

/** From the `tail` quantile to the `1 - tail` quantile. */
export function quantileRange(scalars: Scalars, tail: number): Range {
  const { sorted, offset, scale } = scalars;
  if (sorted.length === 0) return { low: scalars.min, high: scalars.max };
  const at = (q: number): number => offset + scale * sorted[Math.round(q * (sorted.length - 1))];
  return { low: at(tail), high: at(1 - tail) };
}

/** Whether both signs matter, so that 0 belongs in the middle of the colours. */
export function isSigned({ low, high }: Range): boolean {
  return low < 0 && high > 0 && Math.min(-low, high) > 0.05 * Math.max(-low, high);
}

export function symmetric({ low, high }: Range): Range {
  const bound = Math.max(-low, high);
  return { low: -bound, high: bound };
}

export const outlierTail = 0.005;

/** The whole range, or that without outliers where these would take most of the colours. */
export function defaultRange(scalars: Scalars): Range {
  const full = { low: scalars.min, high: scalars.max };
  const robust = quantileRange(scalars, outlierTail);
  const heavyTailed = robust.high - robust.low < 0.5 * (full.high - full.low);
  return heavyTailed && robust.high > robust.low ? robust : full;
}
