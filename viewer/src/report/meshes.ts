// The meshes of an experiment in 3-D: the viewer of `carat view` in a frame.
import type { Experiment } from './data';

/** Frames that are far from the window are taken away: browsers allow few 3-D views at a time. */
const NEAR = '60%';

export class MeshFrame {
  readonly element = document.createElement('figure');
  private frame: HTMLIFrameElement | null = null;
  private wanted: string | null = null;

  constructor(
    private readonly viewer: string,
    private readonly experiment: Experiment,
  ) {
    this.element.className = 'meshes';
    const caption = document.createElement('figcaption');
    caption.textContent = 'The meshes';
    this.element.append(caption);
    new IntersectionObserver(
      (entries) => (entries[entries.length - 1].isIntersecting ? this.open() : this.close()),
      { rootMargin: NEAR },
    ).observe(this.element);
  }

  /** Shows the mesh of this family, if there is one. */
  show(family: string): void {
    this.wanted = family;
    this.open();
    this.choose();
  }

  /** Once more, after the page's colours have changed. */
  restyle(): void {
    if (!this.frame) return;
    this.close();
    this.open();
  }

  private open(): void {
    if (this.frame) return;
    const theme = document.documentElement.dataset['theme'];
    this.frame = document.createElement('iframe');
    this.frame.title = `Meshes of ${this.experiment.title}`;
    // Functions, as the texts may hold what replace() takes for patterns.
    this.frame.srcdoc = this.viewer
      .replace('<html lang="en">', (tag) =>
        theme ? `<html lang="en" data-theme="${theme}">` : tag,
      )
      .replace('<!--carat:title-->', () => 'Meshes')
      .replace('<!--carat:data-->', () => this.experiment.view!);
    this.frame.addEventListener('load', () => this.choose());
    this.element.append(this.frame);
  }

  private close(): void {
    this.frame?.remove();
    this.frame = null;
  }

  /** Uses the viewer's own choice of meshes, a list or a row of buttons. */
  private choose(): void {
    const place = this.frame?.contentDocument?.getElementById('meshes');
    if (!place || this.wanted === null) return;
    const fits = (text: string | null): boolean => text === this.wanted;
    [...place.querySelectorAll('button')].find((button) => fits(button.textContent))?.click();
    const list = place.querySelector('select');
    const option = list && [...list.options].find((candidate) => fits(candidate.text));
    if (!list || !option) return;
    list.value = option.value;
    list.dispatchEvent(new Event('change'));
  }
}
