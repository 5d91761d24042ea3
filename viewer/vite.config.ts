import { defineConfig, type Plugin } from 'vite';

/** Text that may stand inside a script element: nothing in it ends or comments the element. */
function inScript(code: string): string {
  return code.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');
}

/** Puts every script and style sheet of the bundle into the page itself. */
function singleFile(): Plugin {
  return {
    name: 'single-file',
    enforce: 'post',
    generateBundle(_options, bundle) {
      const page = bundle['index.html'];
      if (page?.type !== 'asset') this.error('the bundle has no index.html');
      let html = String(page.source);
      for (const [name, file] of Object.entries(bundle)) {
        if (file === page) continue;
        const text = file.type === 'chunk' ? file.code : String(file.source);
        const tag =
          file.type === 'chunk'
            ? `<script[^>]*src="[^"]*${name}"[^>]*></script>`
            : `<link[^>]*href="[^"]*${name}"[^>]*>`;
        const inlined =
          file.type === 'chunk'
            ? `<script type="module">${inScript(text)}</script>`
            : `<style>${text}</style>`;
        if (!new RegExp(tag).test(html)) this.error(`${name} has no place in the page`);
        html = html.replace(new RegExp(tag), () => inlined);
        delete bundle[name];
      }
      page.source = html;
    },
  };
}

export default defineConfig({
  plugins: [singleFile()],
  build: {
    target: 'es2022',
    modulePreload: false,
    cssCodeSplit: false,
    chunkSizeWarningLimit: 2000,
  },
});
