//! Points on an obstacle: where to put them, and Lucas-Kanade's sparse pyramidal flow that follows them.

use opencv::core::{Point2f, Size, TermCriteria, Vector};
use opencv::video;

use crate::edge::Edge;
use crate::flow::Track;
use crate::follow::Moment;
use crate::image::Gray;
use crate::lens::Lens;
use crate::robust::{Part, PointTrack, Sight, sight_ray};
use crate::why::Why;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// Side of the flow's window, pixels.
    pub window: i32,
    /// Levels of the pyramid above the image.
    pub levels: i32,
    /// A point is lost when following it back ends farther away than this, pixels.
    pub back: f64,
    /// Points on each edge.
    pub on_edge: usize,
    /// Columns and rows of cells between the edges, one point each.
    pub cells: [usize; 2],
    /// Weakest corner taken: smaller eigenvalue of the mean gradient matrix, squared grey levels.
    pub weakest: f64,
    /// Sightings older than this are forgotten, s.
    pub memory: f64,
}

impl Default for Following {
    fn default() -> Self {
        Self { window: 15, levels: 2, back: 0.4, on_edge: 6, cells: [6, 8], weakest: 12.0, memory: 2.0 }
    }
}

/// A point to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where on the obstacle.
    pub part: Part,
    /// Pixels (x, y).
    pub at: [f64; 2],
}

/// A point's flow between two frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Where on the obstacle.
    pub part: Part,
    /// Its place in the later frame and its way.
    pub track: Track,
    /// 1 when following it back ends where it began, 0 at the largest error allowed.
    pub quality: f64,
}

/// Points along the two edges (a little inside, so that the window lies on the obstacle) and one in each cell
/// between them where the image has a corner.
pub fn choose(image: &Gray, left: &Edge, right: &Edge, how: &Following) -> Vec<Point> {
    let inset = f64::from(how.window) / 4.0;
    let mut points = Vec::with_capacity(2 * how.on_edge + how.cells[0] * how.cells[1]);
    for (part, edge, inward) in [(Part::Left, left, inset), (Part::Right, right, -inset)] {
        for k in 0..how.on_edge {
            let share = (k as f64 + 0.5) / how.on_edge as f64;
            let y = edge.line.top[1] + share * (edge.line.bottom[1] - edge.line.top[1]);
            points.push(Point { part, at: [edge.line.x_at(y) + inward, y] });
        }
    }
    let (top, bottom) =
        (left.line.top[1].max(right.line.top[1]), left.line.bottom[1].min(right.line.bottom[1]));
    for row in 0..how.cells[1] {
        for column in 0..how.cells[0] {
            let y = |s: f64| top + (bottom - top) * (row as f64 + s) / how.cells[1] as f64;
            let x = |y: f64, s: f64| {
                let (a, b) = (left.line.x_at(y) + 2.0 * inset, right.line.x_at(y) - 2.0 * inset);
                a + (b - a) * (column as f64 + s) / how.cells[0] as f64
            };
            let mut best: Option<(f64, [f64; 2])> = None;
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let at_y = y((f64::from(i) + 0.5) / 3.0);
                let at = [x(at_y, (f64::from(j) + 0.5) / 3.0), at_y];
                let strength = corner(image, at);
                if strength >= how.weakest && best.is_none_or(|(s, _)| strength > s) {
                    best = Some((strength, at));
                }
            }
            points.extend(best.map(|(_, at)| Point { part: Part::Interior, at }));
        }
    }
    points.retain(|p| inside(image, p.at));
    points
}

fn inside(image: &Gray, at: [f64; 2]) -> bool {
    let fits = |v: f64, size: usize| (2.0..=size as f64 - 3.0).contains(&v);
    fits(at[0], image.width()) && fits(at[1], image.height())
}

/// The smaller eigenvalue of the mean gradient matrix over 9 x 9 pixels about a point (central differences).
fn corner(image: &Gray, at: [f64; 2]) -> f64 {
    let (w, h) = (image.width() as f64, image.height() as f64);
    if !(at[0] >= 6.0 && at[1] >= 6.0 && at[0] < w - 6.0 && at[1] < h - 6.0) {
        return 0.0;
    }
    let (cx, cy) = (at[0] as usize, at[1] as usize);
    let (mut xx, mut xy, mut yy) = (0i64, 0i64, 0i64);
    for y in cy - 4..=cy + 4 {
        let (above, here, below) = (image.row(y - 1), image.row(y), image.row(y + 1));
        for x in cx - 4..=cx + 4 {
            let gx = i64::from(here[x + 1]) - i64::from(here[x - 1]);
            let gy = i64::from(below[x]) - i64::from(above[x]);
            xx += gx * gx;
            xy += gx * gy;
            yy += gy * gy;
        }
    }
    let scale = 1.0 / (81.0 * 4.0);
    let (xx, xy, yy) = (xx as f64 * scale, xy as f64 * scale, yy as f64 * scale);
    let half = (xx - yy) / 2.0;
    (xx + yy) / 2.0 - libm::sqrt(half * half + xy * xy)
}

/// A point's place in the other frame and its quality, unless it was lost.
type Found = Option<([f64; 2], f64)>;

/// Where `points` of the image `from` are in the image `to`, with a quality; `None` for lost ones. Each is followed
/// there and back.
fn lucas_kanade(from: &Gray, to: &Gray, points: &[[f64; 2]], how: &Following) -> Result<Vec<Found>, Why> {
    if points.is_empty() {
        return Ok(Vec::new());
    }
    if from.width() != to.width() || from.height() != to.height() {
        return Err(Why::WrongSize);
    }
    let (a, b) = (from.mat()?, to.mat()?);
    let start: Vector<Point2f> = points.iter().map(|p| Point2f::new(p[0] as f32, p[1] as f32)).collect();
    let (mut there, mut back) = (Vector::<Point2f>::new(), Vector::<Point2f>::new());
    let (mut found, mut found_back) = (Vector::<u8>::new(), Vector::<u8>::new());
    let mut errors = Vector::<f32>::new();
    let size = how.window.clamp(5, 61);
    let window = Size::new(size, size);
    let levels = how.levels.clamp(0, 6);
    // 20 rounds or 0.005 pixels: finer than the default, which stops at 0.01.
    let stop = TermCriteria::new(3, 20, 0.005)?;
    video::calc_optical_flow_pyr_lk(
        &a,
        &b,
        &start,
        &mut there,
        &mut found,
        &mut errors,
        window,
        levels,
        stop,
        0,
        1e-4,
    )?;
    video::calc_optical_flow_pyr_lk(
        &b,
        &a,
        &there,
        &mut back,
        &mut found_back,
        &mut errors,
        window,
        levels,
        stop,
        0,
        1e-4,
    )?;
    let allowed = how.back.max(1e-6);
    Ok((0..points.len())
        .map(|k| {
            let (p, q) = (there.get(k).ok()?, back.get(k).ok()?);
            if found.get(k).ok()? == 0 || found_back.get(k).ok()? == 0 {
                return None;
            }
            let at = [f64::from(p.x), f64::from(p.y)];
            let miss = libm::hypot(f64::from(q.x) - points[k][0], f64::from(q.y) - points[k][1]);
            (miss <= allowed && inside(to, at)).then_some((at, 1.0 - miss / allowed))
        })
        .collect())
}

/// The flow of `points` of the present image since the previous one: no memory is needed. Lost ones are left out.
///
/// # Errors
/// [`Why::WrongSize`] for images of different sizes; [`Why::NoFeatures`] when all points are lost.
pub fn flow(previous: &Gray, present: &Gray, points: &[Point], how: &Following) -> Result<Vec<Flow>, Why> {
    let places: Vec<[f64; 2]> = points.iter().map(|p| p.at).collect();
    let found = lucas_kanade(present, previous, &places, how)?;
    let flows: Vec<Flow> = points
        .iter()
        .zip(found)
        .filter_map(|(p, found)| {
            let (before, quality) = found?;
            let track = Track { x: p.at[0], y: p.at[1], u: p.at[0] - before[0], v: p.at[1] - before[1] };
            Some(Flow { part: p.part, track, quality })
        })
        .collect();
    if flows.is_empty() { Err(Why::NoFeatures) } else { Ok(flows) }
}

/// Carries followed points into the present frame; lost ones are dropped.
///
/// # Errors
/// [`Why::WrongSize`] for images of different sizes.
pub fn advance(
    points: Vec<PointTrack>,
    previous: &Gray,
    present: &Gray,
    moment: &Moment,
    lens: &Lens,
    how: &Following,
) -> Result<Vec<PointTrack>, Why> {
    let places: Vec<[f64; 2]> = points.iter().map(|p| p.pixel).collect();
    let found = lucas_kanade(previous, present, &places, how)?;
    Ok(points
        .into_iter()
        .zip(found)
        .filter_map(|(mut point, found)| {
            let (at, quality) = found?;
            let ray = sight_ray(lens, &moment.attitude, at)?;
            point.way = [at[0] - point.pixel[0], at[1] - point.pixel[1]];
            point.pixel = at;
            point.quality = quality;
            point.sights.retain(|s| s.time < moment.time && moment.time - s.time <= how.memory);
            point.sights.push(Sight { time: moment.time, ray, place: moment.place });
            Some(point)
        })
        .collect())
}

/// Keeps the points that still lie on the obstacle and adds new ones where there are none. At most one point to a
/// cell of the window's size.
pub fn replenish(
    mut points: Vec<PointTrack>,
    image: &Gray,
    left: &Edge,
    right: &Edge,
    moment: &Moment,
    lens: &Lens,
    how: &Following,
) -> Vec<PointTrack> {
    let apart = f64::from(how.window) / 2.0;
    points.retain(|p| {
        let [x, y] = p.pixel;
        let across = left.line.x_at(y) - 2.0 <= x && x <= right.line.x_at(y) + 2.0;
        across
            && y >= left.line.top[1].min(right.line.top[1])
            && y <= left.line.bottom[1].max(right.line.bottom[1])
    });
    let full = 2 * how.on_edge + how.cells[0] * how.cells[1];
    for new in choose(image, left, right, how) {
        if points.len() >= full {
            break;
        }
        let near = |p: &PointTrack| {
            p.part == new.part && libm::hypot(p.pixel[0] - new.at[0], p.pixel[1] - new.at[1]) < apart
        };
        if points.iter().any(near) {
            continue;
        }
        let Some(ray) = sight_ray(lens, &moment.attitude, new.at) else { continue };
        points.push(PointTrack {
            part: new.part,
            pixel: new.at,
            way: [0.0, 0.0],
            quality: 0.0,
            sights: vec![Sight { time: moment.time, ray, place: moment.place }],
        });
    }
    points
}

/// The flow of followed points between the last two frames.
pub fn flows(points: &[PointTrack]) -> Vec<Flow> {
    points
        .iter()
        .filter(|p| p.sights.len() > 1)
        .map(|p| Flow {
            part: p.part,
            track: Track { x: p.pixel[0], y: p.pixel[1], u: p.way[0], v: p.way[1] },
            quality: p.quality,
        })
        .collect()
}
