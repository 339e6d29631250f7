//! The program as a person runs it: exit codes, messages and files.

mod biharmonic;
mod conformal;
mod exit_codes;
mod files;
mod hostile;
mod manifold;
mod powell_sabin;
mod solid;
mod t_spline;
mod workbench;
