//! `soifra sweep`: a mission over seeds, parameters and platforms; `soifra sweep merge`: shards to a whole.

use crate::{
    compile, execute,
    exit::Exit,
    files,
    output::{self, Format},
    report::{
        Refusal,
        table::{figure, table},
    },
    seeds,
    sweep::{self, Document, Plan},
};
use clap::{Args, Subcommand, ValueHint};
use std::collections::BTreeMap;

/// Arguments.
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "Examples:\n  soifra sweep swarm.soi --seeds 20 --set speed=0.1m/s,0.2m/s\n  soifra sweep swarm.soi --seeds 1000 --shard 3/10 --format json > 3.json\n  soifra sweep merge *.json"
)]
pub struct Arguments {
    #[command(subcommand)]
    merge: Option<Sub>,
    #[command(flatten)]
    sweep: Sweep,
}

#[derive(Debug, Args)]
struct Sweep {
    /// Mission source (.soi) or behaviour graph (.yaml, .json)
    #[arg(required = true, value_hint = ValueHint::FilePath)]
    file: Option<String>,
    /// Which mission of the file [default: its first]
    #[arg(long, value_name = "NAME")]
    mission: Option<String>,
    /// Let the faults of this test happen; its mission unless `--mission` names one
    #[arg(long, value_name = "NAME")]
    test: Option<String>,
    /// Seeds: `20` for 1 to 20, or a list as `1..20,42`
    #[arg(long, value_name = "SEEDS", default_value = "20")]
    seeds: String,
    /// Give a parameter one value after the other
    #[arg(long = "set", value_name = "NAME=VALUE,…")]
    sets: Vec<String>,
    /// Run every robot on one platform profile after the other
    #[arg(long, value_name = "PROFILE,…", value_delimiter = ',')]
    platform: Vec<String>,
    /// Threads to use; changes the speed, never the result [default: RAYON_NUM_THREADS, else all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Run only part I of N, for the job array of a cluster
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,
    /// What to print on standard output
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum Sub {
    /// Put the JSON documents of all shards together
    Merge {
        /// One file for each shard
        #[arg(required = true, value_hint = ValueHint::FilePath)]
        files: Vec<String>,
        /// What to print on standard output
        #[arg(long, value_enum, default_value_t)]
        format: Format,
    },
}

impl Arguments {
    /// What to print.
    pub fn format(&self) -> Format {
        match &self.merge {
            Some(Sub::Merge { format, .. }) => *format,
            None => self.sweep.format,
        }
    }
}

/// Runs the command.
pub fn run(a: &Arguments) -> Result<Exit, Refusal> {
    let (document, exit) = match &a.merge {
        Some(Sub::Merge { files, .. }) => merge(files)?,
        None => execute(&a.sweep)?,
    };
    match a.format() {
        Format::Human => output::print(&human(&document))?,
        Format::Json => output::print_json(&document)?,
    }
    Ok(exit)
}

fn execute(a: &Sweep) -> Result<(Document, Exit), Refusal> {
    let wrong = |argument: String, why: String| {
        Refusal::about(
            &argument,
            "S9015",
            "a list of seeds or a shard is wrong",
            why,
            "`soifra sweep --help` shows examples",
        )
    };
    let file = a.file.as_deref().unwrap_or_default();
    let seeds = seeds::parse(&a.seeds).map_err(|e| wrong(format!("--seeds {}", a.seeds), e))?;
    let shard = a
        .shard
        .as_deref()
        .map(|s| seeds::shard(s).map_err(|e| wrong(format!("--shard {s}"), e)))
        .transpose()?;
    let mut sets: Vec<(String, Vec<String>)> = Vec::new();
    for text in &a.sets {
        let (name, values) = compile::split_setting(text)?;
        let values = sweep::values(&values);
        let at = sets.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
            sets.push((name, Vec::new()));
            sets.len() - 1
        });
        // A value given twice would make runs count twice.
        for value in values {
            if !sets[at].1.contains(&value) {
                sets[at].1.push(value);
            }
        }
    }
    let plan = Plan { platforms: a.platform.clone(), test: a.test.clone(), sets, seeds };
    if plan.runs().is_none_or(|n| n > 10_000_000) {
        return Err(wrong("sweep".into(), "more than ten million runs".into()));
    }
    sweep::execute(file, a.mission.as_deref(), plan, shard, execute::threads(a.threads))
}

fn merge(paths: &[String]) -> Result<(Document, Exit), Refusal> {
    let hint = "give the JSON of every shard of one sweep, each once";
    let mut shards = Vec::new();
    for path in paths {
        let text = files::read_text(path)?;
        let document: Document = serde_json::from_str(&text).map_err(|e| {
            Refusal::about(path, "S9016", "this is no result of a sweep", e.to_string(), hint)
        })?;
        shards.push((path.clone(), document));
    }
    let merged = Document::merge(shards).map_err(|why| {
        Refusal::about("sweep merge", "S9016", "these sweep results do not go together", why, hint)
    })?;
    let exit = merged.runs.iter().map(|r| Exit::of_outcome(&r.outcome)).max().unwrap_or(Exit::Success);
    Ok((merged, exit))
}

/// Metrics that say little in a table: left to the JSON.
fn minor(name: &str) -> bool {
    name.ends_with(".reached") || name.ends_with(".collisions") || name.ends_with(".path_length_m")
}

fn human(d: &Document) -> String {
    let outcomes = d.runs.iter().fold(BTreeMap::<&str, usize>::new(), |mut m, r| {
        *m.entry(r.outcome.as_str()).or_default() += 1;
        m
    });
    let tally: Vec<String> = outcomes.iter().map(|(o, n)| format!("{n} {o}")).collect();
    let mut s = format!("{}: {} runs: {}\n", d.mission, d.runs.len(), tally.join(", "));
    for g in &d.groups {
        let rows: Vec<Vec<String>> = g
            .summary
            .iter()
            .filter(|(name, v)| !minor(name) && v.n > 0)
            .map(|(name, v)| {
                vec![
                    name.clone(),
                    format!("{} ± {}", figure(v.mean), figure(v.sd)),
                    figure(v.min),
                    figure(v.median),
                    figure(v.max),
                    v.n.to_string(),
                ]
            })
            .collect();
        if d.groups.len() > 1 {
            s += &format!("\n{}\n", g.case.label());
        } else {
            s.push('\n');
        }
        s += &table(&["metric (SI units)", "mean ± sd", "min", "median", "max", "n"], &rows);
    }
    s + &failures(d)
}

/// More seeds than this are only counted.
const SEEDS: usize = 20;

/// Seeds that did not succeed, by case and reason.
fn failures(d: &Document) -> String {
    let mut by: BTreeMap<(String, &str, &str), Vec<u64>> = BTreeMap::new();
    for r in d.runs.iter().filter(|r| r.outcome != "success") {
        by.entry((r.case.label(), &r.outcome, &r.reason)).or_default().push(r.seed);
    }
    let mut s = String::new();
    for ((case, outcome, reason), seeds) in by {
        let shown: Vec<String> = seeds.iter().take(SEEDS).map(u64::to_string).collect();
        let more =
            if seeds.len() > SEEDS { format!(" and {} more", seeds.len() - SEEDS) } else { String::new() };
        let case = if d.groups.len() > 1 { format!("{case}, ") } else { String::new() };
        let why = if reason.is_empty() { String::new() } else { format!(" ({reason})") };
        s += &format!("\n{outcome}{why}: {case}seeds {}{more}", shown.join(", "));
    }
    if s.is_empty() { s } else { s + "\n" }
}
