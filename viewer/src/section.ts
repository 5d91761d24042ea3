import { fillLoops } from './polygons';
import type { Skin } from './skin';
import type { Volume } from './volume';

/** Heights closer to the plane than this lie in it: what single precision leaves of positions. */
const flat = 2e-6;

/** How a volume lies along a direction; serves every plane across it. */
export interface Heights {
  normal: [number, number, number];
  vertices: Float64Array;
  /** Of every cell's centre, lowest and highest vertex. */
  centres: Float32Array;
  low: Float32Array;
  high: Float32Array;
  /** Of the whole mesh. */
  lowest: number;
  highest: number;
}

/** Cost: O(corners). */
export function heightsAlong(volume: Volume, normal: [number, number, number]): Heights {
  const { positions, faceOffsets, faceVertices, faceCells, cellCentres, nCells, nFaces } = volume;
  const [nx, ny, nz] = normal;
  const vertices = new Float64Array(positions.length / 3);
  for (let v = 0; v < vertices.length; ++v)
    vertices[v] = nx * positions[3 * v] + ny * positions[3 * v + 1] + nz * positions[3 * v + 2];
  const centres = new Float32Array(nCells);
  for (let c = 0; c < nCells; ++c)
    centres[c] =
      nx * cellCentres[3 * c] + ny * cellCentres[3 * c + 1] + nz * cellCentres[3 * c + 2];
  const low = new Float32Array(nCells).fill(Infinity);
  const high = new Float32Array(nCells).fill(-Infinity);
  let lowest = Infinity;
  let highest = -Infinity;
  for (let f = 0; f < nFaces; ++f) {
    let faceLow = Infinity;
    let faceHigh = -Infinity;
    for (let c = faceOffsets[f]; c < faceOffsets[f + 1]; ++c) {
      const height = vertices[faceVertices[c]];
      if (height < faceLow) faceLow = height;
      if (height > faceHigh) faceHigh = height;
    }
    for (let side = 2 * f; side < 2 * f + 2; ++side) {
      const cell = faceCells[side];
      if (cell < 0) continue;
      if (faceLow < low[cell]) low[cell] = faceLow;
      if (faceHigh > high[cell]) high[cell] = faceHigh;
      if (faceLow < lowest) lowest = faceLow;
      if (faceHigh > highest) highest = faceHigh;
    }
  }
  if (nCells === 0) lowest = highest = 0;
  return { normal, vertices, centres, low, high, lowest, highest };
}

/** Cell -> whether its centre lies below the plane. */
export function cellsBelow(heights: Heights, level: number): Uint8Array {
  return Uint8Array.from(heights.centres, (height) => (height < level - flat ? 1 : 0));
}

/** Cell -> whether any of it lies below the plane. */
export function cellsReachingBelow(heights: Heights, level: number): Uint8Array {
  return Uint8Array.from(heights.low, (height) => (height < level - flat ? 1 : 0));
}

/** What a plane cuts out of the cells. */
export interface Section {
  skin: Skin;
  /** In the mesh's stored unit, squared. */
  area: number;
}

/** A cell's section: points, and sides from where a face goes down to where it goes up. */
class CellSection {
  /** Vertices below and not below the plane that a point lies between. */
  readonly below: number[] = [];
  readonly above: number[] = [];
  /** Point -> the next one around the section, and the face between them. */
  readonly next: number[] = [];
  readonly face: number[] = [];
  private readonly pointOfEdge = new Map<number, number>();

  constructor(private readonly nVertices: number) {}

  clear(): void {
    this.below.length = this.above.length = this.next.length = this.face.length = 0;
    this.pointOfEdge.clear();
  }

  /** The point of an edge; both faces of the cell at the edge find the same. */
  point(below: number, above: number): number {
    const key = below * this.nVertices + above;
    let point = this.pointOfEdge.get(key);
    if (point === undefined) {
      point = this.next.length;
      this.pointOfEdge.set(key, point);
      this.below.push(below);
      this.above.push(above);
      this.next.push(-1);
      this.face.push(-1);
    }
    return point;
  }

  connect(start: number, end: number, face: number): void {
    this.next[start] = end;
    this.face[start] = face;
  }
}

/** Computes sections of a volume by planes of one direction. */
class Cutter {
  private readonly cell: CellSection;
  private readonly positions: number[] = [];
  private readonly from: number[] = [];
  private readonly to: number[] = [];
  private readonly fraction: number[] = [];
  private readonly offsets: number[] = [0];
  private readonly cells: number[] = [];
  private readonly triangles: number[] = [];
  private readonly lines: number[] = [];
  private area = 0;

  constructor(
    private readonly volume: Volume,
    private readonly heights: Heights,
    private readonly level: number,
    private readonly apart: boolean,
  ) {
    this.cell = new CellSection(volume.positions.length / 3);
  }

  run(): Section {
    const { low, high } = this.heights;
    for (let c = 0; c < this.volume.nCells; ++c)
      if (low[c] < this.level && high[c] >= this.level - 2 * flat) this.cut(c);
    return {
      skin: {
        offsets: Uint32Array.from(this.offsets),
        cells: Uint32Array.from(this.cells),
        faces: new Int32Array(this.cells.length).fill(-1),
        positions: Float32Array.from(this.positions),
        from: Uint32Array.from(this.from),
        to: Uint32Array.from(this.to),
        fraction: Float32Array.from(this.fraction),
        normals: null,
        triangles: Uint32Array.from(this.triangles),
        lines: Uint32Array.from(this.lines),
      },
      area: this.area,
    };
  }

  /** Signed distance of a vertex, 0 where it lies in the plane. */
  private height(v: number): number {
    const height = this.heights.vertices[v] - this.level;
    return Math.abs(height) < flat ? 0 : height;
  }

  private cut(c: number): void {
    const { cellOffsets, cellSides } = this.volume;
    this.cell.clear();
    for (let i = cellOffsets[c]; i < cellOffsets[c + 1]; ++i) this.crossSide(cellSides[i]);
    if (this.cell.next.length < 3) return;
    const loops = this.loops(c);
    if (loops.length === 0) return;
    const { triangles, area } = fillLoops(loops, this.positions, this.heights.normal);
    this.area += area;
    for (const corner of triangles) this.triangles.push(corner);
    this.cells.push(c);
    this.offsets.push(this.from.length);
  }

  /** The points where a side's edges pass the plane, joined in pairs. */
  private crossSide(side: number): void {
    const { faceOffsets, faceVertices } = this.volume;
    const f = side >>> 1;
    const reversed = (side & 1) === 1;
    const starts: number[] = [];
    const ends: number[] = [];
    let a = faceVertices[faceOffsets[f + 1] - 1];
    let aBelow = this.height(a) < 0;
    for (let c = faceOffsets[f]; c < faceOffsets[f + 1]; ++c) {
      const b = faceVertices[c];
      const bBelow = this.height(b) < 0;
      if (aBelow !== bBelow) {
        const point = aBelow ? this.cell.point(a, b) : this.cell.point(b, a);
        (aBelow === reversed ? starts : ends).push(point);
      }
      a = b;
      aBelow = bBelow;
    }
    if (starts.length > 1) {
      this.sortAlong(starts, f, reversed);
      this.sortAlong(ends, f, reversed);
    }
    starts.forEach((start, i) => this.cell.connect(start, ends[i], f));
  }

  /** Sorts points by their place on the line in which the plane meets a face. */
  private sortAlong(points: number[], f: number, reversed: boolean): void {
    const [nx, ny, nz] = this.heights.normal;
    const [fx, fy, fz] = this.volume.faceNormals.subarray(3 * f, 3 * f + 3);
    const sign = reversed ? -1 : 1;
    const [tx, ty, tz] = [ny * fz - nz * fy, nz * fx - nx * fz, nx * fy - ny * fx];
    const place = (point: number): number => {
      const [x, y, z] = this.position(point);
      return sign * (tx * x + ty * y + tz * z);
    };
    points.sort((a, b) => place(a) - place(b));
  }

  private fractionOf(point: number): number {
    const low = this.height(this.cell.below[point]);
    const high = this.height(this.cell.above[point]);
    return low / (low - high);
  }

  private position(point: number): [number, number, number] {
    const { positions } = this.volume;
    const a = 3 * this.cell.below[point];
    const b = 3 * this.cell.above[point];
    const t = this.fractionOf(point);
    const k = (i: number): number => positions[a + i] + t * (positions[b + i] - positions[a + i]);
    return [k(0), k(1), k(2)];
  }

  /** The closed lines of cell `c` as new corners, each without points that fall together. */
  private loops(c: number): number[][] {
    const { next, face } = this.cell;
    const loops: number[][] = [];
    for (let first = 0; first < next.length; ++first) {
      const points: number[] = [];
      const faces: number[] = [];
      for (let p = first; next[p] >= 0; ) {
        if (points.length > 0 && this.coincide(points[points.length - 1], p)) {
          faces[faces.length - 1] = face[p];
        } else {
          points.push(p);
          faces.push(face[p]);
        }
        const q = next[p];
        next[p] = -1;
        p = q;
      }
      if (points.length > 1 && this.coincide(points[points.length - 1], points[0])) points.pop();
      if (points.length >= 3) loops.push(this.addCorners(c, points, faces));
    }
    return loops;
  }

  /** Whether two edges end in the plane at one vertex. */
  private coincide(p: number, q: number): boolean {
    const { above } = this.cell;
    return above[p] === above[q] && this.height(above[p]) === 0;
  }

  private addCorners(c: number, points: number[], faces: number[]): number[] {
    const begin = this.from.length;
    const corners: number[] = [];
    for (let i = 0; i < points.length; ++i) {
      corners.push(begin + i);
      this.positions.push(...this.position(points[i]));
      this.from.push(this.cell.below[points[i]]);
      this.to.push(this.cell.above[points[i]]);
      this.fraction.push(this.fractionOf(points[i]));
      if (this.drawsLine(c, faces[i]))
        this.lines.push(begin + i, begin + ((i + 1) % points.length));
    }
    return corners;
  }

  /** A line between two sections that touch is drawn once. */
  private drawsLine(c: number, f: number): boolean {
    const { faceCells } = this.volume;
    const other = faceCells[2 * f] === c ? faceCells[2 * f + 1] : faceCells[2 * f];
    return this.apart || other < c || !(this.heights.low[other] < this.level - flat);
  }
}

/**
 * The cross-sections of all cells that a plane meets. What lies in the plane counts as above it,
 * so that a plane along faces cuts the cells below it.
 * \param level  height of the plane
 * \param apart  whether cells are drawn apart, so that every one needs lines of its own
 * Cost: O(cells + corners of the cells that are met).
 */
export function cutVolume(
  volume: Volume,
  heights: Heights,
  level: number,
  apart: boolean,
): Section {
  return new Cutter(volume, heights, level, apart).run();
}
