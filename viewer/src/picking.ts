import type { Vector3 } from 'three';
import type { Mesh } from './mesh';

export interface Pick {
  vertex: number;
  /** The face that was hit; -1 if the vertex was named by its number. */
  face: number;
}

/** The first triangle along the ray, and its distance; one pass over the typed arrays. */
function firstTriangle(mesh: Mesh, origin: Vector3, ray: Vector3): [number, number] {
  const { positions: p, triangles } = mesh;
  let nearest = Infinity;
  let hit = -1;
  for (let i = 0; i < triangles.length; i += 3) {
    const a = 3 * triangles[i];
    const b = 3 * triangles[i + 1];
    const c = 3 * triangles[i + 2];
    const e1x = p[b] - p[a];
    const e1y = p[b + 1] - p[a + 1];
    const e1z = p[b + 2] - p[a + 2];
    const e2x = p[c] - p[a];
    const e2y = p[c + 1] - p[a + 1];
    const e2z = p[c + 2] - p[a + 2];
    const px = ray.y * e2z - ray.z * e2y;
    const py = ray.z * e2x - ray.x * e2z;
    const pz = ray.x * e2y - ray.y * e2x;
    const determinant = e1x * px + e1y * py + e1z * pz;
    if (determinant === 0) continue;
    const tx = origin.x - p[a];
    const ty = origin.y - p[a + 1];
    const tz = origin.z - p[a + 2];
    const u = (tx * px + ty * py + tz * pz) / determinant;
    if (u < 0 || u > 1) continue;
    const qx = ty * e1z - tz * e1y;
    const qy = tz * e1x - tx * e1z;
    const qz = tx * e1y - ty * e1x;
    const v = (ray.x * qx + ray.y * qy + ray.z * qz) / determinant;
    if (v < 0 || u + v > 1) continue;
    const distance = (e2x * qx + e2y * qy + e2z * qz) / determinant;
    if (distance > 0 && distance < nearest) {
      nearest = distance;
      hit = i / 3;
    }
  }
  return [hit, nearest];
}

/** The face under the ray and the vertex of it that is nearest to the hit. */
export function pickAlong(mesh: Mesh, origin: Vector3, ray: Vector3): Pick | null {
  const [triangle, distance] = firstTriangle(mesh, origin, ray);
  if (triangle < 0) return null;
  const face = mesh.triangleFaces[triangle];
  const at = ray.clone().multiplyScalar(distance).add(origin);
  let vertex = -1;
  let nearest = Infinity;
  for (let c = mesh.faceOffsets[face]; c < mesh.faceOffsets[face + 1]; ++c) {
    const v = mesh.faceVertices[c];
    const away = Math.hypot(
      mesh.positions[3 * v] - at.x,
      mesh.positions[3 * v + 1] - at.y,
      mesh.positions[3 * v + 2] - at.z,
    );
    if (away < nearest) {
      nearest = away;
      vertex = v;
    }
  }
  return { vertex, face };
}
