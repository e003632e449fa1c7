//! The bare OpenCV calls that the services make.

use opencv::core::{self, Mat, Point2f, Size, TermCriteria, ToInputArray, Vec3b, Vec4i, Vector};
use opencv::{imgproc, video};
use soifra_vision::contours::Contours;
use soifra_vision::points;

/// RGB to grey.
pub fn grey(rgb: &[u8], (width, height): (usize, usize)) -> Mat {
    let source = Mat::new_rows_cols_with_bytes::<Vec3b>(height as i32, width as i32, rgb).expect("rgb");
    let mut target = Mat::default();
    imgproc::cvt_color_def(&source, &mut target, imgproc::COLOR_RGB2GRAY).expect("grey");
    target
}

/// The bare calls of the detection: derivatives, Canny with the thresholds that the service uses on what it leaves of
/// them, Hough.
pub fn detect(
    gray: &impl ToInputArray,
    (across, along): &(Mat, Mat),
    (low, high): (f64, f64),
    how: &Contours,
) -> Vector<Vec4i> {
    let (mut derivative, mut contours) = (Mat::default(), Mat::default());
    let border = core::BORDER_REPLICATE;
    for (x, y) in [(1, 0), (0, 1)] {
        imgproc::sobel(gray, &mut derivative, core::CV_16S, x, y, 3, 1.0, 0.0, border).expect("sobel");
    }
    imgproc::canny_derivative(across, along, &mut contours, low, high, false).expect("canny");
    let mut lines = Vector::new();
    let step = std::f64::consts::PI / 180.0;
    imgproc::hough_lines_p(&contours, &mut lines, 1.0, step, how.votes, how.shortest, how.gap)
        .expect("hough");
    lines
}

/// The bare calls of the flow: there and back.
pub fn flow(
    from: &impl ToInputArray,
    to: &impl ToInputArray,
    start: &Vector<Point2f>,
    how: &points::Following,
) -> Vector<Point2f> {
    let (mut there, mut back) = (Vector::<Point2f>::new(), Vector::<Point2f>::new());
    let (mut found, mut errors) = (Vector::<u8>::new(), Vector::<f32>::new());
    let size = Size::new(how.window, how.window);
    let stop = TermCriteria::new(3, 20, 0.005).expect("criteria");
    let levels = how.levels;
    video::calc_optical_flow_pyr_lk(
        from,
        to,
        start,
        &mut there,
        &mut found,
        &mut errors,
        size,
        levels,
        stop,
        0,
        1e-4,
    )
    .expect("flow");
    video::calc_optical_flow_pyr_lk(
        to,
        from,
        &there,
        &mut back,
        &mut found,
        &mut errors,
        size,
        levels,
        stop,
        0,
        1e-4,
    )
    .expect("flow back");
    back
}
