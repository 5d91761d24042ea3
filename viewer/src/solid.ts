import {
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh as ThreeMesh,
  Vector4,
  type ShaderMaterial,
  type Texture,
  type Vector3,
} from 'three';
import { Edges } from './edges';
import type { Range, Scalars } from './fields';
import { count } from './numbers';
import type { Place, VolumeInfo } from './page';
import { facePart, positionRows, vertexPart, type PickedPart } from './picked';
import { cellsBelow, cellsReachingBelow, cutVolume, heightsAlong, type Heights } from './section';
import { Shading, sharingAttributes, type CellUniforms } from './shading';
import type { Pick, Shape } from './shape';
import { allSides, exposedSides, skinOfSides } from './sides';
import {
  pickSkin,
  placed,
  placedCorners,
  skinGeometry,
  skinValues,
  type Apart,
  type Skin,
  type SkinHit,
} from './skin';
import type { ThemeColors } from './theme';
import type { Boundary, Volume } from './volume';

/** 'cut': through the cells; 'cells': whole ones. */
export type ClipMode = 'none' | 'cut' | 'cells';

/** Where a volume is clipped: what lies above the level is left out. */
export interface Clip {
  mode: ClipMode;
  /** A unit vector. */
  normal: [number, number, number];
  /** Along the normal, in the stored unit. */
  level: number;
}

/** What a change of the clip brought into sight. */
export interface ClipResult {
  nCells: number;
  /** Of the cut, in the mesh's unit, squared. */
  area: number;
  /** Cells that are drawn apart are all there, or only the outer ones. */
  complete: boolean;
}

const noPlane = new Vector4(0, 0, 0, 1);

type Moves = Omit<CellUniforms, 'plane'>;

/** A skin on the graphics card. */
class DrawnSkin {
  readonly object = new Group();
  skin: Skin | null = null;
  readonly uniforms: CellUniforms;
  private readonly faces: ThreeMesh<BufferGeometry, ShaderMaterial>;
  private readonly edges: Edges;

  constructor(shading: Shading, moves: Moves, meanEdge: number, evenness: number) {
    this.uniforms = { ...moves, plane: { value: noPlane.clone() } };
    this.faces = new ThreeMesh(new BufferGeometry(), shading.material(this.uniforms, evenness));
    this.faces.frustumCulled = false;
    this.edges = new Edges(meanEdge, this.uniforms);
    this.object.add(this.faces, this.edges.object);
  }

  set(skin: Skin | null, centres: Float32Array | null, scalars: Scalars | null): void {
    this.skin = skin;
    this.object.visible = skin !== null;
    this.faces.geometry.dispose();
    this.faces.geometry = skin ? skinGeometry(skin, centres) : new BufferGeometry();
    const lines = sharingAttributes(this.faces.geometry, new BufferGeometry());
    if (skin) lines.setIndex(new BufferAttribute(skin.lines, 1));
    this.edges.setGeometry(lines);
    this.setScalars(scalars);
  }

  setScalars(scalars: Scalars | null): void {
    if (!this.skin) return;
    const values = skinValues(this.skin, scalars);
    this.faces.geometry.setAttribute('value', new BufferAttribute(values, 1));
  }

  setEdgeColor(color: string): void {
    this.edges.setColor(color);
  }

  setScreen(pixelsPerUnit: number, nearest: number, wanted: boolean): void {
    this.edges.setScreen(pixelsPerUnit, nearest, wanted);
  }

  dispose(): void {
    this.faces.geometry.dispose();
    this.faces.material.dispose();
    this.edges.dispose();
  }
}

/** A volume mesh: its boundary, or what a clip leaves of it, its cells together or apart. */
export class Solid implements Shape {
  readonly object = new Group();
  private readonly shading = new Shading();
  private readonly moves = { size: { value: 1 }, explode: { value: 0 } };
  private readonly outside: DrawnSkin;
  private readonly cut: DrawnSkin;
  private scalars: Scalars | null = null;
  private heights: Heights | null = null;
  private clip: Clip = { mode: 'none', normal: [0, 0, 1], level: 0 };
  private flat = false;
  private hidden: boolean[];
  /** What the outside was last built for. */
  private built = '';
  private nKept = 0;
  private complete = true;
  private area = 0;

  constructor(readonly volume: Volume) {
    this.outside = new DrawnSkin(this.shading, this.moves, volume.meanEdge, 0);
    this.cut = new DrawnSkin(this.shading, this.moves, volume.meanEdge, 0.8);
    this.hidden = volume.info.patches.map(() => false);
    this.object.add(this.outside.object, this.cut.object);
    this.update();
  }

  get info(): VolumeInfo {
    return this.volume.info;
  }

  get extent(): Boundary {
    return this.volume.boundary;
  }

  get radius(): number {
    return 1 + this.moves.explode.value;
  }

  get plane(): Vector4 | null {
    const { mode, normal, level } = this.clip;
    return mode === 'none' ? null : new Vector4(...normal, level);
  }

  /** Lowest and highest level of planes across a direction. */
  levels(normal: [number, number, number]): { low: number; high: number } {
    const { lowest, highest } = this.heightsFor(normal);
    return { low: lowest, high: highest };
  }

  /** Clips, and draws the cells apart. */
  show(clip: Clip, apart: Apart): ClipResult {
    const last = this.clip;
    const wasApart = this.isApart;
    this.clip = clip;
    this.moves.size.value = apart.size;
    this.moves.explode.value = apart.explode;
    const same =
      clip.mode === last.mode &&
      clip.level === last.level &&
      clip.normal.every((x, k) => x === last.normal[k]);
    if (!same || wasApart !== this.isApart) this.update();
    return { nCells: this.nKept, area: this.area, complete: this.complete };
  }

  setPatchHidden(patch: number, hidden: boolean): void {
    this.hidden[patch] = hidden;
    this.built = '';
    this.updateOutside();
  }

  setScalars(scalars: Scalars | null): void {
    this.scalars = scalars;
    this.shading.setScalars(scalars);
    this.outside.setScalars(scalars);
    this.cut.setScalars(scalars);
  }

  setColors(colors: Texture): void {
    this.shading.setColors(colors);
  }

  setRange(range: Range, isolineStep: number): void {
    this.shading.setRange(range, isolineStep);
  }

  setTheme({ surface, noValue, edges }: ThemeColors): void {
    this.shading.setPlainColors(surface, noValue);
    this.outside.setEdgeColor(edges);
    this.cut.setEdgeColor(edges);
  }

  setFlat(flat: boolean): void {
    this.flat = flat;
    this.built = '';
    this.updateOutside();
  }

  setScreen(pixelsPerUnit: number, nearest: number, edgesWanted: boolean): void {
    this.outside.setScreen(pixelsPerUnit, nearest, edgesWanted);
    this.cut.setScreen(pixelsPerUnit, nearest, edgesWanted);
  }

  origins(on: Place): Float32Array {
    return on === 'vertex' ? this.volume.positions : this.volume.cellCentres;
  }

  pick(origin: Vector3, ray: Vector3): Pick | null {
    let nearest: { hit: SkinHit; skin: Skin } | null = null;
    for (const { skin, uniforms } of [this.outside, this.cut]) {
      if (!skin) continue;
      const { x, y, z, w } = uniforms.plane.value;
      const drawn = placedCorners(skin, this.volume.cellCentres, this.apart);
      const kept = (at: number[]): boolean => x * at[0] + y * at[1] + z * at[2] <= w;
      const hit = pickSkin(skin, drawn, origin, ray, kept);
      if (hit && (!nearest || hit.distance < nearest.hit.distance)) nearest = { hit, skin };
    }
    return nearest ? this.pickOf(nearest.hit, nearest.skin) : null;
  }

  pickVertex(vertex: number): Pick {
    const { positions } = this.volume;
    const [x, y, z] = positions.subarray(3 * vertex, 3 * vertex + 3);
    const parts = [vertexPart(this.info, positions, vertex)];
    return { vertex, face: -1, cell: -1, marker: [x, y, z], parts };
  }

  counts(): string {
    const { info, nFaces, nCells } = this.volume;
    return (
      `${count(info.vertices)} vertices, ${count(info.edges)} edges, ` +
      `${count(nFaces)} faces, ${count(nCells)} cells`
    );
  }

  dispose(): void {
    this.outside.dispose();
    this.cut.dispose();
    this.shading.dispose();
  }

  private get apart(): Apart {
    return { size: this.moves.size.value, explode: this.moves.explode.value };
  }

  get isApart(): boolean {
    return this.moves.size.value !== 1 || this.moves.explode.value !== 0;
  }

  private heightsFor(normal: [number, number, number]): Heights {
    const same = this.heights?.normal.every((x, k) => x === normal[k]);
    if (!this.heights || !same) this.heights = heightsAlong(this.volume, normal);
    return this.heights;
  }

  private update(): void {
    this.updateOutside();
    this.updateCut();
  }

  private updateOutside(): void {
    const { mode, normal, level } = this.clip;
    const { volume, isApart } = this;
    const plane = this.outside.uniforms.plane.value;
    if (mode === 'cut') plane.set(...normal, level);
    else plane.copy(noPlane);
    // A cut through cells in their places only hides part of the boundary.
    const wholeBoundary = !isApart && mode !== 'cells';
    const wanted = `${isApart ? 'apart' : 'together'} ${wholeBoundary || mode === 'none'}`;
    if (wanted === this.built && wanted.endsWith('true')) return;
    this.built = wanted;
    let kept: Uint8Array | null = null;
    if (mode === 'cells') kept = cellsBelow(this.heightsFor(normal), level);
    else if (mode === 'cut' && isApart) kept = cellsReachingBelow(this.heightsFor(normal), level);
    const { sides, complete } = isApart
      ? allSides(volume, kept, this.hidden)
      : { sides: exposedSides(volume, kept, this.hidden), complete: true };
    this.complete = complete;
    if (kept) this.nKept = kept.reduce((sum, keeps) => sum + keeps, 0);
    const skin = skinOfSides(volume, sides, this.flat || isApart);
    this.outside.set(skin, isApart ? volume.cellCentres : null, this.scalars);
  }

  private updateCut(): void {
    const { mode, normal, level } = this.clip;
    this.area = 0;
    if (mode !== 'cut') {
      if (this.cut.skin) this.cut.set(null, null, null);
      return;
    }
    const heights = this.heightsFor(normal);
    const { skin, area } = cutVolume(this.volume, heights, level, this.isApart);
    this.nKept = skin.cells.length;
    this.area = area * this.info.scale ** 2;
    this.cut.set(skin, this.isApart ? this.volume.cellCentres : null, this.scalars);
  }

  private pickOf(hit: SkinHit, skin: Skin): Pick {
    const { positions, faceOffsets, cellCentres, cellOffsets, facePatches, info } = this.volume;
    const cell = skin.cells[hit.polygon];
    const face = skin.faces[hit.polygon];
    const centre = cellCentres.subarray(3 * cell, 3 * cell + 3);
    const parts: PickedPart[] = [];
    let marker = placed(hit.rest, centre, this.apart);
    let vertex = -1;
    if (face >= 0) {
      vertex = this.nearestVertex(skin, hit);
      const at = positions.subarray(3 * vertex, 3 * vertex + 3);
      marker = placed(at, centre, this.apart);
      parts.push(vertexPart(info, positions, vertex));
    } else {
      const rows = positionRows(info, hit.rest);
      parts.push({ title: 'Point of the cut', rows, on: 'vertex', weights: hit.weights });
    }
    const nFaces = cellOffsets[cell + 1] - cellOffsets[cell];
    parts.push({
      title: `Cell ${count(cell)}`,
      rows: [['faces', String(nFaces)]],
      on: 'cell',
      weights: [[cell, 1]],
    });
    if (face >= 0) {
      const part = facePart(face, faceOffsets[face + 1] - faceOffsets[face]);
      const patch = info.patches[facePatches[face]];
      if (patch) part.rows.push(['patch', patch.name]);
      parts.push(part);
    }
    return { vertex, face, cell, marker, parts };
  }

  private nearestVertex(skin: Skin, { polygon, rest }: SkinHit): number {
    let vertex = -1;
    let nearest = Infinity;
    for (let c = skin.offsets[polygon]; c < skin.offsets[polygon + 1]; ++c) {
      const away = Math.hypot(...rest.map((x, k) => x - skin.positions[3 * c + k]));
      if (away < nearest) {
        nearest = away;
        vertex = skin.from[c];
      }
    }
    return vertex;
  }
}
