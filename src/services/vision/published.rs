//! The detection as it was published: two images, the nearest pair of edges, and their flow.

use super::{eye, sight::Sight};
use soifra_vision::{Why, course, flow, look, points, robust::Part};

/// Collision, distance, clearance, whether the left is freer, turns to the left and to the right; see
/// `nearest_pair_ahead`. Lengths in m, angles in rad; clearance and turns are 0.
///
/// # Errors
/// [`Why::TooShort`] for a first image, those of [`look::nearest`], [`course::diverging`] and [`flow::published`], and
/// [`Why::SpeedUnknown`] and [`Why::SpeedZero`], with which nothing is known of the distance.
pub fn ahead(sight: &Sight) -> Result<[f64; 6], Why> {
    let (Some(previous), Some(present), Some(interval)) =
        (&sight.previous, &sight.memory.image, sight.interval)
    else {
        return Err(Why::TooShort);
    };
    let lens = eye::straight(&sight.optics);
    let (roll, following) = (sight.moment.attitude.roll, points::Following::default());
    let pair = look::nearest(previous, present, roll, &lens, &sight.contours, &following)?;
    let of = |part: Part| -> Vec<flow::Track> {
        pair.flows.iter().filter(|f| f.part == part).map(|f| f.track).collect()
    };
    let collision = course::diverging(&of(Part::Left), &of(Part::Right))?;
    let tracks: Vec<flow::Track> = pair.flows.iter().map(|f| f.track).collect();
    let contact = flow::published(&tracks, interval)?.ttc;
    let speed = match sight.speed {
        None => return Err(Why::SpeedUnknown),
        Some(0.0) => return Err(Why::SpeedZero),
        Some(speed) => speed,
    };
    let distance = contact * speed + sight.optics.ahead(sight.slip());
    let middle = 0.5 * (pair.left.x(&lens) + pair.right.x(&lens));
    let flag = |b: bool| f64::from(u8::from(b));
    Ok([flag(collision), distance, 0.0, flag(middle > lens.cx), 0.0, 0.0])
}
