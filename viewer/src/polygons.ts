import { ShapeUtils, Vector2 } from 'three';

/** Corner numbers in threes, and the signed area of plane polygons. */
export interface Filled {
  triangles: number[];
  area: number;
}

interface Loop {
  corners: number[];
  points: Vector2[];
  area: number;
}

/** Two directions that make a right-handed frame with the unit vector. */
function frame([x, y, z]: [number, number, number]): [number[], number[]] {
  const length = Math.hypot(x, z);
  const u = length > 0.5 ? [z / length, 0, -x / length] : [1 - x * x, -x * y, -x * z];
  const size = Math.hypot(...u);
  const [a, b, c] = u.map((k) => k / size);
  return [
    [a, b, c],
    [y * c - z * b, z * a - x * c, x * b - y * a],
  ];
}

function loopOf(corners: number[], positions: number[], axes: [number[], number[]]): Loop {
  const points = corners.map((corner) => {
    const [x, y] = axes.map(
      (axis) =>
        axis[0] * positions[3 * corner] +
        axis[1] * positions[3 * corner + 1] +
        axis[2] * positions[3 * corner + 2],
    );
    return new Vector2(x, y);
  });
  return { corners, points, area: ShapeUtils.area(points) };
}

function isConvex({ points }: Loop): boolean {
  const n = points.length;
  for (let i = 0; i < n; ++i) {
    const a = points[i];
    const b = points[(i + 1) % n];
    const c = points[(i + 2) % n];
    const cross = (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
    // Corners on a straight line come out bent a little either way.
    if (cross < -1e-3 * a.distanceTo(b) * b.distanceTo(c)) return false;
  }
  return true;
}

/** Back and forth across, which leaves fewer needles than a fan. */
function fillConvex(corners: number[], triangles: number[]): void {
  let low = 0;
  let high = corners.length - 1;
  while (high - low > 1) {
    triangles.push(corners[low], corners[low + 1], corners[high]);
    ++low;
    if (high - low < 2) break;
    triangles.push(corners[low], corners[high - 1], corners[high]);
    --high;
  }
}

function holds({ points }: Loop, at: Vector2): boolean {
  let inside = false;
  for (let i = 0, j = points.length - 1; i < points.length; j = i++) {
    const [a, b] = [points[i], points[j]];
    if (a.y > at.y !== b.y > at.y && at.x < a.x + ((at.y - a.y) / (b.y - a.y)) * (b.x - a.x))
      inside = !inside;
  }
  return inside;
}

/**
 * Fills closed lines that run about what they bound counter-clockwise, and about its holes
 * clockwise, seen against the normal.
 */
export function fillLoops(
  loops: number[][],
  positions: number[],
  normal: [number, number, number],
): Filled {
  const axes = frame(normal);
  const all = loops.map((corners) => loopOf(corners, positions, axes));
  const holes = all.filter(({ area }) => area < 0);
  const triangles: number[] = [];
  for (const outer of all) {
    if (outer.area <= 0) continue;
    const inner = holes.filter((hole) => holds(outer, hole.points[0]));
    if (inner.length === 0 && isConvex(outer)) {
      fillConvex(outer.corners, triangles);
      continue;
    }
    const corners = [outer, ...inner].flatMap((loop) => loop.corners);
    const cut = ShapeUtils.triangulateShape(
      outer.points,
      inner.map(({ points }) => points),
    );
    for (const triangle of cut) triangles.push(...triangle.map((i) => corners[i]));
  }
  return { triangles, area: all.reduce((sum, { area }) => sum + area, 0) };
}
