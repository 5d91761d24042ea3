/** Polygons with their normals. */
interface Polygons {
  nFaces: number;
  positions: Float32Array;
  faceOffsets: Uint32Array;
  faceVertices: Uint32Array;
  faceNormals: Float32Array;
  vertexNormals: Float32Array;
}

function normalise(vectors: Float32Array): void {
  for (let i = 0; i < vectors.length; i += 3) {
    const length = Math.hypot(vectors[i], vectors[i + 1], vectors[i + 2]);
    if (length > 0) for (let k = 0; k < 3; ++k) vectors[i + k] /= length;
  }
}

/** Vector areas of the polygons, and their sums about the vertices, made unit vectors. */
export function polygonNormals(
  positions: Float32Array,
  offsets: Uint32Array,
  vertices: Uint32Array,
): [Float32Array<ArrayBuffer>, Float32Array<ArrayBuffer>] {
  const nFaces = offsets.length - 1;
  const faces = new Float32Array(3 * nFaces);
  const atVertices = new Float32Array(positions.length);
  for (let f = 0; f < nFaces; ++f) {
    const o = 3 * vertices[offsets[f]];
    let x = 0;
    let y = 0;
    let z = 0;
    for (let c = offsets[f] + 1; c + 1 < offsets[f + 1]; ++c) {
      const a = 3 * vertices[c];
      const b = 3 * vertices[c + 1];
      const ax = positions[a] - positions[o];
      const ay = positions[a + 1] - positions[o + 1];
      const az = positions[a + 2] - positions[o + 2];
      const bx = positions[b] - positions[o];
      const by = positions[b + 1] - positions[o + 1];
      const bz = positions[b + 2] - positions[o + 2];
      x += ay * bz - az * by;
      y += az * bx - ax * bz;
      z += ax * by - ay * bx;
    }
    faces[3 * f] = x;
    faces[3 * f + 1] = y;
    faces[3 * f + 2] = z;
    for (let c = offsets[f]; c < offsets[f + 1]; ++c) {
      const v = 3 * vertices[c];
      atVertices[v] += x;
      atVertices[v + 1] += y;
      atVertices[v + 2] += z;
    }
  }
  normalise(faces);
  normalise(atVertices);
  return [faces, atVertices];
}

/** Faces that meet at a larger angle (40 degrees) are shaded apart. */
const creaseCosine = 0.766;

/** Beyond this valence all faces at a vertex are taken together: every pair is compared below it. */
const maxCreasedValence = 64;

/** Vertex -> its corners, by counting. */
function cornersOfVertices(mesh: Polygons): { offsets: Uint32Array; corners: Uint32Array } {
  const { faceVertices } = mesh;
  const offsets = new Uint32Array(mesh.positions.length / 3 + 1);
  for (let c = 0; c < faceVertices.length; ++c) ++offsets[faceVertices[c] + 1];
  for (let v = 0; v + 1 < offsets.length; ++v) offsets[v + 1] += offsets[v];
  const next = offsets.slice();
  const corners = new Uint32Array(faceVertices.length);
  for (let c = 0; c < faceVertices.length; ++c) corners[next[faceVertices[c]]++] = c;
  return { offsets, corners };
}

function facesOfCorners(mesh: Polygons): Uint32Array {
  const faces = new Uint32Array(mesh.faceVertices.length);
  for (let f = 0; f < mesh.nFaces; ++f)
    faces.fill(f, mesh.faceOffsets[f], mesh.faceOffsets[f + 1]);
  return faces;
}

/** A normal a corner: the mean over the faces at its vertex that turn little from its own. */
export function creasedNormals(mesh: Polygons): Float32Array {
  const { faceNormals: n, vertexNormals, faceVertices } = mesh;
  const { offsets, corners } = cornersOfVertices(mesh);
  const faces = facesOfCorners(mesh);
  const result = new Float32Array(3 * faceVertices.length);
  for (let c = 0; c < faceVertices.length; ++c) {
    const v = faceVertices[c];
    if (offsets[v + 1] - offsets[v] > maxCreasedValence) {
      for (let k = 0; k < 3; ++k) result[3 * c + k] = vertexNormals[3 * v + k];
      continue;
    }
    const f = 3 * faces[c];
    for (let i = offsets[v]; i < offsets[v + 1]; ++i) {
      const g = 3 * faces[corners[i]];
      const cosine = n[f] * n[g] + n[f + 1] * n[g + 1] + n[f + 2] * n[g + 2];
      // Neighbours that are turned against this face count with their other side.
      const weight = Math.abs(cosine) > creaseCosine ? Math.sign(cosine) : 0;
      for (let k = 0; k < 3; ++k) result[3 * c + k] += weight * n[g + k];
    }
  }
  normalise(result);
  return result;
}
