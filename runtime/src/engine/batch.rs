//! Evaluates the activations of an instant, on several threads when they are many.
//!
//! Activations of different agents are independent: they share only what does not change before they
//! are committed. Those of one agent run one after the other, in their order. So the outcomes do not
//! depend on how the batch is cut up.

use super::{
    activate::{Desk, Outcome, Release, activate},
    env::Instant,
    minds::{Minds, MindsMut},
};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Fewer activations than this are not worth waking a thread.
const FEW: usize = 128;

/// Threads, and the desks they work at.
#[derive(Default)]
pub(crate) struct Workers {
    pub desks: Vec<Desk>,
    pool: Option<rayon::ThreadPool>,
    /// Releases in order of their agents.
    order: Vec<u32>,
}

impl Workers {
    /// As many workers as `threads`, as far as the system gives them; frames of `frame` registers.
    pub fn new(threads: usize, frame: usize) -> Self {
        let pool = (threads > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok())
            .flatten();
        let count = if pool.is_some() { 2 * threads } else { 1 };
        let desk = || Desk { frame: vec![0.0; frame], ..Desk::default() };
        Workers { desks: (0..count).map(|_| desk()).collect(), pool, order: Vec::new() }
    }

    /// How many threads there are, the calling one included.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// Evaluates `releases`; `outcomes` gets one entry for each.
    pub fn evaluate(
        &mut self,
        instant: &Instant<'_>,
        minds: &mut Minds,
        releases: &[Release],
        outcomes: &mut Vec<Outcome>,
    ) {
        let instance = |k: u32| instant.cast.units[releases[k as usize].unit as usize].instance as usize;
        self.order.clear();
        self.order.extend(0..releases.len() as u32);
        if !self.order.is_sorted_by_key(|&k| instance(k)) {
            self.order.sort_by_key(|&k| instance(k));
        }
        for d in &mut self.desks {
            d.log.clear();
        }
        outcomes.clear();
        let all = minds.all(instant.cast);
        match &self.pool {
            Some(pool) if releases.len() >= FEW => {
                outcomes.resize(releases.len(), Outcome::default());
                let jobs = cut(instant, all, &self.order, &mut self.desks, instance);
                let done: Vec<Vec<(u32, Outcome)>> =
                    pool.install(|| jobs.into_par_iter().map(|job| job.run(instant, releases)).collect());
                for (k, outcome) in done.into_iter().flatten() {
                    outcomes[k as usize] = outcome;
                }
            }
            _ => {
                let Some(desk) = self.desks.first_mut() else { return };
                let in_order = self.order.is_sorted();
                if !in_order {
                    outcomes.resize(releases.len(), Outcome::default());
                }
                let mut all = all;
                for &k in &self.order {
                    let release = &releases[k as usize];
                    let outcome = activate(instant, all.mind(instant.cast, instance(k)), desk, release);
                    if in_order {
                        outcomes.push(outcome);
                    } else {
                        outcomes[k as usize] = outcome;
                    }
                }
            }
        }
    }
}

/// What one thread does: releases of consecutive agents.
struct Job<'a> {
    number: u32,
    minds: MindsMut<'a>,
    order: &'a [u32],
    desk: &'a mut Desk,
}

impl Job<'_> {
    fn run(mut self, instant: &Instant<'_>, releases: &[Release]) -> Vec<(u32, Outcome)> {
        let mut done = Vec::with_capacity(self.order.len());
        for &k in self.order {
            let release = &releases[k as usize];
            let instance = instant.cast.units[release.unit as usize].instance as usize;
            let outcome = activate(instant, self.minds.mind(instant.cast, instance), self.desk, release);
            done.push((k, Outcome { log: self.number, ..outcome }));
        }
        done
    }
}

/// Cuts a batch into one job for each desk, between agents.
fn cut<'a>(
    instant: &Instant<'_>,
    minds: MindsMut<'a>,
    mut order: &'a [u32],
    desks: &'a mut [Desk],
    instance: impl Fn(u32) -> usize,
) -> Vec<Job<'a>> {
    let size = order.len().div_ceil(desks.len().max(1));
    let mut jobs: Vec<Job<'a>> = Vec::new();
    let mut rest = Some(minds);
    for (number, desk) in desks.iter_mut().enumerate() {
        let Some(minds) = rest.take() else { break };
        let mut end = size.min(order.len());
        while end > 0 && end < order.len() && instance(order[end]) == instance(order[end - 1]) {
            end += 1;
        }
        let (mine, others) = order.split_at(end);
        order = others;
        let minds = match others.first() {
            Some(&k) => {
                let (minds, after) = minds.split_at(instant.cast, instance(k));
                rest = Some(after);
                minds
            }
            None => minds,
        };
        jobs.push(Job { number: number as u32, minds, order: mine, desk });
    }
    jobs
}
