//! Plots of the quantities of rows.

use super::DrawnPlot;
use crate::campaign::ItemReport;
use crate::experiment::Plot;

pub(super) fn plot(_item: &ItemReport, _plot: &Plot) -> Option<DrawnPlot> {
    None
}

pub(super) fn pareto(_item: &ItemReport) -> Vec<DrawnPlot> {
    Vec::new()
}
