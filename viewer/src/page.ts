/** What the program wrote into the page, beside the blocks of numbers. */

export type Place = 'vertex' | 'face' | 'cell';

export interface FieldInfo {
  name: string;
  on: Place;
  components: number;
  /** value = offset + scale * stored */
  offset: number;
  scale: number;
  block: number;
}

interface CommonInfo {
  title: string;
  vertices: number;
  edges: number;
  /** position = centre + scale * stored */
  centre: [number, number, number];
  scale: number;
  positions: number;
  faceSizes: number;
  faceVertices: number;
  triangleCorners: number;
  fields: FieldInfo[];
}

export interface SurfaceInfo extends CommonInfo {
  kind: 'surface';
  triangleFaces: number;
  edgeBits: number;
}

export interface VolumeInfo extends CommonInfo {
  kind: 'volume';
  cellSizes: number;
  /** 2 * face, + 1 where the face's normal points into the cell. */
  cellSides: number;
  patches: { name: string; faces: number }[];
}

export type ItemInfo = SurfaceInfo | VolumeInfo;

export interface PageInfo {
  title: string;
  items: ItemInfo[];
}

export function readPageInfo(): PageInfo {
  const text = document.getElementById('description')?.textContent;
  if (!text) throw new Error('This page holds no mesh: its end is missing.');
  return JSON.parse(text) as PageInfo;
}

/** The element of that id; the page is built together with this program. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`The page has no element "${id}".`);
  return element as T;
}
