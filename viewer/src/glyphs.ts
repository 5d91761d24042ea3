import {
  Color,
  ConeGeometry,
  CylinderGeometry,
  GLSL3,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh as ThreeMesh,
  ShaderMaterial,
  Vector4,
  type BufferGeometry,
} from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

const maxGlyphs = 2500;

const vertexShader = /* glsl */ `
  uniform float size;
  uniform vec4 plane;
  in vec3 origin;
  in vec3 direction;
  out vec3 n;
  void main() {
    float strength = length(direction);
    vec3 z = direction / strength;
    vec3 x = normalize(cross(z, abs(z.x) < 0.8 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
    mat3 frame = mat3(x, cross(z, x), z);
    n = normalMatrix * (frame * normal);
    vec4 at = modelViewMatrix * vec4(origin + size * strength * (frame * position), 1.0);
    // Tangent arrows lie in the surface: moved towards the eye they look the same, in front of it.
    at.xyz *= 1.0 - 0.12 * size / length(at.xyz);
    gl_Position = projectionMatrix * at;
    // Arrows at a cut are seen in front of it.
    if (dot(origin, plane.xyz) > plane.w + 0.4 * size) gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  }
`;

const fragmentShader = /* glsl */ `
  uniform vec3 color;
  in vec3 n;
  out vec4 pixel;
  void main() {
    float light = 0.6 + 0.4 * max(dot(normalize(n), normalize(vec3(-0.35, 0.55, 0.75))), 0.0);
    pixel = vec4(color * light, 1.0);
  }
`;

/** From the origin to (0, 0, 1). */
function arrowGeometry(): BufferGeometry {
  const shaft = new CylinderGeometry(0.035, 0.035, 0.7, 6).translate(0, 0.35, 0);
  const head = new ConeGeometry(0.11, 0.32, 10).translate(0, 0.84, 0);
  const arrow = mergeGeometries([shaft, head]).rotateX(Math.PI / 2);
  arrow.deleteAttribute('uv');
  return arrow;
}

/** The arrows of a vector field, thinned out evenly in space. */
export class Glyphs {
  readonly object: ThreeMesh<InstancedBufferGeometry, ShaderMaterial>;
  readonly nShown: number;
  readonly nAll: number;
  private readonly uniforms = {
    size: { value: 1 },
    color: { value: new Color() },
    plane: { value: new Vector4(0, 0, 0, 1) },
  };
  private readonly spacing: number;

  /**
   * \param origins  where the arrows start
   * \param values   the field's numbers as stored; three a row, both
   */
  constructor(origins: Float32Array, values: Float32Array) {
    const chosen = chooseEvenly(origins, values);
    this.nShown = chosen.rows.length;
    this.nAll = values.length / 3;
    this.spacing = chosen.spacing;
    const longest = highLength(values, chosen.rows);
    const geometry = new InstancedBufferGeometry();
    const arrow = arrowGeometry();
    geometry.setIndex(arrow.index);
    for (const name of ['position', 'normal']) geometry.setAttribute(name, arrow.getAttribute(name));
    const gather = (from: Float32Array, factor: number): InstancedBufferAttribute => {
      const rows = new Float32Array(3 * chosen.rows.length);
      for (let i = 0; i < chosen.rows.length; ++i)
        for (let k = 0; k < 3; ++k) rows[3 * i + k] = factor * from[3 * chosen.rows[i] + k];
      return new InstancedBufferAttribute(rows, 3);
    };
    geometry.setAttribute('origin', gather(origins, 1));
    geometry.setAttribute('direction', gather(values, longest > 0 ? 1 / longest : 1));
    geometry.instanceCount = chosen.rows.length;
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      uniforms: this.uniforms,
    });
    this.object = new ThreeMesh(geometry, material);
    this.object.frustumCulled = false;
    this.setLength(1);
  }

  /** \param factor  1: a strong arrow reaches to its neighbour */
  setLength(factor: number): void {
    this.uniforms.size.value = 1.3 * this.spacing * factor;
  }

  /** Arrows that start beyond the plane are not drawn; null: all are. */
  setPlane(plane: Vector4 | null): void {
    if (plane) this.uniforms.plane.value.copy(plane);
    else this.uniforms.plane.value.set(0, 0, 0, 1);
  }

  setColor(color: string): void {
    this.uniforms.color.value.setStyle(color, '');
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

function isArrow(values: Float32Array, row: number): boolean {
  const length = Math.hypot(values[3 * row], values[3 * row + 1], values[3 * row + 2]);
  return length > 0 && Number.isFinite(length);
}

/** Rows that keep a distance of each other: the smallest distance that leaves few enough. */
function chooseEvenly(
  origins: Float32Array,
  values: Float32Array,
): { rows: Uint32Array; spacing: number } {
  for (let n = 128; ; n = Math.floor(0.8 * n)) {
    const rows = chooseApart(origins, values, n);
    if (rows.length <= maxGlyphs || n < 4) return { rows, spacing: spacing(rows.length, n) };
  }
}

/**
 * Rows at least 1 / n of the ball's diameter apart, in order; gives up beyond maxGlyphs. A grid of
 * n cells a side holds one row a cell, so that only the 27 cells about a row are looked at.
 */
function chooseApart(origins: Float32Array, values: Float32Array, n: number): Uint32Array {
  const side = n + 2;
  const rowInCell = new Int32Array(side * side * side).fill(-1);
  const rows = new Uint32Array(maxGlyphs + 1);
  const apart = 2 / n;
  let nRows = 0;
  const place = (x: number): number => 1 + Math.min(n - 1, Math.floor(((x + 1) / 2) * n));
  const isFree = (cell: number, o: number): boolean => {
    for (let dx = -side * side; dx <= side * side; dx += side * side)
      for (let dy = -side; dy <= side; dy += side)
        for (let dz = -1; dz <= 1; ++dz) {
          const other = 3 * rowInCell[cell + dx + dy + dz];
          if (other < 0) continue;
          const x = origins[other] - origins[o];
          const y = origins[other + 1] - origins[o + 1];
          const z = origins[other + 2] - origins[o + 2];
          if (x * x + y * y + z * z < apart * apart) return false;
        }
    return true;
  };
  for (let row = 0; row < origins.length / 3 && nRows <= maxGlyphs; ++row) {
    const o = 3 * row;
    const cell =
      (place(origins[o]) * side + place(origins[o + 1])) * side + place(origins[o + 2]);
    if (rowInCell[cell] >= 0 || !isArrow(values, row) || !isFree(cell, o)) continue;
    rowInCell[cell] = row;
    rows[nRows++] = row;
  }
  return rows.slice(0, nRows);
}

/** On a coarse mesh the grid is finer than the mesh, so count the arrows as well. */
function spacing(nArrows: number, nCells: number): number {
  return Math.min(0.3, Math.max(2 / nCells, 1.6 / Math.sqrt(Math.max(nArrows, 1))));
}

/** The length that 95 % of the arrows do not exceed. */
function highLength(values: Float32Array, rows: Uint32Array): number {
  const lengths = new Float32Array(rows.length);
  for (let i = 0; i < rows.length; ++i) {
    const o = 3 * rows[i];
    lengths[i] = Math.hypot(values[o], values[o + 1], values[o + 2]);
  }
  lengths.sort();
  return lengths[Math.floor(0.95 * (lengths.length - 1))] ?? 0;
}
