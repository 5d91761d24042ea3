import type { Vector3 } from 'three';

/** Where a ray met a triangle: origin + distance * ray, at barycentric (1 - u - v, u, v). */
export interface Hit {
  triangle: number;
  distance: number;
  u: number;
  v: number;
}

/**
 * The first triangle along the ray; one pass over the typed arrays.
 * \param accept  whether a hit counts
 */
export function firstTriangle(
  p: Float32Array,
  triangles: Uint32Array,
  origin: Vector3,
  ray: Vector3,
  accept?: (hit: Hit) => boolean,
): Hit | null {
  let nearest: Hit | null = null;
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
    if (!(distance > 0) || (nearest && distance >= nearest.distance)) continue;
    const hit = { triangle: i / 3, distance, u, v };
    if (!accept || accept(hit)) nearest = hit;
  }
  return nearest;
}
