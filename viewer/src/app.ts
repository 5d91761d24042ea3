import { Clipping } from './clipping';
import { Coloring } from './coloring';
import { channelsOf, loadField, type Channel } from './fields';
import { Glyphs } from './glyphs';
import { fillHelp, listenToKeys, openHelp } from './keys';
import { Marker } from './marker';
import { loadMesh } from './mesh';
import { MeshChooser } from './meshes';
import { count, parse } from './numbers';
import { byId, type FieldInfo, type ItemInfo, type PageInfo, type Place } from './page';
import { hidePicked, showPicked } from './picked';
import { download, takePicture } from './screenshot';
import type { Pick, Shape } from './shape';
import { Solid } from './solid';
import { Surface } from './surface';
import { onSystemTheme, themeColors, toggleTheme } from './theme';
import { View, type Axis } from './view';
import { loadVolume } from './volume';

/** What belongs to the mesh that is shown. */
interface Shown {
  shape: Shape;
  glyphs: Glyphs | null;
  channels: Channel[];
  vectors: FieldInfo[];
}

async function loadShape(info: ItemInfo, progress: (fraction: number) => void): Promise<Shape> {
  if (info.kind === 'volume') return new Solid(await loadVolume(info, progress));
  return new Surface(await loadMesh(info, progress));
}

export class App {
  private readonly view: View;
  private readonly coloring: Coloring;
  private readonly clipping: Clipping;
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
      this.shown?.shape.setScreen(pixelsPerUnit, nearest, this.edgesBox.checked),
    );
    this.coloring = new Coloring(() => this.view.draw());
    this.clipping = new Clipping(this.view, () => this.followClip());
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
    const shape = await loadShape(this.page.items[index], (fraction) => (bar.value = fraction));
    if (index !== this.current) {
      shape.dispose();
      return;
    }
    const lastLabel = this.fieldSelect.selectedOptions[0]?.text;
    this.replaceShown(shape);
    await this.colorBy(this.firstChannel(lastLabel));
    this.fit();
    this.clipping.show(shape instanceof Solid ? shape : null);
    message.hidden = true;
    document.documentElement.dataset['state'] = 'ready';
  }

  private replaceShown(shape: Shape): void {
    this.clearPick();
    if (this.shown) {
      for (const old of [this.shown.shape, this.shown.glyphs])
        if (old) {
          this.view.scene.remove(old.object);
          old.dispose();
        }
    }
    this.view.scene.add(shape.object);
    this.view.setRadius(shape.radius);
    const { fields, title } = shape.info;
    this.shown = {
      shape,
      glyphs: null,
      channels: channelsOf(fields),
      vectors: fields.filter((field) => field.components === 3),
    };
    this.flatBox.checked = false;
    this.fillSelects(this.shown);
    this.paint();
    byId('info').textContent = `${title}: ${shape.counts()}`;
  }

  /** After the clip, or the cells' places, changed. */
  private followClip(): void {
    if (!this.shown) return;
    this.view.setRadius(this.shown.shape.radius);
    this.clipGlyphs(this.shown);
    if (this.marker.object.visible) this.clearPick();
    this.view.draw();
  }

  private clipGlyphs({ shape, glyphs }: Shown): void {
    if (!glyphs) return;
    glyphs.setPlane(shape.plane);
    glyphs.object.visible = !shape.isApart;
  }

  private fillSelects({ channels, vectors }: Shown): void {
    const group = (label: string, options: HTMLOptionElement[]): HTMLElement[] => {
      if (options.length === 0) return [];
      const element = document.createElement('optgroup');
      element.label = label;
      element.append(...options);
      return [element];
    };
    const options = (on: Place): HTMLOptionElement[] =>
      channels.flatMap((channel, i) =>
        channel.field.on === on ? [new Option(channel.label, String(i))] : [],
      );
    this.fieldSelect.replaceChildren(
      new Option('nothing', '-1'),
      ...group('At vertices', options('vertex')),
      ...group('On faces', options('face')),
      ...group('In cells', options('cell')),
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
    await this.coloring.show(this.shown.shape, this.shown.channels[index] ?? null);
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
      shown.glyphs = new Glyphs(shown.shape.origins(field.on), values);
      this.view.scene.add(shown.glyphs.object);
      this.setGlyphLength();
      this.clipGlyphs(shown);
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
    this.shown?.shape.setTheme(colors);
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
    on('previous-field', 'click', () => this.stepField(-1));
    on('next-field', 'click', () => this.stepField(1));
    on('glyphs', 'change', () => this.run(this.showGlyphs(Number(this.glyphSelect.value))));
    on('glyph-length', 'input', () => this.setGlyphLength());
    on('edges', 'change', () => this.view.draw());
    on('flat', 'change', () => {
      this.shown?.shape.setFlat(this.flatBox.checked);
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
      clip: this.clipping.actions,
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
      const pick = this.shown.shape.pick(origin, direction);
      if (pick) this.run(this.show(pick));
      else this.clearPick();
    });
  }

  private async show(pick: Pick): Promise<void> {
    if (!this.shown) return;
    this.marker.show(...pick.marker);
    this.view.draw();
    await showPicked(this.shown.shape.info, pick, () => this.clearPick());
  }

  private clearPick(): void {
    hidePicked();
    this.marker.hide();
    this.view.draw();
  }

  private goToVertex(): void {
    const input = byId<HTMLInputElement>('vertex');
    const vertex = parse(input.value);
    const n = this.shown?.shape.info.vertices ?? 0;
    const exists = Number.isInteger(vertex) && vertex >= 0 && vertex < n;
    input.setCustomValidity(exists ? '' : `A number from 0 to ${n - 1}`);
    if (!input.reportValidity() || !this.shown) return;
    const pick = this.shown.shape.pickVertex(vertex);
    this.view.lookAt(...pick.marker);
    this.run(this.show(pick));
  }

  /** Through the fields in a circle; "nothing" is only there where there are none. */
  private stepField(by: number): void {
    const n = this.shown?.channels.length ?? 0;
    if (n === 0) return;
    const last = Number(this.fieldSelect.value);
    this.run(this.colorBy(last < 0 && by < 0 ? n - 1 : (last + by + n) % n));
  }

  private stepMesh(by: number): void {
    const n = this.page.items.length;
    this.run(this.showMesh((this.current + by + n) % n));
  }

  private fit(up?: Axis): void {
    if (!this.shown) return;
    this.view.fit(this.shown.shape.extent, up);
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
    const title = this.shown?.shape.info.title ?? this.page.title;
    const blob = await takePicture(this.view, this.coloring.legend.current);
    download(blob, `${title.replace(/[^\p{L}\p{N}._-]+/gu, '-') || 'mesh'}.png`);
  }
}
