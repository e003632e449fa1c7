//! `soifra measure`: runs the studies of a file and writes their tables.

use crate::{bars, bench_ratios, execute, exit::Exit, interrupt, output, report::Refusal};
use clap::{Args, ValueHint};

/// Arguments.
#[derive(Debug, Args)]
#[command(
    after_help = "What was measured is kept in pieces, so that an interrupted measurement goes on where it was."
)]
pub struct Arguments {
    /// Studies, as YAML
    #[arg(value_hint = ValueHint::FilePath)]
    file: String,
    /// The page to write; what lies outside its `measured` marks stays
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: String,
    /// Where the pieces are kept
    #[arg(long, value_name = "FOLDER", default_value = "out/results", value_hint = ValueHint::DirPath)]
    pieces: String,
    /// Only the study of this name
    #[arg(long, value_name = "NAME")]
    only: Option<String>,
    /// A folder with what the benches wrote; their ratios come last on the page
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    benches: Option<String>,
    /// A line for the head of the tables, as the commit
    #[arg(long, value_name = "TEXT")]
    remark: Option<String>,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// Runs the command. Bars that are missed make the exit code 1.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    interrupt::flag();
    let studies = bars::read(&a.file)?;
    let mut page = a.remark.as_ref().map_or(String::new(), |r| format!("{r}\n\n"));
    let mut missed = 0;
    for study in studies.iter().filter(|s| a.only.as_ref().is_none_or(|o| *o == s.name)) {
        let Some(document) = study.run(&a.pieces, execute::threads(a.threads))? else {
            output::note("interrupted; the same command goes on from here");
            return Ok(Exit::Interrupted);
        };
        page += &study.markdown(&document);
        for v in study.verdicts(&document).iter().filter(|v| v.met == Some(false)) {
            let value = v.value.map_or("absent".into(), |x| x.to_string());
            output::print(&format!("missed: {} {} is {value}\n", study.name, v.metric))?;
            missed += 1;
        }
    }
    if let Some(folder) = &a.benches {
        page += &bench_ratios::markdown(folder)?;
    }
    bars::write_page(&a.output, &page)?;
    Ok(if missed > 0 { Exit::Failed } else { Exit::Success })
}
