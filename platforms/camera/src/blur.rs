//! Motion blur: the mean of several instants of an exposure.

use crate::geometry::Pose;
use crate::image::Image;
use crate::render::{Scratch, View, render};
use crate::scene::{PartPose, Scene};

/// What happens while the shutter is open, after the instant of the view and the parts given with it.
#[derive(Clone, Copy, Debug)]
pub struct Exposure<'a> {
    /// Of the camera at the end.
    pub pose: Pose,
    /// The parts at the end, in the same order as at the start. A part that is not there stays where it is.
    pub parts: &'a [PartPose],
    /// Instants that are averaged, the first and the last included; 0 and 1 are the start alone.
    pub instants: usize,
}

/// More than this adds nothing that is seen.
const MOST_INSTANTS: usize = 64;

/// As [`render`], over an exposure that begins with `parts` and the view's pose: the mean, to the nearest grey
/// level, of instants equally far apart.
pub fn render_blurred(
    scene: &Scene,
    parts: &[PartPose],
    view: &View,
    exposure: &Exposure,
    bands: usize,
    image: &mut Image,
    scratch: &mut Scratch,
) {
    let instants = exposure.instants.clamp(1, MOST_INSTANTS);
    render(scene, parts, view, bands, image, scratch);
    if instants == 1 {
        return;
    }
    let mut sum: Vec<u16> = image.data.iter().map(|byte| u16::from(*byte)).collect();
    let mut moved = parts.to_vec();
    for instant in 1..instants {
        let share = instant as f64 / (instants - 1) as f64;
        for ((moved, start), end) in moved.iter_mut().zip(parts).zip(exposure.parts) {
            if start.part == end.part {
                moved.pose = start.pose.toward(&end.pose, share);
            }
        }
        let view = View { pose: view.pose.toward(&exposure.pose, share), ..*view };
        render(scene, &moved, &view, bands, image, scratch);
        for (sum, byte) in sum.iter_mut().zip(&image.data) {
            *sum += u16::from(*byte);
        }
    }
    let count = instants as u16;
    for (byte, sum) in image.data.iter_mut().zip(&sum) {
        *byte = ((sum + count / 2) / count) as u8;
    }
}
