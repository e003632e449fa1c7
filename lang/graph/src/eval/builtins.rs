//! What the built-in functions compute, by the number of their arguments. Those the machine has
//! instructions of its own for are not here.

use super::run::MAX_INT;
use super::{FaultKind, geometry as g};
use crate::{Distribution, Function, reason};

/// `x` to an integer power, by repeated squaring: the same on every machine.
pub(super) fn power(x: f64, n: i32) -> f64 {
    let (mut result, mut square, mut left) = (1.0, x, n.unsigned_abs());
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    if n < 0 { 1.0 / result } else { result }
}

fn whole(x: f64) -> Result<f64, FaultKind> {
    if x.abs() <= MAX_INT { Ok(x) } else { Err(FaultKind::Overflow) }
}

/// A function of one number.
pub(super) fn one(f: Function, x: f64) -> Result<f64, FaultKind> {
    Ok(match f {
        Function::Sign if x == 0.0 => 0.0,
        Function::Sign => x.signum(),
        Function::Floor => whole(x.floor())?,
        Function::Ceil => whole(x.ceil())?,
        Function::Round => whole(x.round())?,
        Function::Sin => libm::sin(x),
        Function::Cos => libm::cos(x),
        Function::Tan => libm::tan(x),
        Function::Asin if x.abs() > 1.0 => {
            return Err(FaultKind::Domain("the arc sine of a number beyond 1"));
        }
        Function::Asin => libm::asin(x),
        Function::Acos if x.abs() > 1.0 => {
            return Err(FaultKind::Domain("the arc cosine of a number beyond 1"));
        }
        Function::Acos => libm::acos(x),
        Function::Exp => libm::exp(x),
        Function::Log if x <= 0.0 => {
            return Err(FaultKind::Domain("the logarithm of a number that is not above 0"));
        }
        Function::Log => libm::log(x),
        Function::Wrap | Function::Towards | Function::AngleOf => g::wrap(x),
        _ => return Err(FaultKind::Malformed),
    })
}

/// A function of two numbers.
pub(super) fn two(f: Function, x: f64, y: f64) -> Result<f64, FaultKind> {
    Ok(match f {
        Function::Atan2 => libm::atan2(x, y),
        Function::Hypot => libm::hypot(x, y),
        Function::Modulo if y == 0.0 => return Err(FaultKind::DivisionByZero),
        Function::Modulo => {
            let r = libm::fmod(x, y);
            let r = if r < 0.0 { r + y.abs() } else { r };
            if r >= y.abs() { 0.0 } else { r }
        }
        _ => return Err(FaultKind::Malformed),
    })
}

/// A function of anything, its arguments one after the other from `a`, its value at `d`.
pub(super) fn many(f: Function, frame: &mut [f64], d: usize, a: usize) -> Result<(), FaultKind> {
    let args = frame.get(a..).ok_or(FaultKind::Malformed)?;
    match f {
        Function::Clamp => {
            let [x, low, high] = take(args, 0)?;
            let x = if x < low { low } else { x };
            give(frame, d, [if x > high { high } else { x }])
        }
        Function::HeadingOf => {
            let [x, y, _] = take(args, 0)?;
            give(frame, d, [g::direction(y, x)])
        }
        Function::Polar => {
            let [length, heading] = take(args, 0)?;
            give(frame, d, g::polar(length, heading))
        }
        Function::Unit => {
            let v = g::unit(take(args, 0)?);
            give(frame, d, v)
        }
        Function::Rotate => {
            let ([by], v) = (take(args, 3)?, take(args, 0)?);
            give(frame, d, g::turn(v, by))
        }
        Function::PoseAt => {
            let ([heading], at) = (take(args, 3)?, take(args, 0)?);
            give(frame, d, g::level_pose(at, heading))
        }
        Function::Bearing => {
            let value = g::bearing(take(args, 0)?, take(args, 3)?);
            give(frame, d, [value])
        }
        Function::Place => {
            let value = g::place(take(args, 0)?, take(args, 7)?);
            give(frame, d, value)
        }
        Function::FromBody => {
            let value = g::rotate(g::orientation(take(args, 3)?), take(args, 0)?);
            give(frame, d, value)
        }
        Function::ToBody => {
            let value = g::rotate(g::conjugate(g::orientation(take(args, 3)?)), take(args, 0)?);
            give(frame, d, value)
        }
        Function::PointFromBody => {
            let value = g::point_from_body(take(args, 0)?, take(args, 3)?);
            give(frame, d, value)
        }
        Function::PointToBody => {
            let value = g::point_to_body(take(args, 0)?, take(args, 3)?);
            give(frame, d, value)
        }
        Function::CircleIntersections => {
            let ([ra], [rb]) = (take(args, 3)?, take(args, 7)?);
            let (n, [p, q]) = g::circle_intersections(take(args, 0)?, ra, take(args, 4)?, rb);
            give(frame, d, [n as f64, p[0], p[1], p[2], q[0], q[1], q[2]])
        }
        Function::FirstContact => {
            let [radius] = take(args, 9)?;
            let t = g::first_contact(take(args, 0)?, take(args, 3)?, take(args, 6)?, radius);
            give(frame, d, t.map_or([reason::tag(reason::NO_CONTACT), 0.0], |t| [0.0, t]))
        }
        Function::Exactly => {
            let [value] = take(args, 0)?;
            distribution(frame, d, Distribution::Exact(value))
        }
        Function::Normal => {
            let [deviation, mean] = take(args, 0)?;
            distribution(frame, d, Distribution::Normal(mean, deviation))
        }
        Function::Uniform => {
            let [low, high] = take(args, 0)?;
            distribution(frame, d, Distribution::Uniform(low, high))
        }
        Function::Skewed => {
            let [best, mean, worst] = take(args, 0)?;
            distribution(frame, d, Distribution::Skewed(best, mean, worst))
        }
        Function::Within => {
            let [x, low, high] = take(args, 0)?;
            give(frame, d, [f64::from(u8::from(low <= x && x <= high))])
        }
        _ => Err(FaultKind::Malformed),
    }
}

fn take<const N: usize>(args: &[f64], from: usize) -> Result<[f64; N], FaultKind> {
    args.get(from..).and_then(|a| a.first_chunk::<N>()).copied().ok_or(FaultKind::Malformed)
}

fn give<const N: usize>(frame: &mut [f64], d: usize, value: [f64; N]) -> Result<(), FaultKind> {
    if !value.iter().all(|x| x.is_finite()) {
        return Err(FaultKind::NotFinite);
    }
    frame.get_mut(d..d + N).ok_or(FaultKind::Malformed)?.copy_from_slice(&value);
    Ok(())
}

fn distribution(frame: &mut [f64], d: usize, value: Distribution) -> Result<(), FaultKind> {
    can_draw(value)?;
    give(frame, d, value.registers())
}

/// Whether a distribution is one.
pub(super) fn can_draw(d: Distribution) -> Result<(), FaultKind> {
    match d {
        Distribution::Normal(_, deviation) if deviation < 0.0 => {
            Err(FaultKind::Domain("a normal distribution with a negative deviation"))
        }
        Distribution::Uniform(low, high) if high < low => {
            Err(FaultKind::Domain("a uniform distribution whose bounds are swapped"))
        }
        Distribution::Skewed(best, mean, worst) if (mean - best) * (worst - mean) < 0.0 => {
            Err(FaultKind::Domain("a skewed distribution whose mean is not between best and worst"))
        }
        _ => Ok(()),
    }
}

/// (r × n) · (n × c)
pub(super) fn matrix_product(
    [r, n, c]: [u8; 3],
    frame: &mut [f64],
    d: usize,
    a: usize,
    b: usize,
) -> Result<(), FaultKind> {
    let (r, n, c) = (usize::from(r), usize::from(n), usize::from(c));
    let left = frame.get(a..a + r * n).ok_or(FaultKind::Malformed)?;
    let right = frame.get(b..b + n * c).ok_or(FaultKind::Malformed)?;
    let mut out = [0.0; 64];
    for (i, x) in out.get_mut(..r * c).ok_or(FaultKind::Malformed)?.iter_mut().enumerate() {
        let row = left.get(i / c * n..).unwrap_or_default();
        let column = right.get(i % c..).unwrap_or_default();
        *x = row.iter().take(n).zip(column.iter().step_by(c)).fold(0.0, |s, (x, y)| s + x * y);
        if !x.is_finite() {
            return Err(FaultKind::NotFinite);
        }
    }
    let to = frame.get_mut(d..d + r * c).ok_or(FaultKind::Malformed)?;
    to.copy_from_slice(out.get(..r * c).unwrap_or_default());
    Ok(())
}

/// The inverse of an n × n matrix as an optional.
pub(super) fn inverse(n: u8, frame: &mut [f64], d: usize, a: usize) -> Result<(), FaultKind> {
    let n = usize::from(n);
    let mut out = [0.0; 64];
    let matrix = frame.get(a..a + n * n).ok_or(FaultKind::Malformed)?;
    let inverse = out.get_mut(..n * n).ok_or(FaultKind::Malformed)?;
    let regular = g::inverse(n, matrix, inverse);
    if !inverse.iter().all(|x| x.is_finite()) {
        return Err(FaultKind::NotFinite);
    }
    let to = frame.get_mut(d..d + 1 + n * n).ok_or(FaultKind::Malformed)?;
    if let Some((tag, value)) = to.split_first_mut() {
        *tag = if regular { 0.0 } else { reason::tag(reason::SINGULAR) };
        value.copy_from_slice(inverse);
    }
    Ok(())
}
