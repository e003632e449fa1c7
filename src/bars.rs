//! Measured promises: what a mission must reach over how many seeds, read from a file, run in
//! resumable pieces, and written as Markdown tables.

use crate::{
    compile,
    exit::Exit,
    files, graph_file, interrupt, output,
    report::{Refusal, table::figure},
    statistics::Summary,
    sweep::{self, Document, Plan},
};
use serde::Deserialize;
use std::{collections::BTreeMap, fmt::Write, path::Path};

/// Runs of a study that one saved piece holds at most.
const PIECE: usize = 10;

/// A mission with its seeds, parameters, and what is asked of it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// Name; also of its saved pieces.
    pub name: String,
    /// Heading.
    pub title: String,
    /// Mission, from the folder where the command runs.
    pub mission: String,
    /// Seeds as `soifra sweep` takes them.
    #[serde(default = "twenty")]
    pub seeds: String,
    /// Seeds of the sample that the test suite runs; empty for a study that takes too long.
    #[serde(default = "sample")]
    pub sample: String,
    /// Parameters, each with one value or several separated by commas.
    #[serde(default)]
    pub set: BTreeMap<String, String>,
    /// Test of the mission's file whose faults happen.
    #[serde(default)]
    pub test: Option<String>,
    /// Platforms in place of the mission's own.
    #[serde(default)]
    pub platforms: Vec<String>,
    /// What the reader should know.
    #[serde(default)]
    pub text: String,
    /// Rows of its table.
    pub bars: Vec<Bar>,
}

fn twenty() -> String {
    "20".into()
}

fn sample() -> String {
    "3".into()
}

/// A figure, what was published of it, and what is asked of it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bar {
    /// Name as in a sweep's summary.
    pub metric: String,
    /// Words for it; the metric's name when absent.
    #[serde(default)]
    pub label: Option<String>,
    /// As published, in the unit of the table.
    #[serde(default)]
    pub published: Option<String>,
    /// What the figures are multiplied by, as 100 for centimetres.
    #[serde(default = "one")]
    pub scale: f64,
    /// For a mean that is pooled: the metric that says how many samples each run's figure stands for.
    #[serde(default)]
    pub over: Option<String>,
    /// For a share: the metric whose sum over all runs the sum of this one is divided by.
    #[serde(default)]
    pub per: Option<String>,
    /// What the bar is about.
    #[serde(default)]
    pub of: Statistic,
    /// The bar, in SI units.
    #[serde(default)]
    pub at_most: Option<f64>,
    /// The bar, in SI units.
    #[serde(default)]
    pub at_least: Option<f64>,
    /// For a share of the runs, a bar that few seeds say nothing about: not asked of the sample.
    #[serde(default)]
    pub full_only: bool,
}

fn one() -> f64 {
    1.0
}

/// Which figure of a summary a bar is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Statistic {
    /// Arithmetic mean; of a truth value the share of the runs.
    Mean,
    /// Middle value.
    Median,
    /// Least.
    Min,
    /// Greatest.
    #[default]
    Max,
}

/// What became of a bar.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// The metric.
    pub metric: String,
    /// The figure the bar is about; none when no run has it.
    pub value: Option<f64>,
    /// Whether it was met; none without a bar.
    pub met: Option<bool>,
}

/// Reads a file of studies.
pub fn read(path: &str) -> Result<Vec<Study>, Refusal> {
    graph_file::from_yaml(path, &files::read_text(path)?)
}

impl Study {
    /// The plan for these seeds.
    pub fn plan(&self, seeds: &str) -> Result<Plan, Refusal> {
        let seeds = crate::seeds::parse(seeds).map_err(|why| {
            Refusal::about(
                &self.name,
                "S9015",
                "a list of seeds or a shard is wrong",
                why,
                "write `20` or `1..20,42`",
            )
        })?;
        let sets = self.set.iter().map(|(n, v)| (n.clone(), sweep::values(v))).collect();
        Ok(Plan { platforms: self.platforms.clone(), test: self.test.clone(), sets, seeds })
    }

    /// Runs everything in pieces that are saved in `folder`; pieces that are there already, of the same
    /// graph and plan, are not run again. `None` when it was interrupted.
    pub fn run(&self, folder: &str, threads: usize) -> Result<Option<Document>, Refusal> {
        let plan = self.plan(&self.seeds)?;
        let pieces = plan.runs().unwrap_or(usize::MAX).div_ceil(PIECE).clamp(1, 1000);
        let key = self.key(&plan)?;
        let mut shards = Vec::new();
        for i in 1..=pieces {
            let path = format!("{folder}/{}-{key}-{i}of{pieces}.json", self.name);
            if let Some(saved) = saved(&path) {
                shards.push((path, saved));
                continue;
            }
            output::note(&format!("{}: piece {i} of {pieces}", self.name));
            let (document, exit) =
                sweep::execute(&self.mission, None, plan.clone(), Some((i, pieces)), threads)?;
            if exit == Exit::Interrupted || interrupt::requested() {
                return Ok(None);
            }
            files::write(&path, serde_json::to_string(&document).unwrap_or_default().as_bytes())?;
            shards.push((path, document));
        }
        Document::merge(shards).map(Some).map_err(|why| {
            let hint = format!("remove `{folder}` and measure again");
            Refusal::about(&self.name, "S9016", "these sweep results do not go together", why, &hint)
        })
    }

    /// What saved pieces depend on: graphs and plan.
    fn key(&self, plan: &Plan) -> Result<String, Refusal> {
        let mut text = serde_json::to_string(plan).unwrap_or_default();
        let platforms =
            if plan.platforms.is_empty() { vec![None] } else { plan.platforms.iter().map(Some).collect() };
        for p in platforms {
            let (platform, test) = (p.map(String::as_str), self.test.as_deref());
            let compiled = compile::compile_with(&self.mission, platform, None, test)?;
            text += &graph_file::digest(&compiled.graph);
        }
        Ok(graph_file::sha256(text.as_bytes())[..12].to_string())
    }

    /// What became of each bar, over all runs.
    pub fn verdicts(&self, document: &Document) -> Vec<Verdict> {
        self.bars.iter().map(|b| b.verdict(document)).collect()
    }

    /// The study as Markdown.
    pub fn markdown(&self, document: &Document) -> String {
        let sets: Vec<String> = self.set.iter().map(|(n, v)| format!("{n}={v}")).collect();
        let mut s = format!("### {}\n\n", self.title);
        if !self.text.is_empty() {
            let _ = writeln!(s, "{}\n", self.text.trim());
        }
        let with = if sets.is_empty() { String::new() } else { format!(", `{}`", sets.join("`, `")) };
        let _ =
            writeln!(s, "`{}`, seeds {}{with}: {} runs.\n", self.mission, self.seeds, document.runs.len());
        s += "| figure | published | mean | sd | median | min | max | n | bar | |\n|---|---|---|---|---|---|---|---|---|---|\n";
        for (bar, verdict) in self.bars.iter().zip(self.verdicts(document)) {
            let scaled = |x: Option<f64>| figure(x.map(|x| x * bar.scale));
            let of =
                |f: &dyn Fn(&Summary) -> Option<f64>| scaled(document.summary.get(&bar.metric).and_then(f));
            let _ = writeln!(
                s,
                "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                bar.label.as_deref().unwrap_or(&bar.metric),
                bar.published.as_deref().unwrap_or("–"),
                of(&|s| s.mean),
                of(&|s| s.sd),
                of(&|s| s.median),
                of(&|s| s.min),
                of(&|s| s.max),
                document.summary.get(&bar.metric).map_or(0, |s| s.n),
                match (bar.over.is_some() || bar.per.is_some(), bar.words().is_empty()) {
                    (false, _) => bar.words(),
                    (true, false) => format!("{} (is {})", bar.words(), scaled(verdict.value)),
                    (true, true) => format!("pooled {}", scaled(verdict.value)),
                },
                match verdict.met {
                    Some(true) => "met",
                    Some(false) => "**missed**",
                    None => "",
                },
            );
        }
        s.push('\n');
        s
    }
}

impl Bar {
    fn verdict(&self, document: &Document) -> Verdict {
        let value = self.value(document);
        let asked = self.at_most.is_some() || self.at_least.is_some();
        let holds = value
            .is_some_and(|v| self.at_most.is_none_or(|b| v <= b) && self.at_least.is_none_or(|b| v >= b));
        Verdict { metric: self.metric.clone(), value, met: asked.then_some(holds) }
    }

    /// The figure the bar is about.
    fn value(&self, document: &Document) -> Option<f64> {
        let sums = |f: fn(f64, f64) -> [f64; 2], with: &str| {
            let pair = |figures: Vec<(String, Option<f64>)>| {
                let get = |name: &str| figures.iter().find(|(n, _)| n == name).and_then(|(_, v)| *v);
                Some(f(get(&self.metric)?, get(with)?))
            };
            let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
            let [above, below] = document.runs.iter().filter_map(|r| pair(r.figures())).fold([0.0; 2], sum);
            (below > 0.0).then(|| above / below)
        };
        match (&self.over, &self.per) {
            (Some(over), _) => sums(|x, n| [x * n, n], over),
            (None, Some(per)) => sums(|x, y| [x, y], per),
            (None, None) => document.summary.get(&self.metric).and_then(|s| match self.of {
                Statistic::Mean => s.mean,
                Statistic::Median => s.median,
                Statistic::Min => s.min,
                Statistic::Max => s.max,
            }),
        }
    }

    fn words(&self) -> String {
        let of = match self.of {
            _ if self.over.is_some() => "pooled",
            _ if self.per.is_some() => "share",
            Statistic::Mean => "mean",
            Statistic::Median => "median",
            Statistic::Min => "min",
            Statistic::Max => "max",
        };
        let part =
            |sign: &str, b: Option<f64>| b.map(|b| format!("{of} {sign} {}", figure(Some(b * self.scale))));
        [part("≤", self.at_most), part("≥", self.at_least)]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", ")
    }
}

fn saved(path: &str) -> Option<Document> {
    let document: Document = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    document.complete.then_some(document)
}

/// Lines between which a report is rewritten; the rest of the page stays.
const BEGIN: &str = "<!-- measured: begin -->";
const END: &str = "<!-- measured: end -->";

/// Puts `measured` between the marks of the page at `path`, or makes the page.
pub fn write_page(path: &str, measured: &str) -> Result<(), Refusal> {
    let old = if Path::new(path).exists() {
        files::read_text(path)?
    } else {
        format!("# Results\n\n{BEGIN}\n{END}\n")
    };
    let text = match (old.split_once(BEGIN), old.split_once(END)) {
        (Some((before, _)), Some((_, after))) => format!("{before}{BEGIN}\n\n{measured}{END}{after}"),
        _ => format!("{old}\n{BEGIN}\n\n{measured}{END}\n"),
    };
    files::write(path, text.as_bytes())
}
