import {
  Color,
  DoubleSide,
  GLSL3,
  ShaderMaterial,
  Texture,
  Vector4,
  type BufferGeometry,
  type IUniform,
} from 'three';
import type { Range, Scalars } from './fields';

/** Stands for "no value"; stored values stay far below. */
const missing = 1e35;

/** How single cells are moved apart, and where they are clipped; for all that is drawn of them. */
export interface CellUniforms {
  /** Size of a cell about its centre; 1: as it is. */
  size: IUniform<number>;
  /** A cell moves by this times its centre. */
  explode: IUniform<number>;
  /** Nothing is drawn where dot(rest, plane.xyz) > plane.w. */
  plane: IUniform<Vector4>;
}

/** GLSL of both stages where positions are those of cells. */
export const cellShader = {
  vertex: /* glsl */ `
    in vec3 centre;
    uniform float size;
    uniform float explode;
    out vec3 rest;
    vec3 placed() {
      rest = position;
      return centre + size * (position - centre) + explode * centre;
    }
  `,
  fragment: /* glsl */ `
    uniform vec4 plane;
    in vec3 rest;
    void clip() {
      if (dot(rest, plane.xyz) > plane.w) discard;
    }
  `,
};

/** GLSL of both stages for positions that are used as they are. */
export const plainShader = {
  vertex: 'vec3 placed() { return position; }',
  fragment: 'void clip() {}',
};

const vertexShader = /* glsl */ `
  in float value;
  out vec3 eye;
  out vec3 smoothNormal;
  out float v;
  void main() {
    vec4 at = modelViewMatrix * vec4(placed(), 1.0);
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
  uniform float evenness;
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
    float line = colored && isolineStep > 0.0 ? isoline() : 0.0;
    clip();

    vec3 base = plain;
    if (colored) {
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
    vec3 lit = pow(base, vec3(2.2)) * mix(light, 0.96, evenness) + gloss * (1.0 - evenness);
    pixel = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
  }
`;

/** How polygons are coloured and lit: by a scalar or plain. */
export class Shading {
  private scalars: Scalars | null = null;
  private readonly uniforms = {
    colored: { value: false },
    plain: { value: new Color() },
    noValue: { value: new Color() },
    colors: { value: null as Texture | null },
    low: { value: 0 },
    span: { value: 1 },
    isolineStep: { value: 0 },
  };

  /**
   * A material that follows this shading; the caller disposes of it.
   * \param evenness  1: lit alike from all sides, so that colours are those of the bar; 0: not
   */
  material(cells?: CellUniforms, evenness = 0): ShaderMaterial {
    const shader = cells ? cellShader : plainShader;
    return new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shader.vertex + vertexShader,
      fragmentShader: shader.fragment + fragmentShader,
      uniforms: { ...this.uniforms, ...cells, evenness: { value: evenness } },
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
  }

  setScalars(scalars: Scalars | null): void {
    this.scalars = scalars;
    this.uniforms.colored.value = scalars !== null;
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
    this.uniforms.colors.value?.dispose();
  }
}

/** What the shader takes for a stored number. */
export function shaderValue(stored: number): number {
  return Number.isFinite(stored) ? stored : missing;
}

/** The same attributes with another index: lines along what a geometry fills. */
export function sharingAttributes(from: BufferGeometry, to: BufferGeometry): BufferGeometry {
  for (const name of ['position', 'centre']) {
    const attribute = from.getAttribute(name);
    if (attribute) to.setAttribute(name, attribute);
  }
  return to;
}
