//! The contact sheet: what cameras saw, one image beside the other, on request with what is seen in them.

use super::{PngError, Selection, latest::Latest};
use crate::{
    recording::Everywhere,
    services::{Onlooker, Overlay, Readings},
    trace_file::{Reader, TraceError},
};
use soifra_runtime::{
    Event, Time,
    objects::{Cameras, Frame},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    io::{Read, Seek},
};
use tiny_skia::{Color, IntSize, Pixmap, PixmapPaint, Transform};

/// Images a row.
const COLUMNS: usize = 4;
/// Width of an image on the sheet, pixels.
const WIDTH: u32 = 480;
/// Between two.
const GAP: u32 = 8;

/// Images of a trace, evenly spaced, in order of time.
pub struct Sheet {
    frames: Vec<Frame>,
    /// How many were taken in all.
    all: usize,
}

/// An image of a trace.
struct Taken {
    robot: u32,
    sensor: u32,
    captured: Time,
    view: Vec<f64>,
    /// What had been read when it came.
    readings: Readings,
}

impl Taken {
    fn camera(&self) -> (u32, u32) {
        (self.robot, self.sensor)
    }
}

impl Sheet {
    /// Takes so many images of a trace again. For an overlay the images between them, and those before, are looked at too: what is seen
    /// in an image depends on what was seen in those before.
    pub fn read<R: Read + Seek>(
        mut reader: Reader<R>,
        selection: &Selection,
        limit: usize,
        overlay: Overlay,
    ) -> Result<Sheet, TraceError> {
        let mut read = Latest::new(reader.header());
        let mut taken = Vec::new();
        for record in reader.by_ref() {
            let record = record?;
            match record.event {
                Event::Image { robot, sensor, captured, view, .. } => {
                    let readings = read.of(robot);
                    taken.push(Taken { robot, sensor, captured, view, readings });
                }
                Event::Reading { robot, sensor, registers, .. } if overlay.any() => {
                    read.note((robot, sensor), &registers);
                }
                _ => {}
            }
        }
        let within = |t: &Taken| {
            selection.from.is_none_or(|s| s <= t.captured) && selection.to.is_none_or(|s| t.captured <= s)
        };
        let wanted: Vec<usize> =
            taken.iter().enumerate().filter(|(_, t)| within(t)).map(|(i, _)| i).collect();
        let all = wanted.len();
        let some = limit.min(all);
        let chosen: BTreeSet<usize> =
            (0..some).filter_map(|i| wanted.get(i * all / some.max(1)).copied()).collect();
        let shown: BTreeSet<_> = chosen.iter().filter_map(|i| taken.get(*i)).map(Taken::camera).collect();
        let last = chosen.last().copied();
        let mut cameras = Everywhere::default().of(&reader.header().scene);
        let mut onlookers: BTreeMap<(u32, u32), Onlooker> = BTreeMap::new();
        let mut frames = Vec::new();
        for (i, t) in taken.iter().enumerate().take_while(|(i, _)| Some(*i) <= last) {
            let show = chosen.contains(&i);
            if !(show || overlay.any() && shown.contains(&t.camera())) {
                continue;
            }
            let image = cameras.as_mut().and_then(|c| c.retake(t.robot, t.sensor, t.captured, &t.view));
            let Some(image) = image else { continue };
            let onlooker = onlookers.entry(t.camera()).or_default();
            if overlay.any() {
                onlooker.look(&image, &t.readings);
            }
            if show {
                let mut frame = Frame::clone(&image);
                onlooker.draw(&mut frame, overlay);
                frames.push(frame);
            }
        }
        Ok(Sheet { frames, all })
    }

    /// What is said of those that are not shown, and when the others were taken.
    pub fn rest(&self) -> Option<String> {
        let times = self.frames.iter().map(|f| format!("{:.2}", f.captured.seconds()));
        let times = times.collect::<Vec<_>>().join(", ");
        match self.all {
            0 => Some("no camera was read".into()),
            all => Some(format!("{} of {all} images, at {times} s", self.frames.len())),
        }
    }

    /// The sheet.
    pub fn to_png(&self) -> Result<Vec<u8>, PngError> {
        let scaled = |f: &Frame| (f.height as f32 * WIDTH as f32 / f.width.max(1) as f32).ceil() as u32;
        let row = self.frames.iter().map(scaled).max().unwrap_or(0) + GAP;
        let (columns, rows) =
            (self.frames.len().clamp(1, COLUMNS) as u32, self.frames.len().div_ceil(COLUMNS) as u32);
        let (width, height) = (columns * (WIDTH + GAP) + GAP, rows * row + GAP);
        let mut sheet = Pixmap::new(width, height).ok_or_else(|| PngError::new("the sheet is too large"))?;
        sheet.fill(Color::WHITE);
        for (i, frame) in self.frames.iter().enumerate() {
            let (x, y) = ((i % COLUMNS) as u32 * (WIDTH + GAP) + GAP, (i / COLUMNS) as u32 * row + GAP);
            let rgba: Vec<u8> = frame.data.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect();
            let size = IntSize::from_wh(frame.width, frame.height);
            let Some(image) = size.and_then(|s| Pixmap::from_vec(rgba, s)) else { continue };
            let scale = WIDTH as f32 / frame.width as f32;
            let to = Transform::from_scale(scale, scale).post_translate(x as f32, y as f32);
            let paint = PixmapPaint { quality: tiny_skia::FilterQuality::Bilinear, ..PixmapPaint::default() };
            sheet.draw_pixmap(0, 0, image.as_ref(), &paint, to, None);
        }
        sheet.encode_png().map_err(|e| PngError::new(&e.to_string()))
    }
}
