//! Nanoseconds against the number of items.

use super::BATCH;
use crate::chapters::chapter::{Cell, Chapter, row};
use crate::chapters::figure::{Figure, Unit};
use crate::chapters::statistics::Estimate;
use crate::chapters::targets::Targets;
use crate::measure::table::Table;
use anyhow::{Context, Result};

const OURS: &str = "nf_table";
const PEER: &str = "WeightedTreeIndex";
const ALIAS: &str = "alias table rebuilt";
const CACHES: [&str; 2] = ["warm", "cold"];

/// (items, microseconds of a step): what the project has set itself, warm.
const BOUNDS: [(u32, f64); 2] = [(60_000, 1.0), (1_000_000, 2.5)];
/// How many times as fast as the peer, and as the alias table from so many items on.
const FASTER: f64 = 5.0;
const AS_FAST_AS_ALIAS: f64 = 100.0;
const LARGE: u32 = 60_000;

/// One method at one size, a value for each chunk.
struct Row {
    items: u32,
    cache: &'static str,
    method: String,
    draw: Vec<f64>,
    update: Vec<f64>,
}

impl Row {
    /// Microseconds.
    fn step(&self) -> Vec<f64> {
        self.draw.iter().zip(&self.update).map(|(draw, update)| (draw + update) * f64::from(BATCH) / 1000.0).collect()
    }

    fn place(&self) -> String {
        format!("{} items, {}", self.items, self.cache)
    }
}

pub(super) struct Times(Vec<Row>);

impl Times {
    pub(super) fn new(all: &Table) -> Result<Self> {
        let mut rows = Vec::new();
        for items in all.distinct("items")? {
            for cache in CACHES {
                let some = all.only("items", items)?.only("cache", cache)?;
                for method in some.distinct("method")? {
                    let own = some.only("method", method)?;
                    rows.push(Row {
                        items: items.parse().with_context(|| format!("`{items}` is no number of items"))?,
                        cache,
                        method: method.to_owned(),
                        draw: own.numbers("draw")?,
                        update: own.numbers("update")?,
                    });
                }
            }
        }
        Ok(Self(rows))
    }

    fn find(&self, method: &str, items: u32, cache: &str) -> Option<&Row> {
        self.0.iter().find(|row| row.method == method && row.items == items && row.cache == cache)
    }

    /// Sizes and caches at which both were measured.
    fn pairs(&self) -> impl Iterator<Item = (&Row, &Row)> {
        let ours = self.0.iter().filter(|row| row.method == OURS);
        ours.filter_map(|ours| Some((ours, self.find(PEER, ours.items, ours.cache)?)))
    }

    pub(super) fn write(&self, chapter: &mut Chapter, targets: &mut Targets) {
        chapter.section("Time of draws and updates", "section 6.1");
        let rows = self.0.iter().map(|row| -> Vec<Cell> {
            let ratio = self.find(PEER, row.items, row.cache).filter(|_| row.method != PEER);
            let ratio = ratio.map(|peer| Figure::new(Estimate::ratio(&row.step(), &peer.step()), Unit::Ratio));
            row![
                row.items,
                row.cache,
                row.method.clone(),
                Figure::new(Estimate::median(&row.draw), Unit::Nanoseconds),
                Figure::new(Estimate::median(&row.update), Unit::Nanoseconds),
                Figure::new(Estimate::median(&row.step()), Unit::Microseconds),
                ratio
            ]
        });
        let columns =
            ["items", "caches", "method", "ns per draw", "ns per update", "us per step", "step / WeightedTreeIndex's"];
        chapter.table("times", &columns, 3, rows.collect());

        // What a text can quote: how many times as long the others take, warm.
        let others = self.0.iter().filter(|row| row.cache == "warm" && row.method != OURS).filter_map(|row| {
            let ours = self.find(OURS, row.items, row.cache)?;
            let ratio = Figure::new(Estimate::ratio(&row.step(), &ours.step()), Unit::Ratio);
            Some(row![row.items, row.method.clone(), ratio])
        });
        chapter.table("times as long", &["items", "method", "step / `nf_table`'s"], 2, others.collect());

        self.judge(targets);
    }

    fn judge(&self, targets: &mut Targets) {
        for (items, bound) in BOUNDS {
            if let Some(row) = self.find(OURS, items, "warm") {
                let statement = format!("A step's time in us, {items} items");
                targets.at_most(&statement, &row.place(), Estimate::median(&row.step()), Unit::Microseconds, bound);
            }
        }
        for ours in self.0.iter().filter(|row| row.method == OURS && row.cache == "warm") {
            if let Some(alias) = self.find(ALIAS, ours.items, ours.cache).filter(|row| row.items >= LARGE) {
                let ratio = Estimate::ratio(&alias.step(), &ours.step());
                let statement = "A step's time: the rebuilt alias table's over `nf_table`'s";
                targets.at_least(statement, &ours.place(), ratio, Unit::Ratio, AS_FAST_AS_ALIAS);
            }
        }
        for (ours, peer) in self.pairs() {
            let ratio = Estimate::ratio(&peer.step(), &ours.step());
            // The bound is for large tables in a loop that does nothing else; elsewhere, to be no slower is asked.
            let bound = if ours.cache == "warm" && ours.items >= LARGE { FASTER } else { 1.0 };
            let kind = if bound > 1.0 { "large and warm" } else { "small or cold" };
            let statement = format!("A step's time: WeightedTreeIndex's over `nf_table`'s, {kind}");
            targets.at_least(&statement, &ours.place(), ratio, Unit::Ratio, bound);
        }
    }
}
