//! Runs the cases of a plan in parallel.

use super::{
    document::{Document, Run},
    plan::Plan,
};
use crate::{compile, execute as run, exit::Exit, graph_file, interrupt, output, report::Refusal};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;
use soifra_graph::Value;
use soifra_runtime::Mission;
use std::{collections::BTreeMap, io::IsTerminal, sync::atomic::AtomicBool};

/// One run to be made: place in the plan, case, seed.
#[derive(Clone, Copy)]
struct Job {
    index: usize,
    case: usize,
    seed: u64,
}

/// Runs `plan`, or the part of it that `shard` names, on `threads` threads; `mission` is one of the file's, its first
/// when absent. Everything that can be refused is refused before the first run starts. The second value is the worst
/// run's exit code.
pub fn execute(
    file: &str,
    mission: Option<&str>,
    plan: Plan,
    shard: Option<(usize, usize)>,
    threads: usize,
) -> Result<(Document, Exit), Refusal> {
    let stop = interrupt::flag();
    let mut missions: BTreeMap<Option<String>, (Mission, String)> = BTreeMap::new();
    let cases = plan.cases();
    let mut tests = Vec::new();
    let mut values: Vec<Vec<(usize, Value)>> = Vec::new();
    for case in &cases {
        if !missions.contains_key(&case.platform) {
            let compiled =
                compile::compile_with(file, case.platform.as_deref(), mission, plan.test.as_deref())?;
            if missions.is_empty() {
                compiled.findings.print();
            }
            let digest = graph_file::digest(&compiled.graph);
            tests.clone_from(&compiled.tests);
            missions.insert(case.platform.clone(), (compiled.mission()?, digest));
        }
        let graph = missions[&case.platform].0.graph();
        let set = compile::with_test(&tests, plan.test.as_deref(), case.set.clone());
        let set = compile::settings(graph, &set)?;
        compile::verify_with(graph, &set)?;
        values.push(set);
    }
    let all = (0..cases.len()).flat_map(|case| plan.seeds.iter().map(move |seed| (case, *seed)));
    let mine = |index: &usize| shard.is_none_or(|(i, n)| index % n == i - 1);
    let jobs: Vec<Job> = all
        .enumerate()
        .map(|(index, (case, seed))| Job { index, case, seed })
        .filter(|j| mine(&j.index))
        .collect();

    let bar = progress(jobs.len());
    let one = |job: &Job| -> Option<Result<(Run, Exit), Refusal>> {
        if interrupt::requested() {
            return None;
        }
        let case = &cases[job.case];
        let mission = &missions[&case.platform].0;
        let result = one_run(mission, job, &values[job.case], &stop);
        bar.inc(1);
        match result {
            Ok(report) if report.interrupted() => None,
            Ok(report) => Some(Ok((Run::of(job.index, case, &report), run::exit_of(&report)))),
            Err(refusal) => Some(Err(refusal)),
        }
    };
    let results: Vec<_> =
        match rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(16 << 20).build() {
            Ok(pool) => pool.install(|| jobs.par_iter().map(one).collect()),
            Err(_) => jobs.iter().map(one).collect(),
        };
    bar.finish_and_clear();

    let complete = results.iter().all(Option::is_some);
    let mut worst = if complete { Exit::Success } else { Exit::Interrupted };
    let mut runs = Vec::new();
    for result in results.into_iter().flatten() {
        let (run, exit) = result?;
        worst = worst.max(exit);
        runs.push(run);
    }
    if !complete {
        output::note(&format!("interrupted after {} of {} runs", runs.len(), jobs.len()));
    }
    let name = missions.values().next().map_or(String::new(), |(m, _)| m.graph().name.to_string());
    let digests = missions.into_iter().map(|(p, (_, d))| (p.unwrap_or_default(), d)).collect();
    Ok((Document::new(name, digests, plan, shard, complete, runs), worst))
}

fn one_run(
    mission: &Mission,
    job: &Job,
    values: &[(usize, Value)],
    stop: &AtomicBool,
) -> Result<soifra_runtime::RunReport, Refusal> {
    // A sweep is parallel over its runs; each of them uses one thread.
    let settings = run::settings(mission.graph(), job.seed, values, 1);
    run::Prepared::new(mission, settings)?.run(stop)
}

/// A bar on standard error, when that is a terminal.
fn progress(length: usize) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let bar = ProgressBar::with_draw_target(Some(length as u64), target);
    match ProgressStyle::with_template("  {bar:40} {pos}/{len} runs, {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
