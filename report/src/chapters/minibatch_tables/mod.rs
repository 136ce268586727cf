//! The chapter on tables of importances: time of draws and updates against size, memory, drift.

mod drift;
mod times;

use super::Report;
use super::chapter::Chapter;
use super::measured::Measured;
use super::program;
use super::targets::Targets;
use crate::measure::table::Table;
use anyhow::Result;
use times::Times;

/// Draws, and updates, of a step: what the program measures.
const BATCH: u32 = 64;

pub(super) fn write(report: &Report) -> Result<()> {
    let measured = Measured::new("tables", report.plan.name(), report.reuse)?;
    let path = |name: &str| measured.folder().join(name);
    let reused = report.reuse && path("drift.csv").exists();
    if !reused {
        let [program] = report.build()?;
        program::measure(report, &program, measured.folder())?;
    }
    let read = |name: &str| Table::read(&path(name), ',');
    let (times, items, drift) = (Times::new(&read("times.csv")?)?, read("items.csv")?, read("drift.csv")?);

    let mut chapter = Chapter::new("Tables of importances");
    introduce(&mut chapter);
    if reused {
        report.reused.set(true);
        chapter.paragraph(
            "Written anew from what an earlier run measured, whose date, times and other work the index has.",
        );
    }
    let (mut body, mut targets) = (Chapter::default(), Targets::default());
    times.write(&mut body, &mut targets, report.output)?;
    drift::memory(&items, &mut body, &mut targets)?;
    drift::write(&drift, &mut body, &mut targets)?;
    targets.reason(
        ["A step's time in us", ""],
        "a step takes tens of thousands of instructions (chapter `instructions`), and each level of the tree is a read of memory",
    );
    targets.write_summary(&mut chapter);
    chapter.append(body);
    report.write(&chapter)
}

fn introduce(chapter: &mut Chapter) {
    let batch = chapter.setting("draws and updates of a step", BATCH);
    let megabytes = chapter.setting("MB read before cold draws and updates", 64);
    let percent = chapter.setting("confidence, percent", 95);
    chapter.paragraph(&format!(
        "Made by `cargo xtask report`; machine-readable in `tables.json`; the program is `bench/benches/minibatch_table`. A step of training \
         draws {batch} items in proportion to their importance, and later updates their importances. All methods take turns in one process, a \
         chunk of steps at a time. A chunk's figure is the median of its steps, so that what another program delays does not count; a \
         figure is the median of the chunks and in brackets its {percent} % confidence interval (bootstrap), ratios chunk by chunk."
    ));
    chapter.list(&[
        "`nf_table`: this library through its C ABI, with the vector units that it finds. Its draws return weights too; the peers' do not."
            .to_owned(),
        "Table in Rust: the same, without `unsafe` and so without vector instructions.".to_owned(),
        "WeightedTreeIndex: the tree of `rand_distr`, f32. Alias table rebuilt: `rand_distr`'s `WeightedAliasIndex`, which cannot be \
         updated: it is made anew once a step, and that time, of the processor, is divided by the step's updates."
            .to_owned(),
        format!("Warm: steps follow each other at once. Cold: {megabytes} MB are read before the draws, and again before the updates."),
    ]);
}
