import { BufferAttribute, BufferGeometry, type Vector3 } from 'three';
import type { Scalars } from './fields';
import { firstTriangle, type Hit } from './ray';
import { shaderValue } from './shading';

/** Polygons of cells as they are drawn, each with corners of its own. */
export interface Skin {
  /** Polygon -> its first corner. */
  offsets: Uint32Array<ArrayBuffer>;
  /** Polygon -> its cell, and its face; -1 on a cut. */
  cells: Uint32Array<ArrayBuffer>;
  faces: Int32Array<ArrayBuffer>;
  /** Three a corner, where the cells are in their places. */
  positions: Float32Array<ArrayBuffer>;
  /** A corner lies between two vertices, at this fraction of the way; null: at the first. */
  from: Uint32Array<ArrayBuffer>;
  to: Uint32Array<ArrayBuffer>;
  fraction: Float32Array<ArrayBuffer> | null;
  /** Four a corner; null: those of the triangles. */
  normals: Int16Array<ArrayBuffer> | null;
  /** Three corners a triangle, two a line. */
  triangles: Uint32Array<ArrayBuffer>;
  lines: Uint32Array<ArrayBuffer>;
}

/** How cells are moved apart. */
export interface Apart {
  size: number;
  explode: number;
}

/** \param centres  cell -> its centre, where cells are to be moved apart */
export function skinGeometry(skin: Skin, centres: Float32Array | null): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(skin.positions, 3));
  if (skin.normals) geometry.setAttribute('normal', new BufferAttribute(skin.normals, 4, true));
  if (centres)
    geometry.setAttribute('centre', new BufferAttribute(cornerCentres(skin, centres), 3));
  geometry.setIndex(new BufferAttribute(skin.triangles, 1));
  return geometry;
}

function cornerCentres(skin: Skin, centres: Float32Array): Float32Array<ArrayBuffer> {
  const result = new Float32Array(skin.positions.length);
  for (let p = 0; p < skin.cells.length; ++p) {
    const o = 3 * skin.cells[p];
    for (let i = 3 * skin.offsets[p]; i < 3 * skin.offsets[p + 1]; i += 3) {
      result[i] = centres[o];
      result[i + 1] = centres[o + 1];
      result[i + 2] = centres[o + 2];
    }
  }
  return result;
}

/** A value a corner for the shader. */
export function skinValues(skin: Skin, scalars: Scalars | null): Float32Array<ArrayBuffer> {
  const values = new Float32Array(skin.from.length);
  if (!scalars) return values;
  const stored = scalars.values;
  if (scalars.on === 'cell') {
    for (let p = 0; p < skin.cells.length; ++p)
      values.fill(shaderValue(stored[skin.cells[p]]), skin.offsets[p], skin.offsets[p + 1]);
    return values;
  }
  for (let c = 0; c < values.length; ++c) {
    const a = stored[skin.from[c]];
    const t = skin.fraction ? skin.fraction[c] : 0;
    values[c] = shaderValue(t === 0 ? a : a + t * (stored[skin.to[c]] - a));
  }
  return values;
}

/** Where a ray met a skin. */
export interface SkinHit {
  polygon: number;
  distance: number;
  /** Where the cells are in their places. */
  rest: [number, number, number];
  /** Vertices and what they weigh there. */
  weights: [number, number][];
}

/** The polygon that holds a corner. */
function polygonOf(skin: Skin, corner: number): number {
  let low = 0;
  let high = skin.cells.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (skin.offsets[middle] <= corner) low = middle;
    else high = middle;
  }
  return low;
}

/** \param visible  whether a point, where the cells are in their places, is drawn */
export function pickSkin(
  skin: Skin,
  drawn: Float32Array,
  origin: Vector3,
  ray: Vector3,
  visible: (rest: [number, number, number]) => boolean,
): SkinHit | null {
  const corners = (hit: Hit): [number, number][] => {
    const [a, b, c] = skin.triangles.subarray(3 * hit.triangle, 3 * hit.triangle + 3);
    return [
      [a, 1 - hit.u - hit.v],
      [b, hit.u],
      [c, hit.v],
    ];
  };
  const restOf = (hit: Hit): [number, number, number] => {
    const rest: [number, number, number] = [0, 0, 0];
    for (const [corner, weight] of corners(hit))
      for (let k = 0; k < 3; ++k) rest[k] += weight * skin.positions[3 * corner + k];
    return rest;
  };
  const hit = firstTriangle(drawn, skin.triangles, origin, ray, (at) => visible(restOf(at)));
  if (!hit) return null;
  const weights = corners(hit).flatMap(([corner, weight]): [number, number][] => {
    const t = skin.fraction ? skin.fraction[corner] : 0;
    return [
      [skin.from[corner], weight * (1 - t)],
      [skin.to[corner], weight * t],
    ];
  });
  return {
    polygon: polygonOf(skin, skin.triangles[3 * hit.triangle]),
    distance: hit.distance,
    rest: restOf(hit),
    weights: weights.filter(([, weight]) => weight !== 0),
  };
}

/** A point of a cell where it is drawn; \param at  where it is in its place. */
export function placed(
  at: ArrayLike<number>,
  centre: ArrayLike<number>,
  { size, explode }: Apart,
): [number, number, number] {
  const k = (i: number): number =>
    centre[i] + size * (at[i] - centre[i]) + explode * centre[i];
  return [k(0), k(1), k(2)];
}

/** All corners of a skin where they are drawn. */
export function placedCorners(skin: Skin, centres: Float32Array, apart: Apart): Float32Array {
  if (apart.size === 1 && apart.explode === 0) return skin.positions;
  const result = cornerCentres(skin, centres);
  for (let i = 0; i < result.length; ++i)
    result[i] += apart.size * (skin.positions[i] - result[i]) + apart.explode * result[i];
  return result;
}
