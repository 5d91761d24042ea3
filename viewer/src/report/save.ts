// Figures and data as files.

export function save(name: string, content: Blob): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const GAP = 16;
const TITLE = 20;

/** All panels of a figure side by side, two a row, with their titles. */
export function figureSvg(figure: HTMLElement): SVGSVGElement {
  const make = <K extends keyof SVGElementTagNameMap>(name: K): SVGElementTagNameMap[K] =>
    document.createElementNS('http://www.w3.org/2000/svg', name);
  const whole = make('svg');
  let width = 0;
  let height = 0;
  const panels = [...figure.querySelectorAll<HTMLElement>('.panels > figure')];
  for (const [k, panel] of panels.entries()) {
    const drawing = panel.querySelector('svg')!;
    const [w, h] = [Number(drawing.getAttribute('width')), Number(drawing.getAttribute('height'))];
    const x = (k % 2) * (w + GAP);
    const y = Math.floor(k / 2) * (h + TITLE + GAP);
    const title = make('text');
    title.textContent = panel.querySelector('figcaption span')!.textContent;
    title.setAttribute('x', String(x + w / 2));
    title.setAttribute('y', String(y + TITLE - 6));
    title.setAttribute('text-anchor', 'middle');
    const copy = drawing.cloneNode(true) as SVGSVGElement;
    copy.setAttribute('x', String(x));
    copy.setAttribute('y', String(y + TITLE));
    whole.append(title, copy);
    width = Math.max(width, x + w);
    height = Math.max(height, y + TITLE + h);
  }
  whole.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  whole.setAttribute('width', String(width));
  whole.setAttribute('height', String(height));
  whole.setAttribute('viewBox', `0 0 ${width} ${height}`);
  whole.setAttribute('font-family', 'system-ui, sans-serif');
  whole.setAttribute('font-size', '13');
  whole.setAttribute('color', '#1b2330');
  whole.setAttribute('fill', 'currentColor');
  return whole;
}

export function saveSvg(name: string, figure: HTMLElement): void {
  const text = new XMLSerializer().serializeToString(figureSvg(figure));
  save(`${name}.svg`, new Blob([text], { type: 'image/svg+xml' }));
}

export async function savePng(name: string, figure: HTMLElement): Promise<void> {
  const svg = figureSvg(figure);
  const scale = 2;
  const canvas = document.createElement('canvas');
  canvas.width = scale * Number(svg.getAttribute('width'));
  canvas.height = scale * Number(svg.getAttribute('height'));
  const text = new XMLSerializer().serializeToString(svg);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const context = canvas.getContext('2d')!;
  context.fillStyle = '#ffffff';
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => blob && save(`${name}.png`, blob), 'image/png');
}
