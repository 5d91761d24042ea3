import { byId, type ItemInfo } from './page';

const maxTabs = 6;

/** Chooses among the meshes of the page: buttons in a row, or a list where there are many. */
export class MeshChooser {
  private readonly buttons: HTMLButtonElement[] = [];
  private readonly select: HTMLSelectElement | null = null;

  constructor(items: ItemInfo[], choose: (item: number) => void) {
    const place = byId('meshes');
    place.hidden = items.length < 2;
    if (items.length > maxTabs) {
      const select = document.createElement('select');
      select.setAttribute('aria-label', 'Mesh');
      select.append(...items.map(({ title }, i) => new Option(title, String(i))));
      select.addEventListener('change', () => choose(Number(select.value)));
      place.append(select);
      this.select = select;
      return;
    }
    place.setAttribute('role', 'group');
    place.setAttribute('aria-label', 'Mesh');
    this.buttons = items.map(({ title }, i) => {
      const button = document.createElement('button');
      button.textContent = title;
      button.addEventListener('click', () => choose(i));
      return button;
    });
    place.append(...this.buttons);
  }

  mark(item: number): void {
    if (this.select) this.select.value = String(item);
    this.buttons.forEach((button, i) => button.setAttribute('aria-pressed', String(i === item)));
  }
}
