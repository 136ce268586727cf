//! fit_polynomial.c: loss at the end, and errors of the gradient by coefficient (figure 6.10).

use super::Context;
use super::summary::Summary;
use crate::chapters::chapter::Chapter;
use crate::chapters::figure::Unit;
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::demo::training::polynomial;
use crate::demo::training::program::Program;
use anyhow::Result;

pub(super) fn write(context: &Context, program: &Program, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    let (seeds, steps, batches) =
        if context.sizes() == "quick" { ("2", "1000", "100") } else { ("40", "3000", "2000") };
    let small = ["--seeds", seeds, "--steps", steps, "--batches", batches];
    let trained = context.run(program, "polynomial", &[&small[..], &["--beta", "0.7"]].concat())?;
    let errors = context.run(program, "polynomial variance", &[&small[..], &["--variance"]].concat())?;

    chapter.section("A polynomial of order 6", "figure 6.10");
    for (name, value) in
        [("problems", seeds), ("steps", steps), ("batches", batches), ("batch", "32"), ("rate", ".003")]
    {
        chapter.setting(format!("polynomial: {name}"), value);
    }
    let (order, range, beta) =
        (chapter.setting("polynomial: order", 6), chapter.setting("polynomial: x up to", 2), 0.7);
    chapter.setting("polynomial: beta", beta);
    chapter.setting("polynomial: tables", "2 4");
    chapter.paragraph(&format!(
        "Points of a random polynomial of order {order} on [-{range}, {range}]; its coefficients learned from another random start by Adam, batches of 32, {steps} \
         steps; {seeds} problems. is: one table; 2 and 4: so many tables; omis4-beta: momentum {beta} in the estimate. \"Problem by problem\" is the \
         geometric mean of the ratios to the exact gradient's loss."
    ));
    let losses = Summary::parse(&trained.summary)?;
    losses.write(chapter, "polynomial", 1);
    let description = "mean loss over the exact gradient's, against steps";
    context.plot(chapter, "polynomial", &polynomial::ratio_plot(&trained.csv)?, description)?;
    chapter.paragraph(&format!(
        "Mean squared error of the gradient's estimate over that of uniform draws, each coefficient's, at the same states on the exact gradient's way, \
         tables as the method's own batches have left them, {batches} batches:"
    ));
    let variance = Summary::parse(&errors.summary)?;
    variance.write(chapter, "polynomial variance", 2);
    let description = "error over uniform's, by coefficient, at the end";
    context.plot(chapter, "polynomial-variance", &polynomial::error_plot(&errors.csv)?, description)?;

    let place = format!("{seeds} problems, step {steps}");
    if let Some((ratio, _)) = losses.number(&["omis4"], "over exact") {
        targets.at_most(
            "Polynomial: loss at the end over the exact gradient's, omis4",
            &place,
            Estimate::exact(ratio),
            Unit::Ratio,
            2.0,
        );
    }
    for power in 0..=6 {
        let column = format!("x^{power}");
        let error = |method: &str| variance.number(&[steps, method], &column).map(|(error, _)| error);
        if let (Some(omis), Some(is)) = (error("omis4"), error("is")) {
            let statement = "Polynomial: error of a coefficient's derivative, omis4 over is";
            targets.below(statement, &format!("{column}, step {steps}"), Estimate::exact(omis / is), Unit::Ratio, 1.0);
        }
    }
    Ok(())
}
