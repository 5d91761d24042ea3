import { PerspectiveCamera, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Box, Extent } from './shape';

export type Axis = 'x' | 'y' | 'z';

const axes: Record<Axis, Vector3> = {
  x: new Vector3(1, 0, 0),
  y: new Vector3(0, 1, 0),
  z: new Vector3(0, 0, 1),
};

const fieldOfView = 32;

/** How a mesh is first looked at. */
interface Pose {
  up: Axis;
  /** Towards the camera. */
  direction: Vector3;
}

/** Flat meshes from the front, height fields from above, everything else from in front of it. */
export function defaultPose(box: Box): Pose {
  const size = axisSizes(box);
  const largest = Math.max(...size);
  if (size[2] < 0.02 * largest) return { up: 'y', direction: new Vector3(0, 0, 1) };
  if (size[2] < 0.4 * Math.min(size[0], size[1])) return poseAbout('z', 0.85);
  return poseAbout('y', 0.35);
}

function axisSizes(box: Box): number[] {
  return box.max.map((x, k) => x - box.min[k]);
}

function poseAbout(up: Axis, elevation: number): Pose {
  const towards: Record<Axis, [Vector3, Vector3]> = {
    x: [axes.y, axes.z],
    y: [axes.z, axes.x],
    z: [axes.y.clone().negate(), axes.x],
  };
  const [front, side] = towards[up];
  const azimuth = 0.45;
  const direction = new Vector3()
    .addScaledVector(front, Math.cos(azimuth) * Math.cos(elevation))
    .addScaledVector(side, Math.sin(azimuth) * Math.cos(elevation))
    .addScaledVector(axes[up], Math.sin(elevation));
  return { up, direction };
}

/** The canvas, the camera and what moves it. Draws on demand only. */
export class View {
  readonly scene = new Scene();
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(fieldOfView, 1, 0.01, 100);
  private controls: OrbitControls;
  private scheduled = false;
  private radius = 1;

  /** \param beforeDraw  called with the pixels of a unit at distance 1, and the nearest distance */
  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly beforeDraw: (pixelsPerUnit: number, nearest: number) => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.controls = this.makeControls();
    this.resize();
    new ResizeObserver(() => {
      this.resize();
      this.drawNow();
    }).observe(canvas);
  }

  /** Shows all of the mesh, from the default side. */
  fit(extent: Extent, up?: Axis): void {
    this.resize();
    const { box } = extent;
    const pose = up ? poseAbout(up, 0.35) : defaultPose(box);
    this.camera.up.copy(axes[pose.up]);
    this.controls.dispose();
    this.controls = this.makeControls();
    const centre = new Vector3(...box.min).add(new Vector3(...box.max)).multiplyScalar(0.5);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(pose.direction);
    this.camera.lookAt(centre);
    this.camera.updateMatrixWorld();
    const distance = this.fittingDistance(extent, centre);
    this.camera.position.copy(centre).addScaledVector(pose.direction, this.radius * distance);
    this.controls.update();
    this.draw();
  }

  /** How far from 0 anything is drawn. */
  setRadius(radius: number): void {
    this.radius = radius;
  }

  /** From what is looked at towards the camera. */
  get towardsCamera(): Vector3 {
    return this.camera.position.clone().sub(this.controls.target).normalize();
  }

  get up(): Axis {
    return (['x', 'y', 'z'] as const).find((axis) => axes[axis].equals(this.camera.up)) ?? 'y';
  }

  /** Angles in radians: to the right, and upwards. */
  turn(right: number, upwards: number): void {
    const up = this.camera.up;
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(up, right);
    const side = new Vector3().crossVectors(up, offset).normalize();
    const polar = offset.angleTo(up);
    const bounded = Math.min(Math.PI - 0.01, Math.max(0.01, polar - upwards));
    offset.applyAxisAngle(side, bounded - polar);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  /** In fractions of the view's height. */
  shift(right: number, upwards: number): void {
    const height =
      2 * this.distance() * Math.tan((fieldOfView * Math.PI) / 360);
    const move = new Vector3()
      .addScaledVector(new Vector3().setFromMatrixColumn(this.camera.matrix, 0), right * height)
      .addScaledVector(new Vector3().setFromMatrixColumn(this.camera.matrix, 1), upwards * height);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
    this.draw();
  }

  zoom(factor: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(offset, 1 / factor);
    this.controls.update();
    this.draw();
  }

  lookAt(x: number, y: number, z: number): void {
    const move = new Vector3(x, y, z).sub(this.controls.target);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
    this.draw();
  }

  /** The ray through a point of the window. */
  rayThrough(clientX: number, clientY: number): { origin: Vector3; direction: Vector3 } {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(
      new Vector2(((clientX - left) / width) * 2 - 1, 1 - ((clientY - top) / height) * 2),
      this.camera,
    );
    return caster.ray;
  }

  /** Soon; any number of calls give one picture. */
  draw(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.drawNow();
    });
  }

  drawNow(): void {
    const distance = this.camera.position.length();
    this.camera.near = Math.max(distance - 1.1 * this.radius, 0.002 * Math.max(distance, 0.1));
    this.camera.far = distance + 1.5 * this.radius;
    this.camera.updateProjectionMatrix();
    const pixels = this.renderer.domElement.height / 2;
    this.beforeDraw(pixels * this.camera.projectionMatrix.elements[5], this.camera.near);
    this.renderer.render(this.scene, this.camera);
  }

  private distance(): number {
    return this.camera.position.distanceTo(this.controls.target);
  }

  private makeControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.canvas);
    controls.zoomToCursor = true;
    controls.minDistance = 0.001;
    controls.maxDistance = 50;
    controls.addEventListener('change', () => this.draw());
    return controls;
  }

  /** Smallest distance at which every vertex is in sight, with a margin. */
  private fittingDistance(extent: Extent, centre: Vector3): number {
    const margin = 1.1;
    const upTangent = Math.tan((fieldOfView * Math.PI) / 360) / margin;
    const sideTangent = upTangent * this.camera.aspect;
    const toCamera = this.camera.matrixWorld.clone().setPosition(0, 0, 0).invert();
    let distance = 0.05;
    const vertex = new Vector3();
    const stride = Math.max(1, Math.floor(extent.faceVertices.length / 50000));
    for (let c = 0; c < extent.faceVertices.length; c += stride) {
      vertex.fromArray(extent.positions, 3 * extent.faceVertices[c]);
      vertex.sub(centre).applyMatrix4(toCamera);
      distance = Math.max(
        distance,
        vertex.z + Math.abs(vertex.x) / sideTangent,
        vertex.z + Math.abs(vertex.y) / upTangent,
      );
    }
    return distance;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
  }
}
