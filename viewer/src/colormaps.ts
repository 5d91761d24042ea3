import {
  interpolateCividis,
  interpolateGreys,
  interpolateMagma,
  interpolateRdBu,
  interpolateViridis,
} from 'd3-scale-chromatic';
import { DataTexture, LinearFilter, RGBAFormat } from 'three';

export interface ColorMap {
  name: string;
  title: string;
  diverging: boolean;
  at: (t: number) => string;
}

export const colorMaps: ColorMap[] = [
  { name: 'viridis', title: 'Viridis', diverging: false, at: interpolateViridis },
  { name: 'cividis', title: 'Cividis (colour-blind safe)', diverging: false, at: interpolateCividis },
  { name: 'magma', title: 'Magma', diverging: false, at: interpolateMagma },
  { name: 'grey', title: 'Grey', diverging: false, at: (t) => interpolateGreys(0.95 - 0.85 * t) },
  {
    name: 'blue-red',
    title: 'Blue – white – red (signed)',
    diverging: true,
    at: (t) => interpolateRdBu(0.95 - 0.9 * t),
  },
];

/** RGB bytes of "#rrggbb" or "rgb(r, g, b)". */
function bytesOf(color: string): [number, number, number] {
  if (color.startsWith('#')) {
    const bits = parseInt(color.slice(1), 16);
    return [bits >> 16, (bits >> 8) & 255, bits & 255];
  }
  const [r, g, b] = (color.match(/[\d.]+/g) ?? []).map(Number);
  return [r, g, b];
}

const nSteps = 256;

/** 256 colours in a row, four bytes each. */
export function colorTable(map: ColorMap): Uint8ClampedArray<ArrayBuffer> {
  const table = new Uint8ClampedArray(4 * nSteps);
  for (let i = 0; i < nSteps; ++i) table.set([...bytesOf(map.at(i / (nSteps - 1))), 255], 4 * i);
  return table;
}

export function colorTexture(map: ColorMap): DataTexture {
  const texture = new DataTexture(new Uint8Array(colorTable(map)), nSteps, 1, RGBAFormat);
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

export function mapNamed(name: string): ColorMap {
  return colorMaps.find((map) => map.name === name) ?? colorMaps[0];
}
