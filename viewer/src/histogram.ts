import type { Range, Scalars } from './fields';

const nBins = 80;

/** How often the values occur over the slider's span; bars outside the range are pale. */
export function drawHistogram(
  canvas: HTMLCanvasElement,
  scalars: Scalars,
  domain: Range,
  range: Range,
): void {
  const context = canvas.getContext('2d');
  const span = domain.high - domain.low;
  if (!context) return;
  const ratio = window.devicePixelRatio;
  const { clientWidth: width, clientHeight: height } = canvas;
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  if (!(span > 0)) return;
  const counts = new Float64Array(nBins);
  for (const stored of scalars.sorted) {
    const value = scalars.offset + scalars.scale * stored;
    const bin = Math.floor(((value - domain.low) / span) * nBins);
    ++counts[Math.min(nBins - 1, Math.max(0, bin))];
  }
  const highest = Math.max(1, ...counts);
  const style = getComputedStyle(canvas);
  context.scale(ratio, ratio);
  context.fillStyle = style.color;
  for (let bin = 0; bin < nBins; ++bin) {
    const middle = domain.low + ((bin + 0.5) / nBins) * span;
    context.globalAlpha = middle >= range.low && middle <= range.high ? 0.75 : 0.25;
    // The square root keeps rare values visible.
    const bar = height * Math.sqrt(counts[bin] / highest);
    context.fillRect((bin / nBins) * width, height - bar, width / nBins - 0.5, bar);
  }
}
