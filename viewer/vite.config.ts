import { defineConfig, type Plugin } from 'vite';

/** Text that may stand inside a script element: nothing in it ends or comments the element. */
function inScript(code: string): string {
  return code.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');
}

/** Puts every script and style sheet of the bundle into the page itself. */
function singleFile(name: string): Plugin {
  return {
    name: 'single-file',
    enforce: 'post',
    generateBundle(_options, bundle) {
      const page = bundle[name];
      if (page?.type !== 'asset') this.error(`the bundle has no ${name}`);
      let html = String(page.source);
      for (const [part, file] of Object.entries(bundle)) {
        if (file === page) continue;
        const text = file.type === 'chunk' ? file.code : String(file.source);
        const tag =
          file.type === 'chunk'
            ? `<script[^>]*src="[^"]*${part}"[^>]*></script>`
            : `<link[^>]*href="[^"]*${part}"[^>]*>`;
        const inlined =
          file.type === 'chunk'
            ? `<script type="module">${inScript(text)}</script>`
            : `<style>${text}</style>`;
        if (!new RegExp(tag).test(html)) this.error(`${part} has no place in the page`);
        html = html.replace(new RegExp(tag), () => inlined);
        delete bundle[part];
      }
      page.source = html;
    },
  };
}

// vite build --mode report makes the page of `carat reproduce`, else that of `carat view`.
export default defineConfig(({ mode }) => ({
  plugins: [singleFile(mode === 'report' ? 'report.html' : 'index.html')],
  build: {
    rollupOptions: { input: mode === 'report' ? 'report.html' : 'index.html' },
    emptyOutDir: false,
    target: 'es2022',
    modulePreload: false,
    cssCodeSplit: false,
    chunkSizeWarningLimit: 2000,
  },
}));
