//! Images in files, one after the other at a rate.

use super::{Care, Shots, Wanted, Written, Y4m, pictures, trouble::Trouble, y4m};
use soifra_platforms::recording::{Footage, Picture, Stamp, optics};
use soifra_runtime::{Time, objects::Optics};
use std::{
    fs::File,
    io::{BufReader, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

/// A recording is not longer, in images.
const MOST: usize = 1 << 24;

/// The images of a recording.
#[derive(Debug)]
pub struct Files {
    kind: Arc<Kind>,
    pace: Pace,
    count: usize,
    size: (usize, usize),
}

#[derive(Debug)]
enum Kind {
    Pictures(Vec<PathBuf>),
    Video(PathBuf, Y4m),
}

/// How many images come a second.
#[derive(Debug, Clone, Copy)]
enum Pace {
    Fraction(u64, u64),
    Hertz(f64),
}

impl Pace {
    /// When an image is taken, counted from the first.
    fn at(self, number: usize) -> Option<Time> {
        match self {
            Pace::Fraction(n, d) => {
                let ns = number as u128 * u128::from(d) * 1_000_000_000 / u128::from(n.max(1));
                i64::try_from(ns).ok().map(Time)
            }
            Pace::Hertz(rate) => Time::from_seconds(number as f64 / rate),
        }
    }

    /// From a microsecond between images up to what virtual time can count.
    fn usable(self, count: usize) -> bool {
        let apart = self.at(1).is_some_and(|t| t >= Time(1_000));
        let most = Time(i64::MAX / 4);
        apart && count <= MOST && self.at(count).is_some_and(|t| t < most)
    }
}

/// Whether a file is a trace: it begins as one.
pub fn is_trace(path: &str) -> bool {
    begins(Path::new(path)).is_some_and(|b| b.starts_with(mcap::MAGIC))
}

/// The first bytes of a file; none of a folder, or of what cannot be read.
fn begins(path: &Path) -> Option<Vec<u8>> {
    let mut first = Vec::new();
    File::open(path).ok()?.take(16).read_to_end(&mut first).ok()?;
    Some(first)
}

impl Files {
    /// Finds the images that a path means.
    pub fn find(path: &str, rate: Option<f64>, care: Care) -> Result<Files, Trouble> {
        let at = Path::new(path);
        let (kind, size) = match at {
            _ if at.is_dir() => pictured(pictures::in_folder(at)?, care)?,
            _ if pictures::is_pattern(path) && !at.exists() => pictured(pictures::of_pattern(at)?, care)?,
            _ => {
                let first = match File::open(at) {
                    Ok(_) => begins(at).unwrap_or_default(),
                    Err(e) => return Err(missing(at, &e)),
                };
                if !first.starts_with(y4m::MAGIC) {
                    return Err(unsupported(&first));
                }
                let video = Y4m::index(&mut BufReader::new(File::open(at).map_err(|e| Trouble::io(&e))?))?;
                let size = (video.width, video.height);
                (Kind::Video(at.to_path_buf(), video), size)
            }
        };
        let (count, own) = match &kind {
            Kind::Pictures(paths) => (paths.len(), None),
            Kind::Video(_, y4m) => (y4m.count(), y4m.rate),
        };
        let pace = match (rate, own) {
            (Some(rate), _) => Pace::Hertz(rate),
            (None, Some((n, d))) => Pace::Fraction(n, d),
            (None, None) => {
                return Err(Trouble::no_rate("nothing says how fast its images follow each other"));
            }
        };
        match pace.usable(count) {
            true => Ok(Files { kind: Arc::new(kind), pace, count, size }),
            false => Err(Trouble::no_rate(format!("{count} images at {pace:?} a second cannot be played"))),
        }
    }

    /// When the image after the last would come.
    pub fn end(&self) -> Time {
        self.pace.at(self.count).unwrap_or(Time::MAX)
    }

    /// What there is for a sensor that is wanted.
    pub fn written(&self, wanted: &Wanted<'_>) -> Result<Written, Trouble> {
        if !matches!(&*wanted.part.model, "camera" | "footage") {
            let seen =
                format!("images alone have no readings of `{}`, which an agent reads", wanted.sensor());
            let hint = "run a mission that needs no more than a camera, or record a trace";
            return Err(Trouble::not_named(seen, hint));
        }
        let optics = optics(wanted.platform, wanted.part, self.size.0, self.size.1).map_err(|why| {
            Trouble::not_fitting(why, "declare the lens in the profile as that of the camera that took them")
        })?;
        let latency = Time::from_seconds(wanted.part.number("latency")).unwrap_or(Time::ZERO);
        let stamp = |n: usize| {
            let captured = self.pace.at(n).unwrap_or(Time::MAX);
            Stamp { captured, delivered: captured + latency }
        };
        let shots = Reel { kind: Arc::clone(&self.kind), optics, size: self.size };
        Ok(Written::Images { stamps: (0..self.count).map(stamp).collect(), shots: Arc::new(shots) })
    }
}

fn pictured(paths: Vec<PathBuf>, care: Care) -> Result<(Kind, (usize, usize)), Trouble> {
    // All are looked at before a run, so that none fails in the middle of it.
    let looked = if care == Care::Before { &paths[..] } else { &paths[..paths.len().min(1)] };
    let size = pictures::inspect(looked)?;
    Ok((Kind::Pictures(paths), size))
}

fn missing(path: &Path, e: &std::io::Error) -> Trouble {
    if e.kind() != std::io::ErrorKind::NotFound {
        return Trouble::io(e);
    }
    let hint = "check the path; it is taken from the current folder";
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty() && !f.exists());
    match folder {
        Some(f) => Trouble::not_read(
            "there is no such file or folder",
            format!("there is no folder `{}` either", f.display()),
        ),
        None => Trouble::not_read("there is no such file or folder", hint),
    }
}

/// What a file is that is none of those that can be read.
fn unsupported(first: &[u8]) -> Trouble {
    let convert = "convert it: `ffmpeg -i VIDEO -pix_fmt yuv420p FILE.y4m`";
    let (seen, hint) = match first {
        [] => ("the file is empty", "name a folder of images, a .y4m file or a trace"),
        [0x89, b'P', b'N', b'G', ..] | [0xff, 0xd8, ..] => (
            "this is one image, not a recording",
            "name the folder that it is in, or a pattern as `frames/%04d.png`",
        ),
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => {
            ("this is an MP4 or MOV video, which cannot be read", convert)
        }
        [b'R', b'I', b'F', b'F', ..] => ("this is an AVI video, which cannot be read", convert),
        [0x1a, 0x45, 0xdf, 0xa3, ..] => ("this is a Matroska or WebM video, which cannot be read", convert),
        _ => (
            "this is no format that can be read",
            "PNG and JPEG files, .y4m files and traces can; `ffmpeg -i VIDEO -pix_fmt yuv420p FILE.y4m` converts a video",
        ),
    };
    Trouble::not_read(seen, hint)
}

/// Images with the lens that took them.
#[derive(Debug)]
struct Reel {
    kind: Arc<Kind>,
    optics: Optics,
    size: (usize, usize),
}

struct Running {
    kind: Arc<Kind>,
    optics: Optics,
    size: (usize, usize),
    /// The video.
    open: Option<BufReader<File>>,
}

impl Shots for Reel {
    fn show(&self) -> Result<Box<dyn Footage>, Trouble> {
        let open = match &*self.kind {
            Kind::Pictures(_) => None,
            Kind::Video(path, _) => Some(BufReader::new(File::open(path).map_err(|e| Trouble::io(&e))?)),
        };
        Ok(Box::new(Running { kind: Arc::clone(&self.kind), optics: self.optics, size: self.size, open }))
    }
}

impl Footage for Running {
    fn image(&mut self, number: usize) -> Result<Picture, String> {
        let told = |t: Trouble| t.seen().to_string();
        let (size, data) = match (&*self.kind, &mut self.open) {
            (Kind::Pictures(paths), _) => {
                let path = paths.get(number).ok_or("there is no such image")?;
                let image = pictures::read(path).map_err(told)?;
                ((image.width, image.height), image.data)
            }
            (Kind::Video(_, video), Some(file)) => (self.size, video.image(file, number).map_err(told)?),
            (Kind::Video(..), None) => return Err("its file is not open".into()),
        };
        if size != self.size {
            return Err("it has another size than those before it".into());
        }
        Ok(Picture { width: size.0 as u32, height: size.1 as u32, data, optics: self.optics })
    }
}
