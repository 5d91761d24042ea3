import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh as ThreeMesh,
  type ShaderMaterial,
  type Texture,
  type Vector3,
} from 'three';
import { Edges } from './edges';
import type { Range, Scalars } from './fields';
import { faceCentre, type Mesh } from './mesh';
import { creasedNormals } from './normals';
import { count } from './numbers';
import type { Place, SurfaceInfo } from './page';
import { facePart, vertexPart } from './picked';
import { firstTriangle } from './ray';
import { Shading, shaderValue } from './shading';
import type { Pick, Shape } from './shape';
import type { ThemeColors } from './theme';

/** Up to here every triangle gets corners of its own, so that creases stay sharp. */
const maxSharpTriangles = 400000;

/** A surface mesh: smoothly coloured by a vertex field, flat by a face field, or plain. */
export class Surface implements Shape {
  readonly object = new Group();
  readonly radius = 1;
  readonly plane = null;
  readonly isApart = false;
  private readonly shading = new Shading();
  private readonly faces: ThreeMesh<BufferGeometry, ShaderMaterial>;
  private readonly edges: Edges;
  private scalars: Scalars | null = null;
  private flat = false;
  private layout = '';

  constructor(private readonly mesh: Mesh) {
    this.faces = new ThreeMesh(new BufferGeometry(), this.shading.material());
    this.faces.frustumCulled = false;
    this.edges = new Edges(mesh.meanEdge);
    const lines = new BufferGeometry();
    lines.setAttribute('position', new BufferAttribute(mesh.positions, 3));
    lines.setIndex(new BufferAttribute(mesh.edges, 1));
    this.edges.setGeometry(lines);
    this.object.add(this.faces, this.edges.object);
    this.update();
  }

  get info(): SurfaceInfo {
    return this.mesh.info;
  }

  get extent(): Mesh {
    return this.mesh;
  }

  setScalars(scalars: Scalars | null): void {
    this.scalars = scalars;
    this.shading.setScalars(scalars);
    this.update();
  }

  setFlat(flat: boolean): void {
    this.flat = flat;
    this.update();
  }

  setColors(colors: Texture): void {
    this.shading.setColors(colors);
  }

  setRange(range: Range, isolineStep: number): void {
    this.shading.setRange(range, isolineStep);
  }

  setTheme({ surface, noValue, edges }: ThemeColors): void {
    this.shading.setPlainColors(surface, noValue);
    this.edges.setColor(edges);
  }

  setScreen(pixelsPerUnit: number, nearest: number, edgesWanted: boolean): void {
    this.edges.setScreen(pixelsPerUnit, nearest, edgesWanted);
  }

  origins(on: Place): Float32Array {
    if (on === 'vertex') return this.mesh.positions;
    const centres = new Float32Array(3 * this.mesh.nFaces);
    const centre: [number, number, number] = [0, 0, 0];
    for (let f = 0; f < this.mesh.nFaces; ++f) {
      faceCentre(this.mesh, f, centre);
      centres.set(centre, 3 * f);
    }
    return centres;
  }

  pick(origin: Vector3, ray: Vector3): Pick | null {
    const { positions, triangles, triangleFaces } = this.mesh;
    const hit = firstTriangle(positions, triangles, origin, ray);
    if (!hit) return null;
    const face = triangleFaces[hit.triangle];
    const at = ray.clone().multiplyScalar(hit.distance).add(origin);
    const pick = this.pickVertex(this.nearestVertex(face, at));
    const nVertices = this.mesh.faceOffsets[face + 1] - this.mesh.faceOffsets[face];
    return { ...pick, face, parts: [...pick.parts, facePart(face, nVertices)] };
  }

  pickVertex(vertex: number): Pick {
    const [x, y, z] = this.mesh.positions.subarray(3 * vertex, 3 * vertex + 3);
    const parts = [vertexPart(this.info, this.mesh.positions, vertex)];
    return { vertex, face: -1, cell: -1, marker: [x, y, z], parts };
  }

  counts(): string {
    const { vertices, edges } = this.info;
    return `${count(vertices)} vertices, ${count(edges)} edges, ${count(this.mesh.nFaces)} faces`;
  }

  dispose(): void {
    this.faces.geometry.dispose();
    this.faces.material.dispose();
    this.edges.dispose();
    this.shading.dispose();
  }

  private nearestVertex(face: number, at: Vector3): number {
    const { positions: p, faceOffsets, faceVertices } = this.mesh;
    let vertex = -1;
    let nearest = Infinity;
    for (let c = faceOffsets[face]; c < faceOffsets[face + 1]; ++c) {
      const v = faceVertices[c];
      const away = Math.hypot(p[3 * v] - at.x, p[3 * v + 1] - at.y, p[3 * v + 2] - at.z);
      if (away < nearest) {
        nearest = away;
        vertex = v;
      }
    }
    return vertex;
  }

  private update(): void {
    const own =
      this.flat ||
      this.scalars?.on === 'face' ||
      this.mesh.triangles.length <= 3 * maxSharpTriangles;
    const layout = own ? (this.flat ? 'flat' : 'creased') : 'shared';
    if (layout !== this.layout) {
      this.layout = layout;
      this.faces.geometry.dispose();
      this.faces.geometry = own ? cornerGeometry(this.mesh, this.flat) : sharedGeometry(this.mesh);
    }
    const values = valuesFor(this.mesh, this.scalars, own);
    this.faces.geometry.setAttribute('value', new BufferAttribute(values, 1));
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
    values[i] = shaderValue(scalars.values[row]);
  }
  return values;
}
