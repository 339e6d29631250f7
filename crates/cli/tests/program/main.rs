//! The program as a person runs it: exit codes, messages and files.

mod biharmonic;
mod conformal;
mod exit_codes;
mod files;
mod hostile;
mod kills;
mod manifold;
mod placed;
mod powell_sabin;
mod same_bits;
mod shape;
mod solid;
mod t_spline;
mod workbench;
