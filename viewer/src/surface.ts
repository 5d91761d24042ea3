import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GLSL3,
  Mesh as ThreeMesh,
  ShaderMaterial,
  Texture,
} from 'three';
import type { Range, Scalars } from './fields';
import type { Mesh } from './mesh';
import { creasedNormals } from './normals';

/** Stands for "no value"; stored values stay far below. */
const missing = 1e35;

/** Up to here every triangle gets corners of its own, so that creases stay sharp. */
const maxSharpTriangles = 400000;

const vertexShader = /* glsl */ `
  in float value;
  out vec3 eye;
  out vec3 smoothNormal;
  out float v;
  void main() {
    vec4 at = modelViewMatrix * vec4(position, 1.0);
    eye = at.xyz;
    smoothNormal = normalMatrix * normal;
    v = value;
    gl_Position = projectionMatrix * at;
  }
`;

const fragmentShader = /* glsl */ `
  uniform bool colored;
  uniform vec3 plain;
  uniform vec3 noValue;
  uniform sampler2D colors;
  uniform float low;
  uniform float span;
  uniform float isolineStep;
  in vec3 eye;
  in vec3 smoothNormal;
  in float v;
  out vec4 pixel;

  // Width-constant lines at low + k * isolineStep; they fade where they lie closer than pixels.
  float isoline() {
    float level = (v - low) / isolineStep;
    float perPixel = fwidth(level);
    if (!(perPixel > 0.0)) return 0.0;
    float distance = abs(fract(level + 0.5) - 0.5) / perPixel;
    return (1.0 - smoothstep(0.45, 1.35, distance)) * (1.0 - smoothstep(0.15, 0.4, perPixel));
  }

  void main() {
    vec3 facet = normalize(cross(dFdx(eye), dFdy(eye)));
    if (dot(facet, eye) > 0.0) facet = -facet;
    vec3 n = dot(smoothNormal, smoothNormal) > 0.01 ? normalize(smoothNormal) : facet;
    if (dot(n, facet) < 0.0) n = -n;

    vec3 base = plain;
    if (colored) {
      float line = isolineStep > 0.0 ? isoline() : 0.0;
      if (v > 1e31) {
        base = noValue;
      } else {
        float t = span > 0.0 ? clamp((v - low) / span, 0.0, 1.0) : 0.5;
        base = texture(colors, vec2((t * 255.0 + 0.5) / 256.0, 0.5)).rgb;
        float luminance = dot(base, vec3(0.299, 0.587, 0.114));
        vec3 ink = luminance < 0.3 ? vec3(1.0) : vec3(0.0);
        base = mix(base, ink, 0.7 * line);
      }
    }

    vec3 toEye = normalize(-eye);
    vec3 key = normalize(vec3(-0.35, 0.55, 0.75));
    float light = 0.34 + 0.52 * max(dot(n, key), 0.0) + 0.26 * max(dot(n, toEye), 0.0);
    float gloss = 0.05 * pow(max(dot(n, normalize(key + toEye)), 0.0), 40.0);
    vec3 lit = pow(base, vec3(2.2)) * light + gloss;
    pixel = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
  }
`;

/** The faces of a mesh: smoothly coloured by a vertex field, flat by a face field, or plain. */
export class Surface {
  readonly object: ThreeMesh<BufferGeometry, ShaderMaterial>;
  private readonly uniforms = {
    colored: { value: false },
    plain: { value: new Color() },
    noValue: { value: new Color() },
    colors: { value: null as Texture | null },
    low: { value: 0 },
    span: { value: 1 },
    isolineStep: { value: 0 },
  };
  private scalars: Scalars | null = null;
  private flat = false;
  private layout = '';

  constructor(private readonly mesh: Mesh) {
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      uniforms: this.uniforms,
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    this.object = new ThreeMesh(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.update();
  }

  setScalars(scalars: Scalars | null): void {
    this.scalars = scalars;
    this.uniforms.colored.value = scalars !== null;
    this.update();
  }

  setFlat(flat: boolean): void {
    this.flat = flat;
    this.update();
  }

  setColors(colors: Texture): void {
    this.uniforms.colors.value?.dispose();
    this.uniforms.colors.value = colors;
  }

  /** \param isolineStep  0: none; both in the field's unit */
  setRange(range: Range, isolineStep: number): void {
    if (!this.scalars) return;
    const { offset, scale } = this.scalars;
    this.uniforms.low.value = (range.low - offset) / scale;
    this.uniforms.span.value = (range.high - range.low) / scale;
    this.uniforms.isolineStep.value = isolineStep / scale;
  }

  setPlainColors(plain: string, noValue: string): void {
    this.uniforms.plain.value.setStyle(plain, '');
    this.uniforms.noValue.value.setStyle(noValue, '');
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
    this.uniforms.colors.value?.dispose();
  }

  private update(): void {
    const own =
      this.flat ||
      this.scalars?.on === 'face' ||
      this.mesh.triangles.length <= 3 * maxSharpTriangles;
    const layout = own ? (this.flat ? 'flat' : 'creased') : 'shared';
    if (layout !== this.layout) {
      this.layout = layout;
      this.object.geometry.dispose();
      this.object.geometry = own ? cornerGeometry(this.mesh, this.flat) : sharedGeometry(this.mesh);
    }
    const values = valuesFor(this.mesh, this.scalars, own);
    this.object.geometry.setAttribute('value', new BufferAttribute(values, 1));
  }
}

/** Vertices shared by their triangles: the smallest, for large meshes. */
function sharedGeometry(mesh: Mesh): BufferGeometry {
  const geometry = new BufferGeometry();
  const normals = new Int16Array((mesh.positions.length / 3) * 4);
  for (let v = 0; v < mesh.positions.length / 3; ++v)
    for (let k = 0; k < 3; ++k) normals[4 * v + k] = 32767 * mesh.vertexNormals[3 * v + k];
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 4, true));
  geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
  return geometry;
}

/** Every triangle with corners of its own, so that normals and values may jump between faces. */
function cornerGeometry(mesh: Mesh, flat: boolean): BufferGeometry {
  const n = mesh.triangles.length;
  const positions = new Float32Array(3 * n);
  const normals = new Int16Array(4 * n);
  const source = flat ? mesh.faceNormals : creasedNormals(mesh);
  for (let i = 0; i < n; ++i) {
    const v = 3 * mesh.triangles[i];
    const row = 3 * (flat ? mesh.triangleFaces[(i / 3) | 0] : mesh.triangleCorners[i]);
    for (let k = 0; k < 3; ++k) {
      positions[3 * i + k] = mesh.positions[v + k];
      normals[4 * i + k] = 32767 * source[row + k];
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new BufferAttribute(normals, 4, true));
  return geometry;
}

function valuesFor(
  mesh: Mesh,
  scalars: Scalars | null,
  ownCorners: boolean,
): Float32Array<ArrayBuffer> {
  const n = ownCorners ? mesh.triangles.length : mesh.positions.length / 3;
  const values = new Float32Array(n);
  if (!scalars) return values;
  const onFaces = scalars.on === 'face';
  for (let i = 0; i < n; ++i) {
    const row = !ownCorners ? i : onFaces ? mesh.triangleFaces[(i / 3) | 0] : mesh.triangles[i];
    const value = scalars.values[row];
    values[i] = Number.isFinite(value) ? value : missing;
  }
  return values;
}
