import type { ClipActions } from './keys';
import { count, digitsFor, format, parse } from './numbers';
import { byId } from './page';
import type { Clip, ClipMode, ClipResult, Solid } from './solid';
import type { View } from './view';

type Normal = [number, number, number];

const axisNormals: Record<string, Normal> = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const modes: ClipMode[] = ['none', 'cut', 'cells'];

/** Seconds that the moving plane takes from one end of the mesh to the other. */
const sweepTime = 6;

/** Three numbers as a unit vector; null if they are no direction. */
function parseNormal(text: string): Normal | null {
  const numbers = text.trim().split(/[\s,;]+/).map(parse);
  const length = Math.hypot(...numbers);
  if (numbers.length !== 3 || !Number.isFinite(length) || !(length > 0)) return null;
  const [x, y, z] = numbers.map((k) => k / length);
  return [x, y, z];
}

/** The controls of what only volumes have: the clip plane, shrink, explode, patches. */
export class Clipping {
  private solid: Solid | null = null;
  private normal: Normal = [0, 0, 1];
  /** Along the normal, in the stored unit. */
  private level = 0;
  private low = 0;
  private high = 0;
  private flipped = false;
  private playing = false;
  private scheduled = false;
  private readonly controls = byId('volume-controls');
  private readonly mode = byId<HTMLSelectElement>('clip-mode');
  private readonly axis = byId<HTMLSelectElement>('clip-axis');
  private readonly normalText = byId<HTMLInputElement>('clip-normal');
  private readonly position = byId<HTMLInputElement>('clip-position');
  private readonly levelText = byId<HTMLInputElement>('clip-level');
  private readonly playButton = byId<HTMLButtonElement>('clip-play');
  private readonly shrink = byId<HTMLInputElement>('shrink');
  private readonly explode = byId<HTMLInputElement>('explode');

  /** \param changed  called when another part of the mesh is shown, or at other places */
  constructor(
    private readonly view: View,
    private readonly changed: () => void,
  ) {
    const on = (element: HTMLElement, event: string, action: () => void): void =>
      element.addEventListener(event, action);
    on(this.mode, 'change', () => this.setMode(this.mode.value as ClipMode));
    on(this.axis, 'change', () => this.chooseAxis());
    on(this.normalText, 'change', () => this.readNormal());
    on(byId('clip-facing'), 'click', () => this.face());
    on(this.position, 'input', () => this.setFraction(Number(this.position.value)));
    on(this.levelText, 'change', () => this.readLevel());
    on(byId('clip-flip'), 'click', () => this.actions.flip());
    on(this.playButton, 'click', () => this.actions.play());
    for (const slider of [this.shrink, this.explode])
      on(slider, 'input', () => this.moveApart());
  }

  readonly actions: ClipActions = {
    stepMode: () => this.setMode(modes[(modes.indexOf(this.clipMode) + 1) % modes.length]),
    setAxis: (axis) => {
      if (!this.solid) return;
      this.axis.value = axis;
      if (this.clipMode === 'none') this.mode.value = 'cut';
      this.chooseAxis();
    },
    move: (by) => this.setFraction(this.fraction + by / 100),
    flip: () => {
      this.flipped = !this.flipped;
      this.update();
    },
    play: () => this.setPlaying(!this.playing),
    stepShrink: (by) => this.step(this.shrink, by),
    stepExplode: (by) => this.step(this.explode, by),
  };

  /** Controls another mesh: nothing clipped, in one piece. */
  show(solid: Solid | null): void {
    this.setPlaying(false);
    this.solid = solid;
    this.controls.hidden = !solid;
    if (!solid) return;
    this.mode.value = 'none';
    this.axis.value = 'x';
    this.shrink.value = this.explode.value = '0';
    this.fillPatches(solid);
    this.setNormal([1, 0, 0]);
    this.moveApart();
  }

  private get clipMode(): ClipMode {
    return this.mode.value as ClipMode;
  }

  private get fraction(): number {
    return this.high > this.low ? (this.level - this.low) / (this.high - this.low) : 0.5;
  }

  private setMode(mode: ClipMode): void {
    if (!this.solid) return;
    this.mode.value = mode;
    if (mode === 'none') this.setPlaying(false);
    this.update();
  }

  private chooseAxis(): void {
    const normal = axisNormals[this.axis.value];
    if (normal) this.setNormal(normal);
    else this.face();
  }

  /** The plane across `normal` in the middle of the mesh; what is cut open is seen. */
  private setNormal(normal: Normal): void {
    if (!this.solid) return;
    this.normal = normal;
    ({ low: this.low, high: this.high } = this.solid.levels(normal));
    this.level = (this.low + this.high) / 2;
    const { x, y, z } = this.view.towardsCamera;
    this.flipped = normal[0] * x + normal[1] * y + normal[2] * z < 0;
    this.normalText.value = normal.map((k) => format(Math.round(1e4 * k) / 1e4, 4)).join(', ');
    this.update();
  }

  /** Across the line of sight. */
  private face(): void {
    const { x, y, z } = this.view.towardsCamera;
    this.axis.value = 'free';
    this.setNormal([x, y, z]);
  }

  private readNormal(): void {
    const normal = parseNormal(this.normalText.value);
    this.normalText.setCustomValidity(normal ? '' : 'Three numbers that are not all 0');
    if (this.normalText.reportValidity() && normal) this.setNormal(normal);
  }

  private setFraction(fraction: number): void {
    const bounded = Math.min(1, Math.max(0, fraction));
    this.level = this.low + bounded * (this.high - this.low);
    this.update();
  }

  /** Height of the stored origin along the normal, in the mesh's unit. */
  private get base(): number {
    const centre = this.solid?.info.centre ?? [0, 0, 0];
    return this.normal.reduce((sum, k, i) => sum + k * centre[i], 0);
  }

  private readLevel(): void {
    const height = parse(this.levelText.value);
    if (this.solid && Number.isFinite(height))
      this.level = (height - this.base) / this.solid.info.scale;
    this.update();
  }

  private setPlaying(playing: boolean): void {
    if (playing && !this.solid) return;
    const starts = playing && !this.playing;
    this.playing = playing;
    this.playButton.setAttribute('aria-pressed', String(playing));
    this.playButton.textContent = playing ? 'Pause' : 'Play';
    if (!starts) return;
    if (this.clipMode === 'none') this.setMode('cut');
    let last = performance.now();
    let direction = 1;
    const step = (now: number): void => {
      if (!this.playing) return;
      const fraction = this.fraction + (direction * (now - last)) / (1000 * sweepTime);
      last = now;
      if (fraction >= 1) direction = -1;
      if (fraction <= 0) direction = 1;
      this.setFraction(fraction);
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  private step(slider: HTMLInputElement, by: number): void {
    if (!this.solid) return;
    slider.value = String(Number(slider.value) + 0.05 * by);
    this.moveApart();
  }

  private moveApart(): void {
    const [shrink, explode] = [Number(this.shrink.value), Number(this.explode.value)];
    byId('shrink-text').textContent = `${Math.round(100 * shrink)} %`;
    byId('explode-text').textContent = `${Math.round(100 * explode)} %`;
    this.update();
  }

  /** Once before the next picture, however often the plane moves until then. */
  private update(): void {
    this.showControls();
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.apply();
    });
  }

  private apply(): void {
    if (!this.solid) return;
    const sign = this.flipped ? -1 : 1;
    const [x, y, z] = this.normal;
    const clip: Clip = {
      mode: this.clipMode,
      normal: [sign * x, sign * y, sign * z],
      level: sign * this.level,
    };
    const apart = { size: 1 - Number(this.shrink.value), explode: Number(this.explode.value) };
    byId('clip-note').textContent = this.noteOf(this.solid.show(clip, apart));
    this.changed();
  }

  private showControls(): void {
    if (!this.solid) return;
    byId('clip-plane').hidden = this.clipMode === 'none';
    byId('clip-free').hidden = this.axis.value !== 'free';
    this.position.value = String(this.fraction);
    const { scale } = this.solid.info;
    // To about a ten-thousandth of the mesh, so that 0 is not a number like 1e-17.
    const grain = 10 ** Math.floor(Math.log10(scale * (this.high - this.low) || 1) - 4);
    const height = Math.round((this.base + scale * this.level) / grain) * grain;
    this.levelText.value = format(height, digitsFor(height, 1e4 * grain, 5));
    this.position.setAttribute('aria-valuetext', this.levelText.value);
  }

  private noteOf({ nCells, area, complete }: ClipResult): string {
    const parts: string[] = [];
    if (this.clipMode === 'cut') parts.push(`${count(nCells)} cells cut, area ${format(area)}.`);
    if (this.clipMode === 'cells') parts.push(`${count(nCells)} cells shown.`);
    if (!complete) parts.push('Of so many cells, only the outer ones are drawn apart.');
    return parts.join(' ');
  }

  private fillPatches(solid: Solid): void {
    const { patches } = solid.info;
    byId('patches').hidden = patches.length === 0;
    byId('patch-list').replaceChildren(
      ...patches.map(({ name }, i) => {
        const label = document.createElement('label');
        label.className = 'switch';
        const box = document.createElement('input');
        box.type = 'checkbox';
        box.checked = true;
        box.addEventListener('change', () => {
          solid.setPatchHidden(i, !box.checked);
          this.changed();
        });
        label.append(box, name);
        return label;
      }),
    );
  }
}
