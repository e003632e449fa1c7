//! Every measured promise on a sample of its seeds; `make results` measures them in full. Tests run in the
//! repository's root, from which missions are named.

use soifra::{bars, sweep};

#[test]
fn bars_hold_on_a_sample() {
    let studies = bars::read("missions/bars.yaml").unwrap_or_else(|r| panic!("{}", r.findings.render(false)));
    for study in studies.into_iter().filter(|s| !s.sample.is_empty()) {
        let plan = study.plan(&study.sample).unwrap_or_else(|r| panic!("{}", r.findings.render(false)));
        let (document, _) = sweep::execute(&study.mission, None, plan, None, 2)
            .unwrap_or_else(|r| panic!("{}", r.findings.render(false)));
        for (bar, verdict) in study.bars.iter().zip(study.verdicts(&document)) {
            assert!(
                bar.full_only || verdict.met != Some(false),
                "{}: {} is {:?}",
                study.name,
                bar.metric,
                verdict.value
            );
        }
    }
}
