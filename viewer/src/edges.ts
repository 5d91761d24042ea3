import { BufferGeometry, Color, GLSL3, LineSegments, ShaderMaterial } from 'three';
import { cellShader, plainShader, type CellUniforms } from './shading';

const vertexShader = /* glsl */ `
  uniform float meanEdge;
  uniform float pixelsPerUnit;
  out float opacity;
  void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(placed(), 1.0);
    float pixels = meanEdge * pixelsPerUnit / gl_Position.w;
    opacity = smoothstep(1.5, 9.0, pixels);
  }
`;

const fragmentShader = /* glsl */ `
  uniform vec3 color;
  uniform float strength;
  in float opacity;
  out vec4 pixel;
  void main() {
    clip();
    pixel = vec4(color, strength * opacity);
  }
`;

/** The sides of the polygons; they fade out where they would cover the surface. */
export class Edges {
  readonly object: LineSegments<BufferGeometry, ShaderMaterial>;
  private readonly uniforms;

  /** \param cells  where the lines are those of cells */
  constructor(meanEdge: number, cells?: CellUniforms) {
    this.uniforms = {
      meanEdge: { value: meanEdge },
      pixelsPerUnit: { value: 1 },
      color: { value: new Color() },
      strength: { value: 0.55 },
    };
    const shader = cells ? cellShader : plainShader;
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shader.vertex + vertexShader,
      fragmentShader: shader.fragment + fragmentShader,
      uniforms: { ...this.uniforms, ...cells },
      transparent: true,
      depthWrite: false,
    });
    this.object = new LineSegments(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
  }

  /** Positions, and two of them a line. */
  setGeometry(geometry: BufferGeometry): void {
    this.object.geometry.dispose();
    this.object.geometry = geometry;
  }

  setColor(color: string): void {
    this.uniforms.color.value.setStyle(color, '');
  }

  /**
   * \param pixelsPerUnit  at distance 1 from the camera
   * \param nearest        distance of the nearest point of the mesh
   */
  setScreen(pixelsPerUnit: number, nearest: number, wanted: boolean): void {
    this.uniforms.pixelsPerUnit.value = pixelsPerUnit;
    const largest = (this.uniforms.meanEdge.value * pixelsPerUnit) / nearest;
    this.object.visible = wanted && largest > 1.5;
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}
