//! The chart of the allocation is the published order of steps (SOIFRA, figs. 8 and 10).

use crate::support::{code, folder, soifra, stderr};

/// The lines of a Mermaid chart, with names in place of numbers and without times.
fn steps(chart: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut out = Vec::new();
    for line in chart.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("participant ") {
            let (key, name) = rest.split_once(" as ").expect("a name");
            names.push((key.to_string(), name.to_string()));
        } else if line.contains("->>") || line.starts_with("Note over") {
            let mut text = line.split(" (").next().unwrap_or_default().to_string();
            for (key, name) in names.iter().rev() {
                text = text
                    .replace(&format!("{key}-"), &format!("{name} -"))
                    .replace(&format!(">{key}:"), &format!("> {name}:"));
                text = text.replace(&format!("over {key}:"), &format!("over {name}:"));
            }
            out.push(text);
        }
    }
    out
}

#[test]
fn the_chart_is_the_published_order_of_steps() {
    let dir = folder("allocation_chart");
    let trace = dir.join("a.mcap").to_string_lossy().into_owned();
    let o = soifra(&["run", "missions/agents/allocation.soi", "--trace", &trace]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let chart = dir.join("a.mmd").to_string_lossy().into_owned();
    let o = soifra(&["plot", &trace, "--kind", "sequence", "--output", &chart]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let steps = steps(&std::fs::read_to_string(&chart).expect("a chart"));
    let mut at = 0;
    let mut next = |what: &str| {
        let found = steps[at..].iter().position(|s| s.contains(what));
        let found = found.unwrap_or_else(|| panic!("no `{what}` after step {at}:\n{}", steps.join("\n")));
        at += found + 1;
    };
    // Fig. 8: agents, collaborative or not, register; the planner-matcher queries the directory and requests;
    // the agent agrees by its availability and its nature.
    next("steering@scout ->> df: request register drive");
    next("detector@scout ->> df: request register watch");
    next("planner ->> df: query_ref drive");
    next("df ->> steering@scout: inform registered drive");
    next("df ->> planner: inform_ref drive: steering@scout");
    next("planner ->> detector@scout: request watch for detect_obstacle");
    next("planner ->> steering@scout: request drive for avoid_obstacle");
    next("planner ->> steering@scout: request drive for navigate");
    next("detector@scout ->> planner: agree detect_obstacle");
    next("Note over detector@scout: ▸ watch for detect_obstacle");
    next("steering@scout ->> planner: agree navigate");
    // Fig. 10: video, detection, and for an obstacle the time to contact; nearer than the critical distance the
    // parameter server is updated; the obstacle is avoided, which detection is told; the index goes back.
    next("Note over detector@scout: ▸ video");
    next("Note over detector@scout: ▸ detection");
    next("Note over detector@scout: ▸ time_to_contact");
    next("detector@scout ->> parameters: avoidance_index = 3");
    next("detector@scout ->> avoider@scout: inform Obstacle");
    next("steering@scout ->> detector@scout: inform Avoided");
    next("detector@scout ->> parameters: avoidance_index = 1");
    next("Note over detector@scout: ▪ time_to_contact");
}

#[test]
fn a_matrix_tells_where_missions_work_and_why_not() {
    let o = soifra(&["check", "--matrix", "missions/agents/allocation.soi"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let text = String::from_utf8_lossy(&o.stdout).into_owned();
    let row =
        text.lines().find(|l| l.trim_start().starts_with("allocation ")).unwrap_or_else(|| panic!("{text}"));
    assert!(row.contains("yes") && row.contains("no"), "{text}");
    assert!(
        text.contains("allocation on disc_robot:") && text.contains("S0710 no agent is capable of"),
        "{text}"
    );
}

#[test]
fn the_ontology_shows_who_is_allocated() {
    let o = soifra(&["graph", "missions/agents/allocation.soi", "--kind", "agents"]);
    assert_eq!(code(&o), 0, "{}", stderr(&o));
    let text = String::from_utf8_lossy(&o.stdout).into_owned();
    for part in [
        "mission allocation",
        "goal avoid_collision",
        "sub-goal detect_obstacle",
        "plan detect_by_laser",
        "steering@scout",
        "offered service watch",
        "command base",
        "drive: allocated",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
}
