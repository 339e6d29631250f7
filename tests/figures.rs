//! Rows of the papers' figures that need no model: what they are judged by must hold.

use std::path::Path;
use std::time::Instant;

use msplines_common::progress::unobserved;
use msplines_compare::case::Input;
use msplines_compare::experiment::{Ancestors, Experiment, Row};
use msplines_compare::models::Provenance;
use msplines_compare::output::{ROW_KNOTS, ROW_SURFACE, write_row_files};
use msplines_compare::record::Record;
use msplines_compare::run::run;
use msplines_compare::verdict::Judgement;

/// Interpolation solves nothing; thirty times what rounding was measured to do.
const INTERPOLATED: f64 = 1e-12;
/// Mean error of the spline of genus 8, of which 5 % are left for other kernels of the same solver.
const GENUS_8: f64 = 1.4e-4;

fn experiment(item: &str) -> Experiment {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/experiments/hou2017");
    Experiment::read(&data.join(format!("{item}.toml"))).expect("an experiment")
}

/// Runs the generated rows of an item that `wanted` names, in their order, and judges each.
fn records(item: &str, wanted: &[&str]) -> Vec<Record> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |row: &Option<String>, name: &str| {
        let row = row.as_ref()?;
        Some(folder.path().join(row).join(name))
    };
    let experiment = experiment(item);
    let row_of = |id: &&str| experiment.rows.iter().find(|row| row.id == *id);
    let rows = wanted
        .iter()
        .map(|id| row_of(id).expect("a row of the item"));
    rows.map(|row: &Row| {
        let surface = row.surface.as_deref().expect("a generated row");
        let ancestors = Ancestors {
            knots: file(&row.knots_from, ROW_KNOTS),
            reference: file(&row.compared_with, ROW_SURFACE),
        };
        let input = Input::Surface(surface.parse().expect("a surface"));
        let case = row.case(input, &ancestors).expect("a case");
        let output = run(&case, Instant::now(), &mut unobserved()).expect("a result");
        write_row_files(&folder.path().join(&row.id), &output).expect("written");
        let judgement = Judgement::of(row, Provenance::Generated, &output.record);
        assert_eq!(judgement.failure(), None, "{} of {item}", row.id);
        output.record
    })
    .collect()
}

fn mean(record: &Record) -> f64 {
    record.error.as_ref().expect("an error").mean
}

#[test]
fn figure_3_keeps_more_of_an_image_at_optimised_knots() {
    let pair = records("figure3", &["genus-8-3-exchange", "genus-8-3-blue-noise"]);
    let [optimised, even] = pair.as_slice() else {
        panic!("two rows");
    };
    assert_eq!(optimised.input.genus, Some(8));
    assert_eq!(optimised.dofs, even.dofs);
    let decibels = |record: &Record| record.error.as_ref().and_then(|error| error.psnr_db);
    assert!(decibels(optimised) > decibels(even));
}

#[test]
fn figure_4_has_biharmonic_splines_below_least_squares_meshes_at_equal_counts() {
    for count in ["100", "200", "400"] {
        let ids = ["biharmonic", "ls-mesh"].map(|method| format!("bumpy-sphere-{method}-{count}"));
        let pair = records("figure4", &[&ids[0], &ids[1]]);
        assert_eq!(pair[0].dofs, pair[1].dofs);
        assert!(mean(&pair[0]) < mean(&pair[1]));
    }
}

#[test]
fn figure_5_passes_through_every_vertex_of_its_coarse_mesh() {
    let record = records("figure5", &["bumpy-sphere"]).remove(0);
    assert_eq!(record.dofs, 3 * record.input.vertices);
    assert!(record.error.expect("an error").max < INTERPOLATED);
}

#[test]
fn figure_10_fits_a_surface_of_genus_8() {
    let record = records("figure10", &["genus-8"]).remove(0);
    assert_eq!(record.input.genus, Some(8));
    assert!(mean(&record) < GENUS_8);
}

#[test]
fn figure_11_gives_nearly_the_same_spline_on_other_tessellations() {
    let rows = [
        "bumpy-sphere-fine",
        "bumpy-sphere-coarse",
        "bumpy-sphere-coarse-inside",
        "bumpy-sphere-irregular",
        "bumpy-sphere-irregular-inside",
    ];
    let records = records("figure11", &rows);
    let apart = |record: &Record| record.checks["reference_rms"].as_f64().expect("measured");
    for other in records[1..].chunks_exact(2) {
        let [moved, same] = [&other[0], &other[1]];
        let error = same.error.as_ref().expect("an error").rms;
        assert_eq!(same.dofs, records[0].dofs);
        assert!(apart(same) < 0.5 * error, "{} of {error}", apart(same));
        assert!(apart(same) < apart(moved) && mean(same) < mean(moved));
    }
}
