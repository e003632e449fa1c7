//! From what the user named to a checked graph: a source is compiled, a graph file is loaded and verified.

use crate::{
    files, graph_file, image_files, relative,
    report::{Findings, Refusal},
    services,
};
use soifra_graph::{Diagnostic, Graph, Severity, Span, Value, did_you_mean};
use soifra_lang::{CheckOptions, TestCase};
use soifra_runtime::{Mission, scene::ImageFile};

/// A graph that passed every check, with the warnings and tests that came along.
pub struct Compiled {
    /// The graph.
    pub graph: Graph,
    /// Warnings.
    pub findings: Findings,
    /// `test` blocks of the source; none for a graph file.
    pub tests: Vec<TestCase>,
    /// Image files that the materials of its world name.
    pub images: Vec<ImageFile>,
}

impl Compiled {
    /// The mission with its code.
    pub fn mission(self) -> Result<Mission, Refusal> {
        crate::execute::load(self.graph, self.images)
    }
}

/// A file that passed every check. One of agents or profiles alone has no graph.
pub struct Checked {
    /// The graph, when there is a mission.
    pub graph: Option<Graph>,
    /// Names of the file's missions.
    pub missions: Vec<String>,
    /// Warnings.
    pub findings: Findings,
    /// `test` blocks.
    pub tests: Vec<TestCase>,
    /// Image files that the materials of the graph's world name.
    pub images: Vec<ImageFile>,
}

/// Missions and their timing.
pub type Timings = Vec<(String, soifra_lang::schedule::Timing)>;

/// Compiles or loads a file that must hold a mission; `platform` replaces the platform of every robot.
pub fn compile(path: &str, platform: Option<&str>) -> Result<Compiled, Refusal> {
    compile_mission(path, platform, None)
}

/// Compiles the mission called `mission` of a file that may hold several.
pub fn compile_mission(
    path: &str,
    platform: Option<&str>,
    mission: Option<&str>,
) -> Result<Compiled, Refusal> {
    compile_with(path, platform, mission, None)
}

/// As [`compile_mission`], with the faults that the test called `test` declares. Without a name, the mission is
/// the one that the test runs.
pub fn compile_with(
    path: &str,
    platform: Option<&str>,
    mission: Option<&str>,
    test: Option<&str>,
) -> Result<Compiled, Refusal> {
    let options = CheckOptions {
        platform: platform.map(str::to_string),
        mission: mission.map(str::to_string),
        test: test.map(str::to_string),
        ..CheckOptions::default()
    };
    let checked = check_with(path, &options, &mut Vec::new())?;
    let missing = |option: &str, what: &str, name: &str, known: Vec<&str>| {
        let hint = match did_you_mean(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None if known.is_empty() => format!("the file has no {what}"),
            None => format!("its {what}s are {}", known.join(", ")),
        };
        let title = format!("there is no {what} `{name}`");
        Refusal::about(&format!("{option} {name}"), "S0201", title, "not in this file", &hint)
    };
    if let Some(name) = test
        && !checked.tests.iter().any(|t| *t.name == *name)
    {
        let known = checked.tests.iter().map(|t| &*t.name).collect();
        return Err(missing("--test", "test", name, known));
    }
    if let (None, Some(name)) = (&checked.graph, mission) {
        let known = checked.missions.iter().map(String::as_str).collect();
        return Err(missing("--mission", "mission", name, known));
    }
    match checked.graph {
        Some(graph) => {
            Ok(Compiled { graph, findings: checked.findings, tests: checked.tests, images: checked.images })
        }
        None => Err(Refusal::about(
            path,
            "S0701",
            "there is no mission in this file",
            "it declares things for missions to import",
            "name a file with a line that begins `mission NAME`",
        )),
    }
}

/// Checks a file that may be without a mission.
pub fn check(path: &str, platform: Option<&str>, mission: Option<&str>) -> Result<Checked, Refusal> {
    let options = CheckOptions {
        platform: platform.map(str::to_string),
        mission: mission.map(str::to_string),
        ..CheckOptions::default()
    };
    check_with(path, &options, &mut Vec::new())
}

/// As [`check`]. When the timing is asked for, `timings` gets that of missions that cannot be run, too.
pub fn check_with(path: &str, options: &CheckOptions, timings: &mut Timings) -> Result<Checked, Refusal> {
    let text = files::read_text(path)?;
    if graph_file::is_graph(path) {
        return load(path, &text, options, timings);
    }
    if text.trim().is_empty() {
        let hint =
            "a mission begins with a line `mission NAME \"title\" {`; the tutorial has one to start from";
        return Err(Refusal::about(path, "S0701", "there is no mission in this file", "it is empty", hint));
    }
    let mut checked = soifra_lang::check(path, &text, &mut files::Loader, options);
    *timings = std::mem::take(&mut checked.timings);
    if let Some(graph) = &mut checked.graph {
        relative::name_from(path, &mut graph.sources);
        image_files::name_from_mission(graph);
    }
    let mut diagnostics = checked.diagnostics;
    diagnostics.extend(checked.graph.iter().flat_map(services::missing));
    let (images, wrong) = checked.graph.as_ref().map(|g| image_files::read(path, g)).unwrap_or_default();
    diagnostics.extend(wrong);
    let findings = Findings { diagnostics, sources: checked.sources };
    if findings.errors() > 0 {
        return Err(Refusal { findings, exit: crate::exit::Exit::WrongInput });
    }
    Ok(Checked { graph: checked.graph, missions: checked.missions, findings, tests: checked.tests, images })
}

fn load(path: &str, text: &str, options: &CheckOptions, timings: &mut Timings) -> Result<Checked, Refusal> {
    let graph = graph_file::parse(path, text)?;
    if let Some(p) = &options.platform {
        return Err(Refusal::about(
            path,
            "S9009",
            "a graph file is bound to its platforms",
            format!("`--platform {p}` cannot change them"),
            "run the source instead, or make a graph with `soifra graph MISSION --platform NAME`",
        ));
    }
    if options.timing {
        timings.extend(soifra_lang::schedule::of_graph(&graph).map(|t| (graph.name.to_string(), t)));
    }
    let mut diagnostics = soifra_lang::verify(&graph);
    diagnostics.extend(services::missing(&graph));
    let (images, wrong) = image_files::read(path, &graph);
    diagnostics.extend(wrong);
    let findings = Findings { diagnostics, sources: graph.sources.clone() };
    if findings.errors() > 0 {
        return Err(Refusal { findings, exit: crate::exit::Exit::WrongInput });
    }
    // What the runtime asks of a graph besides: a source always gives it, a file need not.
    crate::execute::load(graph.clone(), images.clone())?;
    let missions = vec![graph.name.to_string()];
    Ok(Checked { graph: Some(graph), missions, findings, tests: Vec::new(), images })
}

/// A parameter as `--set` gives it: `name=value`.
pub fn split_setting(text: &str) -> Result<(String, String), Refusal> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_string(), value.trim().to_string()))
        }
        _ => Err(Refusal::about(
            &format!("--set {text}"),
            "S9011",
            "a parameter is set as name=value",
            "there is no value here",
            "write it without spaces around `=`, as `--set speed=0.3m/s`",
        )),
    }
}

/// The values of `--set` for the parameters of a graph: index in [`Graph::params`], value.
pub fn settings(graph: &Graph, sets: &[(String, String)]) -> Result<Vec<(usize, Value)>, Refusal> {
    sets.iter().map(|(name, text)| setting(graph, "--set", name, text)).collect()
}

/// Refuses values with which the mission would not pass its checks, as places that overlap.
pub fn verify_with(graph: &Graph, values: &[(usize, Value)]) -> Result<(), Refusal> {
    if values.is_empty() {
        return Ok(());
    }
    let mut graph = graph.clone();
    for (index, value) in values {
        graph.params[*index].default = value.clone();
    }
    let mut diagnostics = soifra_lang::verify(&graph);
    diagnostics.retain(|d| d.severity == Severity::Error);
    let findings = Findings { diagnostics, sources: graph.sources.clone() };
    match findings.errors() {
        0 => Ok(()),
        _ => Err(Refusal { findings, exit: crate::exit::Exit::WrongInput }),
    }
}

/// The value of a parameter that is set by `given` (`--set`, or an operator's `set`): index in
/// [`Graph::params`], value.
pub fn setting(graph: &Graph, given: &str, name: &str, text: &str) -> Result<(usize, Value), Refusal> {
    let argument = format!("{given} {name}={text}");
    let Some(index) = graph.params.iter().position(|p| &*p.name == name) else {
        let names = || graph.params.iter().map(|p| &*p.name);
        let hint = match did_you_mean(name, names()) {
            Some(n) => format!("did you mean `{n}`?"),
            None if graph.params.is_empty() => "this mission has no parameters".into(),
            None => format!("the parameters are {}", names().collect::<Vec<_>>().join(", ")),
        };
        let seen = format!("mission `{}` has no parameter `{name}`", graph.name);
        return Err(Refusal::about(&argument, "S9010", "unknown parameter", seen, &hint));
    };
    let param = &graph.params[index];
    match soifra_lang::parse_value(text, &param.ty, &graph.types) {
        Ok(value) => Ok((index, value)),
        Err(why) => {
            let mut diagnostic =
                Diagnostic::error("S9011", format!("the value does not fit the parameter: {why}"))
                    .at(param.at, format!("`{name}` is declared here, a {}", param.ty))
                    .hint(format!("`{given} {name}=…` takes {}", expected(&param.ty, graph)));
            if param.at == Span::default() {
                diagnostic.labels.clear();
            }
            let findings = Findings { diagnostics: vec![diagnostic], sources: graph.sources.clone() };
            Err(Refusal { findings, exit: crate::exit::Exit::WrongInput })
        }
    }
}

/// What a parameter takes, in words.
fn expected(ty: &soifra_graph::Type, graph: &Graph) -> String {
    use soifra_graph::Type;
    match ty {
        Type::Bool => "on, off, true or false".into(),
        Type::Int => "a whole number".into(),
        Type::Quantity(d) if d.si_unit().is_empty() => "a number".into(),
        Type::Quantity(d) => format!("a number with a unit, as 2{}", d.si_unit()),
        Type::Enum(n) => match graph.types.enums.get(n) {
            Some(e) => format!("one of {}", e.variants.iter().map(|v| &**v).collect::<Vec<_>>().join(", ")),
            None => format!("a variant of {n}"),
        },
        other => format!("a {other}"),
    }
}

/// The parameters that a test sets, and after them those that the user sets.
pub fn with_test(
    tests: &[TestCase],
    test: Option<&str>,
    sets: Vec<(String, String)>,
) -> Vec<(String, String)> {
    let of_test =
        tests.iter().find(|t| test == Some(&*t.name)).map(|t| t.sets.as_slice()).unwrap_or_default();
    let mut all: Vec<(String, String)> = of_test.iter().map(|(n, v)| (n.to_string(), v.clone())).collect();
    all.retain(|(n, _)| !sets.iter().any(|(m, _)| m == n));
    all.extend(sets);
    all
}
