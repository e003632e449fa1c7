//! Names the recording of a mission from the command line: as if it stood in the profile.

use super::trouble::Trouble;
use crate::report::Refusal;
use soifra_graph::{Dim, Expr, Graph, Type, TypeTable, Value};
use soifra_platforms::recording::DRIVE;

/// Puts a file, and how many images a second it has, into every platform of a mission that is a recording. What is not
/// given stays as it is.
pub fn name(graph: &mut Graph, file: Option<&str>, rate: Option<&str>) -> Result<(), Refusal> {
    if file.is_none() && rate.is_none() {
        return Ok(());
    }
    let rate = rate.map(hertz).transpose()?;
    let mut taken = false;
    let drives = graph.platforms.iter_mut().flat_map(|p| &mut p.components);
    for drive in drives.filter(|c| &*c.role == "drive" && &*c.model == DRIVE) {
        taken = true;
        for (name, e) in &mut drive.args {
            let given = match &**name {
                "file" => file.map(|f| Value::Text(f.to_string())),
                "rate" => rate.map(|r| Value::Some(Box::new(Value::Number(r)))),
                _ => None,
            };
            if let Some(value) = given {
                *e = Expr::constant(value, e.ty.clone(), e.span);
            }
        }
    }
    if taken {
        return Ok(());
    }
    let option = file.map_or_else(|| "--rate".to_string(), |f| format!("--recording {f}"));
    let seen = format!("no robot of mission `{}` reads a recording", graph.name);
    let hint = "choose a platform that is one, as `--platform recorded_camera`, or write `drive = recorded()` into its profile";
    Err(Trouble::not_named(seen, hint).refusal(&option))
}

/// A rate on the command line.
fn hertz(text: &str) -> Result<f64, Refusal> {
    let frequency = Type::Quantity(Dim::NONE.over(Dim::TIME).unwrap_or(Dim::NONE));
    let value = soifra_lang::parse_value(text, &frequency, &TypeTable::default());
    let refuse = |seen: String| Trouble::no_rate(seen).refusal(&format!("--rate {text}"));
    let rate = value.map_err(refuse)?.number().unwrap_or(0.0);
    match rate.is_finite() && rate > 0.0 {
        true => Ok(rate),
        false => Err(refuse("images that never follow each other".into())),
    }
}
