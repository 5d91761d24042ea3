export interface ThemeColors {
  surface: string;
  noValue: string;
  edges: string;
  glyphs: string;
}

export function themeColors(): ThemeColors {
  const style = getComputedStyle(document.documentElement);
  const read = (name: string): string => style.getPropertyValue(`--${name}`).trim();
  return {
    surface: read('surface'),
    noValue: read('no-value'),
    edges: read('edges'),
    glyphs: read('glyphs'),
  };
}

const darkQuery = window.matchMedia('(prefers-color-scheme: dark)');

function isDark(): boolean {
  const chosen = document.documentElement.dataset['theme'];
  return chosen ? chosen === 'dark' : darkQuery.matches;
}

export function toggleTheme(): void {
  document.documentElement.dataset['theme'] = isDark() ? 'light' : 'dark';
}

export function onSystemTheme(changed: () => void): void {
  darkQuery.addEventListener('change', changed);
}
