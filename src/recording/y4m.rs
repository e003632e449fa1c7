//! Y4M: video without compression (YUV4MPEG2, as mjpegtools and ffmpeg write it).
//!
//! A line `YUV4MPEG2 W640 H480 F20:1 …`, then for each frame a line `FRAME …` and its planes: luma, and two of chroma.
//! 8 bits, progressive, square pixels; 4:2:0, 4:2:2, 4:4:4 and luma alone. Converted to RGB after ITU-R BT.601 in whole
//! numbers, so that it is the same everywhere; a sample of chroma counts for all pixels that it covers.

use super::trouble::Trouble;
use std::io::{Read, Seek, SeekFrom};

/// What a file begins with.
pub const MAGIC: &[u8] = b"YUV4MPEG2";
const FRAME: &[u8] = b"FRAME";

/// A line of parameters is not longer.
const LINE: usize = 1024;
/// Along each side.
const MOST_PIXELS: usize = 8192;

const WRITE: &str = "write it as `ffmpeg -i VIDEO -pix_fmt yuv420p FILE.y4m` does";

/// How many pixels share a sample of chroma, across and down; none without chroma.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sampling(Option<(usize, usize)>);

/// A file: its form, and where its frames lie.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Y4m {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Frames a second, as a fraction; none when the file does not tell.
    pub rate: Option<(u64, u64)>,
    sampling: Sampling,
    /// Whether black is 0 and white 255, and not 16 and 235.
    full: bool,
    frames: Vec<u64>,
}

impl Y4m {
    /// Reads the form of a file and finds its frames, to its end.
    pub fn index(input: &mut (impl Read + Seek)) -> Result<Y4m, Trouble> {
        let length = input.seek(SeekFrom::End(0)).map_err(|e| Trouble::io(&e))?;
        let (header, mut at) = line(input, 0, length)?
            .ok_or_else(|| Trouble::not_read("its first line does not end: this is no Y4M file", WRITE))?;
        let mut y4m = Y4m::of_header(&header)?;
        let size = y4m.size() as u64;
        while at < length {
            let n = y4m.frames.len();
            let cut_off = || {
                let hint = format!(
                    "it was cut off while it was written; make one of {n} frames with `ffmpeg -frames:v {n}`"
                );
                Trouble::not_read(format!("the file ends within frame {n}"), hint)
            };
            let (head, data) = line(input, at, length)?.ok_or_else(cut_off)?;
            if !head.starts_with(FRAME) {
                let seen = format!("at byte {at}, where frame {n} is to begin, stands something else");
                return Err(Trouble::not_read(seen, WRITE));
            }
            at = data.checked_add(size).filter(|end| *end <= length).ok_or_else(cut_off)?;
            y4m.frames.push(data);
        }
        match y4m.frames.is_empty() {
            true => Err(Trouble::not_read("it has no frames", WRITE)),
            false => Ok(y4m),
        }
    }

    /// How many frames there are.
    pub fn count(&self) -> usize {
        self.frames.len()
    }

    /// A frame as RGB.
    pub fn image(&self, input: &mut (impl Read + Seek), number: usize) -> Result<Vec<u8>, Trouble> {
        let at =
            *self.frames.get(number).ok_or_else(|| Trouble::not_read("there is no such frame", WRITE))?;
        let mut planes = vec![0; self.size()];
        input.seek(SeekFrom::Start(at)).map_err(|e| Trouble::io(&e))?;
        input.read_exact(&mut planes).map_err(|e| Trouble::io(&e))?;
        Ok(self.rgb(&planes))
    }

    /// Columns and rows of a plane of chroma.
    fn chroma(&self) -> (usize, usize) {
        self.sampling.0.map_or((0, 0), |(x, y)| (self.width.div_ceil(x), self.height.div_ceil(y)))
    }

    /// Bytes of a frame.
    fn size(&self) -> usize {
        let (columns, rows) = self.chroma();
        self.width * self.height + 2 * columns * rows
    }

    fn rgb(&self, planes: &[u8]) -> Vec<u8> {
        let (luma, chroma) = planes.split_at(self.width * self.height);
        let (columns, rows) = self.chroma();
        let (blue, red) = chroma.split_at(columns * rows);
        let mut out = Vec::with_capacity(3 * luma.len());
        for (i, y) in luma.iter().enumerate() {
            let (u, v) = match self.sampling.0 {
                Some((x, y)) => {
                    let at = i / self.width / y * columns + i % self.width / x;
                    (i32::from(blue[at]) - 128, i32::from(red[at]) - 128)
                }
                None => (0, 0),
            };
            let y = i32::from(*y);
            // Times 256.
            let [r, g, b] = match self.full {
                true => [256 * y + 359 * v, 256 * y - 88 * u - 183 * v, 256 * y + 454 * u],
                false => {
                    let y = 298 * (y - 16);
                    [y + 409 * v, y - 100 * u - 208 * v, y + 516 * u]
                }
            };
            out.extend([r, g, b].map(|c| ((c + 128) >> 8).clamp(0, 255) as u8));
        }
        out
    }

    fn of_header(header: &[u8]) -> Result<Y4m, Trouble> {
        let mut words = header.split(|b| *b == b' ').filter(|w| !w.is_empty());
        if words.next() != Some(MAGIC) {
            return Err(Trouble::not_read("it does not begin with YUV4MPEG2: this is no Y4M file", WRITE));
        }
        let mut y4m = Y4m {
            width: 0,
            height: 0,
            rate: None,
            sampling: Sampling(Some((2, 2))),
            full: false,
            frames: Vec::new(),
        };
        for word in words {
            let (kind, value) = word.split_at(1);
            let value = String::from_utf8_lossy(value);
            match kind {
                b"W" => y4m.width = side("width", &value)?,
                b"H" => y4m.height = side("height", &value)?,
                b"F" => y4m.rate = fraction(&value).filter(|(n, d)| *n > 0 && *d > 0),
                b"C" => y4m.sampling = sampling(&value)?,
                b"I" if !matches!(&*value, "p" | "?") => {
                    let hint = "make whole frames of its fields: `ffmpeg -i VIDEO -vf yadif -pix_fmt yuv420p FILE.y4m`";
                    return Err(Trouble::not_read("its frames are interlaced", hint));
                }
                b"A" if fraction(&value).is_none_or(|(n, d)| n != d) => {
                    let hint = "make them square: `ffmpeg -i VIDEO -vf scale=iw*sar:ih,setsar=1 -pix_fmt yuv420p FILE.y4m`";
                    return Err(Trouble::not_read(format!("its pixels are not square but {value}"), hint));
                }
                b"X" if &*value == "COLORRANGE=FULL" => y4m.full = true,
                _ => {}
            }
        }
        match y4m.width == 0 || y4m.height == 0 {
            true => Err(Trouble::not_read("its first line gives no width or no height", WRITE)),
            false => Ok(y4m),
        }
    }
}

fn side(what: &str, text: &str) -> Result<usize, Trouble> {
    let side = text.parse().ok().filter(|s| (1..=MOST_PIXELS).contains(s));
    side.ok_or_else(|| {
        let hint =
            format!("images have 1 to {MOST_PIXELS} pixels a side; `ffmpeg -vf scale=…` makes them smaller");
        Trouble::not_read(format!("a {what} of {text:?} pixels"), hint)
    })
}

fn fraction(text: &str) -> Option<(u64, u64)> {
    let (n, d) = text.split_once(':')?;
    Some((n.parse().ok()?, d.parse().ok()?))
}

fn sampling(text: &str) -> Result<Sampling, Trouble> {
    Ok(Sampling(match text {
        "420" | "420jpeg" | "420mpeg2" | "420paldv" => Some((2, 2)),
        "422" => Some((2, 1)),
        "444" => Some((1, 1)),
        "mono" => None,
        other => {
            let seen = format!(
                "its colours are stored as {other:?}; 420, 422, 444 and mono with 8 bits can be read"
            );
            return Err(Trouble::not_read(seen, WRITE));
        }
    }))
}

/// The line that begins at `at`, and where the next one does; none when it does not end soon.
fn line(input: &mut (impl Read + Seek), at: u64, length: u64) -> Result<Option<(Vec<u8>, u64)>, Trouble> {
    let mut bytes = vec![0; LINE.min(length.saturating_sub(at) as usize)];
    input.seek(SeekFrom::Start(at)).map_err(|e| Trouble::io(&e))?;
    input.read_exact(&mut bytes).map_err(|e| Trouble::io(&e))?;
    let Some(end) = bytes.iter().position(|b| *b == b'\n') else { return Ok(None) };
    bytes.truncate(end);
    Ok(Some((bytes, at + end as u64 + 1)))
}
