//! What a sweep runs.

use serde::{Deserialize, Serialize};

/// The plan: every platform with every combination of parameters with every seed, in that order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Platforms that replace the mission's own; empty: the mission's own.
    pub platforms: Vec<String>,
    /// Test whose faults happen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<String>,
    /// Parameters with the values they are given, in the order given.
    pub sets: Vec<(String, Vec<String>)>,
    /// Seeds, ascending.
    pub seeds: Vec<u64>,
}

/// A combination of platform and parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// The platform, if it was replaced.
    pub platform: Option<String>,
    /// Parameters as set.
    pub set: Vec<(String, String)>,
}

impl Case {
    /// For tables: `rules=safe speed=2`; `–` when nothing was set.
    pub fn label(&self) -> String {
        let sets = self.set.iter().map(|(n, v)| format!("{n}={v}"));
        let parts: Vec<String> = self.platform.iter().cloned().chain(sets).collect();
        if parts.is_empty() { "–".into() } else { parts.join(" ") }
    }
}

impl Plan {
    /// Every combination, in order; the last parameter changes fastest.
    pub fn cases(&self) -> Vec<Case> {
        let platforms: Vec<Option<String>> = match self.platforms.as_slice() {
            [] => vec![None],
            names => names.iter().cloned().map(Some).collect(),
        };
        let mut cases: Vec<Case> =
            platforms.into_iter().map(|platform| Case { platform, set: Vec::new() }).collect();
        for (name, values) in &self.sets {
            let with = |c: &Case, v: &String| {
                let mut c = c.clone();
                c.set.push((name.clone(), v.clone()));
                c
            };
            cases =
                cases.iter().flat_map(|c| values.iter().map(|v| with(c, v)).collect::<Vec<_>>()).collect();
        }
        cases
    }

    /// Number of runs, `None` when it does not fit.
    pub fn runs(&self) -> Option<usize> {
        let cases =
            self.sets.iter().try_fold(self.platforms.len().max(1), |n, (_, v)| n.checked_mul(v.len()))?;
        cases.checked_mul(self.seeds.len())
    }
}

/// Splits the values of a swept parameter at commas that stand outside brackets and quotes.
pub fn values(text: &str) -> Vec<String> {
    let (mut depth, mut quoted, mut out, mut part) = (0usize, false, Vec::new(), String::new());
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '(' | '[' | '{' if !quoted => depth += 1,
            ')' | ']' | '}' if !quoted => depth = depth.saturating_sub(1),
            ',' if depth == 0 && !quoted => {
                out.push(std::mem::take(&mut part));
                continue;
            }
            _ => {}
        }
        part.push(c);
    }
    out.push(part);
    out.into_iter().map(|v| v.trim().to_string()).filter(|v| !v.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_combination_in_order() {
        let plan = Plan {
            test: None,
            platforms: vec!["p".into(), "q".into()],
            sets: vec![("a".into(), values("1,2")), ("b".into(), values("(0 m, 1 m),x"))],
            seeds: vec![1, 2, 3],
        };
        let labels: Vec<String> = plan.cases().iter().map(Case::label).collect();
        assert_eq!(labels[..3], ["p a=1 b=(0 m, 1 m)", "p a=1 b=x", "p a=2 b=(0 m, 1 m)"]);
        assert_eq!((labels.len(), plan.runs()), (8, Some(24)));
    }
}
