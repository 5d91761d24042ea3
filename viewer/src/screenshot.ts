import { drawBar, type LegendState } from './legend';
import type { View } from './view';

/** Below the mesh, in CSS pixels. */
const legendHeight = 68;

function drawLegend(
  context: CanvasRenderingContext2D,
  legend: LegendState,
  ratio: number,
  ink: string,
): void {
  const { width, height } = context.canvas;
  const barWidth = Math.min(420 * ratio, 0.8 * width);
  const barHeight = 14 * ratio;
  const x = (width - barWidth) / 2;
  const y = height - 40 * ratio;
  drawBar(context, legend, x, y, barWidth, barHeight);
  context.fillStyle = ink;
  context.textAlign = 'center';
  context.font = `600 ${13 * ratio}px system-ui, sans-serif`;
  context.fillText(legend.name, width / 2, y - 8 * ratio);
  context.font = `${12 * ratio}px system-ui, sans-serif`;
  for (const { at, text } of legend.ticks)
    context.fillText(text, x + at * barWidth, y + barHeight + 16 * ratio);
}

/** The picture as it stands, with the colour bar, on the page's background. */
export function takePicture(view: View, legend: LegendState | null): Promise<Blob> {
  view.drawNow();
  const source = view.renderer.domElement;
  const picture = document.createElement('canvas');
  picture.width = source.width;
  const ratio = view.renderer.getPixelRatio();
  picture.height = source.height + (legend ? legendHeight * ratio : 0);
  const context = picture.getContext('2d');
  if (!context) return Promise.reject(new Error('The browser cannot draw a picture.'));
  const style = getComputedStyle(document.documentElement);
  context.fillStyle = style.getPropertyValue('--background');
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(source, 0, 0);
  if (legend) drawLegend(context, legend, ratio, style.getPropertyValue('--ink'));
  return new Promise((resolve, reject) =>
    picture.toBlob((blob) => {
      if (blob) resolve(blob);
      else reject(new Error('The browser cannot save the picture.'));
    }, 'image/png'),
  );
}

export function download(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
