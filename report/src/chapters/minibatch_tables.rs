//! The chapter on tables of importances: time of draws and updates against size, memory, drift.

use super::prelude::*;
use super::{Report, program};

/// Draws, and updates, of a step: what the program measures.
const BATCH: u32 = 64;

pub(super) fn write(report: &Report) -> Result<Chapter> {
    let tables = program::measure(report)?;
    let (mut chapter, mut targets) = (Chapter::new("Tables of importances"), Targets::default());
    chapter.setting("draws and updates of a step", BATCH);
    times(&tables.read("times")?, &mut chapter, &mut targets)?;
    memory(&tables.read("items")?, &mut chapter, &mut targets)?;
    drift(&tables.read("drift")?, &mut chapter, &mut targets)?;
    targets.write(&mut chapter);
    Ok(chapter)
}

const OURS: &str = "nf_table";
const PEER: &str = "WeightedTreeIndex";
const ALIAS: &str = "alias table rebuilt";

/// (items, microseconds of a step): what the project has set itself, warm.
const BOUNDS: [(u32, f64); 2] = [(60_000, 1.0), (1_000_000, 2.5)];
/// How many times as fast as the peer, and as the alias table from so many items on.
const FASTER: f64 = 5.0;
const AS_FAST_AS_ALIAS: f64 = 100.0;
const LARGE: u32 = 60_000;

/// One method at one size, a value for each chunk.
struct Method<'a> {
    items: u32,
    cache: &'a str,
    name: &'a str,
    draw: Vec<f64>,
    update: Vec<f64>,
    /// Microseconds of a step.
    step: Vec<f64>,
}

impl<'a> Method<'a> {
    fn all(table: &'a Table) -> Result<Vec<Self>> {
        let sorted =
            table.distinct("items")?.into_iter().flat_map(|items| ["warm", "cold"].map(|cache| (items, cache)));
        let kinds = table.kinds(&["items", "cache", "method"])?;
        let of = |(items, cache)| kinds.iter().filter(move |kind| kind[..2] == [items, cache]);
        let method = |kind: &Vec<&'a str>| {
            let wanted = [("items", kind[0]), ("cache", kind[1]), ("method", kind[2])];
            let [draw, update] = ["draw", "update"].map(|column| table.numbers_of(column, &wanted));
            let (draw, update) = (draw?, update?);
            let step = draw.iter().zip(&update).map(|(draw, update)| (draw + update) * f64::from(BATCH) / 1000.0);
            Ok(Self { items: kind[0].parse()?, cache: kind[1], name: kind[2], step: step.collect(), draw, update })
        };
        sorted.flat_map(of).map(method).collect()
    }

    /// Another at the same size and cache.
    fn beside<'b>(&self, all: &'b [Self], name: &str) -> Option<&'b Self> {
        all.iter().find(|other| (other.name, other.items, other.cache) == (name, self.items, self.cache))
    }
}

/// Nanoseconds against the number of items.
fn times(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Time of draws and updates", "section 6.1");
    let all = Method::all(table)?;
    let rows = all.iter().map(|of| {
        let ratio = of.beside(&all, PEER).filter(|_| of.name != PEER).map(|peer| Figure::ratio(&of.step, &peer.step));
        let [draw, update] = [&of.draw, &of.update].map(|times| Figure::median(times, Unit::Nanoseconds));
        row![of.items, of.cache, of.name, draw, update, Figure::median(&of.step, Unit::Microseconds), ratio]
    });
    let columns = "items | caches | method | ns per draw | ns per update | us per step | step / WeightedTreeIndex's";
    chapter.table("times", columns, 3, rows.collect());
    // What a text can quote: how many times as long the others take, warm.
    let others = all
        .iter()
        .filter(|of| of.cache == "warm" && of.name != OURS)
        .filter_map(|of| Some(row![of.items, of.name, Figure::ratio(&of.step, &of.beside(&all, OURS)?.step)]));
    chapter.table("times as long", "items | method | step / `nf_table`'s", 2, others.collect());
    judge(&all, targets);
    Ok(())
}

fn judge(all: &[Method], targets: &mut Targets) {
    let place = |of: &Method| format!("{} items, {}", of.items, of.cache);
    let ours = || all.iter().filter(|of| of.name == OURS);
    for (items, bound) in BOUNDS {
        if let Some(of) = ours().find(|of| of.items == items && of.cache == "warm") {
            let statement = format!("A step's time in us, {items} items");
            targets.at_most(&statement, &place(of), Estimate::median(&of.step), Unit::Microseconds, bound);
        }
    }
    for of in ours().filter(|of| of.cache == "warm" && of.items >= LARGE) {
        if let Some(alias) = of.beside(all, ALIAS) {
            let ratio = Estimate::ratio(&alias.step, &of.step);
            let statement = "A step's time: the rebuilt alias table's over `nf_table`'s";
            targets.at_least(statement, &place(of), ratio, Unit::Ratio, AS_FAST_AS_ALIAS);
        }
    }
    for of in ours() {
        let Some(peer) = of.beside(all, PEER) else { continue };
        // The bound is for large tables in a loop that does nothing else; elsewhere, to be no slower is asked.
        let is_large = of.cache == "warm" && of.items >= LARGE;
        let (kind, bound) = if is_large { ("large and warm", FASTER) } else { ("small or cold", 1.0) };
        let statement = format!("A step's time: WeightedTreeIndex's over `nf_table`'s, {kind}");
        targets.at_least(&statement, &place(of), Estimate::ratio(&peer.step, &of.step), Unit::Ratio, bound);
    }
}

/// Bytes per item, and the time of a pass over all items.
fn memory(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Memory", "");
    let mut rows = Vec::new();
    for row in table.rows() {
        let (items, bytes): (f64, f64) = (row.number("items")?, row.number("bytes")?);
        let epsilon = row.number::<f64>("epsilon").ok().map(|value| Figure::exact(value, Unit::PerItem));
        let method = row.word("method")?;
        if method == OURS {
            let estimate = Estimate::exact(bytes / items);
            targets.at_most("Bytes per item", &format!("{items} items"), estimate, Unit::BytesPerItem, 5.0);
        }
        rows.push(row![items as u32, method, Figure::exact(bytes / items, Unit::BytesPerItem), epsilon]);
    }
    chapter.table("memory", "items | method | bytes per item | ns per item to add epsilon", 2, rows);
    Ok(())
}

/// After many updates: against a new table, and against the importances in f64.
fn drift(table: &Table, chapter: &mut Chapter, targets: &mut Targets) -> Result<()> {
    chapter.section("Drift", "");
    let count = |value: f64| Figure::exact(value, Unit::Count);
    if let Some(first) = table.rows().next() {
        chapter.quote("drift: items", count(first.number("items")?));
        chapter.quote("drift: updates", count(first.number("updates")?));
    }
    let mut rows = Vec::new();
    for row in table.rows() {
        let number = |column: &str| row.number::<f64>(column);
        let (changed, risen, lost) = (number("changed")?, number("risen")?, number("lost")?);
        let (method, error) = (row.word("method")?, Figure::exact(number("error")?, Unit::Scientific));
        rows.push(row![method, count(changed), count(number("compared")?), count(risen), count(lost), error]);
        if method == OURS {
            let what = [("Drift: numbers changed by updates", changed), ("Drift: items risen or lost", risen + lost)];
            for (statement, found) in what {
                targets.at_most(statement, "all updates", Estimate::exact(found), Unit::Count, 0.0);
            }
        }
    }
    chapter.table("drift", "method | changed | of | risen | lost | largest error", 1, rows);
    Ok(())
}
