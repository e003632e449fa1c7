//! The mapping services: maps, poses and ways, out of scans and odometry.

mod map;
mod registers;

use map::Map;
use registers::{Registers, Slots};
use soifra_graph::{Function, eval::FaultKind};
use soifra_mapping::{
    Path, Place, Why,
    matching::Matching,
    overlap::overlap,
    particles::{self, Localising, Particles},
    route::{self, Room},
};
use soifra_runtime::objects::{Object, Shelf};
use std::{any::Any, sync::Arc};

/// Where a robot may be.
#[derive(Debug)]
struct Belief(Particles);

/// A way.
#[derive(Debug)]
struct Way(Path);

impl Object for Belief {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl Object for Way {
    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Whether a service is one of these.
pub fn computes(which: Function) -> bool {
    use Function as F;
    matches!(
        which,
        F::KnownMap
            | F::TrueMap
            | F::EmptyMap
            | F::Observe
            | F::Localise
            | F::Located
            | F::MatchScan
            | F::PlanPath
            | F::Track
            | F::FreeWay
            | F::MapOverlap
    )
}

/// Computes a service.
pub fn call(which: Function, args: &[f64], shelf: &mut dyn Shelf, out: &mut [f64]) -> Result<(), FaultKind> {
    let (mut args, out) = (Registers(args), Slots(out));
    match which {
        Function::KnownMap => {
            let [resolution] = args.take()?;
            let made = Map::known(&shelf.mapped(), resolution);
            out.optional(made.map(|m| [shelf.put(Arc::new(m))]))
        }
        Function::TrueMap => {
            let [resolution] = args.take()?;
            let parts = shelf.standing().ok_or(FaultKind::Unavailable("world truth"))?;
            let made = Map::known(&parts, resolution);
            out.optional(made.map(|m| [shelf.put(Arc::new(m))]))
        }
        Function::EmptyMap => {
            let [x, y, _, to_x, to_y, _, resolution] = args.take()?;
            let made = Map::empty([x, y], [to_x, to_y], resolution);
            out.optional(made.map(|m| [shelf.put(Arc::new(m))]))
        }
        Function::Observe => {
            let grid = args.object(shelf)?;
            let at = args.place()?;
            let [reach] = args.take_last()?;
            let seen = of::<Map>(&grid)?.with(at, &args.scan()?, reach);
            out.value([shelf.put(Arc::new(seen))])
        }
        Function::Localise => {
            let made = localise(args, shelf)?;
            out.optional(made.map(|b| [shelf.put(Arc::new(Belief(b)))]))
        }
        Function::Located => {
            let belief = args.object(shelf)?;
            let e = of::<Belief>(&belief)?.0.estimate;
            let mut values = [0.0; 16];
            let (place, rest) = values.split_at_mut(7);
            place.copy_from_slice(&pose(e.place));
            rest[..7].copy_from_slice(&pose(e.origin));
            rest[7] = e.deviation;
            rest[8] = e.turn_deviation;
            out.value(values)
        }
        Function::MatchScan => {
            let grid = args.object(shelf)?;
            let guess = args.place()?;
            let [window, turn] = args.take_last()?;
            let how = Matching { window: [window, turn], ..Matching::default() };
            let found = of::<Map>(&grid)?.fit(&args.scan()?, guess, &how);
            out.optional(found.map(pose))
        }
        Function::PlanPath => {
            let grid = args.object(shelf)?;
            let [x, y, _, to_x, to_y, _, clearance, comfort] = args.take()?;
            let room = Room { clearance, comfort };
            let points = route::plan(of::<Map>(&grid)?.field(), [x, y], [to_x, to_y], &room);
            out.optional(points.and_then(Path::new).map(|p| [shelf.put(Arc::new(Way(p)))]))
        }
        Function::Track => {
            let way = args.object(shelf)?;
            let at = args.place()?;
            let [lookahead] = args.take()?;
            let t = of::<Way>(&way)?.0.track(at, lookahead);
            out.value([t.deviation, t.remaining, t.bearing, t.curvature])
        }
        Function::FreeWay => {
            let way = args.object(shelf)?;
            let grid = args.object(shelf)?;
            let [x, y, _, clearance] = args.take()?;
            out.value([of::<Way>(&way)?.0.free(of::<Map>(&grid)?.field(), [x, y], clearance)])
        }
        Function::MapOverlap => {
            let (a, b) = (args.object(shelf)?, args.object(shelf)?);
            out.value([overlap(&of::<Map>(&a)?.grid, &of::<Map>(&b)?.grid)])
        }
        _ => Err(FaultKind::Malformed),
    }
}

fn localise(mut args: Registers<'_>, shelf: &dyn Shelf) -> Result<Result<Particles, Why>, FaultKind> {
    let before = args.optional_object(shelf)?;
    let before = before.as_ref().map(of::<Belief>).transpose()?;
    let (start, odometry) = (args.place()?, args.place()?);
    let [grid, random, count, spread, turn_spread] = args.take_last()?;
    let grid = shelf.get(grid).ok_or(FaultKind::Unavailable("this grid"))?;
    let how =
        Localising { count: count.max(1.0) as usize, spread: [spread, turn_spread], ..Localising::default() };
    let scan = args.scan()?;
    let field = of::<Map>(&grid)?.field();
    Ok(particles::localise(before.map(|b| &b.0), start, odometry, &scan, field, random, &how))
}

/// An object as what it is.
fn of<T: 'static>(object: &Arc<dyn Object>) -> Result<&T, FaultKind> {
    object.as_any().downcast_ref::<T>().ok_or(FaultKind::Malformed)
}

/// Registers of a pose on the ground: position, then a turn about z as a quaternion.
fn pose(place: Place) -> [f64; 7] {
    let (s, c) = libm::sincos(0.5 * place.yaw);
    [place.at[0], place.at[1], 0.0, 0.0, 0.0, s, c]
}
