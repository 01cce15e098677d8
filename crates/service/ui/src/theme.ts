/** Light or dark: what the system says until the person says otherwise. */
import { effect, signal } from "@preact/signals";

export type Theme = "light" | "dark";

const STORED = "joulepath-theme";
const system = matchMedia("(prefers-color-scheme: dark)");
const systemTheme = (): Theme => (system.matches ? "dark" : "light");

function chosen(): Theme | null {
  const stored = localStorage.getItem(STORED);
  return stored === "light" || stored === "dark" ? stored : null;
}

export const theme = signal<Theme>(chosen() ?? systemTheme());

system.addEventListener("change", () => {
  if (!chosen()) theme.value = systemTheme();
});

effect(() => {
  document.documentElement.dataset.theme = theme.value;
});

export function toggleTheme(): void {
  theme.value = theme.value === "dark" ? "light" : "dark";
  localStorage.setItem(STORED, theme.value);
}

/** The value of a colour of the style sheet, for what is drawn on a canvas. */
export function color(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
