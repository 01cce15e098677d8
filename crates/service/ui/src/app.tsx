/** The frame of the page: its name, its tabs, and what screen readers hear. */
import { announcement } from "./announce";
import { CalibrateTab } from "./calibrate/calibrate_tab";
import { DiagnoseTab } from "./diagnose/diagnose_tab";
import { Help, isHelpOpen } from "./help";
import { PlanTab } from "./plan/plan_tab";
import { RobotsTab } from "./robots/robots_tab";
import { tab, TAB_NAMES, TABS } from "./tab";
import { theme, toggleTheme } from "./theme";
import { GuideLink } from "./widgets/guide_link";
import { TokenForm } from "./widgets/token_form";

export function App() {
  const other = theme.value === "dark" ? "light" : "dark";
  return (
    <>
      <a class="skip" href="#main" onClick={skip}>
        Skip to the content
      </a>
      <header class="top">
        <h1>
          <Mark />
          <span>joulepath</span>
        </h1>
        <nav aria-label="Parts of the page">
          {TABS.map((name) => (
            <button key={name} type="button" aria-current={tab.value === name ? "page" : undefined} onClick={() => (tab.value = name)}>
              {TAB_NAMES[name]}
            </button>
          ))}
        </nav>
        <GuideLink class="guide" />
        <button type="button" class="theme keys" aria-label="Keys" title="Keys (?)" onClick={() => (isHelpOpen.value = true)}>
          ?
        </button>
        <button
          type="button"
          class="theme"
          aria-label={`Switch to ${other} colours`}
          title={`Switch to ${other} colours`}
          onClick={toggleTheme}
        >
          {theme.value === "dark" ? "☀" : "☾"}
        </button>
      </header>
      <Help />
      <TokenForm />
      <main id="main" tabIndex={-1}>
        {tab.value === "plan" && <PlanTab />}
        {tab.value === "robots" && <RobotsTab />}
        {tab.value === "calibrate" && <CalibrateTab />}
        {tab.value === "diagnose" && <DiagnoseTab />}
      </main>
      <p class="guide-below">
        <GuideLink>The guide</GuideLink>
      </p>
      <p class="unseen" role="status" aria-live="polite">
        {announcement.value}
      </p>
    </>
  );
}

/** The address holds the question, so that the link must not change it. */
function skip(event: Event): void {
  event.preventDefault();
  document.getElementById("main")?.focus();
}

function Mark() {
  return (
    <svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true">
      <path d="M5 26c8 0 4-10 11-10s4-9 11-9" fill="none" stroke="currentColor" stroke-width="3.4" stroke-linecap="round" />
      <circle cx="27" cy="7" r="3.6" class="mark-end" />
    </svg>
  );
}
