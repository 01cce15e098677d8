/** One mechanism that was left out: how big, how sure, and what else it could be. */
import { percent, plain, power, quantity, words } from "../format";
import { Fact } from "./recordings";
import type { Finding } from "./report";

export function FindingCard({ finding }: { finding: Finding }) {
  const { evidence, fit } = finding;
  return (
    <section class="card finding" aria-label={words(finding.mechanism)}>
      <h3>{words(finding.mechanism)}</h3>
      <p>{finding.statement}.</p>
      <p class="equation">
        <code>{finding.equation}</code>
      </p>
      <ul class="parameters">
        {finding.parameters.map((parameter) => (
          <Parameter key={parameter.name} {...parameter} />
        ))}
      </ul>
      <dl class="facts">
        <Fact name="Held out before" value={power(fit.held_out_rmse_before_w)} />
        <Fact name="Held out after" value={power(fit.held_out_rmse_after_w)} />
        <Fact name="Chance of as much by accident" value={evidence.p_value < 1e-4 ? "below 1 in 10 000" : percent(evidence.p_value, 2)} />
        <Fact name="Held-out gain" value={percent(evidence.held_out_gain)} />
      </dl>
      {finding.indistinguishable_from.length > 0 ? (
        <p class="else">
          These drives cannot tell it from <b>{finding.indistinguishable_from.map(words).join(", ")}</b>.
        </p>
      ) : (
        <p class="fine">Nothing else that is known looks the same in these drives.</p>
      )}
    </section>
  );
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
        <small class="interval-none">taken from a grid</small>
      )}
    </li>
  );
}
