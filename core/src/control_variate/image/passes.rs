//! Windows by rows, which fits are made to their groups, and what becomes of them.

use super::super::config::{Config, Estimate};
use super::batch::Batch;
use super::bright;
use super::call::Call;
use super::choice::{Choices, Shares, Spreads};
use super::edges::Edges;
use super::fit::Fits;
use super::groups::{Group, Groups, Kind};
use super::products::*;
use super::steps;
use super::sums::Band;
use super::terms::Terms;
use crate::processor::Processor;
use core::hint::black_box;

impl Call<'_> {
    /// All of it: windows some rows at a time, and pixels as soon as no later window has them.
    pub(super) fn run<P: Processor>(&self, arena: &mut Arena<'_, f32>, out: &mut dyn FnMut(usize, Estimate)) {
        let wanted = self.windows.wanted;
        let frames = self.windows.frames();
        let [across, down] = self.windows.counts();
        let [rows, touched] = self.band();
        let mut band = Band::new(self, touched, arena);
        let mut groups = self.groups(arena);
        let has_fits = self.has_edges() || self.fits_without_edges();
        let mut done = self.windows.top(0);
        for row in (0..down).step_by(rows.max(1)) {
            let last = (row + rows).min(down);
            for first in (row * across..last * across).step_by(self.windows_at_once().max(1)) {
                if !has_fits {
                    break;
                }
                let end = (first + self.windows_at_once()).min(last * across);
                self.divide(first, end, &mut groups);
                self.fit::<P>(&mut groups, arena);
                steps::add::<P>(self, &groups, &mut band);
            }
            let end = if last < down { self.windows.top(last) } else { wanted.y + wanted.height };
            for frame in 0..frames {
                for y in done..end {
                    steps::write::<P>(self, (frame, y), &mut band, out);
                }
            }
            done = end;
        }
    }

    /// Fits to all groups: first to all of their pixels, then, where some are too bright, to the others.
    fn fit<P: Processor>(&self, groups: &mut Groups<'_>, arena: &mut Arena<'_, f32>) {
        let later = if self.is_single_fit() { 0 } else { self.turns() };
        let (all, channels) = (self.fits_without_edges(), self.config.channels);
        for (pass, kind) in (0..=later).flat_map(|pass| [(pass, Kind::Smooth), (pass, Kind::Edges)]) {
            let turn = pass.checked_sub(1);
            let mut place = 0;
            // Groups of one size, which come one after the other, have the same.
            let mut last = (0, (0, 0));
            loop {
                let mut lanes = [Group::default(); LANES];
                let (mut used, mut columns) = (0, (0, 0));
                // Eight, or fewer if the next have other columns.
                while let Some(group) = groups.by_size(place).filter(|_| used < LANES) {
                    let is_kind = group.kind == kind && (all || kind == Kind::Edges);
                    let (_, limits) = groups.found(&group);
                    let is_limited = |turn| row_at(limits, 2 * channels, turn).iter().any(|limit| limit.is_finite());
                    if is_kind && turn.is_none_or(is_limited) {
                        if last.0 != group.len {
                            let terms = Terms::new(self, group.len, false);
                            last = (group.len, (terms.columns(), terms.all_own()));
                        }
                        if used > 0 && last.1 != columns {
                            break;
                        }
                        columns = last.1;
                        if self.is_joined() {
                            lanes = [group; LANES];
                        } else {
                            set(&mut lanes, used, group);
                        }
                        used += 1;
                    }
                    place += 1;
                }
                if used == 0 {
                    break;
                }
                self.batch::<P>(lanes, turn, groups, arena);
            }
        }
    }

    /// Fits to eight groups. In a later `turn` only pixels within its limits are fitted to.
    fn batch<P: Processor>(
        &self,
        lanes: [Group; LANES],
        turn: Option<usize>,
        groups: &mut Groups<'_>,
        arena: &mut Arena<'_, f32>,
    ) {
        let arena = &mut arena.scratch();
        let [Group { len, kind, .. }, ..] = lanes;
        let terms = Terms::new(self, len, kind == Kind::Edges);
        let mut batch = Batch::new(self, terms, lanes, arena);
        steps::survey::<P>(&mut batch, groups);
        if let Some(turn) = turn {
            batch.leave_out(groups, turn);
        }
        if self.image.has_known() {
            steps::relate::<P>(&mut batch, arena);
        }
        steps::load::<P>(&mut batch, arena);
        let mut fits = Fits::new(&batch, arena);
        let mut edges = Edges::new(&batch, arena);
        if let Some(edges) = &mut edges {
            steps::load_edges::<P>(edges, &batch);
        }
        let choices = Choices::new(self, &batch.terms);
        let mut shares = Shares::last(choices, arena);
        // Halves choose for each other, then fits to all correct; or fits to all do both.
        let turns = self.turns();
        for step in 0..if turns == 2 { 3 } else { 1 } {
            let is_last = turns == 1 || step == 2;
            if turn.is_some_and(|turn| !is_last && step != turn) {
                continue;
            }
            let judges = if is_last { Colours::ALL } else { Colours::HALVES[(step + 1) % 2] };
            steps::correct::<P>(&mut fits, &batch, judges);
            let present = match &mut edges {
                Some(edges) => steps::correct_edges::<P>(edges, &batch, judges, &mut fits),
                None => NONE,
            };
            let spreads = steps::spreads::<P>(choices, &batch, &fits, judges, &mut arena.scratch());
            let chooses = !self.is_single_fit() && (turns == 1 || !is_last);
            if chooses {
                let colours = if turns == 1 { COLOURS } else { 0 };
                steps::choose::<P>(&spreads, colours, step, self.config.stratified, &present, &mut shares);
                if turn.is_none() {
                    steps::find_limits::<P>(&batch, groups, (step, judges), &shares);
                }
            }
            if is_last {
                if turn.is_none() {
                    self.tell(groups, &batch, &spreads, &shares);
                }
                steps::put::<P>(&batch, groups, &fits, turn, &shares);
            }
        }
    }

    /// What is told of the groups' errors. Bright pixels count: without them the error would be told too small where
    /// every pixel has rare bright samples.
    fn tell(&self, groups: &mut Groups<'_>, batch: &Batch<'_>, spreads: &Spreads<'_>, shares: &Shares<'_>) {
        let channels = self.config.channels;
        let by_groups = self.error_is_the_groups();
        let mut ratios = [[0.0; LANES]; Config::MAX_CHANNELS];
        for (channel, ratio) in ratios.iter_mut().enumerate().take(channels) {
            for turn in 0..self.turns() {
                let turn = spreads.ratio(channel, shares.of(turn, channel), !by_groups);
                *ratio = lanes::zip(ratio, &turn, |sum, turn| sum + turn / self.turns() as f32);
            }
        }
        let freedom = lanes::divisor(&spreads.freedom);
        for (lane, group) in batch.lanes.iter().enumerate().filter(|(_, group)| group.len > 0) {
            let (told, _) = groups.found_mut(group);
            let Some(([gain, has_error], errors)) = told.split_first_chunk_mut() else { continue };
            // Without freedom there is no spread to tell the error from.
            let is_known = !by_groups || spreads.freedom[lane % LANES] > 0.0;
            *has_error = if is_known { 1.0 } else { 0.0 };
            *gain = 0.0;
            let channels_of = ratios.iter().zip(&batch.units).enumerate();
            for (error, (channel, (ratio, units))) in errors.iter_mut().zip(channels_of) {
                let plain = spreads.plain(channel);
                *gain += ratio[lane % LANES] / channels as f32;
                let spread = black_box(ratio[lane % LANES] * plain[lane % LANES]) / freedom[lane % LANES];
                *error = if by_groups {
                    Real::sqrt(spread) * units.powers[lane % LANES]
                } else {
                    Real::sqrt(ratio[lane % LANES])
                };
            }
        }
    }
}

impl Batch<'_> {
    /// Keeps the corrections of the pixels that are chosen for in a turn.
    #[inline]
    pub(super) fn put(&self, groups: &mut Groups<'_>, fits: &Fits<'_>, turn: Option<usize>, shares: &Shares<'_>) {
        let (channels, turns) = (self.call.config.channels, self.call.turns());
        for block in 0..self.len {
            let half = if turns == 1 { 0 } else { usize::from(Colours::HALVES[1].has(block)) };
            if turn.is_some_and(|turn| turn != half) {
                continue;
            }
            for (channel, units) in self.units.iter().enumerate().take(channels) {
                let mut sum = [NONE; AT_ONCE];
                let means = row_at(self.means, self.values, block);
                for (row, sum) in sum.iter_mut().enumerate() {
                    let time = if turns == 1 { 1 + self.colour((block, row)) } else { half };
                    for (kind, shares) in rows(shares.of(time, channel), 1 + fits.count).enumerate() {
                        let Some((plain, shares)) = shares.split_first() else { continue };
                        let value = channel + kind * channels;
                        for (correction, share) in fits.corrections(block, value).iter().zip(shares) {
                            *sum = lanes::plus_product(*sum, correction[row % AT_ONCE], *share);
                        }
                        if let (1, Some(mean), Some(other)) = (kind, means.get(channel), means.get(value)) {
                            let known = minus(&other[row % AT_ONCE], &mean[row % AT_ONCE]);
                            let share = shares.iter().fold(*plain, |sum, share| plus(&sum, share));
                            *sum = lanes::plus_product(*sum, known, share);
                        }
                    }
                }
                // What is too large is no number, and found at the end.
                let sum = sum.map(|sum| {
                    lanes::zip(&sum, &units.powers, |sum, power| if sum.is_finite() { sum * power } else { 0.0 })
                });
                for (row, sum) in sum.iter().enumerate() {
                    for ((group, index), sum) in self.lanes.iter().zip(self.members((block, row))).zip(sum) {
                        let at = group.start * channels + channel * group.len + index as usize;
                        if (index as usize) < group.len {
                            set(groups.corrections, at, *sum);
                        }
                    }
                }
            }
        }
    }

    /// Finds the limits of the groups' values for a turn, where any is too far from those of the `judges`.
    #[inline(always)]
    pub(super) fn find_limits(&self, groups: &mut Groups<'_>, (turn, judges): (usize, Colours), shares: &Shares<'_>) {
        let channels = self.call.config.channels;
        for channel in 0..channels {
            let trust = at(shares.of(turn, channel), 0);
            let limits = bright::limits(self, channel, judges, &trust);
            for (lane, group) in self.lanes.iter().enumerate().filter(|(_, group)| group.len > 0) {
                let (_, out) = groups.found_mut(group);
                copy(row_at_mut(out, 2, turn * channels + channel), &limits[lane % LANES]);
            }
        }
    }
}
