//! The lens that a profile declares for images of a recording.

use crate::sim::args::Args;
use soifra_camera::Lens;
use soifra_runtime::{
    objects::Optics,
    scene::{Part, PlatformScene},
};

/// How a sensor of a platform maps directions to the pixels of an image of this size.
///
/// # Errors
/// That it is no camera, that there is no such lens, or that the sensor is declared with another size; in the words of
/// a report.
pub fn optics(platform: &PlatformScene, part: &Part, width: usize, height: usize) -> Result<Optics, String> {
    let of = format!("platform `{}`", platform.name);
    let args = Args { part, of: &of };
    if !matches!(&*part.model, "camera" | "footage") {
        return Err(args.wrong("its readings are no images"));
    }
    if &*part.model == "camera" {
        let side = |name| args.count(name, Lens::MOST_PIXELS as i64);
        let declared = (side("width")?, side("height")?);
        if declared != (width, height) {
            let (w, h) = declared;
            return Err(args.wrong(format_args!(
                "it is declared with {w} x {h} pixels, the images have {width} x {height}"
            )));
        }
    }
    let [k1, k2] = [args.number("k1")?, args.number("k2")?];
    let distortion = ([k1, k2] != [0.0; 2]).then_some([k1, k2, 0.0, 0.0]);
    let lens = Lens::from_distorted_field_of_view(width, height, args.positive("field_of_view")?, distortion)
        .map_err(|_| args.wrong("there is no such lens"))?;
    Ok(Optics {
        focal: [lens.fx, lens.fy],
        centre: [lens.cx, lens.cy],
        distortion: lens.distortion,
        at: args.vector("at")?,
        tilt: args.number("tilt")?,
    })
}
