//! The vision services: what a mission sees, out of images.

mod eye;
mod onlooker;
mod people;
mod published;
mod sight;

pub use onlooker::Onlooker;
use sight::Sight;
use soifra_graph::{Function, eval::FaultKind, reason};
use soifra_runtime::objects::Shelf;
use soifra_vision::Why;
use std::sync::Arc;

/// Computes a service.
pub fn call(which: Function, args: &[f64], shelf: &mut dyn Shelf, out: &mut [f64]) -> Result<(), FaultKind> {
    if which == Function::Look {
        let made = eye::look(args, shelf)?;
        return optional(out, made.map(|sight| [shelf.put(Arc::new(sight))]));
    }
    if which == Function::WatchPeople {
        let made = people::watch(args, shelf)?;
        return optional(out, made.map(|people| [shelf.put(Arc::new(people))]));
    }
    let (number, rest) = args.split_first().ok_or(FaultKind::Malformed)?;
    let object = shelf.get(*number).ok_or(FaultKind::Unavailable("this sight"))?;
    if which == Function::PeopleSeen {
        let people = object.as_any().downcast_ref::<people::Crowd>().ok_or(FaultKind::Malformed)?;
        return people.seen(out);
    }
    let sight = object.as_any().downcast_ref::<Sight>().ok_or(FaultKind::Malformed)?;
    match (which, rest) {
        (Function::Viewpoint, []) => {
            let slots: &mut [f64; 4] = out.try_into().map_err(|_| FaultKind::Malformed)?;
            *slots = sight.viewpoint();
            Ok(())
        }
        (Function::Obstacles, []) => sight.obstacles(out),
        (Function::ContactByExpansion, []) => optional(out, sight.expansion().map(|t| [t])),
        (Function::ContactByFlow, []) => optional(out, sight.flow().map(|t| [t])),
        (Function::ContactByRobustFlow, [rotating]) => {
            optional(out, sight.robust_flow(*rotating).map(|t| [t]))
        }
        (Function::Diverging, []) => optional(out, sight.diverging().map(|b| [f64::from(u8::from(b))])),
        (Function::NearestPairAhead, []) => optional(out, published::ahead(sight)),
        (Function::CourseAhead, [radius, least]) => optional(out, sight.course(*radius, *least)),
        _ => Err(FaultKind::Malformed),
    }
}

/// Registers of an optional: tag and value.
fn optional<const N: usize>(out: &mut [f64], value: Result<[f64; N], Why>) -> Result<(), FaultKind> {
    let (tag, rest) = out.split_first_mut().ok_or(FaultKind::Malformed)?;
    if rest.len() != N {
        return Err(FaultKind::Malformed);
    }
    match value {
        Ok(value) => {
            *tag = 0.0;
            rest.copy_from_slice(&value);
        }
        Err(why) => {
            *tag = reason::tag(reason::index(why.text()));
            rest.fill(0.0);
        }
    }
    Ok(())
}
