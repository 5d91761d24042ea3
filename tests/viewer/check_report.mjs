// node check_report.mjs PACKAGES CHROMIUM FOLDER: looks at FOLDER/report.html, which
// `carat reproduce` has written, in headless Chromium, and compares it with FOLDER/report.json.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { near, openBrowser, run } from './browser.mjs';

const [packages, executablePath, folder] = process.argv.slice(2);
const report = JSON.parse(readFileSync(join(folder, 'report.json'), 'utf8'));
const address = pathToFileURL(resolve(folder, 'report.html')).href;
const { page, assertSilent, close } = await openBrowser(packages, executablePath);

const figures = report.experiments.flatMap((experiment) =>
  experiment.figures.map((figure) => ({ experiment, figure })),
);
function rowsOf({ experiment, figure }) {
  const names = experiment.columns.map((column) => column.name);
  return experiment.rows
    .map((cells) => Object.fromEntries(names.map((name, k) => [name, cells[k]])))
    .filter((row) => Object.entries(figure.filter ?? {}).every(([k, v]) => row[k] === v));
}
const seriesOf = (figure, row) =>
  figure.series
    .map((name) => row[name])
    .filter((value) => value !== null)
    .join(', ');
const distinct = (values) => [...new Set(values)];
const at = (figure) => page.locator(`[data-figure="${figure.id}"]`);
const ofKind = (kind) => {
  const found = figures.filter(({ figure }) => figure.kind === kind);
  assert.ok(found.length > 0, `the report has no figure of kind ${kind}`);
  return found;
};

const checks = {
  async 'loads, with every experiment and figure'() {
    await page.goto(address);
    await page.waitForSelector('html[data-state=ready]');
    assert.equal(await page.locator('article').count(), report.experiments.length);
    assert.equal(await page.locator('section.figure').count(), figures.length);
    assert.equal(await page.locator('nav a').count(), report.experiments.length);
  },
  async 'draws every curve of every panel'() {
    for (const { experiment, figure } of ofKind('lines')) {
      const rows = rowsOf({ experiment, figure }).filter((row) => row[figure.y] !== null);
      const panels = distinct(rows.map((row) => row[figure.panel]));
      assert.equal(await at(figure).locator('.panels > figure').count(), panels.length);
      for (const [k, panel] of panels.entries()) {
        const expected = distinct(
          rows.filter((row) => row[figure.panel] === panel).map((row) => seriesOf(figure, row)),
        );
        const curves = at(figure).locator('.panels > figure').nth(k).locator('.curves path');
        assert.equal(await curves.count(), expected.length, `${figure.id}, ${panel}`);
        for (const path of await curves.all()) assert.match(await path.getAttribute('d'), /^M.*L/);
      }
    }
  },
  async 'writes the slopes of the data'() {
    let n = 0;
    for (const { experiment, figure } of ofKind('lines')) {
      if (!figure.slopes) continue;
      const rows = rowsOf({ experiment, figure });
      const panel = at(figure).locator('.panels > figure').first();
      const name = await panel.locator('figcaption span').innerText();
      for (const item of await panel.locator('.slopes span').all()) {
        const series = await item.getAttribute('data-series');
        const points = rows
          .filter((row) => row[figure.panel] === name && seriesOf(figure, row) === series)
          .map((row) => [Math.log(row[figure.x]), Math.log(row[figure.y])]);
        assert.ok(points.length === 2 || points.length === 3, 'all points of a curve');
        const mean = (k) => points.reduce((sum, point) => sum + point[k], 0) / points.length;
        const [x, y] = [mean(0), mean(1)];
        const slope =
          points.reduce((sum, point) => sum + (point[0] - x) * (point[1] - y), 0) /
          points.reduce((sum, point) => sum + (point[0] - x) ** 2, 0);
        near(Number(await item.innerText()), Number(slope.toFixed(2)), 1e-9);
        ++n;
      }
    }
    assert.ok(n > 5);
  },
  async 'hides a series in all figures, and shows it again'() {
    const [{ figure }] = ofKind('lines');
    const count = () => page.locator('.curves path').count();
    const before = await count();
    const button = at(figure).locator('.series button').first();
    await button.click();
    assert.equal(await button.getAttribute('aria-pressed'), 'false');
    assert.ok((await count()) < before);
    await button.click();
    assert.equal(await count(), before);
  },
  async 'shows the values under the mouse'() {
    const [{ figure }] = ofKind('lines');
    const dot = at(figure).locator('.panels > figure').first().locator('[aria-label=dot] path');
    await dot.first().scrollIntoViewIfNeeded();
    const box = await dot.first().boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    const tip = at(figure).locator('[aria-label=tip] text');
    await tip.first().waitFor();
    assert.match(await tip.first().textContent(), /operator: /);
  },
  async 'fills matrices, the best of a row in bold'() {
    for (const { experiment, figure } of ofKind('matrix')) {
      const rows = rowsOf({ experiment, figure });
      const labels = (row) => figure.row.map((name) => row[name]).join('\n');
      const lines = at(figure).locator('tbody tr');
      assert.equal(await lines.count(), distinct(rows.map(labels)).length);
      const first = rows.filter((row) => labels(row) === labels(rows[0]));
      const best = Math.min(...first.map((row) => row[figure.value]));
      assert.equal(await lines.first().locator('.best').first().innerText(), best.toFixed(2));
    }
  },
  async 'sorts tables'() {
    const { experiment, figure } = ofKind('table').find(({ figure }) => figure.columns.includes('nnz'));
    const column = figure.columns.indexOf('nnz');
    const header = at(figure).locator('th').nth(column);
    const top = () => at(figure).locator('tbody tr').first().locator('td').nth(column).innerText();
    const values = rowsOf({ experiment, figure }).map((row) => row.nnz);
    for (const [order, expected] of [
      ['ascending', Math.min(...values)],
      ['descending', Math.max(...values)],
    ]) {
      await header.locator('button').click();
      assert.equal(await header.getAttribute('aria-sort'), order);
      assert.equal(Number((await top()).replace(/\s/g, '')), expected);
    }
  },
  async 'saves the data and the figures'() {
    const [{ experiment, figure }] = ofKind('lines');
    const saved = async (button) => {
      const [download] = await Promise.all([page.waitForEvent('download'), button.click()]);
      return readFileSync(await download.path());
    };
    const csv = await saved(page.locator(`#${experiment.name} .command button:has-text("CSV")`));
    assert.equal(csv.toString().trim().split('\n').length, experiment.rows.length + 1);
    const svg = await saved(at(figure).locator('.actions button:has-text("SVG")'));
    assert.match(svg.toString(), /^<svg[^]*<path[^]*<\/svg>$/);
    const png = await saved(at(figure).locator('.actions button:has-text("PNG")'));
    assert.equal(png.toString('latin1', 1, 4), 'PNG');
    assert.ok(png.length > 10000);
  },
  async 'shows the meshes in 3-D beside the curves'() {
    for (const experiment of report.experiments) {
      const column = experiment.columns.findIndex(({ name }) => name === 'family');
      const expected =
        column >= 0
          ? distinct(experiment.rows.map((row) => row[column]))
          : distinct(experiment.rows.map((row) => row[experiment.columns.findIndex(
              ({ name }) => name === 'tessellation',
            )]));
      const place = page.locator(`#${experiment.name} .meshes`);
      await place.scrollIntoViewIfNeeded();
      const frame = place.frameLocator('iframe');
      await frame.locator('html[data-state=ready]').waitFor({ state: 'attached', timeout: 60000 });
      const choices = frame.locator('#meshes button, #meshes option');
      assert.deepEqual(await choices.allTextContents(), expected, experiment.name);
      const drawn = await frame.locator('#canvas').evaluate((canvas) => canvas.width > 100);
      assert.ok(drawn);
      // As many 3-D views as are near the window, not one an experiment.
      assert.ok((await page.locator('.meshes iframe').count()) < 5);
    }
  },
  async 'shows the mesh of a panel'() {
    const [{ experiment, figure }] = ofKind('lines');
    const panel = at(figure).locator('.panels > figure').nth(1);
    const family = await panel.locator('figcaption span').innerText();
    await panel.locator('figcaption button').click();
    const frame = page.locator(`#${experiment.name} .meshes`).frameLocator('iframe');
    await frame.locator(`#info:has-text("${family}")`).waitFor({ state: 'attached' });
  },
  async 'shows the pictures'() {
    const pictures = ofKind('picture');
    for (const { figure } of pictures) {
      const image = at(figure).locator('img');
      assert.ok((await image.evaluate((element) => element.naturalWidth)) > 800);
    }
  },
  async 'light and dark'() {
    const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const before = await background();
    await page.click('header button:has-text("dark")');
    assert.notEqual(await background(), before);
  },
  async 'nothing was fetched and nothing complained'() {
    assertSilent(address);
  },
};

await run(checks, close);
