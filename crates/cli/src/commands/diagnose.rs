//! `joulepath diagnose`.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use clap::{Args, builder::PossibleValuesParser};
use diagnosis::{Diagnosis, Question, diagnose, report::Finding};
use model::mechanism;

use crate::{failure::BadInput, files, interrupt, output, progress, recorded::Recorded};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recorded: Recorded,
    /// Recordings of the same robot known to be healthy
    #[arg(long, num_args = 1..)]
    reference: Vec<PathBuf>,
    /// Another simulator's log of the same drives (Gazebo, Isaac, your own): find what it left out, in place of the robot file
    #[arg(long, num_args = 1.., conflicts_with = "reference", value_name = "FILE")]
    simulated: Vec<PathBuf>,
    /// Mechanisms that are known not to act, such as `payload` of a robot that was weighed
    #[arg(long, num_args = 1.., value_name = "MECHANISM", value_parser = PossibleValuesParser::new(mechanism::ALL.map(|one| one.name())))]
    ruled_out: Vec<String>,
    /// Folder for report.json, report.html and corrected-robot.json; it is made if need be
    #[arg(long)]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let is_new = make_folder(&arguments.out)?;
    let kept = is_new.then(|| interrupt::forget_on_interrupt(&arguments.out));
    let done = diagnosed(arguments);
    drop(kept);
    if done.is_err() && is_new {
        // Nothing is left of what failed; what somebody else put there meanwhile stays.
        let _ = fs::remove_dir(&arguments.out);
    }
    done
}

fn diagnosed(arguments: &Arguments) -> anyhow::Result<()> {
    let Arguments { recorded, reference, simulated, ruled_out, out } = arguments;
    let (robot, suspect) = recorded.read()?;
    let healthy = if reference.is_empty() { None } else { Some(recorded.read_files(reference, &robot)?) };
    let simulated = if simulated.is_empty() { None } else { Some(recorded.read_files(simulated, &robot)?) };
    let bar = progress::steps();
    let told = |step: &str, share: f64| {
        bar.set_position((share * progress::STEPS as f64) as u64);
        bar.set_message(step.to_owned());
    };
    let ruled_out: Vec<_> = ruled_out.iter().filter_map(|name| mechanism::by_name(name)).collect();
    let question = Question {
        ruled_out: &ruled_out,
        simulated: simulated.as_ref(),
        ..Question::new(&robot, &suspect, healthy.as_ref())
    };
    let found = diagnose(&question, &told);
    bar.finish_and_clear();
    let found = found.map_err(|error| recorded.refuse(&error))?;
    let write = |name: &str, text: String| files::write(&out.join(name), text);
    write("corrected-robot.json", serde_json::to_string_pretty(&found.corrected_robot)? + "\n")?;
    write("report.html", report::diagnosis_page(&found, &robot.name))?;
    // Last, so that whoever waits for it finds the others.
    write("report.json", serde_json::to_string_pretty(&found)? + "\n")?;
    found.coverage.words_by_run().iter().for_each(output::note);
    if recorded.json {
        output::json(&found)?;
    } else {
        output::text(summary(&found, out))?;
    }
    Ok(())
}

/// Makes the folder before long work is done for it, and says whether it is new.
fn make_folder(out: &Path) -> Result<bool, BadInput> {
    let is_new = !out.exists();
    if out.exists() && !out.is_dir() {
        return Err(BadInput(format!("--out {}: it is a file; name a folder", out.display())));
    }
    fs::create_dir_all(out)
        .map(|()| is_new)
        .map_err(|error| BadInput(format!("--out {}: the folder cannot be made: {error}", out.display())))
}

/// One screen: the verdict, what, how much, where, the fit, and what next.
fn summary(found: &Diagnosis, out: &Path) -> String {
    let mut text = format!("{}: {}\n", found.verdict, found.sentence);
    for finding in &found.findings {
        text += &finding_lines(finding);
    }
    for place in &found.places {
        let _ = writeln!(
            text,
            "where     {} ({:.0} % of the difference)",
            place.statement,
            100.0 * place.share_of_excess
        );
    }
    let _ = writeln!(
        text,
        "fit       held out {:.1} W before, {:.1} W after, {:.1} W is noise; the robot's file itself is off by {:.1} W",
        found.baseline.held_out_rmse_w,
        found.corrected.held_out_rmse_w,
        found.baseline.noise_floor_w,
        found.baseline.rmse_w
    );
    if let Some(next) = &found.next_drive {
        let _ = writeln!(text, "next      {next}");
    }
    for note in &found.notes {
        let _ = writeln!(text, "note      {note}");
    }
    let _ = writeln!(text, "written   {}", out.join("report.html").display());
    text
}

fn finding_lines(finding: &Finding) -> String {
    let mut text = String::new();
    for parameter in &finding.parameters {
        let unit = if parameter.unit == "1" { "" } else { parameter.unit };
        let interval = parameter
            .interval_95
            .map_or(String::new(), |[low, high]| format!("  (95 %: {low:.3} to {high:.3})"));
        let name = format!("{}.{}", finding.mechanism, parameter.name);
        let _ = writeln!(text, "what      {name} {:.3} {unit}{interval}", parameter.value);
    }
    if !finding.indistinguishable_from.is_empty() {
        let _ = writeln!(text, "or        {}", finding.indistinguishable_from.join(", "));
    }
    text
}
