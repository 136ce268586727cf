//! What `cargo xtask` is made of, for the report too.

pub mod abi;
pub mod c_tests;
pub mod embree;
pub mod examples;
pub mod fill;
pub mod fit;
pub mod fuzz;
pub mod header;
pub mod install;
pub mod instructions;
pub mod library;
pub mod links;
pub mod outcome;
pub mod path_tracer;
pub mod paths;
pub mod python;
pub mod release;
pub mod report;
pub mod run;
pub mod test;
pub mod threads;
pub mod tiles;
pub mod tools;
pub mod train_mlp;
pub mod trainer;
pub mod valgrind;
