/** One mechanism that was left out: how big, how sure, and what else it could be. */
import { percent, plain, power, quantity } from "../format";
import { capitalized, mechanismLabel } from "./labels";
import { probability } from "./odds";
import { Fact } from "./recordings";
import type { Finding, Scope } from "./report";

export function FindingCard({ finding }: { finding: Finding }) {
  const { evidence, fit, scope } = finding;
  // The window stands under "When" where there is a scope.
  const sizes = finding.parameters.filter(({ name }) => !scope || (name !== "from_s" && name !== "until_s"));
  return (
    <section class="card finding" aria-label={mechanismLabel(finding.mechanism)}>
      <h3>
        {capitalized(mechanismLabel(finding.mechanism))}
        {finding.probability !== undefined && <span class="badge">{probability(finding.probability)} probable</span>}
      </h3>
      <p>{capitalized(finding.statement)}.</p>
      <p class="equation">
        <code>{finding.equation}</code>
      </p>
      <ul class="parameters">
        {sizes.map((parameter) => (
          <Parameter key={parameter.name} {...parameter} />
        ))}
      </ul>
      <dl class="facts">
        {scope && <Fact name="When" value={timeOf(scope)} />}
        {scope?.region && <Fact name="Where" value={scope.region} />}
        <Fact name="Held out before" value={power(fit.held_out_rmse_before_w)} />
        <Fact name="Held out after" value={power(fit.held_out_rmse_after_w)} />
        {finding.probability === undefined && (
          <Fact name="Chance of as much by accident" value={evidence.p_value < 1e-4 ? "below 1 in 10 000" : percent(evidence.p_value, 2)} />
        )}
        <Fact name="Squared error removed, held out" value={gain(evidence.held_out_gain)} />
      </dl>
      {finding.indistinguishable_from.length > 0 && (
        <p class="else">
          These drives cannot distinguish it from <b>{finding.indistinguishable_from.map(mechanismLabel).join(", ")}</b>.
        </p>
      )}
      {finding.indistinguishable_from.length === 0 && finding.mechanism !== "unknown" && (
        <p class="fine">No other mechanism explains the drives as well.</p>
      )}
    </section>
  );
}

/** The share of squared errors that the findings take away. It cannot exceed one; below zero they add to the errors. */
const gain = (share: number) => (share <= 0 ? "none" : percent(Math.min(share, 1)));

/** When a finding acts. */
function timeOf({ from_s, until_s, run }: Scope): string {
  const drive = run === null ? "of each drive" : `of drive ${run}`;
  if (from_s !== null && until_s !== null) return `from ${from_s.toFixed()} s to ${until_s.toFixed()} s ${drive}`;
  if (from_s !== null) return `from ${from_s.toFixed()} s ${drive} on`;
  return until_s === null ? "all the time, in all test drives" : `until ${until_s.toFixed()} s ${drive}`;
}

/** A number with its interval, drawn on an axis that holds both and zero. */
function Parameter({ name, value, unit, interval_95 }: Finding["parameters"][number]) {
  const [low, high] = interval_95 ?? [value, value];
  const [from, to] = [Math.min(0, low), Math.max(0, high)];
  const span = (to - from) * 1.1 || 1;
  const place = (at: number) => `${(100 * (at - from + 0.05 * (to - from))) / span}%`;
  const shownUnit = unit === "1" ? "" : unit;
  return (
    <li>
      <span>{quantity(name, unit)}</span>
      <span class="number">
        <b>
          {plain(value)} {shownUnit}
        </b>
      </span>
      {interval_95 ? (
        <>
          <span class="interval" aria-hidden="true">
            <em style={{ left: place(0) }} />
            <i style={{ left: place(low), right: `calc(100% - ${place(high)})` }} />
            <b style={{ left: place(value) }} />
          </span>
          <small>
            95 %: {plain(low)} to {plain(high)} {shownUnit}
          </small>
        </>
      ) : (
        <small class="interval-none">the best of the values tried; no interval</small>
      )}
    </li>
  );
}
