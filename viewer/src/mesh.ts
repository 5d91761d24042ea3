import { breathe, readBytes, readFloats, readIntegers } from './blocks';
import { polygonNormals } from './normals';
import type { SurfaceInfo } from './page';
import type { Box } from './shape';

/** One surface mesh of the page, in typed arrays; positions lie in a ball of radius 1 about 0. */
export interface Mesh {
  info: SurfaceInfo;
  nFaces: number;
  positions: Float32Array<ArrayBuffer>;
  /** Face -> its first corner. */
  faceOffsets: Uint32Array<ArrayBuffer>;
  /** Corner -> vertex. */
  faceVertices: Uint32Array<ArrayBuffer>;
  /** Three corners of the polygons a triangle, and the vertices there. */
  triangleCorners: Uint32Array<ArrayBuffer>;
  triangles: Uint32Array<ArrayBuffer>;
  triangleFaces: Uint32Array<ArrayBuffer>;
  /** Two vertices an edge. */
  edges: Uint32Array<ArrayBuffer>;
  /** Unit normals of faces and vertices; 0 where there is none. */
  faceNormals: Float32Array<ArrayBuffer>;
  vertexNormals: Float32Array<ArrayBuffer>;
  /** Of the vertices that have a face. */
  box: Box;
  meanEdge: number;
}

export function offsetsOf(sizes: Uint32Array): Uint32Array<ArrayBuffer> {
  const offsets = new Uint32Array(sizes.length + 1);
  for (let f = 0; f < sizes.length; ++f) offsets[f + 1] = offsets[f] + sizes[f];
  return offsets;
}

function edgesOf(
  bits: Uint8Array,
  nEdges: number,
  offsets: Uint32Array,
  vertices: Uint32Array,
): Uint32Array<ArrayBuffer> {
  const edges = new Uint32Array(2 * nEdges);
  let at = 0;
  for (let f = 0; f + 1 < offsets.length; ++f)
    for (let c = offsets[f]; c < offsets[f + 1]; ++c)
      if ((bits[c >> 3] >> (c & 7)) & 1) {
        edges[at++] = vertices[c];
        edges[at++] = vertices[c + 1 === offsets[f + 1] ? offsets[f] : c + 1];
      }
  return edges;
}

export function boxOf(positions: Float32Array, vertices: Uint32Array): Box {
  const box: Box = { min: [0, 0, 0], max: [0, 0, 0] };
  for (let k = 0; k < 3; ++k) {
    let low = Infinity;
    let high = -Infinity;
    for (let c = 0; c < vertices.length; ++c) {
      const x = positions[3 * vertices[c] + k];
      if (x < low) low = x;
      if (x > high) high = x;
    }
    if (low <= high) {
      box.min[k] = low;
      box.max[k] = high;
    }
  }
  return box;
}

export function meanEdgeLength(positions: Float32Array, edges: Uint32Array): number {
  let sum = 0;
  for (let i = 0; i < edges.length; i += 2) {
    const a = 3 * edges[i];
    const b = 3 * edges[i + 1];
    sum += Math.hypot(
      positions[a] - positions[b],
      positions[a + 1] - positions[b + 1],
      positions[a + 2] - positions[b + 2],
    );
  }
  return edges.length > 0 ? (2 * sum) / edges.length : 0;
}

/** \param progress called with the fraction done */
export async function loadMesh(
  info: SurfaceInfo,
  progress: (fraction: number) => void,
): Promise<Mesh> {
  const step = async (fraction: number): Promise<void> => {
    progress(fraction);
    await breathe();
  };
  await step(0);
  const positions = await readFloats(info.positions);
  await step(0.2);
  const faceOffsets = offsetsOf(await readIntegers(info.faceSizes));
  await step(0.3);
  const faceVertices = await readIntegers(info.faceVertices);
  await step(0.5);
  const triangleCorners = await readIntegers(info.triangleCorners);
  const triangles = triangleCorners.map((corner) => faceVertices[corner]);
  await step(0.7);
  const triangleFaces = await readIntegers(info.triangleFaces);
  await step(0.8);
  const edges = edgesOf(await readBytes(info.edgeBits), info.edges, faceOffsets, faceVertices);
  const [faceNormals, vertexNormals] = polygonNormals(positions, faceOffsets, faceVertices);
  return {
    info,
    nFaces: faceOffsets.length - 1,
    positions,
    faceOffsets,
    faceVertices,
    triangleCorners,
    triangles,
    triangleFaces,
    edges,
    faceNormals,
    vertexNormals,
    box: boxOf(positions, faceVertices),
    meanEdge: meanEdgeLength(positions, edges),
  };
}

/** Writes the mean of a face's vertices to `out`. */
export function faceCentre(mesh: Mesh, f: number, out: [number, number, number]): void {
  out[0] = out[1] = out[2] = 0;
  const begin = mesh.faceOffsets[f];
  const end = mesh.faceOffsets[f + 1];
  for (let c = begin; c < end; ++c)
    for (let k = 0; k < 3; ++k)
      out[k] += mesh.positions[3 * mesh.faceVertices[c] + k] / (end - begin);
}
