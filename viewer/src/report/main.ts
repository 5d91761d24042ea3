import './report.css';
import { toggleTheme } from '../theme';
import { toCsv } from './data';
import type { Experiment, Figure, PictureFigure, Report } from './data';
import { drawLines } from './lines';
import { MeshFrame } from './meshes';
import { save, savePng, saveSvg } from './save';
import { drawMatrix, drawTable } from './tables';

function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  text = '',
  className = '',
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

function button(text: string, title: string, clicked: () => void): HTMLButtonElement {
  const made = element('button', text);
  made.title = title;
  made.addEventListener('click', clicked);
  return made;
}

function drawPicture(figure: PictureFigure): HTMLElement {
  const picture = element('img', '', 'picture');
  picture.src = figure.image;
  picture.alt = figure.title;
  return picture;
}

function draw(
  experiment: Experiment,
  figure: Figure,
  meshes: MeshFrame | null,
): HTMLElement {
  const section = element('section', '', 'figure');
  section.dataset['figure'] = figure.id;
  section.append(element('h3', figure.title));
  const drawing =
    figure.kind === 'lines'
      ? drawLines(experiment, figure, meshes && ((family) => meshes.show(family)))
      : figure.kind === 'matrix'
        ? drawMatrix(experiment, figure)
        : figure.kind === 'table'
          ? drawTable(experiment, figure)
          : drawPicture(figure);
  section.append(drawing);
  if (figure.caption) section.append(element('p', figure.caption, 'caption'));
  if (figure.kind === 'lines') {
    const actions = element('div', '', 'actions');
    actions.append(
      button('SVG', 'Save the figure as SVG', () => saveSvg(figure.id, section)),
      button('PNG', 'Save the figure as PNG', () => void savePng(figure.id, section)),
    );
    section.append(actions);
  }
  return section;
}

function drawExperiment(experiment: Experiment, meshes: MeshFrame | null): HTMLElement {
  const article = element('article');
  article.id = experiment.name;
  const heading = element('h2', experiment.title);
  if (experiment.paper) heading.append(' ', element('small', experiment.paper));
  const command = element('p', '', 'command');
  const code = element('code', experiment.command);
  command.append(
    code,
    button('copy', 'Copy the command', () => void navigator.clipboard.writeText(experiment.command)),
    button('CSV', 'Save the data', () =>
      save(`${experiment.name}.csv`, new Blob([toCsv(experiment)], { type: 'text/csv' })),
    ),
  );
  article.append(heading, element('p', experiment.text), command);
  const body = element('div', '', 'body');
  const figures = element('div', '', 'figures');
  for (const figure of experiment.figures) figures.append(draw(experiment, figure, meshes));
  body.append(figures);
  if (meshes) body.append(meshes.element);
  article.append(body);
  return article;
}

function describe(report: Report): string {
  const { machine, options } = report;
  const parts = [
    `carat ${report.carat}`,
    machine.cpu,
    `${machine.cores} cores`,
    machine.memory_bytes && `${(machine.memory_bytes / 2 ** 30).toFixed(0)} GiB`,
    machine.system,
    `${report.seconds.toFixed(0)} s of work`,
    options.quick && 'quick',
  ];
  return parts.filter(Boolean).join(' · ');
}

const data = document.getElementById('report');
if (data) {
  const report = JSON.parse(data.textContent ?? '') as Report;
  const contents = document.getElementById('contents')!;
  const experiments = document.getElementById('experiments')!;
  const header = element('header');
  const frames: MeshFrame[] = [];
  header.append(
    element('h1', document.title),
    element('p', describe(report)),
    button('light / dark', 'Light or dark', () => {
      toggleTheme();
      for (const frame of frames) frame.restyle();
    }),
  );
  experiments.append(header);
  for (const experiment of report.experiments) {
    const link = element('a', experiment.title);
    link.href = `#${experiment.name}`;
    contents.append(link);
    const meshes = experiment.view ? new MeshFrame(report.viewer, experiment) : null;
    if (meshes) frames.push(meshes);
    experiments.append(drawExperiment(experiment, meshes));
  }
  document.documentElement.dataset['state'] = 'ready';
}
