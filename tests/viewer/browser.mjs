// A headless Chromium with one page, and what the checks ask of it.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { inflateSync } from 'node:zlib';

/** RGB rows of a PNG of 8-bit RGB or RGBA without interlacing, as browsers write it. */
export function decodePng(png) {
  assert.equal(png.toString('latin1', 1, 4), 'PNG');
  const width = png.readUInt32BE(16);
  const height = png.readUInt32BE(20);
  const channels = { 2: 3, 6: 4 }[png[25]];
  const data = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at))
    if (png.toString('latin1', at + 4, at + 8) === 'IDAT')
      data.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  const raw = inflateSync(Buffer.concat(data));
  const stride = width * channels;
  const pixels = new Uint8Array(stride * height);
  for (let y = 0; y < height; ++y) {
    const filter = raw[y * (stride + 1)];
    for (let x = 0; x < stride; ++x) {
      const left = x >= channels ? pixels[y * stride + x - channels] : 0;
      const up = y > 0 ? pixels[(y - 1) * stride + x] : 0;
      const corner = x >= channels && y > 0 ? pixels[(y - 1) * stride + x - channels] : 0;
      const guess = left + up - corner;
      const paeth = [left, up, corner].reduce((best, value) =>
        Math.abs(value - guess) < Math.abs(best - guess) ? value : best,
      );
      const prediction = [0, left, up, (left + up) >> 1, paeth][filter];
      pixels[y * stride + x] = raw[y * (stride + 1) + 1 + x] + prediction;
    }
  }
  return { width, height, channels, pixels };
}

function differs(a, i, b, j) {
  return [0, 1, 2].some((k) => Math.abs(a.pixels[i + k] - b.pixels[j + k]) > 12);
}

/** Fraction of the pixels that differ visibly. */
export function change(a, b) {
  assert.equal(a.pixels.length, b.pixels.length);
  let n = 0;
  for (let i = 0; i < a.pixels.length; i += a.channels) n += differs(a, i, b, i);
  return n / (a.width * a.height);
}

/** Fraction of the pixels unlike the first one, which shows the background. */
export function drawn(image) {
  let n = 0;
  for (let i = 0; i < image.pixels.length; i += image.channels) n += differs(image, i, image, 0);
  return n / (image.width * image.height);
}

export function near(actual, wanted, relative) {
  const bound = relative * Math.max(Math.abs(wanted), Number.MIN_VALUE);
  assert.ok(Math.abs(actual - wanted) <= bound, `${actual} is not ${wanted} within ${bound}`);
}

/** \param packages  a folder whose node_modules hold playwright-core */
export async function openBrowser(packages, executablePath) {
  const { chromium } = createRequire(resolve(packages, 'package.json'))('playwright-core');
  const profile = mkdtempSync(join(tmpdir(), 'carat-viewer-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath,
    headless: true,
    acceptDownloads: true,
    viewport: { width: 900, height: 700 },
    colorScheme: 'light',
    args: [
      '--no-sandbox',
      '--use-gl=angle',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--disable-background-networking',
      '--disable-component-update',
      '--no-first-run',
    ],
  });
  const page = await context.newPage();
  const complaints = [];
  const requests = [];
  page.on('console', (message) => {
    // Software rendering is slow at reading pixels back, and says so.
    if (!/GPU stall due to ReadPixels/.test(message.text()))
      complaints.push(`${message.type()}: ${message.text()}`);
  });
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => requests.push(request.url()));

  /** Waits until what was asked for is drawn, however slow the machine is. */
  async function settle() {
    await page.waitForTimeout(100);
    await page.evaluate(
      () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
    );
  }

  /** The mesh as it is drawn now, without the controls around it. */
  async function look() {
    await settle();
    await page.waitForTimeout(150);
    const box = await page.locator('#canvas').boundingBox();
    const clip = { x: box.x + 10, y: box.y + 10, width: box.width - 20, height: box.height - 20 };
    return decodePng(await page.screenshot({ clip }));
  }

  function ready() {
    return page.waitForFunction(
      () => ['ready', 'failed'].includes(document.documentElement.dataset.state),
      null,
      { timeout: 60000 },
    );
  }

  async function readPicked(name) {
    const row = page.locator('#picked tr', { has: page.locator(`th:text-is("${name}")`) });
    return (await row.first().locator('td').innerText()).replaceAll('−', '-');
  }

  async function close() {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  }

  /** That the page asked nothing of anyone, and that no error or warning was logged. */
  function assertSilent(address) {
    const foreign = requests.filter((url) => url !== address && !/^(data|blob):/.test(url));
    assert.deepEqual(foreign, []);
    assert.deepEqual(complaints, []);
  }

  return { page, settle, look, ready, readPicked, assertSilent, close };
}

/** Runs checks in order, goes on after one that fails, and sets the exit code. */
export async function run(checks, close) {
  let nFailed = 0;
  try {
    for (const [name, check] of Object.entries(checks)) {
      try {
        await check();
        console.log(`ok      ${name}`);
      } catch (error) {
        ++nFailed;
        console.log(`FAILED  ${name}\n${error.message}`);
      }
    }
  } finally {
    await close();
  }
  process.exitCode = nFailed > 0 ? 1 : 0;
}
