//! `fsot`: makes point sets and sample tiles by filtered sliced optimal transport.

fn main() {}
