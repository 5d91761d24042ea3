// node check_page.mjs PACKAGES CHROMIUM PAGES: looks at PAGES/page.html in headless Chromium.
// PACKAGES is a folder whose node_modules hold playwright-core.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { change, decodePng, drawn, near, openBrowser, run } from './browser.mjs';

const [packages, executablePath, pages] = process.argv.slice(2);
const expected = JSON.parse(readFileSync(join(pages, 'expected.json'), 'utf8'));
const address = pathToFileURL(resolve(pages, 'page.html')).href;
const { page, look, ready, readPicked, assertSilent, close } = await openBrowser(
  packages,
  executablePath,
);

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
    assertSilent(address);
  },
};

await run(checks, close);
