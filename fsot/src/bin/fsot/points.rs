//! `fsot points`.

use crate::common::Common;
use fsot::error::{Error, Result};

/// What `fsot points` is asked for.
#[derive(clap::Args, Debug)]
pub(crate) struct Args {
    /// How many points
    #[arg(short, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..))]
    n: u32,
    #[command(flatten)]
    common: Common,
}

/// Makes the points, writes and measures them.
pub(crate) fn run(args: &Args) -> Result<()> {
    args.common.threads.install(|| make(args))?
}

fn make(args: &Args) -> Result<()> {
    args.common.check_outputs([])?;
    Err(Error::Input(format!("cannot make {} points yet", args.n)))
}
