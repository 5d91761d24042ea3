import { breathe, readFloats, readIntegers } from './blocks';
import { boxOf, offsetsOf } from './mesh';
import { creasedNormals, polygonNormals } from './normals';
import type { VolumeInfo } from './page';
import type { Extent } from './shape';

/** One volume mesh of the page, in typed arrays; positions lie in a ball of radius 1 about 0. */
export interface Volume {
  info: VolumeInfo;
  nFaces: number;
  nCells: number;
  positions: Float32Array<ArrayBuffer>;
  /** Face -> its first corner. */
  faceOffsets: Uint32Array<ArrayBuffer>;
  /** Corner -> vertex. */
  faceVertices: Uint32Array<ArrayBuffer>;
  /** Three corners a triangle; a face of n corners has n - 2 of them, in order of the faces. */
  triangleCorners: Uint32Array<ArrayBuffer>;
  /** Unit normals; 0 where there is none. */
  faceNormals: Float32Array<ArrayBuffer>;
  /** Cell -> its first side. */
  cellOffsets: Uint32Array<ArrayBuffer>;
  /** 2 * face, + 1 where the face's normal points into the cell. */
  cellSides: Uint32Array<ArrayBuffer>;
  /** Two a face, -1 where there is none: the cell that its normal points out of, and the other. */
  faceCells: Int32Array<ArrayBuffer>;
  cellCentres: Float32Array<ArrayBuffer>;
  /** Face -> its patch, -1 where it has none. */
  facePatches: Int32Array<ArrayBuffer>;
  boundary: Boundary;
  meanEdge: number;
}

/** The faces of exactly one cell. */
export interface Boundary extends Extent {
  faces: Uint32Array<ArrayBuffer>;
  faceOffsets: Uint32Array<ArrayBuffer>;
  faceVertices: Uint32Array<ArrayBuffer>;
  /** A normal a corner, shaded together across gentle turns. */
  normals: Float32Array;
  /** Face of the volume -> its first corner here, -1 for inner faces. */
  cornerOfFace: Int32Array<ArrayBuffer>;
}

function cellsOfFaces(
  nFaces: number,
  cellOffsets: Uint32Array,
  cellSides: Uint32Array,
): Int32Array<ArrayBuffer> {
  const faceCells = new Int32Array(2 * nFaces).fill(-1);
  for (let cell = 0; cell + 1 < cellOffsets.length; ++cell)
    for (let i = cellOffsets[cell]; i < cellOffsets[cell + 1]; ++i) faceCells[cellSides[i]] = cell;
  return faceCells;
}

/** Unit normals, and the mean points and areas that cell centres are made of. */
function measureFaces(
  positions: Float32Array,
  offsets: Uint32Array,
  vertices: Uint32Array,
): { normals: Float32Array<ArrayBuffer>; means: Float32Array; areas: Float32Array } {
  const nFaces = offsets.length - 1;
  const normals = new Float32Array(3 * nFaces);
  const means = new Float32Array(3 * nFaces);
  const areas = new Float32Array(nFaces);
  for (let f = 0; f < nFaces; ++f) {
    const begin = offsets[f];
    const end = offsets[f + 1];
    const o = 3 * vertices[begin];
    const [ox, oy, oz] = [positions[o], positions[o + 1], positions[o + 2]];
    let nx = 0;
    let ny = 0;
    let nz = 0;
    let mx = 0;
    let my = 0;
    let mz = 0;
    let ax = 0;
    let ay = 0;
    let az = 0;
    for (let c = begin + 1; c < end; ++c) {
      const v = 3 * vertices[c];
      const bx = positions[v] - ox;
      const by = positions[v + 1] - oy;
      const bz = positions[v + 2] - oz;
      nx += ay * bz - az * by;
      ny += az * bx - ax * bz;
      nz += ax * by - ay * bx;
      mx += bx;
      my += by;
      mz += bz;
      ax = bx;
      ay = by;
      az = bz;
    }
    const length = Math.sqrt(nx * nx + ny * ny + nz * nz);
    const scale = length > 0 ? 1 / length : 0;
    const n = end - begin;
    areas[f] = length / 2;
    normals[3 * f] = nx * scale;
    normals[3 * f + 1] = ny * scale;
    normals[3 * f + 2] = nz * scale;
    means[3 * f] = ox + mx / n;
    means[3 * f + 1] = oy + my / n;
    means[3 * f + 2] = oz + mz / n;
  }
  return { normals, means, areas };
}

/** Means of the faces' points by their areas: inside every convex cell. */
function centresOfCells(
  cellOffsets: Uint32Array,
  cellSides: Uint32Array,
  means: Float32Array,
  areas: Float32Array,
): Float32Array<ArrayBuffer> {
  const nCells = cellOffsets.length - 1;
  const centres = new Float32Array(3 * nCells);
  for (let cell = 0; cell < nCells; ++cell) {
    const sum = [0, 0, 0];
    let total = 0;
    for (let i = cellOffsets[cell]; i < cellOffsets[cell + 1]; ++i) {
      const f = cellSides[i] >>> 1;
      const weight = areas[f] + 1e-30;
      total += weight;
      for (let k = 0; k < 3; ++k) sum[k] += weight * means[3 * f + k];
    }
    for (let k = 0; k < 3; ++k) centres[3 * cell + k] = sum[k] / total;
  }
  return centres;
}

function boundaryOf(
  positions: Float32Array,
  offsets: Uint32Array,
  vertices: Uint32Array,
  faceCells: Int32Array,
): Boundary {
  const nFaces = offsets.length - 1;
  const list: number[] = [];
  for (let f = 0; f < nFaces; ++f)
    if (faceCells[2 * f] < 0 !== faceCells[2 * f + 1] < 0) list.push(f);
  const faces = Uint32Array.from(list);
  const faceOffsets = offsetsOf(faces.map((f) => offsets[f + 1] - offsets[f]));
  const faceVertices = new Uint32Array(faceOffsets[faces.length]);
  const cornerOfFace = new Int32Array(nFaces).fill(-1);
  for (let i = 0; i < faces.length; ++i) {
    const f = faces[i];
    cornerOfFace[f] = faceOffsets[i];
    faceVertices.set(vertices.subarray(offsets[f], offsets[f + 1]), faceOffsets[i]);
  }
  const [faceNormals, vertexNormals] = polygonNormals(positions, faceOffsets, faceVertices);
  const normals = creasedNormals({
    nFaces: faces.length,
    positions,
    faceOffsets,
    faceVertices,
    faceNormals,
    vertexNormals,
  });
  const box = boxOf(positions, faceVertices);
  return { positions, box, faces, faceOffsets, faceVertices, normals, cornerOfFace };
}

function meanSide(
  positions: Float32Array,
  offsets: Uint32Array,
  vertices: Uint32Array,
): number {
  let sum = 0;
  for (let f = 0; f + 1 < offsets.length; ++f) {
    let a = 3 * vertices[offsets[f + 1] - 1];
    for (let c = offsets[f]; c < offsets[f + 1]; ++c) {
      const b = 3 * vertices[c];
      const x = positions[a] - positions[b];
      const y = positions[a + 1] - positions[b + 1];
      const z = positions[a + 2] - positions[b + 2];
      sum += Math.sqrt(x * x + y * y + z * z);
      a = b;
    }
  }
  return vertices.length > 0 ? sum / vertices.length : 0;
}

async function readPatches(info: VolumeInfo, nFaces: number): Promise<Int32Array<ArrayBuffer>> {
  const patches = new Int32Array(nFaces).fill(-1);
  for (const [i, { faces }] of info.patches.entries())
    for (const f of await readIntegers(faces)) patches[f] = i;
  return patches;
}

/** \param progress called with the fraction done */
export async function loadVolume(
  info: VolumeInfo,
  progress: (fraction: number) => void,
): Promise<Volume> {
  const step = async (fraction: number): Promise<void> => {
    progress(fraction);
    await breathe();
  };
  await step(0);
  const positions = await readFloats(info.positions);
  await step(0.1);
  const faceOffsets = offsetsOf(await readIntegers(info.faceSizes));
  await step(0.15);
  const faceVertices = await readIntegers(info.faceVertices);
  await step(0.35);
  const triangleCorners = await readIntegers(info.triangleCorners);
  await step(0.55);
  const cellOffsets = offsetsOf(await readIntegers(info.cellSizes));
  const cellSides = await readIntegers(info.cellSides);
  await step(0.65);
  const nFaces = faceOffsets.length - 1;
  const faceCells = cellsOfFaces(nFaces, cellOffsets, cellSides);
  const facePatches = await readPatches(info, nFaces);
  await step(0.7);
  const { normals, means, areas } = measureFaces(positions, faceOffsets, faceVertices);
  await step(0.85);
  const boundary = boundaryOf(positions, faceOffsets, faceVertices, faceCells);
  return {
    info,
    nFaces,
    nCells: cellOffsets.length - 1,
    positions,
    faceOffsets,
    faceVertices,
    triangleCorners,
    faceNormals: normals,
    cellOffsets,
    cellSides,
    faceCells,
    cellCentres: centresOfCells(cellOffsets, cellSides, means, areas),
    facePatches,
    boundary,
    meanEdge: meanSide(positions, boundary.faceOffsets, boundary.faceVertices),
  };
}
