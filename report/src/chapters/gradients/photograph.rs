//! fit_image.cpp: a photograph learned by a network (figure 6.13).

use super::Context;
use super::summary::Summary;
use super::trainer::Program;
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::Unit;
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use anyhow::Result;

/// The column with the mean of each parameter's ratio.
const ERROR: usize = 3;

pub(super) fn write(context: &Context, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let program = Program::compile("fit_image.cpp", &context.archive)?;
    let all = ["--methods", "is,balance3,omis3,balance6,omis6", "--variance"];
    let losses = context.run(&program, "photograph", &["--methods", "uniform,is,omis3,omis6"])?;
    let strata = context.run(&program, "photograph strata", &["--methods", "is,omis3,omis6", "--stratified"])?;
    let errors = context.run(&program, "photograph variance", &all)?;
    let strata_errors = context.run(&program, "photograph variance strata", &[&all[..], &["--stratified"]].concat())?;

    chapter.section("A photograph", "figure 6.13");
    Summary::parse(&losses.summary)?.write(chapter, "photograph", 1);
    Summary::parse(&strata.summary)?.write(chapter, "photograph strata", 1);
    let variance = Summary::parse(&errors.summary)?;
    variance.write(chapter, "photograph variance", 2);
    Summary::parse(&strata_errors.summary)?.write(chapter, "photograph variance strata", 2);
    for step in ["1000", "2000", "3000", "4000"] {
        let column = variance.columns.get(ERROR).map_or("", String::as_str);
        let error = |method: &str| variance.number(&[step, method], column).map(|(error, _)| error);
        if let (Some(omis), Some(is)) = (error("omis3"), error("is")) {
            let statement = "Photograph: error of the gradient, omis3 over is, tables as kept";
            targets.below(statement, &format!("step {step}"), Estimate::exact(omis / is), Unit::Ratio, 1.0);
        }
    }
    Ok(())
}
