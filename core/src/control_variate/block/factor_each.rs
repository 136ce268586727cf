//! A factorisation for each pixel, eight side by side.

use super::super::config::Config;
use super::fit::{Problem, Setting};
use super::members::Members;
use super::panel::only_used;
use crate::arena::Arena;
use crate::error::Error;
use crate::lanes::{self, LANES, Lanes};
use crate::linalg::{ldlt, packed_len, row, row_mut};
use crate::real::Real;
use crate::rows::{rows, rows_mut};

impl Problem<'_> {
    /// Many samples in each pixel: A less the pixel's own products, factored for eight pixels at a time, which takes
    /// less time than updating one factor by rank n.
    #[inline(always)]
    pub(super) fn by_factor_each<R: Real>(
        &self,
        members: &Members<'_>,
        setting: &Setting<'_, R>,
        estimates: &mut [Lanes<R>],
        arena: &mut Arena<'_, R>,
    ) -> Result<(), Error> {
        let mut arena = arena.scratch();
        let terms = setting.terms;
        let (width, channels) = (terms.columns(), self.config.channels);
        let (squares, all) = (packed_len(width), packed_len(width) + width * channels);
        let count = members.len.div_ceil(LANES);
        let own = arena.take_lanes(count * all)?;
        let system = arena.take_lanes(all)?;
        let scratch = arena.take_lanes(width)?;
        let total = arena.take(all)?;
        let penalties = arena.take(width)?;
        for value in total.iter_mut() {
            *value = R::ZERO;
        }
        for (index, (own, used)) in rows_mut(own, all).zip(setting.places()).enumerate() {
            let whole;
            let mut places = used;
            if setting.leaves_out {
                whole = members.places(index * LANES);
                places = whole.get(..terms.fixed()).unwrap_or(&[]);
            }
            for value in own.iter_mut() {
                *value = [R::ZERO; LANES];
            }
            let (gram, rhs) = own.split_at_mut_checked(squares).unwrap_or((&mut [], &mut []));
            let panel = self.panel(members, index * LANES);
            let columns = &mut *scratch;
            let mut values = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            for sample in 0..self.n {
                self.load(setting, &panel, sample, places, columns, values.get_mut(..channels).unwrap_or(&mut []));
                for (j, column) in columns.iter().enumerate() {
                    for (out, other) in row_mut(gram, j).iter_mut().zip(columns.iter()) {
                        lanes::add_product(out, column, other);
                    }
                }
                for (rhs, value) in rows_mut(rhs, width).zip(&values) {
                    for (out, column) in rhs.iter_mut().zip(columns.iter()) {
                        lanes::add_product(out, value, column);
                    }
                }
            }
            if setting.leaves_out {
                for (total, own) in total.iter_mut().zip(own.iter()) {
                    *total += lanes::sum(&only_used(own, used));
                }
                continue;
            }
            for (total, own) in total.iter_mut().zip(own.iter()) {
                *total += lanes::sum(own);
            }
        }
        let training = (members.len - 1) * self.n;
        self.add_ridge(terms, training, total.get_mut(..squares).unwrap_or(&mut []), penalties);
        let inverse = R::ONE / R::from_usize(self.n);
        let fixed = terms.fixed();
        let outputs = rows_mut(estimates, setting.estimates(channels));
        for ((own, used), out) in rows(own, all).zip(setting.places()).zip(outputs) {
            for ((out, &total), own) in system.iter_mut().zip(total.iter()).zip(own) {
                *out = own.map(|own| total - own);
            }
            if setting.leaves_out {
                // Once more: told apart above, the usual case would take longer.
                for ((out, &total), own) in system.iter_mut().zip(total.iter()).zip(own) {
                    *out = only_used(own, used).map(|own| total - own);
                }
            }
            let (gram, rhs) = system.split_at_mut_checked(squares).unwrap_or((&mut [], &mut []));
            let (own_gram, own_rhs) = own.split_at_checked(squares).unwrap_or((&[], &[]));
            ldlt::factor_each(gram, width);
            // The means of the pixel's columns, which its fit is corrected by.
            let y = &mut *scratch;
            for (j, y) in y.iter_mut().enumerate() {
                let sum = row(own_gram, j).first().copied().unwrap_or([R::ZERO; LANES]);
                *y = if j < fixed { [R::ZERO; LANES] } else { sum.map(|sum| sum * inverse) };
            }
            ldlt::forward_each(gram, fixed, y);
            ldlt::scale_each(gram, y);
            let mut corrected = [[R::ZERO; LANES]; Config::MAX_CHANNELS];
            for (rhs, (own, corrected)) in rows_mut(rhs, width).zip(rows(own_rhs, width).zip(&mut corrected)) {
                ldlt::forward_each(gram, 0, rhs);
                let sum = own.first().copied().unwrap_or([R::ZERO; LANES]);
                *corrected = sum.map(|sum| sum * inverse);
                if setting.leaves_out {
                    // Their values may be out of a narrow type's range; only what they are corrected by counts.
                    *corrected = only_used(corrected, used);
                }
            }
            let mut out = rows_mut(out, channels);
            for (out, mean) in out.next().unwrap_or(&mut []).iter_mut().zip(&corrected) {
                *out = *mean;
            }
            let mut begin = 0;
            for (&end, out) in terms.ends.iter().zip(out) {
                for (corrected, rhs) in corrected.iter_mut().zip(rows(rhs, width)) {
                    for (rhs, y) in rhs.iter().zip(y.iter()).take(end).skip(begin) {
                        *corrected = lanes::minus_product(*corrected, *rhs, *y);
                    }
                }
                begin = end;
                for (out, corrected) in out.iter_mut().zip(&corrected) {
                    *out = *corrected;
                }
            }
        }
        Ok(())
    }
}
