//! Images as files: which there are, in which order, and what is in one.

use super::trouble::Trouble;
use rayon::prelude::*;
use std::{
    cmp::Ordering,
    fs,
    io::Cursor,
    path::{Path, PathBuf},
};
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

/// Files that are taken for images, by how their names end.
const ENDINGS: &[&str] = &["png", "jpg", "jpeg"];
/// Along each side.
const MOST_PIXELS: usize = 8192;
/// Bytes of a file.
const LARGEST: u64 = 256 << 20;

const AGAIN: &str = "write it again as PNG or JPEG, or take it out of the recording";

/// An image as RGB, 8 bits each.
#[derive(Debug, PartialEq, Eq)]
pub struct Decoded {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row by row from the upper left.
    pub data: Vec<u8>,
}

/// The images of a folder, in the order of their names; numbers in names count as numbers.
pub fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, Trouble> {
    let wanted = |name: &str| {
        let ending = name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase());
        !name.starts_with('.') && ending.is_some_and(|e| ENDINGS.contains(&&*e))
    };
    listed(folder, wanted, "there is no PNG or JPEG file in this folder")
}

/// The images whose names follow a pattern: `%d` or `%04d` stands for a number, `*` for anything.
pub fn of_pattern(pattern: &Path) -> Result<Vec<PathBuf>, Trouble> {
    let folder = pattern.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = pattern.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let (before, after, digits) = split(&name).ok_or_else(|| {
        let hint = "write one `%d`, `%04d` or `*` for what differs, in the name of the file, as `frames/left_%04d.png`";
        Trouble::not_read("this pattern is not understood", hint)
    })?;
    let wanted = |name: &str| {
        let middle = name.strip_prefix(&*before).and_then(|n| n.strip_suffix(&*after));
        middle.is_some_and(|m| !digits || (!m.is_empty() && m.bytes().all(|b| b.is_ascii_digit())))
    };
    listed(folder, wanted, "no file has a name like that")
}

/// Whether a path is a pattern.
pub fn is_pattern(path: &str) -> bool {
    path.contains(['*', '%'])
}

/// What stands before and after what differs, and whether that is a number.
fn split(name: &str) -> Option<(String, String, bool)> {
    if let Some((before, after)) = name.split_once('*') {
        return (!after.contains(['*', '%'])).then(|| (before.into(), after.into(), false));
    }
    let (before, rest) = name.split_once('%')?;
    let (count, after) = rest.split_once('d')?;
    let plain = count.bytes().all(|b| b.is_ascii_digit()) && !after.contains('%');
    plain.then(|| (before.into(), after.into(), true))
}

fn listed(folder: &Path, wanted: impl Fn(&str) -> bool, nothing: &str) -> Result<Vec<PathBuf>, Trouble> {
    let entries = fs::read_dir(folder).map_err(|e| Trouble::io(&e))?;
    let mut names: Vec<(String, PathBuf)> = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|e| Trouble::io(&e))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if wanted(&name) {
            names.push((name, entry.path()));
        }
    }
    names.sort_by(|a, b| by_numbers(&a.0, &b.0).then_with(|| a.1.cmp(&b.1)));
    match names.is_empty() {
        true => Err(Trouble::not_read(
            nothing,
            "name a folder of images, a pattern as `frames/%04d.png`, a .y4m file or a trace",
        )),
        false => Ok(names.into_iter().map(|(_, path)| path).collect()),
    }
}

/// Order of names in which `image9` comes before `image10`.
fn by_numbers(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a.as_bytes(), b.as_bytes());
    loop {
        let digits = |x: &[u8]| x.iter().take_while(|c| c.is_ascii_digit()).count();
        let (n, m) = (digits(a), digits(b));
        if n > 0 && m > 0 {
            let number = |x: &[u8]| {
                let zeros = x.iter().take_while(|c| **c == b'0').count();
                x[zeros..].to_vec()
            };
            let (x, y) = (number(&a[..n]), number(&b[..m]));
            let order = x.len().cmp(&y.len()).then_with(|| x.cmp(&y));
            if order != Ordering::Equal {
                return order;
            }
            (a, b) = (&a[n..], &b[m..]);
            continue;
        }
        match (a.split_first(), b.split_first()) {
            (Some((x, rest)), Some((y, other))) if x == y => (a, b) = (rest, other),
            (x, y) => return x.map(|x| x.0).cmp(&y.map(|y| y.0)),
        }
    }
}

/// Looks at every image: width and height of them all.
pub fn inspect(paths: &[PathBuf]) -> Result<(usize, usize), Trouble> {
    let sizes: Vec<Result<(usize, usize), Trouble>> =
        paths.par_iter().map(|path| read(path).map(|d| (d.width, d.height))).collect();
    let mut first = None;
    for (path, size) in paths.iter().zip(sizes) {
        let size = size.map_err(|t| t.of(&name(path)))?;
        let (width, height) = *first.get_or_insert(size);
        if size != (width, height) {
            let seen = format!(
                "{} has {} x {} pixels, those before it have {width} x {height}",
                name(path),
                size.0,
                size.1
            );
            let hint = "a recording is of one camera: put images of another size into a folder of their own";
            return Err(Trouble::not_fitting(seen, hint));
        }
    }
    first.ok_or_else(|| Trouble::not_read("it has no images", AGAIN))
}

/// Of a file, as shown to people.
fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.to_string_lossy(), |n| n.to_string_lossy()).into_owned()
}

/// An image in a file.
pub fn read(path: &Path) -> Result<Decoded, Trouble> {
    let length = fs::metadata(path).map_err(|e| Trouble::io(&e))?.len();
    if length > LARGEST {
        return Err(Trouble::not_read(format!("more than {} MB", LARGEST >> 20), AGAIN));
    }
    decode(&fs::read(path).map_err(|e| Trouble::io(&e))?)
}

/// An image out of the bytes of a PNG or JPEG file.
pub fn decode(bytes: &[u8]) -> Result<Decoded, Trouble> {
    match bytes {
        [] => Err(Trouble::not_read("the file is empty", AGAIN)),
        [0x89, b'P', b'N', b'G', ..] => png(bytes),
        [0xff, 0xd8, ..] => jpeg(bytes),
        _ => Err(Trouble::not_read("this is neither PNG nor JPEG", AGAIN)),
    }
}

fn sized(width: usize, height: usize) -> Result<(), Trouble> {
    match [width, height].iter().all(|s| (1..=MOST_PIXELS).contains(s)) {
        true => Ok(()),
        false => {
            let hint = format!("images have 1 to {MOST_PIXELS} pixels a side: make them smaller");
            Err(Trouble::not_fitting(format!("{width} x {height} pixels"), hint))
        }
    }
}

fn png(bytes: &[u8]) -> Result<Decoded, Trouble> {
    let wrong = |e: png::DecodingError| match e {
        png::DecodingError::IoError(_) => Trouble::not_read("the file is cut off", AGAIN),
        e => Trouble::not_read(format!("a damaged PNG: {e}"), AGAIN),
    };
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(wrong)?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    sized(width, height)?;
    let size = reader.output_buffer_size().ok_or_else(|| Trouble::not_read("too large a PNG", AGAIN))?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(wrong)?;
    pixels.truncate(info.buffer_size());
    // What is transparent shows the colour that it has.
    let data = match info.color_type {
        png::ColorType::Grayscale => pixels.iter().flat_map(|y| [*y; 3]).collect(),
        png::ColorType::GrayscaleAlpha => pixels.chunks_exact(2).flat_map(|p| [p[0]; 3]).collect(),
        png::ColorType::Rgb => pixels,
        png::ColorType::Rgba => pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect(),
        png::ColorType::Indexed => {
            return Err(Trouble::not_read("a PNG whose colours are not expanded", AGAIN));
        }
    };
    Ok(Decoded { width, height, data })
}

fn jpeg(bytes: &[u8]) -> Result<Decoded, Trouble> {
    let wrong = |e: zune_jpeg::errors::DecodeErrors| {
        let text = format!("{e:?}");
        Trouble::not_read(format!("a damaged JPEG: {}", text.trim_matches('"')), AGAIN)
    };
    // Without the last marker the rest of the image would come out grey.
    let last = |marker: u8| bytes.windows(2).rposition(|w| w == [0xff, marker]);
    if last(0xd9).is_none_or(|end| last(0xda).is_some_and(|scan| scan > end)) {
        return Err(Trouble::not_read("the file is cut off", AGAIN));
    }
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(MOST_PIXELS)
        .set_max_height(MOST_PIXELS)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(wrong)?;
    let info = decoder.info().ok_or_else(|| Trouble::not_read("a JPEG without a header", AGAIN))?;
    let (width, height) = (usize::from(info.width), usize::from(info.height));
    sized(width, height)?;
    if !matches!(info.components, 1 | 3) {
        let seen = format!("{} colour channels; grey and RGB images can be read", info.components);
        return Err(Trouble::not_fitting(seen, "convert it: `ffmpeg -i IMAGE -pix_fmt rgb24 IMAGE.png`"));
    }
    let data = decoder.decode().map_err(wrong)?;
    match data.len() == 3 * width * height {
        true => Ok(Decoded { width, height, data }),
        false => Err(Trouble::not_read("a JPEG without all of its pixels", AGAIN)),
    }
}
