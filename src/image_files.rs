//! Image files that materials name: read by the shell, so that everything below it gets pixels.
//!
//! A source names an image from its own folder, as an import; a graph names it from the folder of the mission, so that
//! it does not depend on where a command was started. A trace tells where it lay and its digest.

use crate::{files, recording, report::Refusal};
use soifra_graph::{Component, Diagnostic, Expr, Graph, Op, Span, Value, did_you_mean};
use soifra_runtime::{
    objects::digest,
    scene::{ImageFile, Pixels},
};
use std::{
    collections::BTreeMap,
    path::{Component as Step, Path, PathBuf},
    sync::Arc,
};

/// Along each side. A texture of the camera keeps no more.
const MOST_PIXELS: usize = 4096;

/// It cannot be used.
const UNUSABLE: &str = "S9034";
/// It is not the one that a run was made with.
const CHANGED: &str = "S9035";

fn is_image(c: &Component) -> bool {
    (&*c.role, &*c.model) == ("material", "image")
}

/// Names the images of a graph from the folder of its mission; `graph.sources` are named so already.
pub fn name_from_mission(graph: &mut Graph) {
    let Graph { sources, world, .. } = graph;
    let folder = |span: Span| {
        let source = sources.get(span.file as usize).map_or("", |s| s.path.as_str());
        Path::new(source).parent().unwrap_or(Path::new("")).to_path_buf()
    };
    let names = world.iter_mut().filter(|c| is_image(c)).flat_map(|c| &mut c.args);
    for (_, e) in names.filter(|(name, _)| &**name == "file") {
        anchor(e, &folder);
    }
}

fn anchor(e: &mut Expr, folder: &impl Fn(Span) -> PathBuf) {
    let span = e.span;
    if let Op::Const(Value::Text(name)) = &mut e.op {
        *name = plain(&folder(span).join(&*name));
    }
    for part in &mut e.args {
        anchor(part, folder);
    }
}

/// Without `.` and inner `..`, with `/`.
fn plain(path: &Path) -> String {
    let mut out = PathBuf::new();
    for step in path.components() {
        match step {
            Step::CurDir => {}
            Step::ParentDir if matches!(out.components().next_back(), Some(Step::Normal(_))) => {
                out.pop();
            }
            step => out.push(step),
        }
    }
    out.to_string_lossy().replace('\\', "/")
}

/// Reads every image that a graph may name, whatever its parameters say; `main` is the file that it came from. What is
/// wrong is told at the name.
pub fn read(main: &str, graph: &Graph) -> (Vec<ImageFile>, Vec<Diagnostic>) {
    let folder = Path::new(main).parent().unwrap_or(Path::new(""));
    let (mut images, mut wrong) = (BTreeMap::new(), Vec::new());
    let named = graph.world.iter().filter(|c| is_image(c)).flat_map(|c| &c.args);
    for (_, e) in named.filter(|(name, _)| &**name == "file") {
        e.walk(&mut |e| {
            let Some(Value::Text(name)) = e.as_const() else { return };
            if images.contains_key(name) {
                return;
            }
            let path = folder.join(name);
            match pixels(&path) {
                Ok(pixels) => {
                    let path = path.to_string_lossy().into_owned();
                    images.insert(name.clone(), image(name.clone(), path, pixels));
                }
                Err((seen, hint)) => {
                    let title = format!("the image `{name}` cannot be used");
                    wrong.push(Diagnostic::error(UNUSABLE, title).at(e.span, seen).hint(hint));
                }
            }
        });
    }
    (images.into_values().collect(), wrong)
}

fn image(name: String, path: String, pixels: Pixels) -> ImageFile {
    let digest = digest(pixels.width as u32, pixels.height as u32, &pixels.data);
    ImageFile { name, path, digest: format!("{digest:016x}"), pixels: Some(Arc::new(pixels)) }
}

/// The images that a trace tells of.
///
/// # Errors
/// That one is gone, or has changed since: what cameras saw cannot be rendered from it.
pub fn again(known: &[ImageFile]) -> Result<Vec<ImageFile>, Refusal> {
    let one = |known: &ImageFile| {
        let refuse = |seen: String| {
            let title = format!("the image `{}` is not that of the recorded run", known.name);
            let hint = "put back the file that the run was made with; its path is taken from the folder in which \
                        the run was started";
            Refusal::about(&known.path, CHANGED, title, seen, hint)
        };
        let pixels = pixels(Path::new(&known.path)).map_err(|(seen, _)| refuse(seen))?;
        let now = image(known.name.clone(), known.path.clone(), pixels);
        match now.digest == known.digest {
            true => Ok(now),
            false => {
                Err(refuse(format!("its digest is {}, that of the trace is {}", now.digest, known.digest)))
            }
        }
    };
    known.iter().map(one).collect()
}

/// What is in a file; else what is seen, and what to do about it.
fn pixels(path: &Path) -> Result<Pixels, (String, String)> {
    let smaller = || format!("images of materials have 1 to {MOST_PIXELS} pixels a side: make it smaller");
    if path.is_dir() {
        return Err(("this is a folder".into(), "name one PNG or JPEG file in it".into()));
    }
    if !path.exists() {
        return Err(("there is no such file".into(), near(path)));
    }
    let decoded = recording::read(path).map_err(|trouble| {
        let hint = match trouble.fits() {
            false => smaller(),
            true => "name a PNG or JPEG file that an image viewer shows; others can be converted: \
                     `ffmpeg -i IMAGE IMAGE.png`"
                .into(),
        };
        (trouble.seen().to_string(), hint)
    })?;
    if decoded.width.max(decoded.height) > MOST_PIXELS {
        return Err((format!("{} x {} pixels", decoded.width, decoded.height), smaller()));
    }
    Ok(Pixels { width: decoded.width, height: decoded.height, data: decoded.data })
}

/// A hint with the image of the nearest name in the same folder, if there is one.
fn near(path: &Path) -> String {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    match files::names_in(folder) {
        None => format!("there is no folder `{}` either", folder.display()),
        Some(names) => match did_you_mean(&name, names.iter().map(String::as_str)) {
            Some(near) => format!("did you mean `{near}`, in the same folder?"),
            None => "paths are relative to the file that names the image".into(),
        },
    }
}
