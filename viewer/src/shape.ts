import type { Object3D, Texture, Vector3, Vector4 } from 'three';
import type { Range, Scalars } from './fields';
import type { ItemInfo, Place } from './page';
import type { PickedPart } from './picked';
import type { ThemeColors } from './theme';

export interface Box {
  min: [number, number, number];
  max: [number, number, number];
}

/** Where something is, for the camera. */
export interface Extent {
  box: Box;
  positions: Float32Array;
  /** The vertices that count. */
  faceVertices: Uint32Array;
}

/** What a ray met, or what was named by its number. */
export interface Pick {
  vertex: number;
  /** -1: none. */
  face: number;
  cell: number;
  /** Where the marker goes, as drawn. */
  marker: [number, number, number];
  parts: PickedPart[];
}

/** A mesh of the page as it is drawn: a surface or a volume. */
export interface Shape {
  readonly info: ItemInfo;
  readonly extent: Extent;
  readonly object: Object3D;
  /** How far from the middle it reaches, where the mesh itself lies within 1. */
  readonly radius: number;

  setScalars(scalars: Scalars | null): void;
  setColors(colors: Texture): void;
  /** \param isolineStep  0: none; both in the field's unit */
  setRange(range: Range, isolineStep: number): void;
  setTheme(colors: ThemeColors): void;
  setFlat(flat: boolean): void;
  /** Whether edges are seen, given the pixels of a unit at distance 1 and the nearest distance. */
  setScreen(pixelsPerUnit: number, nearest: number, edgesWanted: boolean): void;

  /** Where the arrows of a field start, three numbers a row. */
  origins(on: Place): Float32Array;
  /** Nothing is drawn of what lies beyond; null: all is. */
  readonly plane: Vector4 | null;
  /** Cells are not drawn in their places. */
  readonly isApart: boolean;

  pick(origin: Vector3, ray: Vector3): Pick | null;
  pickVertex(vertex: number): Pick;
  /** "8 vertices, 12 edges, 6 faces" */
  counts(): string;
  dispose(): void;
}
