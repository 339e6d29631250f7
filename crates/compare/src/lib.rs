//! The comparison harness: runs a fit as a recorded case, judges it, and writes the tables.
//!
//! [`run::run`] turns a [`case::Case`] into a [`record::Record`]; the program `msplines` and
//! `cargo xtask repro` are two thin callers of it. An [`experiment::Experiment`] is a table or
//! figure of a paper as data; a [`campaign::Campaign`] runs its rows, each in a process of its own,
//! stores every finished row at once, gives [`verdict`]s and hands a report to [`report`].

pub mod animation;
mod arrays;
pub mod atlas_file;
pub mod battery;
pub mod campaign;
pub mod case;
pub mod clock;
pub mod display;
pub mod error;
pub mod experiment;
mod fit;
pub mod generated;
pub mod input;
pub mod machine;
pub mod measure;
pub mod models;
pub mod output;
pub mod peers;
pub mod record;
pub mod report;
pub mod row_process;
pub mod run;
pub mod spline_file;
pub mod store;
pub mod verdict;
