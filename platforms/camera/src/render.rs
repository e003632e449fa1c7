//! A frame from a scene.

use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::facet::{Facet, Optics, collect};
use crate::geometry::Pose;
use crate::image::Image;
use crate::lens::Lens;
use crate::light::Light;
use crate::scene::{PartPose, Scene};
use crate::shade::shade;
use crate::smooth;
use crate::visibility::Strip;
use crate::warp::Warp;

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Between four texels of the full image: distant faces shimmer.
    Bilinear,
    /// Between four texels of the size that fits the distance.
    #[default]
    Mipmap,
    /// Between four texels of each of the two sizes nearest to the distance.
    Trilinear,
}

/// What a frame is taken with.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The camera's lens.
    pub lens: &'a Lens,
    /// Of the camera's frame (x forward, y left, z up), in the world.
    pub pose: Pose,
    /// What lights the scene, and the exposure.
    pub light: &'a Light,
    /// How textures are looked up.
    pub filter: Filter,
}

/// Memory that is kept from frame to frame. One for each camera saves computing its lens's map again.
#[derive(Default)]
pub struct Scratch {
    facets: Vec<Facet>,
    numbers: Vec<u32>,
    /// For each strip, the facets that may be seen in it.
    bins: Vec<Vec<u32>>,
    /// One for each band.
    strips: Vec<Strip>,
    warp: Option<Warp>,
    /// What the warp is taken from.
    straight: Image,
}

impl Scratch {
    /// Empty.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// Rows of a strip: few enough that it stays in a core's own cache, many enough that the row above and the row
/// below it, which are drawn twice, hardly count.
const ROWS: usize = 40;

/// More threads than this are not asked for.
const MOST_BANDS: usize = 64;

/// Takes a frame of the scene with the parts that are in it; the image gets the lens's size.
///
/// `bands` is the number of threads that share the work, the calling one included; the bytes do not depend on it.
/// Through a lens that cannot be (see [`Lens::check`]) there is no image, and its size is zero.
pub fn render(
    scene: &Scene,
    parts: &[PartPose],
    view: &View,
    bands: usize,
    image: &mut Image,
    scratch: &mut Scratch,
) {
    if view.lens.check().is_err() {
        image.resize(0, 0);
        return;
    }
    if view.lens.distortion.is_none() {
        straight(scene, parts, view, bands, image, scratch);
        return;
    }
    let warp = match scratch.warp.take() {
        Some(warp) if warp.of() == view.lens => warp,
        _ => Warp::new(view.lens),
    };
    let mut wide = std::mem::take(&mut scratch.straight);
    let from = View { lens: warp.source(), ..*view };
    straight(scene, parts, &from, bands, &mut wide, scratch);
    warp.resample(&wide, bands, image);
    scratch.straight = wide;
    scratch.warp = Some(warp);
}

/// Through a pinhole.
fn straight(
    scene: &Scene,
    parts: &[PartPose],
    view: &View,
    bands: usize,
    image: &mut Image,
    scratch: &mut Scratch,
) {
    let (width, height) = (view.lens.width, view.lens.height);
    image.resize(width, height);
    let Some(optics) = Optics::new(view.lens, &view.pose) else {
        image.data.fill(0);
        return;
    };
    let Scratch { facets, numbers, bins, strips, .. } = scratch;
    collect(scene, parts, &optics, view.light, facets, numbers);
    sort_into_bins(facets, height, bins);
    let (facets, bins, exposure) = (&*facets, &*bins, view.light.exposure());

    let bands = bands.clamp(1, MOST_BANDS).min(bins.len());
    strips.resize_with(strips.len().max(bands), Strip::default);
    each_chunk(&mut image.data, 3 * width * ROWS, &mut strips[..bands], |strip, number, bytes| {
        let (from, rows) = (number * ROWS, bytes.len() / (3 * width));
        let (first, end) = (from.saturating_sub(1), (from + rows + 1).min(height));
        strip.begin(first, end - first, width);
        for &number in bins.get(number).into_iter().flatten() {
            if let Some(facet) = facets.get(number as usize) {
                strip.cover(number, facet);
            }
        }
        shade(strip, scene, facets, &optics, exposure, view.filter);
        smooth::write(strip, facets, from - first, bytes);
    });
}

/// Notes for each strip which facets reach into it or the rows beside it.
fn sort_into_bins(facets: &[Facet], height: usize, bins: &mut Vec<Vec<u32>>) {
    bins.resize_with(height.div_ceil(ROWS), Vec::new);
    for bin in &mut *bins {
        bin.clear();
    }
    for (number, facet) in (0..).zip(facets) {
        let (from, to) = (facet.rows.0.max(1) as usize - 1, facet.rows.1.max(0) as usize + 1);
        let reached = from / ROWS..to.div_ceil(ROWS).min(bins.len());
        for bin in &mut bins[reached] {
            bin.push(number);
        }
    }
}

/// Works through chunks of `bytes`, with one thread for each worker. A thread takes the next chunk when it is done
/// with one: they need not be equally hard. If a thread cannot be had, the others do its work.
pub(crate) fn each_chunk<W: Send>(
    bytes: &mut [u8],
    size: usize,
    workers: &mut [W],
    work: impl Fn(&mut W, usize, &mut [u8]) + Sync,
) {
    let Some((own, others)) = workers.split_first_mut() else { return };
    let queue = Mutex::new(bytes.chunks_mut(size.max(1)).enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let run = |worker: &mut W| {
        while let Some((number, chunk)) = next() {
            work(worker, number, chunk);
        }
    };
    if others.is_empty() {
        run(own);
        return;
    }
    let run = &run;
    thread::scope(|scope| {
        for other in others {
            let spawned = thread::Builder::new().spawn_scoped(scope, move || run(other));
            if spawned.is_err() {
                break;
            }
        }
        run(own);
    });
}
