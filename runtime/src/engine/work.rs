//! What executing units asks for: cores, drawn execution times, budgets, shared resources. Fixed at the start.

use super::cast::{Cast, CoreInfo, LONGEST, Rank, Work};
use crate::{
    Time,
    mission::{
        START_VALUE,
        code::{KindCode, UnitCode},
        start::Start,
    },
    seed::stream_id,
};
use soifra_graph::{Diagnostic, Distribution, Name, eval::Block};
use std::cmp::Reverse;

/// The most rounds of one activation.
const MOST_ROUNDS: i64 = 100_000;

/// What the unit that is added to the cast next asks for; `None` when it just takes its worst case, on nobody's
/// core.
pub(super) fn of_unit(
    cast: &mut Cast,
    start: &mut Start<'_>,
    robot: u32,
    unit: &UnitCode,
    source: &str,
    arguments: &[f64],
) -> Result<Option<u32>, Diagnostic> {
    let t = &unit.timing;
    let tolerant = matches!(t.misses, soifra_graph::Misses::AtMost(_));
    let timed = t.core.is_some() || t.takes.is_some() || t.jitter.is_some() || t.budget.is_some();
    if !timed && !tolerant {
        return Ok(None);
    }
    let bad = |text: String| Diagnostic::error(START_VALUE, text).at(unit.span, "in the timing of this unit");
    let duration = |start: &mut Start<'_>, block: Option<&Block>| -> Result<Time, Diagnostic> {
        let Some(block) = block else { return Ok(Time::ZERO) };
        let s = start.run_with(block, &[], arguments)?.first().copied().unwrap_or(0.0);
        match Time::from_seconds(s) {
            Some(t) if (0..=LONGEST).contains(&t.0) => Ok(t),
            _ => Err(bad(format!("a duration of {s} s is not possible here"))),
        }
    };
    let worst = duration(start, t.worst_case.as_ref())?;
    let budget = duration(start, t.budget.as_ref())?;
    let jitter = duration(start, t.jitter.as_ref())?;
    let cost = match &unit.kind {
        KindCode::Anytime(a) => duration(start, Some(&a.cost))?,
        _ => Time::ZERO,
    };
    let rounds = if cost > Time::ZERO { budget.0 / cost.0 } else { 0 };
    if matches!(unit.kind, KindCode::Anytime(_)) && !(1..=MOST_ROUNDS).contains(&rounds) {
        return Err(bad(format!(
            "a budget of {} s for rounds of {} s is not possible",
            budget.seconds(),
            cost.seconds()
        )));
    }
    let mut resources: Vec<(Name, Time)> = Vec::new();
    for (name, block) in &t.shares {
        let time = duration(start, Some(block))?;
        resources.push((name.clone(), time));
    }
    let takes = match &t.takes {
        Some(block) => match start.run_with(block, &[], arguments)? {
            r if r.len() == 4 => Some(Distribution::from_registers(r)),
            _ => return Err(bad("no distribution".into())),
        },
        None => None,
    };
    let charged = worst > Time::ZERO || rounds > 0;
    let core = match t.core {
        Some(n) if charged => {
            let n = u32::try_from(n).map_err(|_| bad(format!("there is no core {n}")))?;
            Some(core(cast, robot, Some(n)))
        }
        // Rounds are charged one after the other, if to nobody else's core.
        None if rounds > 0 => Some(core(cast, robot, None)),
        _ => None,
    };
    cast.works.push(Work {
        core,
        takes,
        rounds: rounds as u32,
        cost,
        jitter,
        misses: t.misses,
        resources,
        sections: Vec::new(),
        stream: stream_id(source),
    });
    Ok(Some(cast.works.len() as u32 - 1))
}

/// The core of a robot with a number; a new one when there is none, or no number.
fn core(cast: &mut Cast, robot: u32, number: Option<u32>) -> u32 {
    let known = number.and_then(|_| cast.cores.iter().position(|c| c.robot == robot && c.number == number));
    let at = known.unwrap_or_else(|| {
        cast.cores.push(CoreInfo { robot, number });
        cast.cores.len() - 1
    });
    at as u32
}

/// Gives every resource its ceiling: the rank of the most urgent unit of the core that holds it.
pub(super) fn ceilings(cast: &mut Cast) {
    let mut holders: Vec<(u32, Name, Rank)> = Vec::new();
    for (u, info) in cast.units.iter().enumerate() {
        let Some(work) = info.work.and_then(|w| cast.works.get(w as usize)) else { continue };
        let Some(core) = work.core else { continue };
        let rank = (Reverse(info.priority), u as u32);
        for (name, _) in &work.resources {
            match holders.iter_mut().find(|h| h.0 == core && h.1 == *name) {
                Some(h) => h.2 = h.2.min(rank),
                None => holders.push((core, name.clone(), rank)),
            }
        }
    }
    for work in &mut cast.works {
        let Some(core) = work.core else { continue };
        let ceiling = |name: &Name| holders.iter().find(|h| h.0 == core && h.1 == *name).map(|h| h.2);
        work.sections = work.resources.iter().filter_map(|(n, t)| Some((ceiling(n)?, *t))).collect();
    }
}
