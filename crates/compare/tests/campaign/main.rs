//! Campaigns over rows that a shell script answers: what is stored, resumed, judged and written.

#![cfg(unix)]

mod project;
mod reports;
mod rows;

use std::path::Path;

#[test]
fn the_experiments_of_the_project_can_be_read_and_name_known_models() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let manifest = msplines_compare::models::Manifest::read(&data.join("models.toml"));
    let manifest = manifest.expect("a manifest");
    let folder = data.join("experiments");
    let all = msplines_compare::experiment::experiments(&folder, None, None).expect("experiments");
    for experiment in &all {
        for model in experiment
            .rows
            .iter()
            .filter_map(|row| row.model.as_deref())
        {
            let (paper, item) = (&experiment.paper, &experiment.item);
            assert!(
                manifest.model(model).is_some(),
                "{paper} {item} names {model}"
            );
        }
    }
    let error = msplines_compare::experiment::experiments(&folder, Some("p"), None);
    assert!(
        error
            .expect_err("no such paper")
            .to_string()
            .contains("hou2017 table1")
    );
}
