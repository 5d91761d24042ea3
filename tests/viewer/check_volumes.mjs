// node check_volumes.mjs PACKAGES CHROMIUM PAGES: looks at PAGES/volumes.html in headless Chromium.
// Its first mesh is 4 x 4 x 4 cubes over [-1, 1]^3 about `shift`, its second one prisms.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { change, decodePng, drawn, near, openBrowser, run } from './browser.mjs';

const [packages, executablePath, pages] = process.argv.slice(2);
const { shift } = JSON.parse(readFileSync(join(pages, 'volumes.json'), 'utf8'));
const address = pathToFileURL(resolve(pages, 'volumes.html')).href;
const { page, settle, look, ready, readPicked, assertSilent, close } = await openBrowser(
  packages,
  executablePath,
);

/** Cells and area that the note on the clip tells; positions hold single precision. */
async function cut() {
  await settle();
  const note = await page.innerText('#clip-note');
  const [, cells, area] = note.match(/^([\d,]+) cells cut, area ([\d.]+)\.$/) ?? assert.fail(note);
  return { cells: Number(cells), area: Number(area) };
}

async function shownCells() {
  await settle();
  const note = await page.innerText('#clip-note');
  return Number((note.match(/^(\d+) cells shown\.$/) ?? assert.fail(note))[1]);
}

async function type(id, text) {
  await page.fill(id, text);
  await page.press(id, 'Enter');
}

/** The plane at z = `z` of the lattice. */
async function level(z) {
  await type('#clip-level', String(shift[2] + z));
  await page.focus('#canvas');
}

async function clickMiddle(right = 0, down = 0) {
  await settle();
  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.click(box.x + box.width / 2 + right, box.y + box.height / 2 + down);
  await page.waitForSelector('#picked:not([hidden])');
}

const checks = {
  async 'loads, and draws the boundary'() {
    await page.goto(address);
    await ready();
    assert.equal(await page.getAttribute('html', 'data-state'), 'ready');
    assert.match(await page.innerText('#info'), /125 vertices, 300 edges, 240 faces, 64 cells/);
    assert.ok(drawn(await look()) > 0.1);
  },
  async 'edges are those of the polygons'() {
    await page.selectOption('#field', '-1');
    const on = await look();
    await page.uncheck('#edges');
    const share = change(on, await look());
    assert.ok(share > 0.002 && share < 0.05, `edges change ${share} of the pixels`);
    await page.check('#edges');
    await page.selectOption('#field', { label: 'linear' });
  },
  async 'picks a cell, its face and a vertex'() {
    await clickMiddle();
    const cell = Number(await page.getAttribute('#picked', 'data-cell'));
    assert.ok(cell >= 48 && cell < 64, `cell ${cell} is not at the front`);
    assert.equal(Number(await readPicked('number')), cell);
    assert.equal(Number(await readPicked('faces')), 6);
    const [x, y, z] = await Promise.all(['x', 'y', 'z'].map(async (k) => Number(await readPicked(k))));
    const linear = 1 + 2 * (x - shift[0]) - 3 * (y - shift[1]) + 5 * (z - shift[2]);
    assert.equal(z, shift[2] + 1);
    near(Number(await readPicked('linear')), linear, 1e-6);
    await page.keyboard.press('Escape');
  },
  async 'a cut along faces has their polygons'() {
    const before = await look();
    await page.keyboard.press('z');
    assert.deepEqual(await cut(), { cells: 16, area: 4 });
    assert.ok(change(before, await look()) > 0.1);
  },
  async 'a cut moves, by number, slider and key'() {
    await level(0.3);
    assert.deepEqual(await cut(), { cells: 16, area: 4 });
    const before = await look();
    await page.fill('#clip-position', '0.9');
    assert.equal(Number(await page.inputValue('#clip-level')), shift[2] + 0.8);
    assert.ok(change(before, await look()) > 0.02);
    await page.focus('#canvas');
    for (let i = 0; i < 5; ++i) await page.keyboard.press(',');
    near(Number(await page.inputValue('#clip-level')), shift[2] + 0.7, 1e-9);
    await page.fill('#clip-position', '1');
    assert.deepEqual(await cut(), { cells: 16, area: 4 });
    await page.fill('#clip-position', '0');
    assert.deepEqual(await cut(), { cells: 0, area: 0 });
  },
  async 'flipped, the other side stays'() {
    await level(0.3);
    const before = await look();
    await page.keyboard.press('f');
    assert.ok(change(before, await look()) > 0.1);
    assert.deepEqual(await cut(), { cells: 16, area: 4 });
    await page.keyboard.press('f');
  },
  async 'the cut interpolates the field'() {
    for (const [right, down] of [[0, 0], [60, 35], [-80, 50]]) {
      await clickMiddle(right, down);
      assert.equal(await page.innerText('#picked h2 >> nth=0'), 'Point of the cut');
      const read = async (k) => Number(await readPicked('xyz'[k])) - shift[k];
      const [x, y, z] = [await read(0), await read(1), await read(2)];
      near(z, 0.3, 1e-5);
      near(Number(await readPicked('linear')), 1 + 2 * x - 3 * y + 5 * z, 1e-5);
      const place = (t) => Math.floor(2 * (t + 1));
      const cell = place(x) + 4 * place(y) + 16 * place(z);
      assert.equal(await page.getAttribute('#picked', 'data-cell'), String(cell));
      await page.keyboard.press('Escape');
    }
  },
  async 'a free direction: a hexagon through the middle'() {
    await page.selectOption('#clip-axis', 'free');
    await type('#clip-normal', '1, 1, 1');
    const { cells, area } = await cut();
    near(area, 3 * Math.sqrt(3), 1e-5);
    // The cells whose corners are on both sides, counted by the sum of their numbers.
    let n = 0;
    for (let c = 0; c < 64; ++c) {
      const sum = (c % 4) + (Math.floor(c / 4) % 4) + Math.floor(c / 16);
      n += sum < 6 && sum + 3 > 6 ? 1 : 0;
    }
    assert.equal(cells, n);
    const before = await look();
    await page.keyboard.press('ArrowLeft');
    await page.click('#clip-facing');
    assert.ok(change(before, await look()) > 0.02);
  },
  async 'whole cells'() {
    await page.selectOption('#clip-axis', 'z');
    await page.selectOption('#clip-mode', 'cells');
    await level(0.1);
    assert.equal(await shownCells(), 32);
    await level(0.3);
    assert.equal(await shownCells(), 48);
    await page.keyboard.press('f');
    assert.equal(await shownCells(), 16);
    await page.keyboard.press('f');
  },
  async 'cell values are flat'() {
    await page.selectOption('#field', { label: 'number' });
    assert.ok(await page.locator('#isoline-controls').isHidden());
    await page.selectOption('#clip-mode', 'cut');
    await page.click('#clip-facing');
    await page.uncheck('#edges');
    await page.selectOption('#clip-axis', 'z');
    await page.keyboard.press('0');
    const image = await look();
    // Along a row of pixels a few colours stand for the few cells that it passes.
    const y = Math.floor(image.height / 2);
    const colors = new Map();
    for (let x = 0; x < image.width; ++x) {
      const i = (y * image.width + x) * image.channels;
      const key = String(image.pixels.subarray(i, i + 3));
      colors.set(key, (colors.get(key) ?? 0) + 1);
    }
    const wide = [...colors.values()].filter((n) => n > 20).length;
    assert.ok(wide >= 5 && wide <= 20, `${wide} colours in a row`);
    await page.check('#edges');
  },
  async 'cells shrink and explode'() {
    await page.selectOption('#clip-mode', 'none');
    const whole = await look();
    await page.focus('#canvas');
    for (let i = 0; i < 6; ++i) await page.keyboard.press('k');
    assert.equal(await page.innerText('#shrink-text'), '30 %');
    const shrunk = await look();
    assert.ok(change(whole, shrunk) > 0.05);
    assert.ok(drawn(shrunk) < drawn(whole), 'the background shows through the gaps');
    for (let i = 0; i < 10; ++i) await page.keyboard.press('m');
    assert.equal(await page.innerText('#explode-text'), '50 %');
    assert.ok(change(shrunk, await look()) > 0.1);
    await page.keyboard.press('z');
    assert.deepEqual(await cut(), { cells: 16, area: 4 });
    await page.fill('#explode', '0');
    await page.fill('#shrink', '0');
    await page.selectOption('#clip-mode', 'none');
    assert.ok(change(whole, await look()) < 0.001);
  },
  async 'patches are hidden'() {
    await page.focus('#canvas');
    for (let i = 0; i < 4; ++i) await page.keyboard.press('ArrowLeft');
    await page.selectOption('#up', 'z');
    for (let i = 0; i < 9; ++i) await page.keyboard.press('ArrowDown');
    const before = await look();
    await page.uncheck('#patch-list input');
    const share = change(before, await look());
    assert.ok(share > 0.02, `the patch is ${share} of the pixels`);
    await page.check('#patch-list input');
    assert.ok(change(before, await look()) < 0.001);
  },
  async 'steps through the fields'() {
    await page.selectOption('#field', { label: 'mode_1' });
    await page.click('#next-field');
    await settle();
    assert.equal(await page.innerText('#legend-name'), 'mode_2');
    await page.focus('#canvas');
    await page.keyboard.press(']');
    await settle();
    assert.equal(await page.innerText('#legend-name'), 'mode_3');
    await page.keyboard.press('[');
    await settle();
    assert.equal(await page.innerText('#legend-name'), 'mode_2');
  },
  async 'arrows are clipped'() {
    await page.keyboard.press('z');
    const before = await look();
    await page.selectOption('#glyphs', { label: 'wind' });
    const share = change(before, await look());
    assert.ok(share > 0.002 && share < 0.3, `arrows change ${share} of the pixels`);
  },
  async 'the plane moves by itself'() {
    await page.focus('#canvas');
    await page.keyboard.press('a');
    const before = await page.inputValue('#clip-level');
    await page.waitForTimeout(400);
    assert.notEqual(await page.inputValue('#clip-level'), before);
    await page.keyboard.press('a');
    await settle();
    const stopped = await page.inputValue('#clip-level');
    await page.waitForTimeout(200);
    assert.equal(await page.inputValue('#clip-level'), stopped);
  },
  async 'the picture shows the cut'() {
    const [download] = await Promise.all([
      page.waitForEvent('download'),
      page.click('#screenshot'),
    ]);
    assert.ok(drawn(decodePng(readFileSync(await download.path()))) > 0.1);
  },
  async 'sections that are concave and in several parts'() {
    await page.click('.meshes button:has-text("prisms")');
    await ready();
    assert.ok(await page.locator('#legend').isHidden());
    await page.keyboard.press('z');
    const upright = await cut();
    assert.equal(upright.cells, 4);
    near(upright.area, 1.5 * Math.sqrt(3) + 3 + 7 + 1, 1e-5);
    // Across y at 2.5: both arms of the U, and what stands between them.
    await page.keyboard.press('y');
    await type('#clip-level', '2.5');
    const arms = await cut();
    assert.equal(arms.cells, 2);
    near(arms.area, 2 * 3, 1e-5);
    await page.focus('#canvas');
    await page.keyboard.press('f');
    near((await cut()).area, 2 * 3, 1e-5);
    const before = await look();
    await page.keyboard.press('k');
    await page.keyboard.press('k');
    assert.ok(change(before, await look()) > 0.001);
  },
  async 'a volume without cells is empty'() {
    await page.click('.meshes button:has-text("empty")');
    await ready();
    assert.equal(await page.getAttribute('html', 'data-state'), 'ready');
    await page.keyboard.press('z');
    assert.deepEqual(await cut(), { cells: 0, area: 0 });
    await page.keyboard.press('k');
    assert.equal(drawn(await look()), 0);
  },
  async 'a surface has no such controls, and nothing complained'() {
    await page.click('.meshes button:has-text("square")');
    await ready();
    assert.ok(await page.locator('#volume-controls').isHidden());
    await page.keyboard.press('z');
    await page.keyboard.press('k');
    assert.ok(drawn(await look()) > 0.1);
    assertSilent(address);
  },
};

await run(checks, close);
