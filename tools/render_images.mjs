// node tools/render_images.mjs BUILD [CHROMIUM [CASE]]: renders docs/images with the program in
// BUILD. The pages are those of `carat ... -o x.html`; headless Chromium looks at them. CASE is the
// case `flange` of docs/openfoam.md; without it its picture stays as it is.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const [build, executablePath = '/usr/bin/chromium', foamCase] = process.argv.slice(2);
if (!build) throw new Error('usage: node tools/render_images.mjs BUILD [CHROMIUM [CASE]]');
const packages = resolve(build, 'viewer/work/package.json');
const { chromium } = createRequire(packages)('playwright-core');
const output = join(dirname(fileURLToPath(import.meta.url)), '../docs/images');
const rabbit = '/usr/share/glmark2/models/bunny.obj';
const work = mkdtempSync(join(tmpdir(), 'carat-images-'));
mkdirSync(output, { recursive: true });

const file = (name) => join(work, name);
const carat = (...args) => execFileSync(resolve(build, 'carat'), args, { stdio: 'pipe' });

const context = await chromium.launchPersistentContext(file('profile'), {
  executablePath,
  headless: true,
  colorScheme: 'light',
  deviceScaleFactor: 1.5,
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

/** A look at a page that carat wrote: the canvas, and the colour bar if asked for. */
async function look(name, { width = 420, height = 420, legend = true, set = {}, keys = [] } = {}) {
  const page = await context.newPage();
  await page.setViewportSize({ width, height });
  await page.goto(pathToFileURL(file(name)).href);
  await page.waitForFunction(() => document.documentElement.dataset.state === 'ready');
  await page.addStyleTag({
    content: `#header, #panel, #message, #legend-name ${legend ? '' : ', #legend'} { display: none }`,
  });
  await page.evaluate((values) => {
    document.body.classList.add('panel-closed');
    for (const [id, value] of Object.entries(values)) {
      const element = document.getElementById(id);
      if (element.type === 'checkbox') {
        if (element.checked !== value) element.click();
      } else {
        element.value = value;
        element.dispatchEvent(new Event('input', { bubbles: true }));
        element.dispatchEvent(new Event('change', { bubbles: true }));
      }
    }
  }, set);
  await page.waitForTimeout(300); // the canvas takes its new size
  await page.keyboard.press('0');
  for (const key of keys) await page.keyboard.press(key);
  await page.waitForTimeout(500);
  const picture = await page.screenshot();
  await page.close();
  return picture;
}

/** Franke's function and minus its Laplacian, as expressions. */
function franke() {
  // factor * exp(-a X^2 - b Y^2 - d Y), X = 9x - x0, Y = 9y - y0
  const terms = [
    [0.75, 0.25, 2, 0.25, 2, 0],
    [0.75, 1 / 49, -1, 0, -1, 0.1],
    [0.5, 0.25, 7, 0.25, 3, 0],
    [-0.2, 1, 4, 1, 7, 0],
  ];
  const parts = terms.map(([factor, a, x0, b, y0, d]) => {
    const [x, y] = [`(9*x-(${x0}))`, `(9*y-(${y0}))`];
    const term = `(${factor})*exp(-${a}*${x}^2-${b}*${y}^2-${d}*${y})`;
    const gradient2 = `(${18 * a}*${x})^2+(${18 * b}*${y}+${9 * d})^2`;
    return { term, load: `-${term}*(${gradient2}-${162 * (a + b)})` };
  });
  return {
    solution: parts.map(({ term }) => term).join('+'),
    load: parts.map(({ load }) => `(${load})`).join('+'),
  };
}

/** Several pictures with titles in one. */
async function grid(pictures, columns, width, height) {
  const cells = pictures
    .map(
      ({ title, picture }) =>
        `<figure><img src="data:image/png;base64,${picture.toString('base64')}" />` +
        `<figcaption>${title}</figcaption></figure>`,
    )
    .join('');
  const rows = Math.ceil(pictures.length / columns);
  const page = await context.newPage();
  await page.setViewportSize({ width: columns * width, height: rows * (height + 28) });
  await page.setContent(`<style>
    body { margin: 0; background: #f6f7f9; display: grid; grid-template-columns: repeat(${columns}, ${width}px) }
    figure { margin: 0 } img { width: ${width}px; height: ${height}px; display: block }
    figcaption { font: 14px/28px 'DejaVu Sans', sans-serif; text-align: center; color: #333 }
  </style>${cells}`);
  const picture = await page.screenshot();
  await page.close();
  return picture;
}

function save(name, picture) {
  writeFileSync(join(output, name), picture);
  console.log(`${name}: ${Math.round(picture.length / 1000)} kB`);
}

const times = (n, key) => Array(n).fill(key);

try {
  carat('convert', rabbit, file('rabbit.ply'), '--dual');
  carat('geodesics', file('rabbit.ply'), '--source', '65081', '-o', file('geodesics.html'));
  carat('curvature', file('rabbit.ply'), '--signed', '-o', file('curvature.html'));
  save('geodesics.png', await look('geodesics.html'));
  save('curvature.png', await look('curvature.html'));
  const close = times(8, '+');
  save('polygons.png', await look('geodesics.html', { keys: close }));

  const { solution, load } = franke();
  carat('generate', 'plane-voronoi', '--level', '3', '--jitter', '0.4', '-o', file('plane.ply'));
  carat('poisson', file('plane.ply'), '--rhs', load, '--dirichlet', solution, '-o',
        file('poisson.html'));
  save('poisson.png', await look('poisson.html', { set: { low: '0', high: '1.22' } }));

  carat('generate', 'ball-voronoi', '--level', '2', '-o', file('ball.vtu'));
  carat('geodesics', file('ball.vtu'), '--source', '0', '--edge-length', 'mean', '-o',
        file('distance.html'));
  carat('eigen', file('ball.vtu'), '-k', '6', '--dirichlet', '-o', file('modes.html'));
  const inside = { 'clip-mode': 'cut', 'clip-axis': 'y', 'clip-position': '0.5' };
  save('volume-geodesics.png', await look('distance.html', { set: inside }));
  save('volume-mode.png', await look('modes.html',
      { set: { ...inside, 'clip-mode': 'cells', field: '4' } }));
  carat('generate', 'ball-truncated', '--level', '1', '-o', file('cells.vtu'));
  carat('geodesics', file('cells.vtu'), '--source', '0', '-o', file('cells.html'));
  save('volume-cells.png', await look('cells.html',
      { set: { ...inside, 'clip-mode': 'cells', shrink: '0.15', explode: '0.35', isolines: false } }));
  if (foamCase) {
    carat('poisson', foamCase, '--rhs', '0', '--dirichlet', 'patch2=273', '--dirichlet',
          'patch4=573', '-o', file('flange.html'));
    save('openfoam.png', await look('flange.html'));
  }

  const families = JSON.parse(carat('list', 'families', '--json')).families;
  const pictures = { surface: [], volume: [] };
  for (const { name, kind } of families) {
    const level = kind === 'volume' || name.startsWith('plane') ? '0' : '1';
    carat('generate', name, '--level', level, '-o', file(`${name}.html`));
    const keys = name.startsWith('torus') ? times(5, 'ArrowUp') : [];
    const set = kind === 'volume' ? { ...inside, 'clip-mode': 'cells' } : {};
    const picture = await look(`${name}.html`, { width: 170, height: 170, legend: false, keys, set });
    pictures[kind].push({ title: name, picture });
  }
  save('families.png', await grid(pictures.surface, 5, 170, 170));
  save('volume-families.png', await grid(pictures.volume, 8, 170, 170));
} finally {
  await context.close();
  rmSync(work, { recursive: true, force: true });
}
