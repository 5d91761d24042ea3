import { Coloring } from './coloring';
import { Edges } from './edges';
import { channelsOf, loadField, type Channel } from './fields';
import { Glyphs } from './glyphs';
import { fillHelp, listenToKeys, openHelp } from './keys';
import { Marker } from './marker';
import { loadMesh, type Mesh } from './mesh';
import { MeshChooser } from './meshes';
import { count, parse } from './numbers';
import { byId, type FieldInfo, type PageInfo } from './page';
import { hidePicked, showPicked } from './picked';
import { pickAlong, type Pick } from './picking';
import { download, takePicture } from './screenshot';
import { Surface } from './surface';
import { onSystemTheme, themeColors, toggleTheme } from './theme';
import { View, type Axis } from './view';

/** What belongs to the mesh that is shown. */
interface Shown {
  mesh: Mesh;
  surface: Surface;
  edges: Edges;
  glyphs: Glyphs | null;
  channels: Channel[];
  vectors: FieldInfo[];
}

export class App {
  private readonly view: View;
  private readonly coloring: Coloring;
  private readonly marker: Marker;
  private readonly meshes: MeshChooser;
  private shown: Shown | null = null;
  private current = -1;
  private readonly fieldSelect = byId<HTMLSelectElement>('field');
  private readonly glyphSelect = byId<HTMLSelectElement>('glyphs');
  private readonly edgesBox = byId<HTMLInputElement>('edges');
  private readonly flatBox = byId<HTMLInputElement>('flat');

  constructor(
    private readonly page: PageInfo,
    private readonly fail: (error: unknown) => void,
  ) {
    document.title = page.title;
    byId('title').textContent = page.title;
    this.view = new View(byId<HTMLCanvasElement>('canvas'), (pixelsPerUnit, nearest) =>
      this.shown?.edges.setScreen(pixelsPerUnit, nearest, this.edgesBox.checked),
    );
    this.coloring = new Coloring(() => this.view.draw());
    this.marker = new Marker(this.view.renderer.getPixelRatio());
    this.view.scene.add(this.marker.object);
    this.meshes = new MeshChooser(page.items, (item) => this.run(this.showMesh(item)));
    fillHelp();
    this.connectControls();
    this.connectPicking();
    if (window.innerWidth < 700) this.togglePanel();
  }

  /** Decodes and shows item `index`; the last one stays in sight until then. */
  async showMesh(index: number): Promise<void> {
    if (index === this.current) return;
    this.current = index;
    this.meshes.mark(index);
    document.documentElement.dataset['state'] = 'loading';
    const message = byId('message');
    const bar = byId<HTMLProgressElement>('progress');
    byId('message-text').textContent = 'Reading the mesh …';
    message.hidden = false;
    const mesh = await loadMesh(this.page.items[index], (fraction) => (bar.value = fraction));
    if (index !== this.current) return;
    const lastLabel = this.fieldSelect.selectedOptions[0]?.text;
    this.replaceShown(mesh);
    await this.colorBy(this.firstChannel(lastLabel));
    this.view.fit(mesh);
    byId<HTMLSelectElement>('up').value = this.view.up;
    message.hidden = true;
    document.documentElement.dataset['state'] = 'ready';
  }

  private replaceShown(mesh: Mesh): void {
    this.clearPick();
    if (this.shown) {
      const { surface, edges, glyphs } = this.shown;
      for (const old of [surface, edges, glyphs])
        if (old) {
          this.view.scene.remove(old.object);
          old.dispose();
        }
    }
    const surface = new Surface(mesh);
    const edges = new Edges(mesh);
    edges.object.renderOrder = 1;
    this.view.scene.add(surface.object, edges.object);
    const { fields } = mesh.info;
    this.shown = {
      mesh,
      surface,
      edges,
      glyphs: null,
      channels: channelsOf(fields),
      vectors: fields.filter((field) => field.components === 3),
    };
    this.flatBox.checked = false;
    this.fillSelects(this.shown);
    this.paint();
    byId('info').textContent =
      `${mesh.info.title}: ${count(mesh.info.vertices)} vertices, ` +
      `${count(mesh.info.edges)} edges, ${count(mesh.nFaces)} faces`;
  }

  private fillSelects({ channels, vectors }: Shown): void {
    const group = (label: string, options: HTMLOptionElement[]): HTMLElement[] => {
      if (options.length === 0) return [];
      const element = document.createElement('optgroup');
      element.label = label;
      element.append(...options);
      return [element];
    };
    const options = (on: 'vertex' | 'face'): HTMLOptionElement[] =>
      channels.flatMap((channel, i) =>
        channel.field.on === on ? [new Option(channel.label, String(i))] : [],
      );
    this.fieldSelect.replaceChildren(
      new Option('nothing', '-1'),
      ...group('At vertices', options('vertex')),
      ...group('On faces', options('face')),
    );
    this.glyphSelect.replaceChildren(
      new Option('none', '-1'),
      ...vectors.map((field, i) => new Option(field.name, String(i))),
    );
    byId('glyph-controls').hidden = vectors.length === 0;
    byId('glyph-size').hidden = true;
    byId('glyph-note').textContent = '';
  }

  /** The channel called as the last one, else the first. */
  private firstChannel(lastLabel: string | undefined): number {
    const channels = this.shown?.channels ?? [];
    const same = channels.findIndex(({ label }) => label === lastLabel);
    return same >= 0 ? same : channels.length > 0 ? 0 : -1;
  }

  private async colorBy(index: number): Promise<void> {
    if (!this.shown) return;
    this.fieldSelect.value = String(index);
    await this.coloring.show(this.shown.surface, this.shown.channels[index] ?? null);
  }

  private async showGlyphs(index: number): Promise<void> {
    const { shown } = this;
    if (!shown) return;
    const field = shown.vectors[index];
    const values = field ? await loadField(field) : null;
    if (shown.glyphs) {
      this.view.scene.remove(shown.glyphs.object);
      shown.glyphs.dispose();
      shown.glyphs = null;
    }
    if (field && values) {
      shown.glyphs = new Glyphs(shown.mesh, field, values);
      this.view.scene.add(shown.glyphs.object);
      this.setGlyphLength();
    }
    byId('glyph-size').hidden = !shown.glyphs;
    byId('glyph-note').textContent = shown.glyphs
      ? `${count(shown.glyphs.nShown)} of ${count(shown.glyphs.nAll)} shown`
      : '';
    this.paint();
  }

  private setGlyphLength(): void {
    this.shown?.glyphs?.setLength(10 ** Number(byId<HTMLInputElement>('glyph-length').value));
    this.view.draw();
  }

  /** Takes the colours of the page's theme. */
  private paint(): void {
    const colors = themeColors();
    this.shown?.surface.setPlainColors(colors.surface, colors.noValue);
    this.shown?.edges.setColor(colors.edges);
    this.shown?.glyphs?.setColor(colors.glyphs);
    this.view.draw();
  }

  private restyle(): void {
    this.paint();
    this.coloring.restyle();
  }

  private run(work: Promise<void>): void {
    work.catch(this.fail);
  }

  private connectControls(): void {
    const on = (id: string, event: string, action: () => void): void =>
      byId(id).addEventListener(event, action);
    on('field', 'change', () => this.run(this.colorBy(Number(this.fieldSelect.value))));
    on('glyphs', 'change', () => this.run(this.showGlyphs(Number(this.glyphSelect.value))));
    on('glyph-length', 'input', () => this.setGlyphLength());
    on('edges', 'change', () => this.view.draw());
    on('flat', 'change', () => {
      this.shown?.surface.setFlat(this.flatBox.checked);
      this.view.draw();
    });
    on('up', 'change', () => this.fit(byId<HTMLSelectElement>('up').value as Axis));
    on('fit', 'click', () => this.fit());
    on('screenshot', 'click', () => this.run(this.picture()));
    on('theme', 'click', () => this.switchTheme());
    on('help', 'click', openHelp);
    on('toggle-panel', 'click', () => this.togglePanel());
    onSystemTheme(() => this.restyle());
    byId('go-to').addEventListener('submit', (event) => {
      event.preventDefault();
      this.goToVertex();
    });
    listenToKeys(this.view, {
      fit: () => this.fit(),
      toggleEdges: () => this.edgesBox.click(),
      toggleIsolines: () => this.coloring.toggleIsolines(),
      stepField: (by) => this.stepField(by),
      stepMesh: (by) => this.stepMesh(by),
      picture: () => this.run(this.picture()),
      toggleTheme: () => this.switchTheme(),
      togglePanel: () => this.togglePanel(),
      clearPick: () => this.clearPick(),
    });
  }

  /** A press that does not move is a pick; everything else turns the mesh. */
  private connectPicking(): void {
    let down: PointerEvent | null = null;
    this.view.canvas.addEventListener('pointerdown', (event) => {
      down = event.isPrimary && event.button === 0 ? event : null;
    });
    this.view.canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 5)
        return;
      down = null;
      if (!this.shown) return;
      const { origin, direction } = this.view.rayThrough(event.clientX, event.clientY);
      const pick = pickAlong(this.shown.mesh, origin, direction);
      if (pick) this.run(this.show(pick));
      else this.clearPick();
    });
  }

  private async show(pick: Pick): Promise<void> {
    if (!this.shown) return;
    const { mesh } = this.shown;
    const [x, y, z] = mesh.positions.subarray(3 * pick.vertex, 3 * pick.vertex + 3);
    this.marker.show(x, y, z);
    this.view.draw();
    await showPicked(mesh, pick, () => this.clearPick());
  }

  private clearPick(): void {
    hidePicked();
    this.marker.hide();
    this.view.draw();
  }

  private goToVertex(): void {
    const input = byId<HTMLInputElement>('vertex');
    const vertex = parse(input.value);
    const n = this.shown?.mesh.info.vertices ?? 0;
    const exists = Number.isInteger(vertex) && vertex >= 0 && vertex < n;
    input.setCustomValidity(exists ? '' : `A number from 0 to ${n - 1}`);
    if (!input.reportValidity() || !this.shown) return;
    const [x, y, z] = this.shown.mesh.positions.subarray(3 * vertex, 3 * vertex + 3);
    this.view.lookAt(x, y, z);
    this.run(this.show({ vertex, face: -1 }));
  }

  private stepField(by: number): void {
    const n = this.fieldSelect.options.length;
    this.fieldSelect.selectedIndex = (this.fieldSelect.selectedIndex + by + n) % n;
    this.run(this.colorBy(Number(this.fieldSelect.value)));
  }

  private stepMesh(by: number): void {
    const n = this.page.items.length;
    this.run(this.showMesh((this.current + by + n) % n));
  }

  private fit(up?: Axis): void {
    if (!this.shown) return;
    this.view.fit(this.shown.mesh, up);
    byId<HTMLSelectElement>('up').value = this.view.up;
  }

  private switchTheme(): void {
    toggleTheme();
    this.restyle();
  }

  private togglePanel(): void {
    const closed = document.body.classList.toggle('panel-closed');
    byId('toggle-panel').setAttribute('aria-expanded', String(!closed));
    this.coloring.restyle();
  }

  private async picture(): Promise<void> {
    const title = this.shown?.mesh.info.title ?? this.page.title;
    const blob = await takePicture(this.view, this.coloring.legend.current);
    download(blob, `${title.replace(/[^\p{L}\p{N}._-]+/gu, '-') || 'mesh'}.png`);
  }
}
