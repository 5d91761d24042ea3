// node check_page.mjs PACKAGES CHROMIUM PAGES: looks at PAGES/page.html in headless Chromium.
// PACKAGES is a folder whose node_modules hold playwright-core.
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { inflateSync } from 'node:zlib';

const [packages, executablePath, pages] = process.argv.slice(2);
const { chromium } = createRequire(resolve(packages, 'package.json'))('playwright-core');
const expected = JSON.parse(readFileSync(join(pages, 'expected.json'), 'utf8'));
const address = pathToFileURL(resolve(pages, 'page.html')).href;

/** RGB rows of a PNG of 8-bit RGB or RGBA without interlacing, as browsers write it. */
function decodePng(png) {
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
function change(a, b) {
  assert.equal(a.pixels.length, b.pixels.length);
  let n = 0;
  for (let i = 0; i < a.pixels.length; i += a.channels) n += differs(a, i, b, i);
  return n / (a.width * a.height);
}

/** Fraction of the pixels unlike the first one, which shows the background. */
function drawn(image) {
  let n = 0;
  for (let i = 0; i < image.pixels.length; i += image.channels) n += differs(image, i, image, 0);
  return n / (image.width * image.height);
}

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

/** The mesh as it is drawn now, without the controls around it. */
async function look() {
  await page.waitForTimeout(250);
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

function near(actual, wanted, relative) {
  const bound = relative * Math.max(Math.abs(wanted), Number.MIN_VALUE);
  assert.ok(Math.abs(actual - wanted) <= bound, `${actual} is not ${wanted} within ${bound}`);
}

const checks = {
  async 'loads, and the title is plain text'() {
    await page.goto(address);
    await ready();
    assert.equal(await page.getAttribute('html', 'data-state'), 'ready');
    assert.equal(await page.title(), expected.title);
    assert.equal(await page.innerText('h1'), expected.title);
    assert.equal(await page.innerText('.meshes [aria-pressed=true]'), 'grid </script><i>');
    assert.equal(await page.locator('h1 b, .meshes i').count(), 0);
  },
  async 'draws the mesh on the background'() {
    const share = drawn(await look());
    assert.ok(share > 0.1 && share < 0.9, `${share} of the pixels are drawn`);
  },
  async 'isolines are lines'() {
    const on = await look();
    await page.uncheck('#isolines');
    const share = change(on, await look());
    assert.ok(share > 0.01 && share < 0.3, `isolines change ${share} of the pixels`);
  },
  async 'edges are lines'() {
    const on = await look();
    await page.uncheck('#edges');
    const share = change(on, await look());
    assert.ok(share > 0.01 && share < 0.5, `edges change ${share} of the pixels`);
    await page.check('#edges');
  },
  async 'picks the vertex in the middle and reads its values'() {
    const box = await page.locator('#canvas').boundingBox();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector('#picked[data-vertex]');
    assert.equal(await page.getAttribute('#picked', 'data-vertex'), String(expected.vertex));
    for (const [k, x] of expected.position.entries())
      near(Number(await readPicked('xyz'[k])), x, 1e-12);
    near(Number(await readPicked('distance')), expected.distance, 1e-6);
    near(Number(await readPicked('nearly constant')), expected.nearly, 1e-12);
    assert.equal(await readPicked('gradient'), '0, 0, 0');
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#picked').isHidden());
  },
  async 'shows values that are not finite as such'() {
    await page.fill('#vertex', '0');
    await page.press('#vertex', 'Enter');
    await page.waitForSelector('#picked[data-vertex="0"]');
    assert.equal(await readPicked('curvature < \\"0\\" & >'), 'NaN');
    await page.fill('#vertex', '32');
    await page.press('#vertex', 'Enter');
    await page.waitForSelector('#picked[data-vertex="32"]');
    assert.equal(await readPicked('curvature < \\"0\\" & >'), '∞');
    await page.click('#picked .close');
    await page.click('#fit');
  },
  async 'another field has other colours and its own range'() {
    const before = await look();
    await page.selectOption('#field', { label: 'curvature < "0" & >' });
    assert.ok(change(before, await look()) > 0.1);
    assert.equal(await page.inputValue('#map'), 'blue-red');
    assert.equal(await page.inputValue('#low'), '−1');
    assert.equal(await page.inputValue('#high'), '1');
    assert.match(await page.innerText('#range-note'), /2 without a finite value/);
  },
  async 'the range can be dragged and typed'() {
    const before = await look();
    await page.fill('#high', '0.2');
    await page.press('#high', 'Enter');
    assert.ok(change(before, await look()) > 0.05);
    await page.focus('#low-slider');
    await page.keyboard.press('End');
    assert.equal(await page.inputValue('#low'), '0.2');
    await page.click('#full-range');
    assert.equal(await page.inputValue('#high'), '1');
  },
  async 'faces are coloured one by one'() {
    const before = await look();
    await page.selectOption('#field', { label: 'checker' });
    assert.ok(change(before, await look()) > 0.1);
    assert.ok(await page.locator('#isoline-controls').isHidden());
  },
  async 'arrows appear'() {
    const before = await look();
    await page.selectOption('#glyphs', { label: 'gradient' });
    const share = change(before, await look());
    assert.ok(share > 0.02 && share < 0.5, `arrows change ${share} of the pixels`);
    assert.equal(await page.innerText('#glyph-note'), '1,088 of 1,089 shown');
  },
  async 'keys turn, zoom and reset'() {
    await page.focus('#canvas');
    const before = await look();
    for (const key of ['ArrowLeft', 'ArrowUp', '+']) {
      const last = await look();
      await page.keyboard.press(key);
      assert.ok(change(last, await look()) > 0.02, `${key} does nothing`);
    }
    await page.keyboard.press('0');
    assert.ok(change(before, await look()) < 0.001);
  },
  async 'the mouse turns'() {
    const before = await look();
    const box = await page.locator('#canvas').boundingBox();
    await page.mouse.move(box.x + 200, box.y + 300);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 320, { steps: 4 });
    await page.mouse.up();
    assert.ok(change(before, await look()) > 0.05);
    assert.ok(await page.locator('#picked').isHidden());
  },
  async 'the picture is a PNG of the mesh'() {
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.click('#screenshot'),
    ]);
    assert.equal(download.suggestedFilename(), 'grid-script-i-.png');
    assert.ok(drawn(decodePng(readFileSync(await download.path()))) > 0.1);
  },
  async 'light and dark'() {
    const before = await look();
    await page.keyboard.press('t');
    assert.ok(change(before, await look()) > 0.3);
  },
  async 'the second mesh has no fields'() {
    await page.click('.meshes button:has-text("drum")');
    await ready();
    assert.ok(drawn(await look()) > 0.1);
    assert.ok(await page.locator('#legend').isHidden());
    assert.match(await page.innerText('#info'), /24 vertices, 36 edges, 14 faces/);
  },
  async 'help opens and closes'() {
    await page.keyboard.press('?');
    assert.ok(await page.locator('#keys').isVisible());
    await page.keyboard.press('Escape');
    assert.ok(await page.locator('#keys').isHidden());
  },
  async 'nothing was fetched and nothing complained'() {
    const foreign = requests.filter((url) => url !== address && !/^(data|blob):/.test(url));
    assert.deepEqual(foreign, []);
    assert.deepEqual(complaints, []);
  },
};

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
  await context.close();
  rmSync(profile, { recursive: true, force: true });
}
process.exitCode = nFailed > 0 ? 1 : 0;
