//! The report as one page that a person understands in a minute.

use std::fmt::Write as _;

use crate::{
    chart::{self, escaped},
    discovered::UNKNOWN,
    report::{Diagnosis, Finding, Verdict},
    words::{listed, plain},
};

impl Diagnosis {
    /// A self-contained page, without scripts, for light and dark screens: the verdict in a sentence, where, what, how much, the
    /// fit before and after, what else it could be, and what to drive next.
    pub fn html(&self, robot: &str) -> String {
        let mut body = String::new();
        let _ = write!(
            body,
            "<header><p class='verdict {0}'>{0}</p><h1>{1}</h1><p class=quiet>{2}</p></header>",
            self.verdict,
            escaped(&self.sentence),
            self.scope(robot)
        );
        body += &section(
            "Power over time",
            &(chart::power(self) + &chart::differences(self) + &self.places_text() + &chart::way(self)),
        );
        if !self.findings.is_empty() {
            let parts: String = self.findings.iter().map(finding).collect();
            body += &section("What was left out, and how much", &parts);
        }
        body += &section("How well it fits", &(chart::fits(self) + FIT_WORDS));
        if let Some(next) = &self.next_drive {
            body += &section("What to drive next", &format!("<p>To decide, {}.</p>", escaped(next)));
        }
        if self.verdict == Verdict::Consistent {
            body += &section("What would have been noticed", &self.noticed());
        }
        if !self.notes.is_empty() {
            let notes: String = self.notes.iter().map(|note| format!("<li>{}", escaped(note))).collect();
            body += &section("To know", &format!("<ul>{notes}</ul>"));
        }
        let title = format!("{}: {}", escaped(robot), self.verdict);
        format!(
            "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>{title}</title>\
             <style>{STYLE}</style><main>{body}</main></html>\n"
        )
    }

    fn scope(&self, robot: &str) -> String {
        let drives = self.trace.runs.len();
        let behind = if drives == 1 { "" } else { " (drawn behind one another)" };
        let minutes = self.trace.t_s.len() as f64 / 60.0;
        let plural = if drives == 1 { "drive" } else { "drives" };
        format!(
            "{}: {drives} {plural}{behind}, {minutes:.0} minutes of driving compared with the model",
            escaped(robot)
        )
    }

    fn places_text(&self) -> String {
        if self.places.is_empty() && self.verdict != Verdict::Consistent {
            return String::new();
        }
        if self.places.is_empty() {
            return "<p>Nothing that comes again differs anywhere beyond noise.</p>".into();
        }
        let mut items = String::new();
        for place in &self.places {
            let _ = write!(
                items,
                "<li>{} <span class=quiet>({:.0} % of the difference)</span>",
                escaped(&place.statement),
                100.0 * place.share_of_excess
            );
        }
        format!("<p>Recording and model differ</p><ul>{items}</ul>")
    }

    fn noticed(&self) -> String {
        let mut rows = String::new();
        for size in &self.detectable {
            let unit = if size.unit == "1" { "" } else { size.unit };
            let (what, parameter) = (plain(size.mechanism), size.parameter);
            let _ = write!(rows, "<tr><td>{what}<td>{parameter}<td class=number>{:.3} {unit}", size.value);
        }
        let mut text = format!(
            "<p>These drives would have shown each of the following from about this size on:</p><table>{rows}</table>"
        );
        if !self.not_judged.is_empty() {
            let names: Vec<String> = self.not_judged.iter().map(|name| plain(name).to_owned()).collect();
            let _ = write!(text, "<p>They tell nothing of {}.</p>", escaped(&listed(&names)));
        }
        text
    }
}

fn section(title: &str, inside: &str) -> String {
    format!("<section><h2>{title}</h2>{inside}</section>")
}

fn finding(found: &Finding) -> String {
    let mut rows = String::new();
    for parameter in &found.parameters {
        let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
        let interval = parameter.interval_95.map_or(String::new(), |[low, high]| {
            format!("between {} and {}{unit}, 95 % sure", number(low), number(high))
        });
        let name = without_unit(parameter.name);
        let _ =
            write!(rows, "<tr><td>{name}<td class=number>{}{unit}<td>{interval}", number(parameter.value));
    }
    let others: Vec<String> = found.indistinguishable_from.iter().map(|n| plain(n).to_owned()).collect();
    let is_described = found.mechanism == UNKNOWN;
    let or = if is_described {
        String::new()
    } else if others.is_empty() {
        "<p>Nothing else that is known explains it as well.</p>".to_owned()
    } else {
        format!("<p>These drives cannot tell it from {}.</p>", escaped(&listed(&others)))
    };
    format!(
        "<article><h3>{}</h3><p>{}.</p><table>{rows}</table><p class=equation>{}</p><p>Where it was not fitted, the error falls from \
         {:.1} W to {:.1} W. Chance would do as much in {} drives.</p>{or}</article>",
        if is_described { "outside the list" } else { plain(&found.mechanism) },
        escaped(&found.statement),
        escaped(&found.equation),
        found.fit.held_out_rmse_before_w,
        found.fit.held_out_rmse_after_w,
        odds(found.evidence.p_value),
    )
}

/// A parameter's name as people say it; its unit stands beside its value.
fn without_unit(name: &str) -> String {
    if let "from_s" | "until_s" = name {
        return name.replace("_s", "").replacen("", "acts ", 1);
    }
    const UNITS: [&str; 12] = [
        "_kg",
        "_n",
        "_w",
        "_s",
        "_m",
        "_m2",
        "_rad",
        "_mps",
        "_k_per_w",
        "_per_mps",
        "_kg_per_m",
        "_per_rad",
    ];
    let unit = UNITS.iter().filter(|unit| name.ends_with(**unit)).max_by_key(|unit| unit.len());
    name.strip_suffix(unit.copied().unwrap_or("")).unwrap_or(name).replace('_', " ")
}

/// Three figures that count.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (2.0 - value.abs().max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}")
}

fn odds(p_value: f64) -> String {
    /// Beyond, the exact figure says nothing.
    const SURE: f64 = 1e-6;
    if p_value < SURE { "less than one in a million".into() } else { format!("one in {:.0}", 1.0 / p_value) }
}

const FIT_WORDS: &str = "<p class=quiet>Root mean square error over averages of one second. “Held out” means judged on parts of the drives \
                         that were not fitted. The noise floor is what no model could predict.</p>";

const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1d2430;--quiet:#5d6778;--page:#fff;--card:#f4f6f9;--line:#d5dbe5;--recorded:#7b8698;--filed:#d9660b;\
--corrected:#1667c9;--shade:#f3c64f55;--good:#1d7d46;--doubt:#a86500;--bad:#b3261e}
@media(prefers-color-scheme:dark){:root{--ink:#e8ecf3;--quiet:#9aa6b8;--page:#12161d;--card:#1b212b;--line:#343d4b;--recorded:#8a94a5;\
--filed:#ff9a4d;--corrected:#6eb0ff;--shade:#f3c64f33;--good:#5fce8f;--doubt:#f0b455;--bad:#ff8a80}}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:60rem;margin:0 auto;padding:2rem 1rem}
h1{font-size:1.6rem;line-height:1.3;margin:.3rem 0}h2{font-size:1.1rem;margin:2rem 0 .6rem}h3{margin:0;font-size:1rem}
.verdict{display:inline-block;margin:0;padding:.1rem .7rem;border-radius:1rem;border:2px solid;font-weight:600}
.consistent,.explained{color:var(--good)}.ambiguous{color:var(--doubt)}.unexplained{color:var(--bad)}
figure{margin:1rem 0}.quiet{color:var(--quiet);font-size:.9rem}.equation{font-family:ui-monospace,monospace;font-size:.9rem;color:var(--quiet)}
article{background:var(--card);border-radius:.6rem;padding:1rem;margin:.6rem 0}article p{margin:.4rem 0}
table{border-collapse:collapse}td{padding:.15rem 1.2rem .15rem 0;vertical-align:top}.number{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}
svg{display:block;width:100%;height:auto}svg text{fill:var(--quiet);font-size:12px}ul{margin:.2rem 0;padding-left:1.3rem}";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{EvidenceFigures, FindingFit};

    #[test]
    fn units_stand_beside_values_and_nothing_is_nothing() {
        let names = ["drag_area_m2", "east_mps", "from_s", "roll_change"].map(without_unit);
        assert_eq!(names, ["drag area", "east", "acts from", "roll change"]);
        assert_eq!([0.0, 0.1224, -3.937].map(number), ["0", "0.122", "-3.94"]);
    }
    #[test]
    fn what_is_outside_the_list_is_headed_so_and_is_not_held_against_what_is_known() {
        let of = |mechanism: &str| {
            finding(&Finding {
                mechanism: mechanism.to_owned(),
                statement: "It takes 2 W more".into(),
                equation: "c · 1 W".into(),
                parameters: Vec::new(),
                evidence: EvidenceFigures { p_value: 1e-4, delta_bic: 20.0, held_out_gain: 0.1 },
                indistinguishable_from: Vec::new(),
                fit: FindingFit { held_out_rmse_before_w: 3.0, held_out_rmse_after_w: 2.0 },
                probability: None,
                scope: None,
            })
        };
        let (outside, payload) = (of(UNKNOWN), of("payload"));
        assert!(
            outside.contains("<h3>outside the list</h3>") && !outside.contains("Nothing else"),
            "{outside}"
        );
        assert!(
            payload.contains("<h3>a load on board</h3>") && payload.contains("Nothing else"),
            "{payload}"
        );
    }
}
