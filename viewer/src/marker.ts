import { BufferAttribute, BufferGeometry, GLSL3, Points, ShaderMaterial } from 'three';

const vertexShader = /* glsl */ `
  uniform float size;
  void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
  }
`;

const fragmentShader = /* glsl */ `
  out vec4 pixel;
  void main() {
    float r = 2.0 * length(gl_PointCoord - 0.5);
    vec3 color = r < 0.5 ? vec3(0.93, 0.26, 0.13) : vec3(1.0);
    pixel = vec4(color, 1.0 - smoothstep(0.85, 1.0, r));
  }
`;

/** The dot on the picked vertex, in front of everything. */
export class Marker {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  private readonly position = new BufferAttribute(new Float32Array(3), 3);

  constructor(pixelRatio: number) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', this.position);
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      uniforms: { size: { value: 13 * pixelRatio } },
      transparent: true,
      depthTest: false,
    });
    this.object = new Points(geometry, material);
    this.object.frustumCulled = false;
    this.object.renderOrder = 2;
    this.object.visible = false;
  }

  show(x: number, y: number, z: number): void {
    this.position.setXYZ(0, x, y, z);
    this.position.needsUpdate = true;
    this.object.visible = true;
  }

  hide(): void {
    this.object.visible = false;
  }
}
