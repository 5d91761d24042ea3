import type { Skin } from './skin';
import type { Volume } from './volume';

/** Sides of cells: 2 * face, + 1 where the face's normal points into the cell. */
export type Sides = Uint32Array<ArrayBuffer>;

/** Of cells that are moved apart, at most about this many corners are drawn. */
const maxApartCorners = 3e6;

/**
 * The sides where kept cells end.
 * \param kept    cell -> whether it is; null: all are
 * \param hidden  patch -> whether its faces are left out
 */
export function exposedSides(volume: Volume, kept: Uint8Array | null, hidden: boolean[]): Sides {
  const { faceCells, facePatches, nFaces } = volume;
  const has = (cell: number): boolean => cell >= 0 && (!kept || kept[cell] === 1);
  const shown = (f: number): boolean => facePatches[f] < 0 || !hidden[facePatches[f]];
  const list: number[] = [];
  if (kept) {
    for (let f = 0; f < nFaces; ++f) {
      const below = has(faceCells[2 * f]);
      if (below !== has(faceCells[2 * f + 1]) && shown(f)) list.push(2 * f + (below ? 0 : 1));
    }
  } else {
    for (const f of volume.boundary.faces)
      if (shown(f)) list.push(2 * f + (faceCells[2 * f] >= 0 ? 0 : 1));
  }
  return Uint32Array.from(list);
}

/** All sides of kept cells; of many cells those nearest to where kept cells end. */
export function allSides(
  volume: Volume,
  kept: Uint8Array | null,
  hidden: boolean[],
): { sides: Sides; complete: boolean } {
  const { cellOffsets, cellSides, faceOffsets, faceCells, facePatches, nCells } = volume;
  const taken = new Uint8Array(nCells);
  const queue = new Uint32Array(nCells);
  let nQueued = 0;
  const take = (cell: number): void => {
    if (cell < 0 || taken[cell] || (kept && !kept[cell])) return;
    taken[cell] = 1;
    queue[nQueued++] = cell;
  };
  for (const side of exposedSides(volume, kept, [])) take(faceCells[side]);
  const sides = new Uint32Array(cellSides.length);
  let nSides = 0;
  let nCorners = 0;
  let done = 0;
  for (; done < nQueued && nCorners < maxApartCorners; ++done)
    for (let i = cellOffsets[queue[done]]; i < cellOffsets[queue[done] + 1]; ++i) {
      const f = cellSides[i] >>> 1;
      take(faceCells[cellSides[i] ^ 1]);
      if (facePatches[f] >= 0 && hidden[facePatches[f]]) continue;
      sides[nSides++] = cellSides[i];
      nCorners += faceOffsets[f + 1] - faceOffsets[f];
    }
  return { sides: sides.slice(0, nSides), complete: done === nQueued };
}

/** First triangle of a face. */
function firstTriangleOf(volume: Volume, f: number): number {
  return volume.faceOffsets[f] - 2 * f;
}

/** The polygons of sides. \param flat  whether the boundary is shaded face by face as well. */
export function skinOfSides(volume: Volume, sides: Sides, flat: boolean): Skin {
  const { faceOffsets, faceVertices, faceNormals, positions, faceCells, boundary } = volume;
  const offsets = new Uint32Array(sides.length + 1);
  for (let p = 0; p < sides.length; ++p) {
    const f = sides[p] >>> 1;
    offsets[p + 1] = offsets[p] + faceOffsets[f + 1] - faceOffsets[f];
  }
  const n = offsets[sides.length];
  const cells = new Uint32Array(sides.length);
  const faces = new Int32Array(sides.length);
  const from = new Uint32Array(n);
  const corners = new Float32Array(3 * n);
  const normals = new Int16Array(4 * n);
  const triangles = new Uint32Array(3 * (n - 2 * sides.length));
  const lines = new Uint32Array(2 * n);
  let nTriangleCorners = 0;
  let nLineEnds = 0;
  for (let p = 0; p < sides.length; ++p) {
    const f = sides[p] >>> 1;
    const begin = faceOffsets[f];
    const shift = offsets[p] - begin;
    cells[p] = faceCells[sides[p]];
    faces[p] = f;
    const smooth = flat ? -1 : boundary.cornerOfFace[f];
    const normalSource = smooth < 0 ? faceNormals : boundary.normals;
    for (let c = begin; c < faceOffsets[f + 1]; ++c) {
      const at = c + shift;
      const v = faceVertices[c];
      from[at] = v;
      const normalRow = 3 * (smooth < 0 ? f : smooth + c - begin);
      for (let k = 0; k < 3; ++k) {
        corners[3 * at + k] = positions[3 * v + k];
        normals[4 * at + k] = 32767 * normalSource[normalRow + k];
      }
      const next = c + 1 === faceOffsets[f + 1] ? begin : c + 1;
      // Where cells end, every edge is passed once in either direction: one of them is drawn.
      if (v < faceVertices[next] === (sides[p] & 1) > 0) continue;
      lines[nLineEnds++] = at;
      lines[nLineEnds++] = next + shift;
    }
    const end = 3 * firstTriangleOf(volume, f + 1);
    for (let i = 3 * firstTriangleOf(volume, f); i < end; ++i)
      triangles[nTriangleCorners++] = volume.triangleCorners[i] + shift;
  }
  return {
    offsets,
    cells,
    faces,
    positions: corners,
    from,
    to: from,
    fraction: null,
    normals,
    triangles,
    lines: lines.slice(0, nLineEnds),
  };
}
