//! Which way the body goes, and how fast, out of where odometry says it was at the last images.

use crate::why::Why;

/// Where the body was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Seconds.
    pub time: f64,
    /// Metres in the level frame.
    pub place: [f64; 2],
    /// Radians in the level frame.
    pub yaw: f64,
}

/// How the body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Azimuth of the direction of motion in the level frame, radians.
    pub course: f64,
    /// Metres per second.
    pub speed: f64,
}

/// A point of the level frame as seen from a body at `place` that goes along `course`: metres ahead, to the left.
pub fn relative(point: [f64; 2], place: [f64; 2], course: f64) -> [f64; 2] {
    let (s, c) = libm::sincos(course);
    let (x, y) = (point[0] - place[0], point[1] - place[1]);
    [x * c + y * s, y * c - x * s]
}

/// Slower than this is standing, m/s.
const STANDING: f64 = 0.02;

/// The motion at `now`. What the body covered since the oldest of `before`, as seen from the body, tells speed and
/// slip; the course is the yaw and the slip. So a robot on wheels that turns has its course at once, and one that flies
/// and slips has it without the noise of a single reading. A body that stands faces where it would go.
///
/// # Errors
/// [`Why::BadNumber`]; [`Why::TooShort`] without an earlier stop.
pub fn motion(before: &[Stop], now: &Stop) -> Result<Motion, Why> {
    let Some(first) = before.first() else { return Err(Why::TooShort) };
    let (mut ahead, mut aside) = (0.0, 0.0);
    for (a, b) in before.iter().zip(before[1..].iter().chain([now])) {
        let (s, c) = libm::sincos(a.yaw + crate::attitude::wrap(b.yaw - a.yaw) / 2.0);
        let (x, y) = (b.place[0] - a.place[0], b.place[1] - a.place[1]);
        ahead += x * c + y * s;
        aside += y * c - x * s;
    }
    let speed = libm::hypot(ahead, aside) / crate::why::interval(now.time - first.time)?;
    if !speed.is_finite() || !now.yaw.is_finite() {
        return Err(Why::BadNumber);
    }
    if speed < STANDING {
        return Ok(Motion { course: now.yaw, speed: 0.0 });
    }
    Ok(Motion { course: now.yaw + libm::atan2(aside, ahead), speed })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(speed: f64, turn: f64, slip: f64) -> Vec<Stop> {
        let mut at = Stop { time: 0.0, place: [1.0, 2.0], yaw: 0.3 };
        let mut out = vec![at];
        for k in 1..=8 {
            let (s, c) = libm::sincos(at.yaw + turn * 0.025 + slip);
            at.place = [at.place[0] + speed * 0.05 * c, at.place[1] + speed * 0.05 * s];
            at.yaw += turn * 0.05;
            at.time = f64::from(k) * 0.05;
            out.push(at);
        }
        out
    }

    #[test]
    fn speed_and_slip_come_out_on_arcs_too() {
        for (turn, slip) in [(0.0, 0.0), (0.8, 0.0), (-0.5, 0.2), (0.0, -1.0)] {
            let stops = arc(0.5, turn, slip);
            let (now, before) = stops.split_last().unwrap();
            let found = motion(before, now).unwrap();
            assert!((found.speed - 0.5).abs() < 1e-9, "{found:?}");
            assert!((found.course - now.yaw - slip).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn a_standing_robot_faces_its_course() {
        let stops = arc(0.001, 0.5, 1.0);
        let (now, before) = stops.split_last().unwrap();
        assert_eq!(motion(before, now).unwrap(), Motion { course: now.yaw, speed: 0.0 });
        assert_eq!(motion(&[], now), Err(Why::TooShort));
        assert_eq!(motion(&[*now], now), Err(Why::ZeroInterval));
    }
}
