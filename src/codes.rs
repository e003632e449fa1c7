//! The diagnostics of the command line itself (`S90..`); those of the language come from its crate.

/// A diagnostic's page.
#[derive(Debug, Clone, Copy)]
pub struct Page {
    /// Code.
    pub code: &'static str,
    /// One line, no full stop.
    pub title: &'static str,
    /// Markdown.
    pub text: &'static str,
}

const fn page(code: &'static str, title: &'static str, text: &'static str) -> Page {
    Page { code, title, text }
}

/// Every page of the command line, by code.
pub const PAGES: &[Page] = &[
    page(
        "S0901",
        "A value at the start cannot be used",
        "A value of the scene cannot be worked out, or lies outside what is possible, with the parameters and the seed of this run: a chance above 1, a negative number of robots, a division by zero. The report names the thing and its argument. With the default parameters `soifra check` finds most of these; look at what `--set` gave.",
    ),
    page(
        "S9001",
        "The file cannot be read",
        "There is no such file, or it may not be opened. Paths are taken from the current folder; the report names the nearest file name in the same folder.",
    ),
    page(
        "S9002",
        "A file is needed here",
        "The path names a directory. Commands that take several files take them one by one: `soifra check missions/*.soi`.",
    ),
    page(
        "S9003",
        "The file is not UTF-8 text",
        "Missions and graphs are UTF-8. The report shows the first byte that belongs to no character. Save the file as UTF-8; `iconv -f latin1 -t utf-8 OLD > NEW` converts an old one.",
    ),
    page(
        "S9004",
        "The file is too large",
        "soifra reads files up to 256 MB. Larger ones are most likely not what was meant.",
    ),
    page(
        "S9005",
        "The graph file cannot be read",
        "The YAML or JSON of a graph file is cut off or not well formed; the report shows where. Brackets may nest 2048 deep in JSON and 128 deep in YAML: a graph that nests deeper than YAML allows can be written as JSON.",
    ),
    page(
        "S9006",
        "This is no behaviour graph",
        "The file is YAML or JSON, but not a graph: it lacks the `schema` number. `soifra graph MISSION --format yaml` makes a graph file.",
    ),
    page(
        "S9007",
        "The graph has another schema version",
        "Graph files carry the version of their form. A reader refuses others instead of guessing. Make the graph again from its source.",
    ),
    page(
        "S9008",
        "The graph is damaged",
        "Something in the graph file has the wrong form; the report gives the path to it, as `agents[0].units[2].trigger`.",
    ),
    page(
        "S9009",
        "A graph file is bound to its platforms",
        "`--platform` chooses profiles while a source is compiled. In a graph file they are chosen already. Run the source, or make a graph with `soifra graph MISSION --platform NAME`.",
    ),
    page(
        "S9010",
        "Unknown parameter",
        "`--set` names a parameter that the mission does not have. The report lists the nearest name, or all of them.",
    ),
    page(
        "S9011",
        "The value does not fit the parameter",
        "`--set name=value` takes a value of the parameter's type, with its unit and without spaces around `=`: `--set speed=0.3m/s`, `--set mode=careful`, `--set avoidance=off`.",
    ),
    page(
        "S9012",
        "The file cannot be written",
        "Output is refused before anything starts when its file cannot be made: a folder that is not writable, a directory of that name, a full disk. `--trace none` runs without a trace.",
    ),
    page(
        "S9013",
        "Standard output cannot be written",
        "The result could not be written, for instance because the disk is full. A reader that goes away (`| head`) is no error.",
    ),
    page(
        "S9014",
        "The system gives no thread",
        "soifra compiles and runs on a thread with a large stack of its own. The system refused it: memory or thread limits (`ulimit -v`, `ulimit -u`) are too low.",
    ),
    page(
        "S9015",
        "A list of seeds or a shard is wrong",
        "Seeds are given as `20` (1 to 20), `5..9` or `1..20,42`; a shard as `i/n` with i from 1 to n.",
    ),
    page(
        "S9016",
        "These sweep results do not go together",
        "`soifra sweep merge` takes the JSON of all shards of one sweep: the same mission, graph, parameters and number of shards, each shard once.",
    ),
    page(
        "S9017",
        "The trace stopped being writable",
        "The run was aborted because its trace could not be written any more, for instance because the disk is full. What was recorded until then is kept and opens.",
    ),
    page(
        "S9018",
        "The trace cannot be read",
        "The file is no soifra trace, or is damaged so far that nothing can be told from it. A trace that was cut off opens with all but its last chunk.",
    ),
    page(
        "S9019",
        "The run differs from its golden",
        "`soifra test` compares a run with what was accepted before: events in order exactly, figures within 1e-6. When the change is meant, accept it with `soifra test --accept`.",
    ),
    page(
        "S9020",
        "The mission cannot be set up",
        "An expression of the scene could not be evaluated for these parameters and this seed, or the platform cannot be built from it.",
    ),
    page(
        "S9021",
        "Nothing to test",
        "No mission among the files has a `test` block or a golden. Write a `test`, or make a golden with `soifra test --accept`.",
    ),
    page(
        "S9022",
        "A test failed",
        "An expectation of a `test` block did not hold. The report names the test, the seed and the first instant at which it was violated; `soifra run` with that seed records the trace.",
    ),
    page(
        "S9023",
        "The replay differs",
        "The trace was re-executed on its recorded inputs and something came out differently. The report names the first record that differs.",
    ),
    page(
        "S9024",
        "The command line is wrong",
        "An option, argument or command that soifra does not have, or one that is missing. `soifra --help` and `soifra COMMAND --help` list what there is.",
    ),
    page(
        "S9025",
        "No diagnostic has this code",
        "Codes are an S and four digits, as in the brackets of a report. `soifra explain` lists all.",
    ),
    page(
        "S9026",
        "The file does not have the form that is wanted",
        "A file of studies for `soifra measure` is a YAML list; the report gives the path to what is wrong in it. Fields of a study: `name`, `title`, `mission`, `seeds`, `sample`, `set`, `platforms`, `text`, `bars`. Fields of a bar: `metric`, `label`, `published`, `scale`, `of` (`mean`, `median`, `min`, `max`), `over` (a mean of the runs' figures, weighted by this metric), `per` (the sum over all runs, divided by that of this metric), `at_most`, `at_least`, `full_only`.",
    ),
    page(
        "S9027",
        "The trace knows nothing of that name",
        "`soifra plot --agent` takes an agent of every robot (`courier`) or of one (`courier@r1`), `--conversation` the identifier of a conversation or its beginning. Nothing in the trace tells of such a one; the report names the nearest, or what there is.",
    ),
    page(
        "S9028",
        "An operator input is not understood",
        "`soifra run --realtime` takes inputs on standard input, one a line: `kill AGENT@ROBOT` ends an agent, `set NAME=VALUE` changes a parameter of the mission (the value with its unit, as for `--set`), `stop` ends the run with every robot's safe action. Any other line is told and changes nothing, and so is one that comes when the run is over. A line has at most 4096 bytes and is UTF-8. A run whose standard input is not meant for it is given none: `< /dev/null`.",
    ),
    page(
        "S9029",
        "A service is not in this program",
        "The mission calls a function that is computed by a library which this program was built without. Vision services (`look`, `contact_by_expansion`, …) come with the feature `vision`, which is on by default and needs OpenCV; `make` installs it.",
    ),
    page(
        "S9030",
        "A mission and a recording do not go together",
        "A robot whose platform is a recording (`drive = recorded()`) reads what `--recording PATH` names, or the `file` of its profile. The report says what is missing: no recording is named, no robot takes one, a sensor that an agent reads was not recorded, some robots are simulated beside it. Images alone have readings of a camera and of nothing else; a trace has all that was read in its run, by name of robot and sensor.",
    ),
    page(
        "S9031",
        "The recording cannot be read",
        "There is no such file or folder, no image in it, a format that is not known, or a file that is damaged or cut off; the report names it. Recordings are folders of PNG or JPEG files, taken in the order of their names (numbers in them count as numbers), patterns of such files (`frames/left_%04d.png`, `frames/*.jpg`), .y4m files (8 bits; 4:2:0, 4:2:2, 4:4:4 or luma alone; progressive, square pixels), and traces. `ffmpeg -i VIDEO -pix_fmt yuv420p FILE.y4m` converts other videos. All images are read once before the run starts.",
    ),
    page(
        "S9032",
        "The images of the recording do not fit",
        "Images of one recording have one size, at most 8192 pixels a side, in grey or RGB; a `camera` that declares its width and height takes no others (a `footage` takes any). The report names the first image that differs.",
    ),
    page(
        "S9033",
        "The rate of the recording is not known",
        "Image files do not tell how many of them were taken a second: say it with `--rate 20Hz`, or as `rate` of the profile's `recorded`. It is above zero, and at most 1 MHz. A .y4m file has a rate of its own, which `--rate` replaces; a trace has the times of its images, and takes no rate.",
    ),
    page(
        "S9034",
        "The image of a material cannot be used",
        "A world covers things with image files: `material door = image(\"posters/door.png\", width: 1.2 m)`. The path is taken from the folder of the file that names it. The report says what is wrong with it: there is no such file (and which one has a name like it), it is damaged or cut off, it is neither PNG nor JPEG, its colours are neither grey nor RGB, or it has more than 4096 pixels along a side.",
    ),
    page(
        "S9035",
        "An image file has changed since the run",
        "What cameras saw is rendered again from the world of a trace. A trace knows the image files of its materials by path and digest; one of them is gone, or holds other pixels. Put back the file that the run was made with, and start the command in the folder in which the run was started.",
    ),
    page(
        "S9999",
        "A defect of soifra",
        "soifra met a state it holds impossible. It exits with 70. Please report it with the command line and the files.",
    ),
];

/// The page of a code, of the command line or of the language.
pub fn find(code: &str) -> Option<Page> {
    let code = code.trim().to_ascii_uppercase();
    PAGES
        .iter()
        .find(|p| p.code == code)
        .copied()
        .or_else(|| soifra_lang::explain(&code).map(|e| page(e.code, e.title, e.text)))
}

/// Every page, by code.
pub fn all() -> Vec<Page> {
    let mut pages: Vec<Page> = soifra_lang::explanations().map(|e| page(e.code, e.title, e.text)).collect();
    pages.extend(PAGES);
    pages.sort_by_key(|p| p.code);
    pages
}
