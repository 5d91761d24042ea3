import './style.css';
import { App } from './app';
import { byId, readPageInfo } from './page';

/** Shows what went wrong instead of an empty page. */
function fail(error: unknown): void {
  document.documentElement.dataset['state'] = 'failed';
  byId('message').hidden = false;
  byId('progress').hidden = true;
  byId('message-text').textContent = error instanceof Error ? error.message : String(error);
}

try {
  const app = new App(readPageInfo(), fail);
  await app.showMesh(0);
} catch (error) {
  fail(error);
}
